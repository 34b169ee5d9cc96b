// voxel_field_test.cpp: fields at the voxels of a measure: lattices, backgrounds, vectors, tiles.
#include "vog/voxel_field.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "support/data.h"
#include "support/level_volumes.h"
#include "support/refused_files.h"
#include "support/vdb_grids.h"
#include "vog/distributed.h"
#include "vog/points.h"
#include "vog/progress.h"
#include "vog/volume_io.h"

namespace vog::test {

namespace {

using openvdb::Coord;
using openvdb::FloatGrid;

const float kNan = std::numeric_limits<float>::quiet_NaN();

/// Transform of a grid of tests, without rounding.
void place(openvdb::GridBase& grid, const Affine& m) {
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
float signed_value(Vec3i i) { return float(i.x * 31 - i.y * 17 + i.z * 7) / 4 - 3; }

/// A linear function of the world.
double plane(Vec3d p) { return 2 - 3 * p.x + 0.5 * p.y + 1.25 * p.z; }

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

const Affine kWorld{{{Vec3d{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}}, {100.25, -7, 3}};

}  // namespace

TEST_F(voxel_field, signed_values_of_equal_lattices_are_exact) {
    for (const Vec3i shift : {Vec3i{}, Vec3i{3, -5, 16}}) {
        Volume volume = cube_of(20, 0.5f, kWorld);
        const auto grid = make_grid("t", openvdb::GRID_UNKNOWN);
        fill(*grid, shift, shift + Vec3i{19, 19, 19}, signed_value);
        // Like a transform of single precision: off by up to 1e-4 of a voxel.
        Affine map = kWorld;
        map.translation = kWorld(vec_cast<double>(-shift)) + Vec3d{4e-5, -3e-5, 2e-5};
        place(*grid, map);
        const VoxelField field = read(grid, volume);
        EXPECT_EQ(field.name, "t");
        EXPECT_FALSE(field.is_vector());
        expect_values(
            volume, field, [&](Vec3i i) { return Vec3d{double(signed_value(i + shift))}; }, 0);
        const VoxelValues& values = field.component[0];
        float least = 1e9f, most = -1e9f;
        for (std::size_t n = 0; n < values.leaf.size(); ++n)
            for (int at = 0; at < kLeafVoxels; ++at)
                if (volume.leaves[n].active(at)) {
                    least = std::min(least, values.leaf[n][std::size_t(at)]);
                    most = std::max(most, values.leaf[n][std::size_t(at)]);
                }
        EXPECT_EQ(field.lower, double{least});
        EXPECT_EQ(field.upper, double{most});
        EXPECT_TRUE(notes_.empty());
    }
}

TEST_F(voxel_field, a_plane_is_exact_in_scaled_shifted_and_rotated_lattices) {
    const Affine turned = turned_map();
    struct Case {
        Affine measure, field;
    };
    Affine coarse = kWorld, fine = kWorld, shifted = kWorld, mirrored = kWorld;
    coarse.linear = {{Vec3d{1.3, 0, 0}, {0, 0.9, 0}, {0, 0, 2}}};
    fine.linear = {{Vec3d{0.17, 0, 0}, {0, 0.25, 0}, {0, 0, 0.3}}};
    shifted.translation = kWorld.translation + Vec3d{0.2, 0.1, -0.05};
    mirrored.linear(0, 0) = -0.5;
    for (const Case& one : {Case{kWorld, coarse}, Case{kWorld, fine}, Case{kWorld, shifted},
                            Case{kWorld, mirrored}, Case{turned, kWorld}, Case{kWorld, turned}}) {
        Volume volume = cube_of(9, 0.5f, one.measure);
        const auto grid = make_grid<openvdb::DoubleGrid>("t");
        const Box box = transformed(inverse(one.field), world_box(volume));
        fill(*grid, vec_cast<int>(box.lower) - Vec3i{2, 2, 2},
             vec_cast<int>(box.upper) + Vec3i{2, 2, 2},
             [&](Vec3i i) { return plane(one.field(vec_cast<double>(i))); });
        place(*grid, one.field);
        const VoxelField field = read(grid, volume);
        expect_values(
            volume, field, [&](Vec3i i) { return Vec3d{plane(one.measure(vec_cast<double>(i)))}; },
            4e-5);  // floats of about 300
        EXPECT_TRUE(notes_.empty());
    }
}

TEST_F(voxel_field, inactive_voxels_have_the_background) {
    Volume volume = cube_of(8, 0.5f, {});
    for (int n = 0; n < 64; ++n) volume.leaves[0].value[std::size_t(n)] = 2;  // x = 0
    const auto grid = make_grid("t");
    grid->tree().root().setBackground(-4, false);
    fill(*grid, {1, 0, 0}, {7, 7, 7}, [](Vec3i) { return 9.0f; });
    grid->tree().setValueOff({0, 2, 3}, 77);
    expect_values(
        volume, read(grid, volume), [](Vec3i i) { return Vec3d{i.x == 0 ? -4.0 : 9.0}; }, 0);
    // 64 of 512 voxels of density 2, the others of 0.5: 128 / 352 of the mass.
    ASSERT_EQ(notes_.size(), 1u);
    EXPECT_EQ(notes_[0].substr(notes_[0].find("fields.vdb")),
              "fields.vdb: grid 't': inactive at 36 % of the mass of the volume, where its "
              "background counts");
}

TEST_F(voxel_field, signed_distances_keep_their_sign_inside) {
    Volume volume = cube_of(8, 0.5f, {});
    const auto grid = make_grid("surface", openvdb::GRID_LEVEL_SET);
    grid->tree().root().setBackground(3, false);
    fill(*grid, {3, 0, 0}, {4, 7, 7}, [](Vec3i i) { return float(i.x) - 3.5f; });
    for (int x = 0; x < 3; ++x)
        for (int y = 0; y < 8; ++y)
            for (int z = 0; z < 8; ++z) grid->tree().setValueOff({x, y, z}, -3);
    expect_values(
        volume, read(grid, volume),
        [](Vec3i i) { return Vec3d{i.x < 3   ? -3
                                   : i.x > 4 ? 3
                                             : i.x - 3.5}; }, 0);
}

TEST_F(voxel_field, every_type_of_numbers_is_read) {
    const auto check = [&]<class GridT>(GridT*, double scale) {
        Volume volume = cube_of(8, 0.5f, {});
        const auto grid = make_grid<GridT>("t");
        fill(*grid, {}, {7, 7, 7}, [&](Vec3i i) {
            return static_cast<typename GridT::ValueType>((i.x - 3 * i.z) * scale);
        });
        const VoxelField field = read(grid, volume);
        expect_values(
            volume, field, [&](Vec3i i) { return Vec3d{(i.x - 3 * i.z) * scale}; }, 0);
        EXPECT_EQ(field.lower, -21 * scale);
    };
    check(static_cast<FloatGrid*>(nullptr), 0.5);
    check(static_cast<openvdb::DoubleGrid*>(nullptr), 0.25);
    check(static_cast<openvdb::Int32Grid*>(nullptr), 1);
    check(static_cast<openvdb::Int64Grid*>(nullptr), 2);
    Volume volume = cube_of(8, 0.5f, {});
    const auto flags = make_grid<openvdb::BoolGrid>("flags");
    const auto mask = make_grid<openvdb::MaskGrid>("mask");
    for (int x = 0; x < 8; ++x) flags->tree().setValueOn({x, 0, 0}, x % 2 == 0);
    mask->tree().setValueOn({3, 0, 0});
    expect_values(
        volume, read(flags, volume),
        [](Vec3i i) { return Vec3d{i.y == 0 && i.z == 0 && i.x % 2 == 0 ? 1.0 : 0.0}; }, 0);
    expect_values(
        volume, read(mask, volume),
        [](Vec3i i) {
            return Vec3d{i == Vec3i{3, 0, 0} ? 1.0 : 0.0};
        },
        0);
    const auto half = make_grid("half");
    half->setSaveFloatAsHalf(true);
    fill(*half, {}, {7, 7, 7}, [](Vec3i i) { return 0.125f - float(i.y); });
    expect_values(
        volume, read(half, volume), [](Vec3i i) { return Vec3d{0.125 - i.y}; }, 0);
}

TEST_F(voxel_field, vectors_are_along_the_worlds_axes) {
    const Affine map = turned_map();
    const auto stored = [](Vec3i i) { return Vec3d{i.x - 4.0, 2.0 * i.y, 1.0 - 2.0 * i.z}; };
    struct Case {
        openvdb::VecType type;
        bool local;
        std::function<Vec3d(Vec3d)> expected;
    };
    const Mat3 normal = transpose(inverse(map.linear));
    const auto same = [](Vec3d v) { return v; };
    const std::vector<Case> cases{
        {openvdb::VEC_INVARIANT, false, same},
        {openvdb::VEC_CONTRAVARIANT_RELATIVE, false, same},
        {openvdb::VEC_COVARIANT, false, same},
        {openvdb::VEC_INVARIANT, true, same},
        {openvdb::VEC_CONTRAVARIANT_RELATIVE, true, [&](Vec3d v) { return map.linear * v; }},
        {openvdb::VEC_CONTRAVARIANT_ABSOLUTE, true, [&](Vec3d v) { return map(v); }},
        {openvdb::VEC_COVARIANT, true, [&](Vec3d v) { return normal * v; }},
        {openvdb::VEC_COVARIANT_NORMALIZE, true, [&](Vec3d v) { return normalized(normal * v); }},
    };
    const auto check = [&]<class GridT>(GridT*, const Case& one) {
        Volume volume = cube_of(8, 0.5f, map);
        const auto grid = make_grid<GridT>("v", openvdb::GRID_UNKNOWN);
        fill(*grid, {}, {7, 7, 7}, [&](Vec3i i) {
            const Vec3d v = stored(i);
            using Number = typename GridT::ValueType::value_type;
            return typename GridT::ValueType(Number(v.x), Number(v.y), Number(v.z));
        });
        grid->setVectorType(one.type);
        grid->setIsInWorldSpace(!one.local);
        place(*grid, map);
        const VoxelField field = read(grid, volume);
        ASSERT_TRUE(field.is_vector());
        double most = 0;
        expect_values(
            volume, field,
            [&](Vec3i i) {
                const Vec3d v = one.expected(stored(i));
                most = std::max(most, length(v));
                return v;
            },
            4e-6);
        EXPECT_NEAR(field.upper, most, 1e-5);
    };
    for (const Case& one : cases) {
        check(static_cast<openvdb::Vec3SGrid*>(nullptr), one);
        check(static_cast<openvdb::Vec3DGrid*>(nullptr), one);
        check(static_cast<openvdb::Vec3IGrid*>(nullptr), one);
    }
    Volume volume = cube_of(8, 0.5f, map);
    const auto grid = make_grid<openvdb::Vec3SGrid>("v");
    fill(*grid, {}, {7, 7, 7}, [](Vec3i) { return openvdb::Vec3s(1); });
    grid->setIsInWorldSpace(false);
    grid->insertMeta("vector_type", openvdb::StringMetadata("sideways"));
    EXPECT_NE(refusal(grid, volume).find("vectors of type 'sideways', expected invariant"),
              std::string::npos);
}

TEST_F(voxel_field, staggered_vectors_are_averaged_from_their_faces) {
    // Component c at index i - e_c / 2; planes are then exact at any place.
    const auto velocity = [](Vec3d p) {
        return Vec3d{plane(p), 3 - plane({p.z, p.x, p.y}), p.x - 2 * p.z};
    };
    Affine coarse = kWorld;
    coarse.linear = {{Vec3d{0.7, 0, 0}, {0, 0.7, 0}, {0, 0, 0.7}}};
    for (const Affine& measure : {kWorld, coarse}) {
        Volume volume = cube_of(9, 0.5f, measure);
        const auto grid = make_grid<openvdb::Vec3SGrid>("v", openvdb::GRID_STAGGERED);
        place(*grid, kWorld);
        fill(*grid, {-1, -1, -1}, {16, 16, 16}, [&](Vec3i i) {
            openvdb::Vec3s value;
            for (int c = 0; c < 3; ++c) {
                Vec3d at = vec_cast<double>(i);
                at[c] -= 0.5;
                value[c] = float(velocity(kWorld(at))[c]);
            }
            return value;
        });
        expect_values(
            volume, read(grid, volume),
            [&](Vec3i i) { return velocity(measure(vec_cast<double>(i))); }, 6e-5);
    }
    // Faces that a file cut to the density lacks are left out.
    Volume volume = cube_of(8, 0.5f, {});
    const auto cut = make_grid<openvdb::Vec3SGrid>("v", openvdb::GRID_STAGGERED);
    fill(*cut, {}, {7, 7, 7}, [](Vec3i i) { return openvdb::Vec3s(float(i.x), 5, 5); });
    expect_values(
        volume, read(cut, volume),
        [](Vec3i i) {
            return Vec3d{i.x == 7 ? 7 : i.x + 0.5, 5, 5};
        },
        0);
}

TEST_F(voxel_field, tiles_are_divided_where_the_field_varies) {
    Volume volume = cube_of(8, 0.5f, {});
    volume.tiles = {{{8, 0, 0}, 8, 0.25f}, {{128, 0, 0}, 128, 1.5f}, {{256, 0, 0}, 128, 2}};
    sort_nodes(volume);
    const Volume before = volume;
    std::vector<VoxelField> others{own_field(volume)};

    const auto grid = make_grid("t");
    fill(*grid, {}, {15, 7, 7}, signed_value);           // a leaf and the small tile
    grid->tree().addTile(2, Coord(128, 0, 0), 7, true);  // the first of 128
    set_voxel(*grid, {256, 0, 8}, -2.5f);                // one voxel in the other
    const VoxelField field = read(grid, volume, others);
    validate(volume);
    EXPECT_EQ(active_voxels(volume), active_voxels(before));
    EXPECT_DOUBLE_EQ(mass(volume), mass(before));
    ASSERT_EQ(volume.leaves.size(), 3u);
    EXPECT_EQ(volume.leaves[1].origin, (Vec3i{8, 0, 0}));
    EXPECT_EQ(volume.leaves[2].origin, (Vec3i{256, 0, 8}));
    ASSERT_EQ(volume.tiles.size(), 1u + 16 * 16 * 16 - 1);
    EXPECT_EQ(volume.tiles[0].edge, 128);
    for (std::size_t n = 0; n < volume.tiles.size(); ++n) {
        EXPECT_EQ(field.component[0].tile[n], n == 0 ? 7.0f : 0.0f);
        EXPECT_EQ(volume.tiles[n].value, n == 0 ? 1.5f : 2.0f);
        EXPECT_EQ(others[0].component[0].tile[n], volume.tiles[n].value);
    }
    expect_values(
        volume, field,
        [](Vec3i i) {
            return Vec3d{i.x < 16 ? double(signed_value(i)) : i == Vec3i{256, 0, 8} ? -2.5 : 0.0};
        },
        0);
    expect_values(
        volume, others[0], [](Vec3i i) { return Vec3d{i.x < 8    ? 0.5
                                                      : i.x < 16 ? 0.25
                                                                 : 2.0}; }, 0);
    EXPECT_EQ(notes_.size(), 1u);
    // A second field of the same kind divides nothing more.
    const Volume divided = volume;
    read(grid, volume, others);
    expect_same_volume(volume, divided);
}

/// Takes no quadratic time: 50,000 tiles in the volume and in the grid.
TEST_F(voxel_field, many_tiles_are_sampled_one_by_one) {
    Volume volume;
    const auto grid = make_grid("t");
    for (int n = 0; n < 50000; ++n) {
        const Vec3i origin{4096 * (n / 500), 4096 * (n % 500), 0};
        volume.tiles.push_back({origin, 4096, 0.5f});
        grid->tree().addTile(3, Coord(origin.x, origin.y, origin.z), float(n) - 7, true);
    }
    const VoxelField field = read(grid, volume);
    ASSERT_EQ(volume.tiles.size(), 50000u);
    for (std::size_t n = 0; n < 50000; ++n) ASSERT_EQ(field.component[0].tile[n], float(n) - 7);
    EXPECT_TRUE(notes_.empty());
    // Tiles of many root cells: a grid of voxels a hundredth as large.
    Volume few;
    few.tiles = {{{0, 0, 0}, 4096, 0.5f}};
    Affine fine;
    fine.linear = {{Vec3d{0.01, 0, 0}, {0, 0.01, 0}, {0, 0, 0.01}}};
    const auto corner = make_grid("t");
    corner->tree().addTile(3, Coord(0, 0, 0), 3, true);
    place(*corner, fine);
    read(corner, few);
    EXPECT_EQ(active_voxels(few), std::uint64_t{4096} * 4096 * 4096);
    EXPECT_GT(few.tiles.size(), 32768u);
    EXPECT_EQ(notes_.size(), 1u);
}

TEST_F(voxel_field, tiles_that_would_fill_memory_are_refused) {
    Volume volume;
    volume.tiles = {{{0, 0, 0}, 4096, 0.5f}};
    const auto grid = make_grid("t");
    fill(*grid, {}, {40, 40, 40}, signed_value);
    Affine coarse;
    coarse.linear = {{Vec3d{100, 0, 0}, {0, 100, 0}, {0, 0, 100}}};
    place(*grid, coarse);
    EXPECT_NE(refusal(grid, volume)
                  .find("varies inside the tiles of the volume: more than 268,435,456 voxels or "
                        "16,777,216 tiles to divide them into"),
              std::string::npos);
}

TEST_F(voxel_field, values_not_finite_count_at_voxels_of_the_measure_alone) {
    Volume volume = cube_of(8, 0.5f, {});
    const auto grid = make_grid("t");
    fill(*grid, {-4, -4, -4}, {12, 12, 12}, [](Vec3i) { return 1.0f; });
    set_voxel(*grid, {-1, 3, 3}, kNan);
    set_voxel(*grid, {8, 3, 3}, std::numeric_limits<float>::infinity());
    expect_values(
        volume, read(grid, volume), [](Vec3i) { return Vec3d{1}; }, 0);
    // A lattice of half the voxels' size: all centres are those of voxels of the grid.
    Affine fine;
    fine.linear = {{Vec3d{0.5, 0, 0}, {0, 0.5, 0}, {0, 0, 0.5}}};
    place(*grid, fine);
    Volume small = cube_of(4, 0.5f, {});
    set_voxel(*grid, {1, 2, 2}, kNan);
    expect_values(
        small, read(grid, small), [](Vec3i) { return Vec3d{1}; }, 0);
    place(*grid, {});
    set_voxel(*grid, {5, 6, 7}, kNan);
    EXPECT_NE(refusal(grid, volume)
                  .find("grid 't': not finite at 2 voxels of the volume, the "
                        "first at index [1, 2, 2], expected finite values there"),
              std::string::npos);
    const auto large = make_grid<openvdb::DoubleGrid>("t");
    fill(*large, {}, {7, 7, 7}, [](Vec3i) { return 1e300; });
    EXPECT_NE(refusal(large, volume).find("not finite at 512 voxels"), std::string::npos);
    Volume tile;
    tile.tiles = {{{0, 0, 0}, 128, 1}};
    const auto nan_tile = make_grid("t");
    nan_tile->tree().addTile(2, Coord(0, 0, 0), kNan, true);
    EXPECT_NE(refusal(nan_tile, tile).find("not finite at 2,097,152 voxels"), std::string::npos);
}

TEST_F(voxel_field, a_grid_elsewhere_is_refused) {
    Volume volume = cube_of(8, 0.5f, kWorld);
    volume.name = "density";
    const auto grid = make_grid("t");
    set_voxel(*grid, {0, 0, 0}, 1.0f);
    EXPECT_NE(refusal(grid, volume)
                  .find("grid 't': active at no voxel of 'density': [-0.5, -0.5, "
                        "-0.5] to [0.5, 0.5, 0.5] of the world, which lies in "
                        "[100, -7.25, 2.75] to [104, -3.25, 6.75]; expected "
                        "grids that overlap"),
              std::string::npos);
    // Indices beyond the range of integers.
    Affine tiny;
    tiny.linear(0, 0) = 1e-8;
    place(*grid, tiny);
    Volume far = cube_of(8, 0.5f, kWorld);
    far.tiles = {{{128, 0, 0}, 128, 1}};
    EXPECT_NE(refusal(grid, far).find("active at no voxel"), std::string::npos);
}

TEST_F(voxel_field, names_units_and_wrong_grids) {
    Volume volume = cube_of(8, 0.5f, {});
    const auto grid = make_grid("t");
    fill(*grid, {}, {7, 7, 7}, signed_value);
    grid->insertMeta("units", openvdb::StringMetadata("K"));
    EXPECT_EQ(read(grid, volume).unit, "K");
    const VoxelField named = read(grid, volume, {}, {.name = "temperature", .unit = "mK"});
    EXPECT_EQ(named.name, "temperature");
    EXPECT_EQ(named.unit, "mK");
    EXPECT_NE(error_of([&] {
                  read(grid, volume, {}, {.grid = "heat"});
              }).find("fields.vdb: no grid named 'heat' (it has: t)"),
              std::string::npos);
    EXPECT_NE(error_of([&] {
                  read_field({.file = dir_ / "absent.vdb"}, volume);
              }).find("absent.vdb: no such file"),
              std::string::npos);
    EXPECT_EQ(error_of([&] { read_field({.grid = "t"}, volume); }),
              "field 't': no file, expected a .vdb or .nvdb");
    Points points;
    points.position = {{1, 2, 3}};
    write_points(dir_ / "points.vdb", points);
    EXPECT_NE(error_of([&] {
                  read_field({.file = dir_ / "points.vdb", .grid = "points"}, volume);
              }).find("grid 'points': holds points, expected numbers or vectors"),
              std::string::npos);
}

TEST_F(voxel_field, fields_of_levels_follow_the_pattern_of_the_grid) {
    const auto expect = [](const FieldSource& field, const std::string& pattern,
                           const std::string& file, const std::string& grid) {
        const FieldSource level = field_of_level(field, pattern, {"amr.vdb", "density_L12", ""});
        EXPECT_EQ(level.file, file);
        EXPECT_EQ(level.grid, grid);
        EXPECT_EQ(level.name, field.name);
    };
    expect({.grid = "T_L*", .name = "T"}, "density_L*", "amr.vdb", "T_L12");
    expect({.file = "b.vdb", .grid = "*_heat", .name = "T"}, "density_*", "b.vdb", "L12_heat");
    expect({.grid = "T", .name = "T"}, "density_L12", "amr.vdb", "T");
    EXPECT_EQ(error_of([] {
                  field_of_level({.grid = "T_L*"}, "density_L12", {"a.vdb", "density_L12", ""});
              }),
              "grid 'density_L12' and field 'T_L*': expected a * in both, or in neither");
}

TEST_F(voxel_field, threads_change_nothing) {
    Volume volume = random_volume(3, 0.6);
    const auto grid = make_grid("t");
    grid->tree().root().setBackground(-1, false);
    fill(*grid, {-20, -20, -20}, {20, 20, 20}, signed_value);
    place(*grid, turned_map());
    Volume again = volume;
    const VoxelField field = read(grid, volume);
    const ThreadLimit one(1);
    const VoxelField same = read(grid, again);
    expect_same_volume(volume, again);
    EXPECT_EQ(field.component[0].leaf, same.component[0].leaf);
    EXPECT_EQ(field.component[0].tile, same.component[0].tile);
    EXPECT_EQ(field.lower, same.lower);
}

TEST_F(voxel_field, a_volumes_own_values) {
    Volume volume = cube_of(8, 0.5f, {});
    volume.name = "ct";
    volume.tiles = {{{8, 0, 0}, 8, 0.25f}};
    const VoxelField field = own_field(volume);
    EXPECT_EQ(field.name, "ct");
    EXPECT_EQ(own_field(volume, "hu").name, "hu");
    EXPECT_EQ(field.component[0].leaf[0], volume.leaves[0].value);
    EXPECT_EQ(field.component[0].tile, std::vector<float>{0.25f});
    EXPECT_EQ(field.lower, 0.25);
    EXPECT_EQ(field.upper, 0.5);
}

/// A measure of volume, for signed values.
TEST_F(voxel_field, ones_count_active_voxels_of_any_value) {
    const auto grid = make_grid("hu", openvdb::GRID_UNKNOWN);
    fill(*grid, {}, {9, 7, 7}, signed_value);
    set_voxel(*grid, {3, 2, 1}, kNan);
    grid->tree().addTile(1, Coord(64, 0, 0), -5, true);
    write_grids(dir_ / "ct.vdb", {grid});
    const VdbOptions ones{.ones = true};
    std::vector<std::string> notes;
    Volume volume = read_volume(dir_ / "ct.vdb", ones, &notes);
    validate(volume);
    EXPECT_EQ(active_voxels(volume), 639u + 512u);
    EXPECT_EQ(mass(volume), 639.0 + 512.0);
    ASSERT_EQ(notes.size(), 1u);
    EXPECT_NE(notes[0].find("ct.vdb: grid 'hu': 1 values that are not finite left out, the first "
                            "at index [3, 2, 1]"),
              std::string::npos)
        << notes[0];
    const VoxelField field = read_field({.file = dir_ / "ct.vdb", .grid = "hu"}, volume);
    EXPECT_EQ(field.lower, double(signed_value({0, 7, 0})));
    EXPECT_EQ(field.component[0].tile, std::vector<float>{-5});
    const std::vector<std::filesystem::path> files{dir_ / "ct.vdb"};
    EXPECT_EQ(mass(read_levels(files, {.ones = true}).volumes[0]), 1151.0);

    const auto count = [&](const openvdb::GridBase::Ptr& other) {
        write_grids(dir_ / "other.vdb", {other});
        return mass(read_volume(dir_ / "other.vdb", {.grid = other->getName(), .ones = true}));
    };
    const auto surface = make_grid("surface", openvdb::GRID_LEVEL_SET);
    fill(*surface, {}, {3, 3, 3}, [](Vec3i i) { return float(i.x) - 1.5f; });
    EXPECT_EQ(count(surface), 64);
    const auto flags = make_grid<openvdb::BoolGrid>("flags");
    flags->tree().setValueOn({0, 0, 0}, false);
    flags->tree().setValueOn({0, 0, 1}, true);
    EXPECT_EQ(count(flags), 2);
    const auto mask = make_grid<openvdb::MaskGrid>("mask");
    mask->tree().setValueOn({3, 0, 0});
    EXPECT_EQ(count(mask), 1);
    const auto velocity = make_grid<openvdb::Vec3SGrid>("v");
    set_voxel(*velocity, {0, 0, 0}, openvdb::Vec3s(-1, 0, 2));
    EXPECT_EQ(count(velocity), 1);
}

/// Temperature and velocity of a Mantaflow fire, against OpenVDB's own reading.
TEST_F(voxel_field, of_a_plume_are_as_openvdb_reads_them) {
    VOG_NEEDS_DATA("plume/plume_0030.vdb");
    const std::filesystem::path path = data_dir() / "plume" / "plume_0030.vdb";
    Volume volume = read_volume(path, {.grid = "density"});
    openvdb::io::File file(path.string());
    file.open();
    for (const char* name : {"temperature", "flame"}) {
        const auto grid = openvdb::gridPtrCast<FloatGrid>(file.readGrid(name));
        notes_.clear();
        const VoxelField field = read_field({.file = path, .grid = name}, volume, {}, &notes_);
        expect_values(
            volume, field,
            [&](Vec3i i) {
                return Vec3d{double(grid->tree().getValue({i.x, i.y, i.z}))};
            },
            0);
    }
    read_field({.file = path, .grid = "temperature"}, volume, {}, &notes_);
    EXPECT_EQ(notes_.size(), 2u) << "8 voxels of density have no temperature";
    const auto grid = openvdb::gridPtrCast<openvdb::Vec3SGrid>(file.readGrid("velocity"));
    const VoxelField velocity = read_field({.file = path, .grid = "velocity"}, volume);
    const auto& tree = grid->tree();
    expect_values(
        volume, velocity,
        [&](Vec3i i) {
            const Coord at(i.x, i.y, i.z);
            Vec3d mean;
            for (int c = 0; c < 3; ++c) {
                Coord next = at;
                next[c] += 1;
                const double lower = tree.getValue(at)[c];
                mean[c] =
                    tree.isValueOn(next) ? 0.5 * (lower + double(tree.getValue(next)[c])) : lower;
            }
            return mean;
        },
        1e-5);
    EXPECT_GT(velocity.upper, 50);
    // fire.vdb: temperature at the voxels of flames, in the same lattice.
    VOG_NEEDS_DATA("fire.vdb");
    const std::filesystem::path fire = data_dir() / "fire.vdb";
    Volume flames = read_volume(fire, {.grid = "flames"});
    const VoxelField heat = read_field({.file = fire, .grid = "temperature"}, flames);
    EXPECT_GE(heat.lower, 0);
    EXPECT_NEAR(heat.upper, 1.27148, 1e-5);
}

}  // namespace vog::test
