// model_files.cpp: the format of a model's file, by its extension.
#include "vog/model_io.h"

#include <fmt/core.h>

#include <numeric>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "io/exchange/splat_models.h"
#include "io/file_extension.h"
#include "io/model_part.h"
#include "io/ply/ply_part.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/ply.h"
#include "vog/site.h"
#include "vog/vogz.h"

namespace vog {

namespace {

enum class Format { ply, vogz, splats };

/// expected  extensions, for messages
Format format_of(const std::filesystem::path& file, const char* expected) {
    const std::string extension = lower_extension(file);
    if (extension == ".ply") return Format::ply;
    if (extension == ".vogz") return Format::vogz;
    if (exchange::is_splats(file)) return Format::splats;
    throw Error(fmt::format("{}: extension '{}', expected {}", file.string(), extension, expected));
}

constexpr const char* kReadable =
    ".ply, .vogz (model), .spz, .glb, .usda or .usd (splats), or a site's folder";

/// Run of a model that was read whole.
Gaussians part_of(const Gaussians& whole, const ModelPart& part) {
    const auto [begin, end] = run_of(part, whole.size());
    std::vector<std::size_t> own(end - begin);
    std::iota(own.begin(), own.end(), begin);
    return select(whole, own);
}

}  // namespace

Gaussians read_model(const std::filesystem::path& file, Hierarchy* hierarchy,
                     const ValueRules& rules, ValueNotes* notes) {
    if (const auto site = find_site(file)) {
        if (hierarchy) *hierarchy = {};
        return read_site(site->folder, site->model);
    }
    require_readable(file);
    switch (format_of(file, kReadable)) {
        case Format::ply:
            return ply::read_part(file, {}, hierarchy, {rules, notes});
        case Format::vogz:
            return read_vogz(file, hierarchy);
        case Format::splats:
            break;
    }
    if (hierarchy) *hierarchy = {};
    return exchange::read_splats(file, {rules, notes});
}

Gaussians read_model(const std::filesystem::path& file, const ModelPart& part) {
    return read_model(file, part, {}, nullptr);
}

Gaussians read_model(const std::filesystem::path& file, const ModelPart& part,
                     const ValueRules& rules, ValueNotes* notes) {
    if (const auto site = find_site(file)) {
        require_part(part, file.string());
        return part_of(read_site(site->folder, site->model), part);
    }
    require_readable(file);
    switch (format_of(file, kReadable)) {
        case Format::ply:
            require_part(part, file.string());
            return ply::read_part(file, part, nullptr, {rules, notes});
        case Format::vogz:
            return read_vogz(file, part);
        case Format::splats:
            break;
    }
    require_part(part, file.string());
    return part_of(exchange::read_splats(file, {rules, notes}), part);
}

void write_model(const std::filesystem::path& file, const Gaussians& gaussians,
                 const Hierarchy& hierarchy) {
    constexpr const char* kWritable = ".ply or .vogz (model)";
    const Format format = format_of(file, kWritable);
    if (format == Format::splats)
        throw Error(fmt::format("{}: splats, expected {}; vog export and write_splats write them",
                                file.string(), kWritable));
    if (format == Format::ply)
        write_ply(file, gaussians, hierarchy);
    else
        write_vogz(file, gaussians, hierarchy);
}

}  // namespace vog
