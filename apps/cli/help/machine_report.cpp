// machine_report.cpp: the processor's instructions, memory, graphics and libraries.
#include "help/machine_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <gnu/libc-version.h>
#include <hwy/targets.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "files/film.h"
#include "help/version.h"
#include "vog/error.h"
#include "vog/picture.h"
#include "vog/progress.h"
#include "vog/text.h"

namespace vog::cli {

namespace {

using ReportJson = nlohmann::ordered_json;

/// Value of a line "key: value" or KEY="value" of a system's file; empty: no such line.
std::string line_of(const char* file, const std::string& key) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        if (!line.starts_with(key)) continue;
        const std::size_t begin = line.find_first_of(":=");
        if (begin == line.npos) continue;
        std::string value = line.substr(line.find_first_not_of(" \t\"", begin + 1));
        while (!value.empty() && (value.back() == '"' || value.back() == ' ')) value.pop_back();
        return value;
    }
    return {};
}

/// Bytes of a line of /proc/meminfo; 0 where the system has none.
std::uint64_t memory_line(const std::string& key) {
    return std::strtoull(line_of("/proc/meminfo", key).c_str(), nullptr, 10) * 1024;
}

/// Limit of this process's control group, bytes; 0: none.
std::uint64_t group_limit() {
    std::ifstream in("/sys/fs/cgroup/memory.max");
    std::uint64_t limit = 0;
    return in >> limit ? limit : 0;
}

/// Highway's names of the SIMD targets in a set, the best first.
std::vector<std::string> target_names(std::int64_t set) {
    std::vector<std::string> names;
    for (int bit = 0; bit < 62; ++bit)
        if (set >> bit & 1) names.emplace_back(hwy::TargetName(std::int64_t{1} << bit));
    return names;
}

ReportJson processor() {
    const std::int64_t supported = hwy::SupportedTargets();
    // Of all targets that the loops are compiled for, the first that the processor has is run.
    const std::vector<std::string> usable = target_names(supported & HWY_TARGETS);
    std::string name = line_of("/proc/cpuinfo", "model name");
    if (name.empty()) name = "unknown";
    return {{"name", name},
            {"architecture",
             [] {
                 utsname system{};
                 return ::uname(&system) == 0 ? std::string(system.machine)
                                              : std::string("unknown");
             }()},
            {"cores", std::thread::hardware_concurrency()},
            {"threads", thread_count()},
            {"simd", usable.empty() ? std::string("none") : usable.front()},
            {"simd_supported", target_names(supported)},
            {"simd_compiled", target_names(HWY_TARGETS)}};
}

/// What a try found; its message where it failed.
template <class Try>
ReportJson found_by(const Try& attempt) {
    try {
        return {{"found", true}, {"name", attempt()}};
    } catch (const std::exception& error) {
        return {{"found", false}, {"reason", printable(error.what())}};
    }
}

/// Prepares one Gaussian for a renderer.
/// throws  vog::Error without the GPU or the library that it needs
void try_renderer(Renderer renderer) {
    Gaussians model;
    model.mean.push_back({0, 0, 0});
    model.scale.push_back({1, 1, 1});
    model.density.push_back(1);
    const Scene scene = scene_of(std::move(model));
    PictureRenderer(scene).prepare(resolve({.renderer = renderer}, scene));
}

struct OptionalLibrary {
    const char *name, *purpose, *version;  ///< version empty: not in this build
};
constexpr OptionalLibrary kLibraries[] = {
    {"OpenVDB", ".vdb and .nvdb", VOG_WITH_OPENVDB},
    {"Embree", "ray tracing on the processor", VOG_WITH_EMBREE},
    {"libtiff", "stacks of .tif", VOG_WITH_TIFF},
    {"cfitsio", "cubes of .fits", VOG_WITH_CFITSIO},
    {"HDF5", "particles in .hdf5", VOG_WITH_HDF5},
    {"cpp-httplib", "vog serve", VOG_WITH_HTTPLIB},
    {"window", "vog view", VOG_WITH_VIEWER}};

ReportJson libraries() {
    ReportJson list = ReportJson::array();
    for (const OptionalLibrary& library : kLibraries) {
        ReportJson one = {
            {"name", library.name}, {"purpose", library.purpose}, {"found", *library.version != 0}};
        if (*library.version && std::string_view(library.version) != "yes")
            one["version"] = library.version;
        list.push_back(one);
    }
    return list;
}

std::string display() {
    for (const char* variable : {"WAYLAND_DISPLAY", "DISPLAY"})
        if (const char* value = std::getenv(variable); value && *value)
            return fmt::format("{}={}", variable, printable(value));
    return {};
}

std::string text_of(const ReportJson& value) { return value.get<std::string>(); }
std::string words_of(const ReportJson& list) {
    return fmt::format("{}", fmt::join(list.get<std::vector<std::string>>(), " "));
}
std::string bytes_of(const ReportJson& value) { return bytes_text(value.get<std::uint64_t>()); }

std::string yes_or_no(const ReportJson& part) {
    return part["found"] ? text_of(part["name"]) : "no: " + text_of(part["reason"]);
}

}  // namespace

ReportJson machine_report(const std::function<std::string()>& open_gl) {
    utsname system{};
    (void)::uname(&system);
    std::string distribution = line_of("/etc/os-release", "PRETTY_NAME");
    ReportJson report = {
        {"version", version_number()},
        {"commit", commit_text()},
        {"build", build_type()},
        {"compiler", VOG_COMPILER},
        {"system",
         {{"distribution", distribution.empty() ? "unknown" : distribution},
          {"kernel", fmt::format("{} {}", system.sysname, system.release)},
          {"libc", std::string("glibc ") + gnu_get_libc_version()}}},
        {"processor", processor()},
        {"memory",
         {{"total_bytes", memory_line("MemTotal")},
          {"available_bytes", memory_line("MemAvailable")},
          {"limit_bytes", group_limit()}}},
        {"opengl", found_by([&] {
             if (!open_gl)
                 throw Error("this build has no window (it was configured with -DVOG_VIEWER=OFF)");
             return open_gl();
         })},
        {"display", display()},
        {"cuda", found_by([] {
             try_renderer(Renderer::cuda);
             return "an NVIDIA GPU: --renderer cuda";
         })},
        {"optix", found_by([] {
             try_renderer(Renderer::optix);
             return "an NVIDIA GPU with OptiX: --renderer optix";
         })},
        {"libraries", libraries()}};
    const std::string ffmpeg = program_path("ffmpeg");
    report["ffmpeg"] =
        ffmpeg.empty()
            ? ReportJson{{"found", false}, {"reason", "not in PATH; films (.mp4, .webm) need it"}}
            : ReportJson{{"found", true}, {"name", ffmpeg}};
    return report;
}

std::string machine_text(const ReportJson& report) {
    std::string text;
    const auto line = [&](const std::string& name, const std::string& value) {
        text += fmt::format("{:<12} {}\n", name, value);
    };
    const ReportJson& processor = report["processor"];
    line("vog",
         fmt::format("{}, commit {}, {}, {}", text_of(report["version"]), text_of(report["commit"]),
                     text_of(report["build"]), text_of(report["compiler"])));
    line("system",
         fmt::format("{}, {}, {}", text_of(report["system"]["distribution"]),
                     text_of(report["system"]["kernel"]), text_of(report["system"]["libc"])));
    line("processor",
         fmt::format("{}, {} cores, {} threads used", text_of(processor["name"]),
                     processor["cores"].get<unsigned>(), processor["threads"].get<int>()));
    line("SIMD",
         fmt::format("{} (this processor has {}; compiled for {})", text_of(processor["simd"]),
                     words_of(processor["simd_supported"]), words_of(processor["simd_compiled"])));
    const ReportJson& memory = report["memory"];
    std::string sizes = fmt::format("{}, {} available", bytes_of(memory["total_bytes"]),
                                    bytes_of(memory["available_bytes"]));
    if (memory["limit_bytes"] != 0) sizes += ", limited to " + bytes_of(memory["limit_bytes"]);
    line("memory", sizes);
    line("OpenGL", yes_or_no(report["opengl"]));
    const auto shown = text_of(report["display"]);
    line("display", shown.empty() ? "no: neither DISPLAY nor WAYLAND_DISPLAY is set; vog view "
                                    "--headless --script FILE works without"
                                  : shown);
    line("CUDA", yes_or_no(report["cuda"]));
    line("OptiX", yes_or_no(report["optix"]));
    for (const ReportJson& library : report["libraries"])
        line(text_of(library["name"]),
             fmt::format("{} ({})",
                         !library["found"]             ? "not in this build"
                         : library.contains("version") ? text_of(library["version"])
                                                       : "yes",
                         text_of(library["purpose"])));
    line("ffmpeg", yes_or_no(report["ffmpeg"]));
    return text;
}

}  // namespace vog::cli
