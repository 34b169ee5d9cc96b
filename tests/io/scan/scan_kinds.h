// scan_kinds.h: Rows of dense images: files, and the grids, places and notes that are right.
#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "io/scan/scan_files.h"

namespace vog::test {

using Files = std::vector<std::pair<std::string, std::string>>;

/// Files, the first of which is read, and what lies in it.
struct Kind {
    std::string what;
    Files files;
    std::vector<std::string> names{"value"};
    Affine map{};
    std::string grid{};  ///< with values 1 to 24; empty: the first of `names`
    std::string unit{};
    std::string note{};  ///< part of it; empty: none
};

inline std::string counted() { return bytes_of(scan_values()); }
/// Slices of the counted values as files of six voxels each.
inline Files with_slices(Files files, const std::string& pattern, const std::string& before = "",
                         bool packed = false) {
    for (int z = 0; z < 4; ++z) {
        const std::string slice = before + counted().substr(static_cast<std::size_t>(12 * z), 12);
        files.emplace_back(fmt::format(fmt::runtime(pattern), z), packed ? gzipped(slice) : slice);
    }
    return files;
}
/// Counted values beside others in every voxel.
inline std::string side_by_side() {
    std::string bytes;
    for (const std::int16_t v : scan_values())
        bytes += bytes_of(std::vector<std::int16_t>{v, static_cast<std::int16_t>(100 + v)});
    return bytes;
}
inline std::string two_frames() { return bytes_of(scan_values(100)) + counted(); }

inline std::string mha(const std::string& more, const std::string& sizes = "2 3 4", int axes = 3) {
    return fmt::format("ObjectType = Image\nNDims = {}\nDimSize = {}\nElementType = MET_SHORT\n{}",
                       axes, sizes, more);
}
inline std::string nrrd(const std::string& more, const std::string& sizes = "2 3 4", int axes = 3) {
    return fmt::format("NRRD0005\ntype: short\ndimension: {}\nsizes: {}\nendian: little\n{}", axes,
                       sizes, more);
}

inline void expect_kinds(const std::vector<Kind>& kinds) {
    for (const Kind& kind : kinds) {
        SCOPED_TRACE(kind.what);
        const TempDir dir;
        for (const auto& [name, bytes] : kind.files) {
            std::filesystem::create_directories((dir / name).parent_path());
            write_bytes(dir / name, bytes);
        }
        const std::filesystem::path file = dir / kind.files[0].first;
        if (absent(file)) GTEST_SKIP() << "this build lacks the library of " << file.extension();
        ASSERT_EQ(refusal([&] { grid_names(file); }), "no error");
        EXPECT_EQ(grid_names(file), kind.names);
        const std::string grid = kind.grid.empty() ? kind.names[0] : kind.grid;
        std::vector<std::string> notes;
        const Volume volume = read_volume(file, {.grid = grid}, &notes);
        expect_counted(volume, kind.what);
        expect_map(volume.world_from_index, kind.map);
        EXPECT_EQ(volume_head(file, grid).length_unit, kind.unit);
        EXPECT_EQ(notes.size(), kind.note.empty() ? 0u : 1u);
        EXPECT_TRUE(notes.empty() || notes[0].find(kind.note) != std::string::npos) << notes[0];
        EXPECT_EQ(volume_note(file), notes.empty() ? "" : notes[0]);
    }
}

/// Expects each file to be refused in one line with this text.
inline void expect_refused(const std::vector<std::pair<Files, std::string>>& rows) {
    for (const auto& [files, text] : rows) {
        const TempDir dir;
        for (const auto& [name, bytes] : files) write_bytes(dir / name, bytes);
        if (absent(dir / files[0].first)) continue;
        const std::string message = refusal([&] { read_volume(dir / files[0].first); });
        EXPECT_NE(message.find(text), std::string::npos) << message;
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
}

}  // namespace vog::test
