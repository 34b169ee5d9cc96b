// voxel_fields.h: grids with fields and their reading, for tests of fields at the voxels of a measure.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "support/data.h"
#include "support/level_volumes.h"
#include "support/refused_files.h"
#include "support/vdb_grids.h"
#include "vog/voxel_field.h"

namespace vog::test {

inline const float kNan = std::numeric_limits<float>::quiet_NaN();

/// Transform of a grid of tests, without rounding.
inline void place(openvdb::GridBase& grid, const Affine& m) {
    const auto& r = m.linear;
    const Vec3d t = m.translation;
    const openvdb::Mat4d matrix(r(0, 0), r(1, 0), r(2, 0), 0.0, r(0, 1), r(1, 1), r(2, 1), 0.0,
                                r(0, 2), r(1, 2), r(2, 2), 0.0, t.x, t.y, t.z, 1.0);
    grid.setTransform(openvdb::math::Transform::createLinearTransform(matrix));
}

/// Sets a box of active voxels.
template <class GridT>
void fill(GridT& grid, Vec3i lower, Vec3i upper,
          const std::function<typename GridT::ValueType(Vec3i)>& value) {
    for (int x = lower.x; x <= upper.x; ++x)
        for (int y = lower.y; y <= upper.y; ++y)
            for (int z = lower.z; z <= upper.z; ++z) set_voxel(grid, {x, y, z}, value({x, y, z}));
}

/// Signed, different in each voxel of a small grid.
inline float signed_value(Vec3i i) { return float(i.x * 31 - i.y * 17 + i.z * 7) / 4 - 3; }

/// A linear function of the world.
inline double plane(Vec3d p) { return 2 - 3 * p.x + 0.5 * p.y + 1.25 * p.z; }

class voxel_field : public testing::Test {
  protected:
    VoxelField read(const openvdb::GridBase::Ptr& grid, Volume& volume,
                    std::span<VoxelField> others = {}, const FieldSource& source = {}) {
        write_grids(dir_ / "fields.vdb", {grid});
        FieldSource from = source;
        from.file = dir_ / "fields.vdb";
        if (from.grid.empty()) from.grid = grid->getName();
        notes_.clear();
        return read_field(from, volume, others, &notes_);
    }
    std::string refusal(const openvdb::GridBase::Ptr& grid, Volume volume) {
        const std::string message = error_of([&] { read(grid, volume); });
        EXPECT_EQ(message.find('\n'), std::string::npos);
        return message;
    }
    /// Expects value(index) in every component at every active voxel, and 0 elsewhere.
    static void expect_values(const Volume& volume, const VoxelField& field,
                              const std::function<Vec3d(Vec3i)>& value, double tolerance) {
        for (std::size_t c = 0; c < field.component.size(); ++c) {
            const VoxelValues& values = field.component[c];
            ASSERT_EQ(values.leaf.size(), volume.leaves.size());
            for (std::size_t n = 0; n < values.leaf.size(); ++n)
                for (int at = 0; at < kLeafVoxels; ++at) {
                    const Vec3i index =
                        volume.leaves[n].origin + Vec3i{at >> 6, (at >> 3) & 7, at & 7};
                    const double expected =
                        volume.leaves[n].active(at) ? value(index)[static_cast<int>(c)] : 0;
                    ASSERT_NEAR(double{values.leaf[n][static_cast<std::size_t>(at)]}, expected,
                                tolerance)
                        << index.x << " " << index.y << " " << index.z << " component " << c;
                }
        }
    }
    TempDir dir_;
    std::vector<std::string> notes_;
};

inline const Affine kWorld{{{Vec3d{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}}, {100.25, -7, 3}};

}  // namespace vog::test
