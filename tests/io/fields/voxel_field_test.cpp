// voxel_field_test.cpp: fields at the voxels of a measure: lattices, backgrounds, vectors, levels.
#include "vog/voxel_field.h"

#include <gtest/gtest.h>

#include "support/voxel_fields.h"
#include "vog/distributed.h"
#include "vog/progress.h"
#include "vog/volume_io.h"

namespace vog::test {

namespace {

using openvdb::Coord;
using openvdb::FloatGrid;

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

TEST_F(voxel_field, values_of_equal_lattices_with_other_axes_are_exact) {
    Volume volume = cube_of(20, 0.5f, kWorld);
    const auto grid = make_grid("t", openvdb::GRID_UNKNOWN);
    fill(*grid, {0, 3, -19}, {19, 22, 0}, signed_value);
    const Affine volume_from_grid{{{Vec3d{0, 1, 0}, {-1, 0, 0}, {0, 0, -1}}}, {-3, 19, 0}};
    Affine map{kWorld.linear * volume_from_grid.linear, kWorld(volume_from_grid.translation)};
    map.translation = map.translation + Vec3d{4e-5, -3e-5, 2e-5};
    map.linear(0, 1) *= 1 + 1e-6;
    place(*grid, map);
    expect_values(
        volume, read(grid, volume),
        [&](Vec3i i) {
            return Vec3d{double(signed_value({19 - i.y, i.x + 3, -i.z}))};
        },
        0);
    EXPECT_TRUE(notes_.empty());
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
              "fields.vdb: grid 't': inactive at 36 % of the mass of the volume; the "
              "field has its background value there");
    // Below, there is none: 64 of 512 voxels with 1e-4 of the mass.
    for (int n = 0; n < 64; ++n) volume.leaves[0].value[std::size_t(n)] = 3.5e-4f;
    read(grid, volume);
    EXPECT_TRUE(notes_.empty());
    // From 0.1 % there is one: 64 of 512 voxels with 2e-3 of the mass.
    for (int n = 0; n < 64; ++n) volume.leaves[0].value[std::size_t(n)] = 7e-3f;
    read(grid, volume);
    EXPECT_EQ(notes_.size(), 1u);
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

/// Temperature and velocity of a Mantaflow fire, against OpenVDB's own reading.
TEST_F(voxel_field, of_real_data_are_as_openvdb_reads_them) {
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
    notes_.clear();
    read_field({.file = path, .grid = "temperature"}, volume, {}, &notes_);
    EXPECT_TRUE(notes_.empty()) << "3e-5 % of the mass have no temperature";
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
