// vogz_test.cpp: compact models: errors within the steps, exact mass, sizes, parts, levels, fields, refused files.
#include "vog/vogz.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <set>

#include "core/parallel.h"
#include "support/data.h"
#include "support/field_models.h"
#include "support/image_bytes.h"
#include "support/refusal.h"
#include "support/refused_files.h"
#include "support/scenes.h"
#include "vog/distributed.h"
#include "vog/model_io.h"
#include "vog/progress.h"

namespace vog::test {

namespace {

using Matrix = std::array<double, 9>;

/// Covariance of Gaussian i.
Matrix covariance(const Gaussians& model, std::size_t i) {
    const Mat3 r = model.axis_aligned() ? Mat3{} : matrix_from_quat(model.rotation[i]);
    const Vec3d s = vec_cast<double>(model.scale[i]);
    Matrix c{};
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
            for (int k = 0; k < 3; ++k)
                c[static_cast<std::size_t>(3 * a + b)] += r(a, k) * r(b, k) * s[k] * s[k];
    return c;
}

/// Largest relative change of a variance along any direction: the largest entry of W (C' - C) W^T.
double shape_error(const Gaussians& model, const Gaussians& changed, std::size_t i) {
    const Mat3 w = whitening(model, i);
    const Matrix before = covariance(model, i), after = covariance(changed, i);
    Mat3 difference;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) {
            const auto n = static_cast<std::size_t>(3 * a + b);
            difference(a, b) = after[n] - before[n];
        }
    const Mat3 relative = w * difference * transpose(w);
    double most = 0;
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) most = std::max(most, std::abs(relative(a, b)));
    return most;
}

/// Distance of the means, in standard deviations.
double mean_error(const Gaussians& model, const Gaussians& changed, std::size_t i) {
    return length(whitening(model, i) * (world_mean(changed, i) - world_mean(model, i)));
}

/// Sorted by mean: files have an order of their own.
Gaussians sorted(const Gaussians& model) {
    std::vector<std::size_t> index(model.size());
    for (std::size_t i = 0; i < index.size(); ++i) index[i] = i;
    std::ranges::sort(index, {}, [&](std::size_t i) {
        const Vec3f m = model.mean[i];
        return std::tuple(m.x, m.y, m.z);
    });
    return select(model, index);
}

Gaussians with_fields(int count, std::uint64_t seed) {
    Gaussians model = random_gaussians(count, 0.02, 0.06, seed);
    add_random_fields(model, seed);
    return model;
}

}  // namespace

TEST(vogz, errors_stay_within_the_steps) {
    for (const double step : {0.1, 0.025, 0.001}) {
        for (const bool rotated : {true, false}) {
            Gaussians model = random_gaussians(9000, 0.03, 0.05, 1);
            if (!rotated) model.rotation.clear();
            const Gaussians back = rounded(model, {step, 1.0 / 256});
            for (std::size_t i = 0; i < model.size(); ++i) {
                // Half a step of 1.41 along each of three axes, doubled where powers of two are rounded by up to a half,
                // and as much longer as the shortest axis is shorter than the mean one.
                const Vec3f s = model.scale[i];
                const double thin = std::cbrt(s.x * s.y * s.z) / std::min({s.x, s.y, s.z});
                ASSERT_LT(mean_error(model, back, i),
                          1.5 * 0.5 * 1.42 * std::sqrt(3) * step * thin + 1e-5);
                // An entry of the logarithm is off by at most 0.58 steps, a variance by twice that of a few.
                ASSERT_LT(shape_error(model, back, i), 4 * step + 1e-5);
                ASSERT_NEAR(std::log(mass(back, i) / mass(model, i)), 0, 0.55 * step + 1e-4);
            }
        }
    }
}

TEST(vogz, mass_is_exact) {
    const TempDir dir;
    for (const int count : {1, 2, 100, 20000}) {
        const Gaussians model = random_gaussians(count, 0.01, 0.3, 2);
        write_vogz(dir / "m.vogz", model, {}, {{0.3, 0.1}, false});
        EXPECT_NEAR(mass(read_vogz(dir / "m.vogz")) / mass(model), 1, 1e-6) << count;
    }
}

TEST(vogz, files_hold_the_rounded_model_and_its_description) {
    const TempDir dir;
    Gaussians model = with_fields(20000, 3);
    model.origin = {1e6, -2, 3};
    model.box = {{-1, -2, -3}, {1e7, 2, 3}};
    model.source = "cloud.vdb density", model.source_voxels = 1234567890123;
    model.method = "moments", model.options = "--budget 7", model.summary = "a \"summary\"\n";
    model.fields.scalar.back().is_measure = true, model.fields.scalar.back().background = -0.1;
    model.cutoff = 2.5f;
    for (const bool deflate : {false, true}) {
        write_vogz(dir / "m.vogz", model, {}, {{}, deflate});
        const Gaussians read = read_vogz(dir / "m.vogz");
        const Gaussians expected = sorted(rounded(model, {}));
        const Gaussians found = sorted(read);
        EXPECT_EQ(found.mean, expected.mean);
        EXPECT_EQ(found.scale, expected.scale);
        EXPECT_EQ(found.rotation, expected.rotation);
        EXPECT_EQ(found.density, expected.density);
        expect_same_fields(found.fields, expected.fields);
        EXPECT_TRUE(read.fields.scalar.back().is_measure);
        EXPECT_EQ(read.origin, model.origin);
        EXPECT_EQ(read.box.lower, model.box.lower);
        EXPECT_EQ(read.box.upper, model.box.upper);
        EXPECT_EQ(read.source, model.source);
        EXPECT_EQ(read.source_voxels, model.source_voxels);
        EXPECT_EQ(read.method, model.method);
        EXPECT_EQ(read.options, model.options);
        EXPECT_EQ(read.summary, model.summary);
        EXPECT_EQ(read.cutoff, model.cutoff);
        const VogzInfo info = read_vogz_info(dir / "m.vogz");
        EXPECT_EQ(info.gaussians, model.size());
        EXPECT_EQ(info.description.fields.names(), model.fields.names());
        EXPECT_EQ(info.chunks, 3u);
    }
}

TEST(vogz, a_second_rounding_changes_little) {
    const Gaussians model = with_fields(3000, 4);
    const Gaussians once = rounded(model, {}), twice = rounded(once, {});
    for (std::size_t i = 0; i < model.size(); ++i) {
        ASSERT_LT(mean_error(model, twice, i), 0.2);
        ASSERT_LT(shape_error(once, twice, i), 0.03);
    }
}

TEST(vogz, fields_stay_within_their_steps) {
    const Gaussians model = with_fields(9000, 5);
    constexpr double kStep = 1.0 / 64;
    const Gaussians back = rounded(model, {0.025, kStep});
    for (std::size_t f = 0; f < model.fields.scalar.size(); ++f) {
        const ScalarField &a = model.fields.scalar[f], &b = back.fields.scalar[f];
        const double range = a.upper - a.lower;
        for (std::size_t i = 0; i < model.size(); ++i) {
            ASSERT_NEAR(a.value[i], b.value[i], (0.5 * kStep + 1e-6) * range) << a.name;
            ASSERT_NEAR(std::sqrt(a.deviation[i] / range), std::sqrt(b.deviation[i] / range),
                        2.01 * kStep)
                << a.name;
            ASSERT_NEAR(a.skewness[i], b.skewness[i], 16.01 * kStep);
            const double spread = std::cbrt(mass(model, i) / model.density[i]);
            for (int axis = 0; axis < 3; ++axis)
                ASSERT_NEAR(a.gradient[i][axis] * spread, b.gradient[i][axis] * spread,
                            (0.75 * kStep * 3 + 1e-5) * range +
                                0.05 * std::abs(a.gradient[i][axis] * spread));
        }
    }
    for (std::size_t f = 0; f < model.fields.vector.size(); ++f) {
        const VectorField &a = model.fields.vector[f], &b = back.fields.vector[f];
        for (std::size_t i = 0; i < model.size(); ++i)
            for (int axis = 0; axis < 3; ++axis)
                ASSERT_NEAR(a.value[i][axis], b.value[i][axis], (0.5 * kStep + 1e-6) * a.upper);
    }
    EXPECT_NO_THROW(validate(back));
}

TEST(vogz, files_are_small) {
    // A random cloud of nearly equal Gaussians: means inside of their cells are most of it.
    const TempDir dir;
    Gaussians model = random_gaussians(30000, 0.02, 0.03, 6);
    const VogzReport report = write_vogz(dir / "m.vogz", model);
    EXPECT_EQ(report.bytes, std::filesystem::file_size(dir / "m.vogz"));
    EXPECT_EQ(report.bytes, report.header + report.shapes);
    EXPECT_LT(static_cast<double>(report.bytes), 9.0 * 30000);
    model.rotation.clear();
    const VogzReport standard = write_vogz(dir / "m.vogz", model);
    EXPECT_LT(static_cast<double>(standard.bytes), 7.0 * 30000);
    // Half the step: a bit more for each of seven numbers.
    const VogzReport fine = write_vogz(dir / "m.vogz", model, {}, {{0.0125, 1.0 / 256}, false});
    EXPECT_NEAR(static_cast<double>(fine.shapes) - static_cast<double>(standard.shapes),
                30000 * 7 / 8.0, 30000 * 0.15);
}

TEST(vogz, same_bytes_for_any_number_of_threads) {
    const TempDir dir;
    const Gaussians model = with_fields(30000, 7);
    {
        const ThreadLimit one(1);
        write_vogz(dir / "one.vogz", model);
    }
    write_vogz(dir / "all.vogz", model);
    EXPECT_EQ(read_bytes(dir / "one.vogz"), read_bytes(dir / "all.vogz"));
}

TEST(vogz, hierarchies_come_back) {
    const TempDir dir;
    for (const int count : {2, 9, 40, 30000}) {
        Gaussians model = with_fields(count, 8);
        const Hierarchy hierarchy = build_hierarchy(model);
        const VogzReport report = write_vogz(dir / "m.vogz", model, hierarchy);
        EXPECT_GT(report.levels, 0u);
        Hierarchy read;
        const Gaussians back = read_vogz(dir / "m.vogz", &read);
        ASSERT_EQ(back.size(), model.size());
        EXPECT_EQ(read.node_count, hierarchy.node_count);
        EXPECT_EQ(read.leaf_count, hierarchy.leaf_count);
        EXPECT_EQ(read.first_node, hierarchy.first_node);
        for (std::size_t n = 0; n < read.size(); ++n) {
            EXPECT_GE(read.error[n], hierarchy.error[n]);
            EXPECT_LE(read.error[n], 1.02f * hierarchy.error[n]);
            // Balls hold all supports below, as rounded.
            for (std::size_t k = 0; k < read.leaf_count[n]; ++k) {
                const std::size_t i = read.first_leaf[n] + k;
                const Vec3f s = back.scale[i];
                EXPECT_LE(length(world_mean(back, i) - world_mean(read.nodes, n)) +
                              back.cutoff * double{std::max({s.x, s.y, s.z})},
                          read.radius[n]);
            }
        }
        // In the order of the hierarchy, not sorted again.
        for (std::size_t i = 0; i < back.size(); ++i) ASSERT_LT(mean_error(model, back, i), 0.2);
    }
}

TEST(vogz, parts_are_those_of_the_whole) {
    const TempDir dir;
    Gaussians model = with_fields(40000, 9);
    const Hierarchy hierarchy = build_hierarchy(model);
    write_vogz(dir / "m.vogz", model, hierarchy);
    const Gaussians whole = read_vogz(dir / "m.vogz");

    const VogzInfo info = read_vogz_info(dir / "m.vogz");
    ASSERT_GT(info.levels.size(), 3u);
    EXPECT_EQ(info.levels.front(), 1u);
    for (std::size_t level = 0; level < info.levels.size(); ++level) {
        const Gaussians coarse = read_vogz(dir / "m.vogz", VogzPart{level, {}, {}});
        EXPECT_GE(coarse.size(), info.levels[level]);
        EXPECT_NEAR(mass(coarse) / mass(model), 1, 1e-6) << level;
        expect_same_fields(select(coarse, {}).fields, select(model, {}).fields);
    }
    const std::string field = model.fields.scalar.front().name;
    const Gaussians one = read_vogz(dir / "m.vogz", VogzPart{{}, {}, std::vector{field}});
    EXPECT_EQ(one.mean, whole.mean);
    EXPECT_EQ(one.fields.names(), std::vector{field});
    EXPECT_EQ(one.fields.scalar[0].value, whole.fields.scalar[0].value);

    const Box corner{{-1.5, -1.5, -1.5}, {-0.8, -0.8, -0.8}};
    const Gaussians some = read_vogz(dir / "m.vogz", VogzPart{{}, corner, {}});
    EXPECT_LT(some.size(), whole.size());
    std::set<float> xs;
    for (const Vec3f m : some.mean) xs.insert(m.x);
    for (std::size_t i = 0; i < whole.size(); ++i) {
        const Box support = support_box(whole, i);
        bool inside = true;
        for (int axis = 0; axis < 3; ++axis)
            inside = inside && support.lower[axis] < corner.upper[axis] &&
                     support.upper[axis] > corner.lower[axis];
        EXPECT_TRUE(!inside || xs.contains(whole.mean[i].x)) << i;
    }

    Gaussians joined;
    for (int part = 0; part < 7; ++part)
        append(joined, read_model(dir / "m.vogz", ModelPart{part, 7}));
    EXPECT_EQ(joined.mean, whole.mean);
    EXPECT_EQ(joined.density, whole.density);
    expect_same_fields(joined.fields, whole.fields);
}

TEST(vogz, odd_models_come_back) {
    const TempDir dir;
    const auto back_of = [&](const Gaussians& model) {
        write_vogz(dir / "m.vogz", model);
        return read_vogz(dir / "m.vogz");
    };
    EXPECT_EQ(back_of(Gaussians{}).size(), 0u);
    Random random(10);
    // Coincident means; scales and densities at the ends of floats; needles and plates.
    Gaussians model;
    for (int n = 0; n < 20; ++n)
        add(model, {1, 2, 3}, {0.1f, 0.2f, 0.3f}, 1.0f + static_cast<float>(n));
    EXPECT_EQ(back_of(model).size(), 20u);
    EXPECT_NEAR(mass(back_of(model)) / mass(model), 1, 1e-6);
    Gaussians extreme;
    add(extreme, {0, 0, 0}, {1e-30f, 1e-30f, 1e-30f}, 3e38f);
    add(extreme, {1e-28f, 0, 0}, {1e-29f, 1e-30f, 1e-30f}, 1e-38f);
    EXPECT_EQ(back_of(extreme).size(), 2u);
    Gaussians apart = random_gaussians(3000, 1e-4, 2e-4, 13);  // and one far away
    add(apart, {1e6f, 1e6f, 1e6f}, {1e-4f, 1e-4f, 1e-4f}, 1, random.rotation());
    EXPECT_EQ(back_of(apart).size(), 3001u);
    Gaussians wide;  // supports beyond the range of floats
    add(wide, {3e38f, 0, 0}, {3e38f, 1e38f, 1e38f}, 1e-38f);
    add(wide, {-3e38f, 0, 0}, {3e38f, 1e38f, 1e38f}, 1e-38f);
    EXPECT_EQ(back_of(wide).size(), 2u);
    add(wide, {0, 0, 0}, {1e-38f, 1e-38f, 1e-38f}, 1);
    EXPECT_NE(refusal([&] { back_of(wide); }).find("too small and too far apart for one lattice"),
              std::string::npos);
    Gaussians thin;
    for (int n = 0; n < 2000; ++n)
        add(thin, vec_cast<float>(random.in_cube(1)), {1, 1e-3f, n % 2 ? 1e-3f : 1.0f}, 1,
            random.rotation());
    const Gaussians fine = rounded(thin, {});
    for (std::size_t i = 0; i < thin.size(); ++i) {
        ASSERT_LT(mean_error(thin, fine, i), 0.2);
        ASSERT_LT(shape_error(thin, fine, i), 0.5);
    }
}

TEST(vogz, gaussians_without_density_are_left_out) {
    const TempDir dir;
    Gaussians model = random_gaussians(50, 0.1, 0.2, 11);
    model.density[7] = model.density[8] = 0;
    const VogzReport report = write_vogz(dir / "m.vogz", model);
    EXPECT_EQ(report.left_out, 2u);
    EXPECT_EQ(read_vogz(dir / "m.vogz").size(), 48u);
    const Hierarchy hierarchy = build_hierarchy(model);
    EXPECT_NE(refusal([&] {
                  write_vogz(dir / "m.vogz", model, hierarchy);
              }).find("has no density, expected some in a model with levels"),
              std::string::npos);
    EXPECT_EQ(read_vogz(dir / "m.vogz").size(), 48u);  // the file is kept
}

TEST(vogz, bad_files_are_refused) {
    const TempDir dir;
    Gaussians model = with_fields(10, 12);
    model.fields.vector.clear();
    const Hierarchy hierarchy = build_hierarchy(model);
    write_vogz(dir / "m.vogz", model, hierarchy);
    const std::string bytes = read_bytes(dir / "m.vogz");
    const auto read = [](const std::filesystem::path& file) {
        Hierarchy nodes;
        read_vogz(file, &nodes);
    };
    expect_all_truncations_refused(bytes, read);
    expect_refused(bytes + "x", read, "too long");
    expect_refused("ply\nformat binary", read, "not a compact model (.vogz)");
    std::string newer = bytes;
    newer[8] = 2;
    expect_refused(newer, read, "a compact model of version 2, expected 1");
    std::string minor = bytes;
    minor[10] = 7;  // 1.7: what it adds can be left out
    std::ofstream(dir / "minor.vogz", std::ios::binary) << minor;
    EXPECT_NO_THROW(read(dir / "minor.vogz"));
    // Checksums cover all bytes behind the fixed ones, whose minor version and reserved word have none.
    for (std::size_t at = 0; at < bytes.size(); ++at) {
        if ((at >= 10 && at < 12) || (at >= 44 && at < 48)) continue;
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ 0x10);
        std::ofstream(dir / "changed.vogz", std::ios::binary) << changed;
        EXPECT_THROW(read(dir / "changed.vogz"), Error) << at;
    }
    EXPECT_NE(refusal([&] { read_vogz(dir / "none.vogz"); }).find("none.vogz"), std::string::npos);
    EXPECT_NE(refusal([&] {
                  read_vogz(dir / "m.vogz", VogzPart{99, {}, {}});
              }).find("level 99, expected below"),
              std::string::npos);
    EXPECT_NE(refusal([&] {
                  read_vogz(dir / "m.vogz", VogzPart{{}, {}, std::vector<std::string>{"nothing"}});
              }).find("no field 'nothing' (it has: "),
              std::string::npos);
    EXPECT_NE(refusal([&] {
                  write_vogz(dir / "m.vogz", model, {}, {{0.7, 0.1}, false});
              }).find("step 0.7, expected from 1e-6 to 0.5"),
              std::string::npos);
}

}  // namespace vog::test
