// outputs.cpp: extensions, folders and identity of the files that a command writes.
#include "files/outputs.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <map>
#include <system_error>

#include "files/inputs.h"
#include "files/next_steps.h"
#include "files/sequence.h"
#include "vog/error.h"

namespace vog::cli {

namespace fs = std::filesystem;

namespace {

/// Whether two names are one file, or would be once it is written.
bool same_file(const fs::path& a, const fs::path& b) {
    std::error_code code;
    const bool exists = fs::exists(a, code);
    if (exists && fs::exists(b, code))
        return fs::is_regular_file(a, code) && fs::equivalent(a, b, code);
    const auto full = [&](const fs::path& path) {
        return fs::weakly_canonical(fs::absolute(path, code), code);
    };
    return full(a) == full(b);
}

/// Command that writes files of an extension, or folders; empty: none.
std::string writer_of(const std::string& output, const std::string& extension) {
    static const std::map<std::string, std::string> kWriters = {
        {".html", "page"},   {".vogz", "pack"},   {".spz", "export"}, {".glb", "export"},
        {".usda", "export"}, {".ply", "convert"}, {".png", "render"}, {".exr", "render"}};
    if (is_sequence(output)) return "page";
    const auto found = kWriters.find(extension);
    return found == kWriters.end() ? "" : found->second;
}

/// throws vog::Error unless a file of this name can be written
void check_folder(const std::string& output) {
    std::error_code code;
    const auto fail = [&](const std::string& why) {
        throw Error(fmt::format("{}: cannot write: {}", output, why));
    };
    const fs::path path(output);
    const fs::path folder = path.has_parent_path() ? path.parent_path() : ".";
    if (!fs::is_directory(folder, code)) fail(fmt::format("no folder '{}'", folder.string()));
    const fs::file_status status = fs::status(path, code);
    if (status.type() == fs::file_type::none) fail(code.message());
    if (fs::is_directory(status)) fail("it is a folder");
    const bool in_place = fs::exists(status) && !fs::is_regular_file(status);
    if (::access(in_place ? path.c_str() : folder.c_str(), W_OK) != 0)
        fail(std::generic_category().message(errno));
}

}  // namespace

std::string command_line(const std::string& command, const std::vector<std::string>& inputs,
                         const std::string& output) {
    constexpr std::size_t kMost = 3;
    std::string text = "vog " + command;
    std::size_t shown = 0;
    for (const std::string& input : inputs) {
        if (input.empty()) continue;  // not given
        text += shown < kMost ? " " + quoted(input) : " ...";
        if (++shown > kMost) break;
    }
    return output.empty() ? text : text + " -o " + quoted(output);
}

void check_output(const std::string& output, const std::vector<std::string>& inputs,
                  const std::vector<std::string>& extensions) {
    const std::string extension = extension_of(output);
    if (std::find(extensions.begin(), extensions.end(), extension) == extensions.end()) {
        const std::string writer = writer_of(output, extension);
        throw Error(
            fmt::format("{}: this command writes {}{}", output, fmt::join(extensions, ", "),
                        writer.empty() ? "" : "; use " + command_line(writer, inputs, output)));
    }
    check_folder(output);
    check_distinct({output}, inputs);
}

void check_distinct(const std::vector<std::string>& outputs,
                    const std::vector<std::string>& inputs) {
    for (std::size_t n = 0; n < outputs.size(); ++n) {
        if (outputs[n].empty()) continue;
        for (const std::string& input : inputs)
            if (!input.empty() && same_file(outputs[n], input))
                throw Error(fmt::format("{} is also an input; choose another output", outputs[n]));
        for (std::size_t m = 0; m < n; ++m)
            if (!outputs[m].empty() && same_file(outputs[n], outputs[m]))
                throw Error(fmt::format("{} would be written twice, as {} and as {}", outputs[n],
                                        outputs[m], outputs[n]));
    }
}

}  // namespace vog::cli
