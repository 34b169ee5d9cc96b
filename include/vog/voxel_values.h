// vog/voxel_values.h: one rule for values that are no density: negative, NaN or infinite.
// Every reader refuses them, with their number and the first index, unless ValueRules accept them;
// a report of what was changed goes to ValueNotes. Inactive voxels are empty whatever they store.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "vog/linear.h"

namespace vog {

/// Values that readers accept though they are no density.
struct ValueRules {
    bool skip_nonfinite = false;  ///< leave out voxels of NaN or infinite value: they are inactive
    bool clip_negative = false;   ///< set negative values to 0
    /// Value of empty space in a dense image: density is the value above it. Nothing: by the image's values
    /// (docs/scans.md, "Background"), 0 with clip_negative.
    std::optional<double> background{};
};

/// Values that a reader changed; the value of a tile counts once.
struct ValueNotes {
    std::uint64_t clipped_negative = 0;    ///< active values below 0, set to 0
    std::uint64_t skipped_nonfinite = 0;   ///< active values not finite, left out
    std::uint64_t inactive_nonfinite = 0;  ///< inactive voxels of leaves with a value not finite
    std::optional<Vec3i> first_skipped{};  ///< index of the first voxel left out
    std::optional<double> background{};  ///< value of empty space that the reader found, subtracted

    void add(const ValueNotes& other) {
        clipped_negative += other.clipped_negative;
        skipped_nonfinite += other.skipped_nonfinite;
        inactive_nonfinite += other.inactive_nonfinite;
        if (!first_skipped) first_skipped = other.first_skipped;
        if (!background) background = other.background;
    }
};

/// Notes in words: "a.vdb: 3 negative values of 'density' set to 0; 2 values not finite left out".
/// where   start of the text: "a.vdb: grid 'density'"
/// returns  empty if nothing was changed
std::string values_text(const ValueNotes& notes, const std::string& where);

}  // namespace vog
