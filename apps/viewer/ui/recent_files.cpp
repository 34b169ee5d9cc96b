// recent_files.cpp: the list of files opened lately, in the user's folder of states.
#include "ui/recent_files.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

#include "core/atomic_file.h"

namespace vog::viewer {

namespace fs = std::filesystem;

RecentFiles::RecentFiles(fs::path list) : list_(std::move(list)) {
    std::ifstream in(list_);
    for (std::string line; sets_.size() < kMost && std::getline(in, line);) {
        std::istringstream names(line);
        std::vector<std::string> set;
        for (std::string name; std::getline(names, name, '\t');)
            if (!name.empty()) set.push_back(name);
        if (!set.empty()) sets_.push_back(std::move(set));
    }
}

void RecentFiles::add(const std::vector<std::string>& files) {
    if (list_.empty() || files.empty()) return;
    std::vector<std::string> set;
    for (const std::string& file : files) {
        std::error_code code;
        const fs::path path = fs::absolute(file, code);
        set.push_back(code ? file : path.lexically_normal().string());
        if (set.back().find_first_of("\t\n\r") != std::string::npos) return;
    }
    std::erase(sets_, set);
    sets_.insert(sets_.begin(), std::move(set));
    if (sets_.size() > kMost) sets_.resize(kMost);
    std::error_code code;
    fs::create_directories(list_.parent_path(), code);
    write_file(list_, [&](std::ofstream& out) {
        for (const std::vector<std::string>& each : sets_) {
            const char* separator = "";
            for (const std::string& name : each) out << std::exchange(separator, "\t") << name;
            out << "\n";
        }
    });
}

fs::path recent_files_path() {
    const char* state = std::getenv("XDG_STATE_HOME");
    if (state && fs::path(state).is_absolute()) return fs::path(state) / "vog" / "recent";
    const char* home = std::getenv("HOME");
    if (!home || !*home) return {};
    return fs::path(home) / ".local" / "state" / "vog" / "recent";
}

std::string set_name(const std::vector<std::string>& files) {
    std::string name = fs::path(files.front()).filename().string();
    if (files.size() > 1) name += fmt::format(" and {} more", files.size() - 1);
    return name;
}

}  // namespace vog::viewer
