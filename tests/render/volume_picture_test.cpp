// volume_picture_test.cpp: Pictures by value against closed forms, and against all voxels one by one.
#include "vog/volume_picture.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/reference/reference.h"
#include "support/made_fields.h"
#include "support/random_volume.h"
#include "support/ray_voxels.h"
#include "vog/error.h"
#include "vog/field_maps.h"
#include "vog/progress.h"

namespace vog::test {

namespace {

// Float pixels in [0, 1], and the promised end of opaque rays.
constexpr double kTolerance = 1e-6;

Camera orthographic(Vec3d eye, Vec3d look_at, double width) {
    Camera camera;
    camera.eye = eye, camera.look_at = look_at, camera.orthographic_width = width;
    if (eye.x == look_at.x && eye.z == look_at.z) camera.up = {0, 0, 1};
    return camera;
}
Camera pinhole(Vec3d eye, Vec3d look_at) {
    Camera camera;
    camera.eye = eye, camera.look_at = look_at;
    if (eye.x == look_at.x && eye.z == look_at.z) camera.up = {0, 0, 1};
    return camera;
}

VoxelField own_density() {
    VoxelField field = test::own();
    field.name = "density";
    return field;
}

/// One leaf whose voxels are value(x); voxels of edge 0.5, from -0.25 to 3.75.
template <class Value>
Volume half_edge_leaf(const Value& value) {
    Volume volume;
    volume.world_from_index.linear = {{Vec3d{0.5, 0, 0}, Vec3d{0, 0.5, 0}, Vec3d{0, 0, 0.5}}};
    Leaf& leaf = volume.leaves.emplace_back();
    for (int n = 0; n < kLeafVoxels; ++n) leaf.set(n, static_cast<float>(value(n >> 6)));
    return volume;
}

Rgba one_pixel(const Volume& volume, const VoxelField& field, const ValueTransfer& transfer,
               const Camera& camera, const VolumeLook& look = {}) {
    return render_volume_reference({&volume, 1}, {&field, 1}, transfer, camera, 1, 1, {}, look)
        .pixel[0];
}

void expect_near(const Rgba& got, const Rgba& expected, double tolerance = kTolerance) {
    EXPECT_NEAR(got.r, expected.r, tolerance);
    EXPECT_NEAR(got.g, expected.g, tolerance);
    EXPECT_NEAR(got.b, expected.b, tolerance);
    EXPECT_NEAR(got.a, expected.a, tolerance);
}
Rgba rgba(double r, double g, double b, double a) {
    return {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b),
            static_cast<float>(a)};
}

/// Two colours, with a step of opacity at 1.
ValueTransfer two_materials() {
    return {"two",
            {{0, 1, 0.5f, 0}, {1, 1, 0.5f, 0}, {1, 0, 0.25f, 1}},
            {{0, 0.2}, {1, 0.2}, {1, 0.6}},
            1.5};
}

constexpr Vec3d kMiddle{1.75, 1.75, 1.75};

}  // namespace

TEST(volume_picture, a_box_of_one_value_absorbs_by_its_chord) {
    const Volume volume = half_edge_leaf([](int) { return 0.5; });
    const ValueTransfer transfer = two_materials();
    const double extinction = -std::log(0.8) / 1.5;
    const auto expected = [&](double chord) {
        const double alpha = 1 - std::exp(-extinction * chord);
        return rgba(alpha, 0.5 * alpha, 0, alpha);
    };
    const Vec3d side = kMiddle + Vec3d{-9, 0, 0}, corner = kMiddle + Vec3d{9, 9, 9};
    expect_near(one_pixel(volume, own_density(), transfer, orthographic(side, kMiddle, 1)),
                expected(4));
    expect_near(one_pixel(volume, own_density(), transfer, pinhole(side, kMiddle)), expected(4));
    expect_near(one_pixel(volume, own_density(), transfer, pinhole(corner, kMiddle)),
                expected(4 * std::sqrt(3.0)));
    // The eye inside, a quarter from the front.
    expect_near(one_pixel(volume, own_density(), transfer, pinhole({0.75, 1.75, 1.75}, kMiddle)),
                expected(3));
    expect_near(one_pixel(volume, own_density(), transfer, orthographic({9, 9, 9}, {9, 9, 0}, 1)),
                rgba(0, 0, 0, 0));
}

TEST(volume_picture, two_slabs_differ_by_their_order) {
    const Volume volume = half_edge_leaf([](int x) { return x < 4 ? 0.5 : 1.0; });
    const double thin = 1 - std::exp(std::log(0.8) / 1.5 * 2);
    const double thick = 1 - std::exp(std::log(0.4) / 1.5 * 2);
    const auto expected = [&](bool thin_first) {
        const double a = thin_first ? thin : (1 - thick) * thin;
        const double b = thin_first ? (1 - thin) * thick : thick;
        return rgba(a, 0.5 * a + 0.25 * b, b, a + b);
    };
    for (const bool thin_first : {true, false}) {
        const Vec3d eye = kMiddle + Vec3d{thin_first ? -9.0 : 9.0, 0, 0};
        expect_near(
            one_pixel(volume, own_density(), two_materials(), orthographic(eye, kMiddle, 1)),
            expected(thin_first));
        expect_near(one_pixel(volume, own_density(), two_materials(), pinhole(eye, kMiddle)),
                    expected(thin_first));
    }
}

TEST(volume_picture, another_field_is_weighed_by_density) {
    const Volume volume = half_edge_leaf([](int) { return 3.0; });
    VoxelField field = own_density();
    field.component[0].leaf.resize(1);
    field.component[0].leaf[0].fill(0.5f);
    const double alpha = 1 - std::exp(std::log(0.8) / 1.5 * 3 * 4);
    expect_near(one_pixel(volume, field, two_materials(),
                          orthographic(kMiddle + Vec3d{0, 0, 9}, kMiddle, 1)),
                rgba(alpha, 0.5 * alpha, 0, alpha));
}

TEST(volume_picture, a_ramp_is_classified_voxel_by_voxel) {
    const Volume volume = half_edge_leaf([](int x) { return x; });
    const ValueTransfer transfer{"ramp", {{1, 0, 0, 0}, {7, 1, 1, 1}}, {{2, 0}, {6, 0.8}}, 1};
    double light = 0, passed = 1;
    for (int x = 0; x < 8; ++x) {
        const double grey = std::clamp((x - 1) / 6.0, 0.0, 1.0);
        const double opacity = std::clamp((x - 2) / 4.0, 0.0, 1.0) * 0.8;
        const double clear = std::sqrt(1 - opacity);  // half a unit distance
        light += passed * (1 - clear) * grey, passed *= clear;
    }
    expect_near(one_pixel(volume, own_density(), transfer,
                          orthographic(kMiddle + Vec3d{-9, 0, 0}, kMiddle, 1)),
                rgba(light, light, light, 1 - passed));
}

namespace {

/// Every active voxel and tile on a ray, sorted, by light_of.
Rgba brute_force(const Volume& volume, const VoxelField& field, const ValueTransfer& transfer,
                 Vec3d origin, Vec3d direction) {
    struct Cell {
        double first, last, density, value;
    };
    const IndexRay ray(volume, origin, direction);
    std::vector<Cell> cells;
    const VoxelValues& values = field.component[0];
    const bool is_own = values.leaf.empty() && values.tile.empty();
    const auto add = [&](Vec3d center, double edge, float density, float value) {
        const Vec3d half{0.5, 0.5, 0.5};
        const auto [first, last] = ray.cut(center - half, center - half + Vec3d{edge, edge, edge});
        if (last > first) cells.push_back({first, last, density, is_own ? density : value});
    };
    for (std::size_t t = 0; t < volume.tiles.size(); ++t)
        add(vec_cast<double>(volume.tiles[t].origin), volume.tiles[t].edge, volume.tiles[t].value,
            is_own ? 0 : values.tile[t]);
    for (std::size_t l = 0; l < volume.leaves.size(); ++l) {
        const Leaf& leaf = volume.leaves[l];
        const Vec3d corner = vec_cast<double>(leaf.origin);
        if (ray.length_in(corner, kLeafEdge) == 0) continue;
        for (std::size_t n = 0; n < kLeafVoxels; ++n)
            if (leaf.active(static_cast<int>(n)))
                add(corner + Vec3d{double(n >> 6), double(n >> 3 & 7), double(n & 7)}, 1,
                    leaf.value[n], is_own ? 0 : values.leaf[l][n]);
    }
    std::ranges::sort(cells, {}, &Cell::first);
    double r = 0, g = 0, b = 0, passed = 1;
    for (const Cell& cell : cells) {
        const ValueLight light = light_of(transfer, cell.value);
        const double depth = light.extinction * (is_own ? 1 : cell.density) *
                             (cell.last - cell.first) * length(direction);
        const double weight = passed * -std::expm1(-depth);
        r += weight * light.r, g += weight * light.g, b += weight * light.b;
        passed *= std::exp(-depth);
    }
    return rgba(r, g, b, 1 - passed);
}

VoxelField random_field(const Volume& volume) {
    Random random(5);
    VoxelField field = own_density();
    VoxelValues& values = field.component[0];
    values.leaf.resize(volume.leaves.size());
    for (auto& leaf : values.leaf)
        for (float& value : leaf) value = static_cast<float>(random(-1, 2));
    for (std::size_t t = 0; t < volume.tiles.size(); ++t)
        values.tile.push_back(static_cast<float>(random(-1, 2)));
    return field;
}

}  // namespace

TEST(volume_picture, is_that_of_all_voxels_in_order) {
    Volume volume = random_volume(3);
    const VoxelField fields[] = {own_density(), random_field(volume)};
    const ValueTransfer transfer{
        "t",
        {{-0.5, 1, 0, 0}, {0.4, 0, 1, 0.2f}, {0.4, 0.1f, 0, 1}, {3, 1, 1, 0}},
        {{-1, 0.3}, {0, 0}, {0.5, 0.05}, {0.9, 0}, {0.9, 0.4}, {1.2, 0.4}, {1.2, 0.01}},
        0.3};
    for (const auto& [name, map] : grid_maps()) {
        SCOPED_TRACE(name);
        volume.world_from_index = map;
        const Vec3d middle = map({3.2, 4.1, 2.7});
        const double size = length(map.linear * Vec3d{20, 20, 20});
        Camera turned = orthographic(middle + Vec3d{size, 2 * size, 3 * size}, middle, size);
        const Camera cameras[] = {pinhole(middle + Vec3d{2 * size, -size, size}, middle), turned,
                                  orthographic(middle + Vec3d{0, 0, -9 * size}, middle, size),
                                  pinhole(middle, middle + Vec3d{1, 2, 3})};
        for (const Camera& camera : cameras)
            for (const VoxelField& field : fields) {
                constexpr int kSide = 5;
                const VolumeImage image = render_volume_reference({&volume, 1}, {&field, 1},
                                                                  transfer, camera, kSide, kSide);
                const CameraFrame frame = frame_of(camera, kSide, kSide);
                for (int n = 0; n < kSide * kSide; ++n)
                    expect_near(
                        image.pixel[static_cast<std::size_t>(n)],
                        brute_force(volume, field, transfer, frame.origin(n % kSide, n / kSide),
                                    frame.direction(n % kSide, n / kSide)),
                        2 * kTolerance);
            }
    }
}

TEST(volume_picture, a_field_without_values_is_the_volumes_own_in_maps_too) {
    const Volume volume = random_volume(9);
    const VoxelField implied = own_density(), stated = own_field(volume);
    const Camera camera = pinhole({30, 20, 40}, {3, 3, 3});
    const auto draw = [&](const VoxelField& field) {
        return render_field_reference({&volume, 1}, {&field, 1}, FieldPart::value, camera, 16, 16);
    };
    const FieldMaps a = draw(implied), b = draw(stated);
    EXPECT_EQ(a.column, b.column);
    ASSERT_GT(a.column[136], 0);
    EXPECT_EQ(a.mean[136], b.mean[136]);
    EXPECT_EQ(a.deviation[136], b.deviation[136]);
}

TEST(volume_picture, is_the_same_for_any_number_of_threads_and_averages_samples) {
    const Volume volume = random_volume(4);
    const VoxelField field = own_density();
    const ValueTransfer transfer = two_materials();
    const Camera camera = pinhole({30, 20, 40}, {3, 3, 3});
    const auto draw = [&](int width, int samples) {
        return render_volume_reference({&volume, 1}, {&field, 1}, transfer, camera, width, width,
                                       {.samples = samples});
    };
    const VolumeImage all = draw(40, 1);
    {
        const ThreadLimit one(1);
        EXPECT_EQ(draw(40, 1).pixel, all.pixel);
    }
    const VolumeImage fine = draw(20, 2);
    for (int n = 0; n < 400; ++n) {
        double mean = 0;
        for (int s = 0; s < 4; ++s)
            mean += all.pixel[static_cast<std::size_t>((2 * (n / 20) + s / 2) * 40 + 2 * (n % 20) +
                                                       s % 2)]
                        .a /
                    4;
        EXPECT_NEAR(fine.pixel[static_cast<std::size_t>(n)].a, mean, kTolerance);
    }
}

TEST(volume_picture, volumes_that_overlap_add_their_extinctions) {
    const Volume volume = random_volume(7);
    const Volume twice[] = {volume, volume};
    const VoxelField fields[] = {own_density(), own_density()};
    ValueTransfer transfer = two_materials();
    const Camera camera = pinhole({30, 20, 40}, {3, 3, 3});
    const VolumeImage sum = render_volume_reference(twice, fields, transfer, camera, 24, 24);
    transfer.unit_distance /= 2;
    const VolumeImage one =
        render_volume_reference({&volume, 1}, {fields, 1}, transfer, camera, 24, 24);
    for (std::size_t n = 0; n < sum.pixel.size(); ++n)
        expect_near(sum.pixel[n], one.pixel[n], 2 * kTolerance);
}

TEST(volume_picture, clips_cut_exactly_within_voxels) {
    const Volume volume = half_edge_leaf([](int) { return 0.5; });
    const double extinction = -std::log(0.8) / 1.5;
    const auto alpha = [&](const Clipping& clip, const Camera& camera) {
        VolumeLook look;
        look.clip = clip;
        const double of_look = one_pixel(volume, own_density(), two_materials(), camera, look).a;
        const VoxelField field = own_density();
        ReferenceOptions options;
        options.clip = clip;
        const FieldMaps maps = render_field_reference({&volume, 1}, {&field, 1}, FieldPart::value,
                                                      camera, 1, 1, options);
        const VoxelGrid grid = voxel_grid(volume);
        const double depth = render_reference({&grid, 1}, camera, 1, 1, options).depth[0];
        EXPECT_NEAR(depth, maps.column[0], kTolerance);
        EXPECT_NEAR(of_look, 1 - std::exp(-extinction * depth / 0.5), kTolerance);
        return of_look;
    };
    const Camera camera = orthographic(kMiddle + Vec3d{-9, 0, 0}, kMiddle, 1);
    const auto expected = [&](double chord) { return 1 - std::exp(-extinction * chord); };
    EXPECT_NEAR(alpha({Box{{0.3, 0, 0}, {1.4, 2, 2}}, {}}, camera), expected(1.1), kTolerance);
    EXPECT_NEAR(alpha({{}, {{{2, 0, 0}, 2}}}, camera), expected(2.75), kTolerance);
    EXPECT_NEAR(alpha({{}, {{{-1, 1, 0}, 0}}}, camera), expected(2), kTolerance);
    EXPECT_EQ(alpha({Box{{0, 2, 0}, {1, 3, 2}}, {}}, camera), 0);
    EXPECT_THROW(alpha({Box{{0, 2, 0}, {1, 2, 2}}, {}}, camera), Error);
    EXPECT_THROW(alpha({{}, {{{0, 0, 0}, 1}}}, camera), Error);
}

TEST(volume_picture, two_sides_of_a_plane_have_the_whole_optical_depth) {
    Volume coarse = random_volume(5), fine = random_volume(6);
    coarse.tiles.clear(), fine.tiles.clear();
    fine.world_from_index.linear = {{Vec3d{0.5, 0, 0}, Vec3d{0, 0.5, 0}, Vec3d{0, 0, 0.5}}};
    fine.world_from_index.translation = {-0.25, -0.25, -0.25};
    Levels levels;
    levels.volumes = {coarse, fine};
    const Camera camera = pinhole({30, 20, 40}, {3, 3, 3});
    for (const Interpolation interpolation : {Interpolation::constant, Interpolation::linear}) {
        // Linear: exact, cell by cell.
        const LevelGrids grids = level_grids(levels, {interpolation, 0});
        const VoxelGrid one = voxel_grid(coarse, {interpolation, 0});
        const auto draw = [&](double side, bool mesh) {
            ReferenceOptions options;
            if (side != 0) options.clip.planes = {{{side, side, 0}, side * 7.3}};
            return mesh ? render_reference(grids, camera, 9, 9, options)
                        : render_reference({&one, 1}, camera, 9, 9, options);
        };
        for (const bool mesh : {true, false}) {
            const DepthImage whole = draw(0, mesh), front = draw(1, mesh), back = draw(-1, mesh);
            for (std::size_t n = 0; n < whole.depth.size(); ++n)
                EXPECT_NEAR(front.depth[n] + back.depth[n], whole.depth[n],
                            1e-5 * whole.depth[n] + 1e-9);
            EXPECT_GT(front.depth[40], 0.1f);
            EXPECT_GT(back.depth[40], 0.1f);
        }
    }
}

TEST(volume_picture, light_shades_by_the_gradient) {
    // Opaque: the front voxels alone are visible, whose gradient is along the ray.
    const Volume volume = half_edge_leaf([](int) { return 1.0; });
    ValueTransfer transfer{"grey", {{0, 0.5f, 0.25f, 0}}, {{0, 1}}, 1e-3};
    VolumeLook look;
    look.light = true;
    look.ambient = 0.2, look.diffuse = 0.6, look.specular = 0.1;
    const Camera camera = orthographic(kMiddle + Vec3d{-9, 0, 0}, kMiddle, 1);
    expect_near(one_pixel(volume, own_density(), transfer, camera, look),
                rgba(0.8 * 0.5 + 0.1, 0.8 * 0.25 + 0.1, 0.1, 1), 2e-6);
    // 60 degrees off: half the diffuse light; the half vector is 30 degrees off.
    look.lights = {{{-0.5, 0, std::sqrt(0.75)}}};
    const double shine = 0.1 * std::pow(std::cos(std::acos(-1.0) / 6), look.power);
    expect_near(one_pixel(volume, own_density(), transfer, camera, look),
                rgba(0.5 * 0.5 + shine, 0.5 * 0.25 + shine, shine, 1), 2e-6);
    // From behind: ambient alone. Inside, without a gradient: the colour itself.
    look.lights = {{{1, 0, 0}}};
    expect_near(one_pixel(volume, own_density(), transfer, camera, look), rgba(0.1, 0.05, 0, 1),
                2e-6);
    look.clip.planes = {{{1, 0, 0}, 0.5}};
    expect_near(one_pixel(volume, own_density(), transfer, camera, look), rgba(0.5, 0.25, 0, 1),
                2e-6);
}

TEST(volume_picture, is_blended_over_a_background) {
    const VolumeImage picture{
        3, 1, {rgba(0.25, 0, 0, 0.5), rgba(0, 0, 0, 0), rgba(0.2, 0.3, 0.4, 1)}};
    const Image black = over(picture, {0, 0, 0, 1}), white = over(picture, {1, 1, 1, 1});
    expect_near(black.pixel[0], rgba(0.25, 0, 0, 1));
    expect_near(white.pixel[0], rgba(0.75, 0.5, 0.5, 1));
    expect_near(white.pixel[1], rgba(1, 1, 1, 1));
    expect_near(white.pixel[2], rgba(0.2, 0.3, 0.4, 1));
    const Image clear = over(picture, {0, 0, 0, 0});
    expect_near(clear.pixel[0], rgba(0.5, 0, 0, 0.5));
    EXPECT_EQ(clear.pixel[1].a, 0);
    EXPECT_THROW(over(picture, {2, 0, 0, 1}), Error);
}

TEST(volume_picture, refuses_fields_of_other_volumes_and_lights_of_no_number) {
    const Volume volume = half_edge_leaf([](int) { return 1.0; });
    const Camera camera = pinhole({9, 9, 9}, kMiddle);
    VoxelField field = own_density();
    field.component[0].tile = {1};
    EXPECT_THROW(one_pixel(volume, field, two_materials(), camera), Error);
    EXPECT_THROW((void)render_volume_reference({&volume, 1}, {}, two_materials(), camera, 1, 1),
                 Error);
    VolumeLook look;
    look.diffuse = -1;
    EXPECT_THROW(one_pixel(volume, own_density(), two_materials(), camera, look), Error);
    look.diffuse = std::numeric_limits<double>::infinity();
    EXPECT_THROW(one_pixel(volume, own_density(), two_materials(), camera, look), Error);
}

TEST(volume_picture, interpolated_voxels_are_classified_at_samples) {
    // Values x + 1 between the centres, falling to 0 within a voxel beyond the first and the last; voxels of edge 0.5.
    const Volume volume = half_edge_leaf([](int x) { return x + 1; });
    const auto value_at = [](double x) {  // in voxels
        return x < 0 ? std::max(1 + x, 0.0) : x > 7 ? std::max(8 * (8 - x), 0.0) : x + 1;
    };
    const ValueTransfer transfer{
        "bands", {{0, 1, 0, 0}, {8, 0, 1, 0}}, {{1.3, 0}, {1.3, 0.4}, {5.6, 0.1}, {5.6, 0.7}}, 1.5};
    const auto quadrature = [&](double weight) {
        double red = 0, green = 0, passed = 1;
        constexpr int kSteps = 90000;
        for (int n = 0; n < kSteps; ++n) {
            const double x = -1 + 9 * (n + 0.5) / kSteps;
            const ValueLight light = light_of(transfer, weight > 0 ? value_at(x) : 5);
            const double s = light.extinction * (weight > 0 ? weight : value_at(x));
            const double clear = std::exp(-s * 4.5 / kSteps);
            red += passed * (1 - clear) * light.r, green += passed * (1 - clear) * light.g;
            passed *= clear;
        }
        return rgba(red, green, 0, 1 - passed);
    };
    const Camera camera = orthographic(kMiddle + Vec3d{-9, 0, 0}, kMiddle, 1);
    const auto pixel = [&](const VoxelField& field, double step, const VolumeLook& look = {}) {
        return render_volume_reference({&volume, 1}, {&field, 1}, transfer, camera, 1, 1, {}, look,
                                       {Interpolation::linear, step})
            .pixel[0];
    };
    const Rgba exact = quadrature(1);
    expect_near(pixel(own_density(), 0.002), exact, 1e-3);
    expect_near(pixel(own_density(), 0.25), exact, 0.05);
    // Another field, 5 everywhere, does not fade; its density does.
    VoxelField five = own_density();
    five.lower = five.upper = 5;
    five.component[0].leaf.resize(1);
    five.component[0].leaf[0].fill(5);
    expect_near(pixel(five, 0.002), quadrature(0), 1e-3);
    // The gradient is along x, its length does not matter; the same with a light from the eye.
    VolumeLook look;
    look.light = true, look.ambient = 0.5, look.diffuse = 0.25, look.specular = 0;
    const Rgba lit = pixel(own_density(), 0.002, look);
    expect_near(lit, rgba(0.75 * exact.r, 0.75 * exact.g, 0, exact.a), 1e-3);
    look = {};
    look.clip.planes.push_back({{1, 0, 0}, 99});
    EXPECT_EQ(pixel(own_density(), 0.25, look).a, 0);
    EXPECT_THROW((void)pixel(own_density(), 0), Error);
    const std::vector<Volume> two{volume, volume};
    const std::vector<VoxelField> fields{own_density(), own_density()};
    EXPECT_THROW((void)render_volume_reference(two, fields, transfer, camera, 1, 1, {}, {},
                                               {Interpolation::linear, 0.25}),
                 Error);
}

}  // namespace vog::test
