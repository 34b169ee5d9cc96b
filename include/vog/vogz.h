// vog/vogz.h: models in compact files. Numbers are rounded on lattices as fine as a Gaussian is small, and coded by what
// differs from their neighbours, in chunks with checksums: a reader may load just a level, a box or some fields.
// docs/formats.md has the layout, docs/compact.md sizes and errors.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vog/gaussians.h"
#include "vog/lod.h"

namespace vog {

/// Fineness of a compact file.
struct VogzPrecision {
    /// Step of a Gaussian's numbers, [1e-6, 0.5]: of its mass and shape relative to themselves, of its mean 1.41 of it in
    /// standard deviations. Errors are at most half of a step. Half the step takes 1.25 bytes more a Gaussian.
    double step = 0.025;
    /// Step of field values relative to the range of the data, [1e-6, 0.5].
    double field_step = 1.0 / 256;
};

struct VogzOptions {
    VogzPrecision precision;
    /// Entropy coder deflate, which browsers have built in, in place of zstd: slower, and of the same size.
    bool deflate = false;
    /// First view, extinction and ranges for <vog-view>: JSON of page_of_file (vog/export_html.h); empty: it refuses the file.
    std::string page{};
};

/// Bytes of a compact file.
struct VogzReport {
    std::size_t gaussians = 0;  ///< written
    std::size_t left_out = 0;   ///< without density
    std::uint64_t bytes = 0;    ///< size of the file
    std::uint64_t shapes = 0;   ///< bytes of the Gaussians, without fields
    std::uint64_t levels = 0;   ///< bytes of the nodes of the hierarchy, with fields
    std::vector<std::pair<std::string, std::uint64_t>> fields;  ///< name and bytes
    std::uint64_t header = 0;                                   ///< bytes of all else
};

/// Writes a model. Its mass is exact to 1e-6, the number and place of its Gaussians are kept; those without density are
/// left out where there is no hierarchy.
/// hierarchy  of this model, in the order of build_hierarchy; the file then has its order, and with VogzOptions::deflate pages
///            can stream it by ranges (docs/streaming.md). Empty: the file is in Morton order
/// throws     vog::Error for an invalid model, hierarchy or option, or if the file cannot be written
/// cost       O(N log N) time, parallel; 30 bytes a Gaussian
VogzReport write_vogz(const std::filesystem::path& file, const Gaussians& gaussians,
                      const Hierarchy& hierarchy = {}, const VogzOptions& options = {});

/// The model that a reader of write_vogz's file would get, in the order of `gaussians`.
/// throws  vog::Error as write_vogz
[[nodiscard]] Gaussians rounded(const Gaussians& gaussians, const VogzPrecision& precision);

/// Part of a compact file.
struct VogzPart {
    /// Nodes of this depth of the hierarchy in place of the Gaussians: 0 the roots. The result is a coarse model: all
    /// nodes of the depth, and the Gaussians above it.
    std::optional<std::size_t> level;
    /// Only chunks that reach into this box, world units; they are whole, and may reach out of it.
    std::optional<Box> box;
    /// Names of the fields to read; none: all.
    std::optional<std::vector<std::string>> fields;
};

/// Description of a compact file, without its Gaussians.
struct VogzInfo {
    Gaussians
        description;  ///< origin, cutoff, box, texts, names and ranges of fields; no Gaussians
    std::size_t gaussians = 0;
    std::vector<std::size_t>
        levels;              ///< number of nodes of each depth of the hierarchy, roots first
    std::size_t chunks = 0;  ///< number of chunks of Gaussians
    VogzPrecision precision;
    /// Why a page cannot stream the file by ranges, and what would be valid, in words; empty: it can.
    std::string not_streamed;
};
/// throws  vog::Error for a missing or malformed file
VogzInfo read_vogz_info(const std::filesystem::path& file);

/// Reads a model.
/// hierarchy  receives the file's hierarchy, or an empty one; null: not read
/// throws     vog::Error for a missing, truncated or corrupt file, or one of a newer version
Gaussians read_vogz(const std::filesystem::path& file, Hierarchy* hierarchy = nullptr);
/// Reads a part of a model, and only its chunks of the file.
/// throws  vog::Error as above, and for a level or field that the file lacks
Gaussians read_vogz(const std::filesystem::path& file, const VogzPart& part);

}  // namespace vog
