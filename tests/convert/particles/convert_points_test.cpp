// convert_points_test.cpp: particles to Gaussians: masses, radii, cuts, errors.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <span>

#include "convert/particles/nearest_neighbours.h"
#include "render/splat/splat.h"
#include "support/refused_files.h"
#include "support/scenes.h"
#include "vog/compare.h"
#include "vog/convert_points.h"

namespace vog::test {

using namespace vog::particles;

namespace {

/// Clusters of very different density, with velocities and masses.
Points clustered(std::size_t count, std::uint32_t seed = 1) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> place(-20, 30);
    std::normal_distribution<double> normal;
    Points points;
    points.source = "made.xyz";
    points.attributes = {{"mass", {}}};
    Vec3d center;
    double width = 1;
    for (std::size_t n = 0; n < count; ++n) {
        if (n % 100 == 0) {
            center = {place(random), place(random), place(random)};
            width = std::exp(normal(random));
        }
        points.position.push_back(
            center + width * Vec3d{normal(random), 0.5 * normal(random), 0.2 * normal(random)});
        points.velocity.push_back({float(normal(random)), float(normal(random)), 1.0f});
        points.attributes[0].value.push_back(float(std::exp(2 * normal(random))));
    }
    return points;
}

double sum(std::span<const float> values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

/// Mean and second moments of a model's mass.
struct Totals {
    double mass = 0;
    Vec3d first;
    Vec3d second;  ///< about the origin, along the axes
};
Totals totals(const Gaussians& model) {
    Totals all;
    for (std::size_t i = 0; i < model.size(); ++i) {
        const double m = mass(model, i);
        const Vec3d mean = vec_cast<double>(model.mean[i]);
        const Mat3 axes = model.axis_aligned() ? Mat3{} : matrix_from_quat(model.rotation[i]);
        all.mass += m;
        all.first = all.first + m * mean;
        for (int axis = 0; axis < 3; ++axis) {
            double variance = 0;
            for (int own = 0; own < 3; ++own)
                variance += std::pow(axes(axis, own) * model.scale[i][own], 2);
            all.second[axis] +=
                m * (variance * variance_within(model.cutoff) + mean[axis] * mean[axis]);
        }
    }
    return all;
}
void expect_same(const Totals& a, const Totals& b) {
    EXPECT_NEAR(a.mass / b.mass, 1, 1e-6);
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(a.first[axis] / a.mass, b.first[axis] / b.mass, 1e-5);
        EXPECT_NEAR(a.second[axis] / b.second[axis], 1, 1e-5);
    }
}

}  // namespace

TEST(points_convert, neighbour_distances_are_those_of_all_pairs) {
    std::mt19937 random(2);
    std::normal_distribution<float> normal;
    for (const std::size_t count : {2u, 7u, 8u, 9u, 65u, 700u}) {
        BigVector<Vec3f> places(count);
        for (std::size_t n = 0; n < count; ++n)
            places[n] = n % 3 == 2 ? places[n - 1]  // some in one place
                                   : Vec3f{normal(random), 9 * normal(random), normal(random)};
        for (const int k : {1, 2, 8, 31, 64}) {
            const BigVector<float> found = neighbour_distances(places, k);
            for (std::size_t n = 0; n < count; ++n) {
                std::vector<float> all;
                for (std::size_t other = 0; other < count; ++other)
                    if (other != n) all.push_back(length(places[n] - places[other]));
                std::ranges::sort(all);
                const std::size_t at = std::min<std::size_t>(std::size_t(k), all.size()) - 1;
                EXPECT_NEAR(found[n], all[at], 1e-6 * all[at]) << count << " " << k << " " << n;
            }
        }
    }
}

TEST(points_convert, a_particle_has_its_value_as_mass_where_it_is) {
    const Points points = clustered(3000);
    for (const char* value : {"count", "speed", "mass"}) {
        const BigVector<float> values = point_values(points, value);
        PointOptions options;
        options.value = value;
        const Gaussians model = convert_points(points, options);
        ASSERT_EQ(model.size(), points.size());
        EXPECT_TRUE(model.axis_aligned());
        for (std::size_t i = 0; i < model.size(); ++i) {
            EXPECT_NEAR(mass(model, i) / values[i], 1, 1e-6);
            EXPECT_EQ(model.mean[i], vec_cast<float>(points.position[i]));
            EXPECT_EQ(model.scale[i].x, model.scale[i].y);
            EXPECT_EQ(model.scale[i].x, model.scale[i].z);
        }
        EXPECT_NEAR(mass(model) / sum(values), 1, 1e-6);
        EXPECT_EQ(model.box, bounds(points));
        EXPECT_EQ(model.source, std::string("made.xyz ") + value);
    }
}

TEST(points_convert, the_adaptive_radius_is_half_the_distance_to_a_neighbour) {
    // On a line: the k-th neighbour inside lies (k + 1) / 2 away.
    Points points;
    for (int n = 0; n < 101; ++n) points.position.push_back({3.0 * n, 1, 2});
    for (const int k : {1, 2, 8}) {
        PointOptions options;
        options.neighbours = k;
        const Gaussians model = convert_points(points, options);
        const double deviation = model.scale[50].x * std::sqrt(variance_within(model.cutoff));
        EXPECT_NEAR(deviation, 0.5 * 3 * ((k + 1) / 2), 1e-4);
    }
    PointOptions constant;
    constant.radius = 0.25;
    const Gaussians model = convert_points(points, constant);
    EXPECT_NEAR(model.scale[7].y * std::sqrt(variance_within(model.cutoff)), 0.25, 1e-6);
}

TEST(points_convert, every_cut_conserves_mass_center_and_spread) {
    const Points points = clustered(4000);
    PointOptions options;
    options.value = "mass";
    const Totals whole = totals(convert_points(points, options));
    for (const std::size_t budget : {1u, 2u, 10u, 500u, 3999u, 4000u, 100000u}) {
        options.budget = budget;
        const Gaussians model = convert_points(points, options);
        EXPECT_LE(model.size(), budget);
        EXPECT_GE(model.size(), std::min<std::size_t>(budget, 4000) * 9 / 10);
        expect_same(totals(model), whole);
    }
    options.budget = 0;
    for (const int block : {1, 2, 4, 8, 128}) {
        options.block_voxels = block;
        expect_same(totals(convert_points(points, options)), whole);
    }
}

TEST(points_convert, two_clusters_become_two_gaussians) {
    Points points;
    for (int n = 0; n < 1000; ++n)
        points.position.push_back({n < 600 ? 0.0 : 50.0, 0.1 * (n % 10), 0.1 * (n / 10 % 10)});
    PointOptions options;
    options.radius = 0.2;
    options.budget = 2;
    Gaussians model = convert_points(points, options);
    ASSERT_EQ(model.size(), 2u);
    const std::size_t first = model.mean[0].x < 25 ? 0 : 1;
    EXPECT_NEAR(model.mean[first].x, 0, 1e-4);
    EXPECT_NEAR(model.mean[1 - first].x, 50, 1e-4);
    EXPECT_NEAR(mass(model, first), 600, 1e-3);
    // Ten planes 0.1 apart have the variance 0.0825; the particles' own comes on top.
    const double keeps = std::sqrt(variance_within(model.cutoff));
    const Vec3f scale = model.scale[first];
    EXPECT_NEAR(scale.x * keeps, std::sqrt(0.0825 + 0.04), 1e-4);
    EXPECT_NEAR(scale.z * keeps, 0.2, 1e-4);
}

TEST(points_convert, uniform_cells_are_cubes_of_voxels) {
    const Points points = clustered(2000, 3);
    const double edge = 4 * point_voxel_size(points);
    const Vec3d lower = bounds(points).lower;
    std::vector<std::array<int, 3>> cells;
    for (const Vec3d& p : points.position) {
        std::array<int, 3> cell{};
        for (int axis = 0; axis < 3; ++axis)
            cell[std::size_t(axis)] = int((p[axis] - lower[axis]) / edge);
        cells.push_back(cell);
    }
    std::ranges::sort(cells);
    const auto repeated = std::ranges::unique(cells);
    PointOptions options;
    options.block_voxels = 4;
    EXPECT_EQ(convert_points(points, options).size(), cells.size() - repeated.size());
}

TEST(points_convert, the_model_is_the_same_for_any_number_of_threads) {
    const Points points = clustered(20000);
    const auto convert = [&](std::size_t budget) {
        PointOptions options;
        options.value = "speed";
        options.budget = budget;
        return convert_points(points, options);
    };
    for (const std::size_t budget : {0u, 1500u}) {
        const Gaussians many = convert(budget);
        const ThreadLimit one(1);
        const Gaussians single = convert(budget);
        EXPECT_EQ(many.mean, single.mean);
        EXPECT_EQ(many.scale, single.scale);
        EXPECT_EQ(many.rotation, single.rotation);
        EXPECT_EQ(many.density, single.density);
    }
}

TEST(points_convert, a_picture_is_the_sum_of_the_particles_own_gaussians) {
    const Points points = clustered(300);
    const Gaussians model = convert_points(points);
    const Camera camera = paper_view(model.box);
    const DepthImage image = render_splat(model, camera, 48, 40);
    const std::vector<double> exact = exact_depth({"particles", model, camera, 48, 40});
    const double largest = *std::max_element(exact.begin(), exact.end());
    for (std::size_t n = 0; n < exact.size(); ++n)
        EXPECT_NEAR(image.depth[n], exact[n], 2e-5 * largest);
}

TEST(points_convert, densities_beyond_float_are_refused) {
    for (const auto& [factor, text] :
         {std::pair{1e21, "below 1.2e-38"}, {1e-30, "above 3.4e+38"}}) {
        Points points = clustered(300);
        for (Vec3d& p : points.position) p = factor * p;
        EXPECT_NE(error_of([&] { (void)convert_points(points); }).find(text), std::string::npos);
    }
}

TEST(points_convert, the_requested_error_is_met_with_few) {
    const Points points = clustered(5000);
    PointOptions options;
    options.error = 0.1;
    MomentReport report;
    const Gaussians model = convert_points(points, options, &report);
    EXPECT_LE(report.measured_error, 0.1);
    EXPECT_GT(report.measured_error, 0.08);
    EXPECT_LT(model.size(), points.size() / 2);
    // The report is of this model, not of the last one tried.
    EXPECT_NEAR(mass(model), static_cast<double>(points.size()) * (1 - report.dropped_mass_share),
                1e-5 * static_cast<double>(points.size()));
    options.error = 0;
    options.budget = model.size();
    options.measure = true;
    (void)convert_points(points, options, &report);
    EXPECT_NEAR(report.measured_error, 0.1, 0.02);
}

TEST(points_convert, particles_without_value_are_left_out) {
    Points points = clustered(1000);
    for (std::size_t n = 0; n < 1000; n += 2) points.attributes[0].value[n] = 0;
    PointOptions options;
    options.value = "mass";
    EXPECT_EQ(convert_points(points, options).size(), 500u);
    options.budget = 1000;
    EXPECT_EQ(convert_points(points, options).size(), 500u);
    EXPECT_EQ(convert_points_paper(points, "mass").size(), 500u);
}

TEST(points_convert, one_particle_and_many_in_one_place_need_a_radius) {
    Points points;
    points.source = "one.xyz";
    points.position = {{5, 6, 7}};
    EXPECT_EQ(error_of([&] { (void)convert_points(points); }),
              "one.xyz: one particle, so there is no spacing for an adaptive radius, expected a "
              "constant one (--radius X)");
    PointOptions options;
    options.radius = 2;
    for (const std::size_t count : {1u, 2u, 100u}) {
        points.position.assign(count, {5, 6, 7});
        for (const std::size_t budget : {0u, 1u, 50u}) {
            options.budget = budget;
            const Gaussians model = convert_points(points, options);
            EXPECT_NEAR(mass(model), double(count), 1e-5 * double(count));
            const DepthImage image = render_splat(model, paper_view(view_box(model)), 33, 33);
            // Through the middle: mass over 2 pi s^2, times the share of the line within the cut.
            const double s = 2 / std::sqrt(variance_within(kMomentCutoff));
            const double expected = double(count) / (2 * std::numbers::pi * s * s) *
                                    std::erf(kMomentCutoff / std::numbers::sqrt2) /
                                    mass_within(kMomentCutoff);
            EXPECT_NEAR(image.depth[16 * 33 + 16] / expected, 1, 1e-4);
        }
    }
    EXPECT_NE(error_of([&] { (void)convert_points(points); }).find("all 100 particles lie in one"),
              std::string::npos);
}

TEST(points_convert, coinciding_particles_among_others_keep_their_mass) {
    Points points = clustered(500);
    for (std::size_t n = 0; n < 50; ++n) points.position[n] = points.position[0];
    const Gaussians model = convert_points(points);
    EXPECT_NEAR(mass(model), 500, 5e-4);
    for (const Vec3f& scale : model.scale) EXPECT_GT(scale.x, 0);
}

TEST(points_convert, halos_far_from_the_origin_keep_their_shape) {
    Points points = clustered(1000);
    PointOptions options;
    options.budget = 100;
    const Gaussians near = convert_points(points, options);
    for (Vec3d& p : points.position) p = p + Vec3d{1048576, -2097152, 4194304};
    const Gaussians far = convert_points(points, options);
    ASSERT_EQ(near.size(), far.size());
    for (std::size_t i = 0; i < near.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_NEAR(far.scale[i][axis] / near.scale[i][axis], 1, 1e-4);
}

TEST(points_convert, the_papers_particles_have_their_speed_as_peak) {
    const Points points = clustered(2000);
    const Gaussians model = convert_points_paper(points);
    ASSERT_EQ(model.size(), points.size());
    EXPECT_NEAR(model.cutoff, std::sqrt(-2 * std::log(0.01)), 1e-6);
    EXPECT_EQ(model.method, "paper");
    const double voxel = point_voxel_size(points);
    BigVector<float> peaks = model.density, speeds = point_values(points, "speed");
    for (const Vec3f& scale : model.scale)
        EXPECT_NEAR(scale.x, 0.5 * voxel / std::numbers::sqrt2, 1e-6 * voxel);
    std::ranges::sort(peaks);
    std::ranges::sort(speeds);
    EXPECT_EQ(peaks, speeds);
    // Leaf by leaf: the 512 voxels of a leaf follow each other.
    std::vector<Vec3i> leaves;
    for (const Vec3f& mean : model.mean) {
        const Vec3d at = (1 / (8 * voxel)) * (vec_cast<double>(mean) - bounds(points).lower);
        const Vec3i leaf = vec_cast<std::int32_t>(at);
        if (leaves.empty() || !(leaves.back() == leaf)) leaves.push_back(leaf);
    }
    const std::size_t visits = leaves.size();
    const auto less = [](Vec3i a, Vec3i b) {
        return std::tuple(a.x, a.y, a.z) < std::tuple(b.x, b.y, b.z);
    };
    std::ranges::sort(leaves, less);
    leaves.erase(std::unique(leaves.begin(), leaves.end()), leaves.end());
    // A mean on a face may round to the other leaf.
    EXPECT_LE(visits, leaves.size() + 4);
    EXPECT_EQ(convert_points_paper(points, "mass", 0.3).scale[0].x,
              float(0.3 / std::numbers::sqrt2));
}

TEST(points_convert, about_one_particle_a_voxel) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> unit;
    Points points;
    for (int n = 0; n < 50000; ++n)
        points.position.push_back({2 * unit(random), unit(random), unit(random)});
    // 50,000 voxels fill the box of volume 2.
    EXPECT_NEAR(point_voxel_size(points), std::cbrt(2.0 / 50000), 0.01 * std::cbrt(2.0 / 50000));
    for (Vec3d& p : points.position) p.z = 3;
    EXPECT_NEAR(point_voxel_size(points), std::sqrt(2.0 / 50000), 0.01 * std::sqrt(2.0 / 50000));
    // Half of them in a thousandth of the volume need smaller voxels.
    for (Vec3d& p : points.position) p.z = unit(random);
    const double uniform = point_voxel_size(points);
    for (std::size_t n = 0; n < 25000; ++n) points.position[n] = 0.1 * points.position[n];
    EXPECT_LT(point_voxel_size(points), 0.6 * uniform);
}

TEST(points_convert, options_and_values_out_of_range_are_refused) {
    const Points points = clustered(10);
    const auto refused = [&](auto change) {
        PointOptions options;
        change(options);
        return error_of([&] { (void)convert_points(points, options); });
    };
    EXPECT_NE(refused([](auto& o) { o.budget = 5, o.block_voxels = 2; }).find("expected one of"),
              std::string::npos);
    EXPECT_NE(refused([](auto& o) { o.block_voxels = 3; }).find("block 3"), std::string::npos);
    EXPECT_NE(refused([](auto& o) { o.error = 1; }).find("error 1"), std::string::npos);
    EXPECT_NE(refused([](auto& o) { o.radius = -1; }).find("radius -1"), std::string::npos);
    EXPECT_NE(refused([](auto& o) { o.neighbours = 65; }).find("neighbours 65"), std::string::npos);
    EXPECT_EQ(refused([](auto& o) { o.value = "heat"; }),
              "made.xyz: no value named 'heat' (it has: count, speed, mass)");
    EXPECT_EQ(error_of([&] { (void)convert_points({}); }), "points: no particles");
    Points bad = points;
    bad.attributes[0].value[3] = -2;
    PointOptions options;
    options.value = "mass";
    EXPECT_EQ(error_of([&] { (void)convert_points(bad, options); }),
              "made.xyz: 'mass' of particle 3 is -2, expected 0 or more (--clip-negative sets "
              "negative ones to 0)");
    bad.attributes[0].value.assign(10, 0);
    EXPECT_EQ(error_of([&] { (void)convert_points(bad, options); }),
              "made.xyz: 'mass' is 0 for all particles");
    bad.position[9].y = std::nan("");
    EXPECT_EQ(error_of([&] { (void)convert_points(bad); }),
              "made.xyz: the position of particle 9 is not finite");
}

TEST(points_convert, reductions_of_real_data_stay_near_the_full_set) {
    VOG_NEEDS_DATA("lcdm.xyz");
    const Points points = read_points(data_dir() / "lcdm.xyz");
    const Gaussians full = convert_points(points);
    const Camera camera = paper_view(full.box);
    DepthImage reference = render_splat(full, camera, 512, 512);
    set_extinction(reference, auto_extinction(reference));
    // Measured 37.7 and 27.0 dB (docs/particles.md).
    for (const auto& [budget, least_db] : {std::pair{8192u, 37.0}, {1024u, 26.5}}) {
        PointOptions options;
        options.budget = budget;
        const Gaussians model = convert_points(points, options);
        EXPECT_NEAR(mass(model) / 65536, 1, 1e-6);
        DepthImage image = render_splat(model, camera, 512, 512);
        EXPECT_GT(compare(reference, image).grey.psnr_db, least_db) << budget;
    }
}

}  // namespace vog::test
