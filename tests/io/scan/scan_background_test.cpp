// scan_background_test.cpp: The background that dense images have, and that models and pictures of values above it are those of
// shifted values.
#include "io/scan/scan_background.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <random>

#include "io/scan/scan_files.h"
#include "vog/compare.h"
#include "vog/convert_moments.h"
#include "vog/dense.h"
#include "vog/model_io.h"
#include "vog/picture.h"
#include "vog/sample.h"

namespace vog::test {

namespace {

constexpr int kEdge = 24;

/// An image of a ball of a third of the edge in empty space: radius^3 4 pi / 3 = 0.16 of the voxels.
std::vector<float> ball_in(const std::function<double()>& empty,
                           const std::function<double()>& ball) {
    std::vector<float> values;
    const double middle = 0.5 * (kEdge - 1);
    for (int z = 0; z < kEdge; ++z)
        for (int y = 0; y < kEdge; ++y)
            for (int x = 0; x < kEdge; ++x) {
                const double r = std::hypot(x - middle, y - middle, z - middle);
                values.push_back(static_cast<float>(r < kEdge / 3.0 ? ball() : empty()));
            }
    return values;
}

struct Draws {
    std::mt19937 generator{7};
    std::function<double()> normal(double mean, double deviation) {
        return [this, mean, deviation] {
            return std::round(std::normal_distribution<>(mean, deviation)(generator));
        };
    }
};
std::function<double()> constant(double value) {
    return [value] { return value; };
}

/// A volume of raw floats, with the lines that its reader reports.
struct Read {
    Volume volume;
    std::vector<std::string> notes;
};
Read read_raw(const TempDir& dir, const std::vector<float>& values, const std::string& unit = "",
              const VdbOptions& options = {}, int edge = kEdge) {
    write_bytes(dir / "a.raw", bytes_of(values));
    write_bytes(
        dir / "a.raw.json",
        fmt::format(R"({{"size": [{0}, {0}, {0}], "type": "float32", "value_unit": "{1}"}})", edge,
                    unit));
    Read read;
    read.volume = read_volume(dir / "a.raw", options, &read.notes);
    return read;
}

}  // namespace

TEST(scan_background, air_of_hounsfield_units_is_minus_1000) {
    const TempDir dir;
    Draws random;
    std::vector<float> values = ball_in(random.normal(-1000, 15), constant(40));
    for (std::size_t n = 0; n < 100; ++n) values[n] = -3024;  // padding
    for (const std::string unit : {"", "HU"}) {
        const auto [volume, notes] = read_raw(dir, values, unit);
        EXPECT_EQ(volume.background, -1000);
        ASSERT_EQ(notes.size(), 1u);
        EXPECT_EQ(notes[0], fmt::format("{}: grid 'value': density is the value above the "
                                        "background, -1000",
                                        (dir / "a.raw").string()));
        float middle = 0, first = 1;
        copy_dense(volume, {12, 12, 12}, {1, 1, 1}, {&middle, 1});
        copy_dense(volume, {0, 0, 0}, {1, 1, 1}, {&first, 1});
        EXPECT_EQ(middle, 1040);
        EXPECT_EQ(first, 0);
        const VoxelField field = measure_field(volume);
        EXPECT_EQ(field.upper, 40);
        EXPECT_EQ(field.background, -1000);
        const VolumeInfo info = inspect_volume(dir / "a.raw").front();
        EXPECT_EQ(info.background, -1000);
        EXPECT_EQ(info.grid.active_voxels, active_voxels(volume));
    }
    // 12-bit scanners store air as -1024; a cropped scan of tissue has a unit and no air.
    EXPECT_EQ(read_raw(dir, ball_in(constant(-1024), constant(40))).volume.background, -1000);
    EXPECT_EQ(read_raw(dir, ball_in(constant(-100), constant(40)), "HU").volume.background, -1000);
}

TEST(scan_background, other_values_of_both_signs_are_no_hounsfield_units) {
    const TempDir dir;
    Draws random;
    for (const auto& [values, unit] :
         {std::pair{ball_in(random.normal(0, 400), constant(40)), "km/s"},
          {ball_in(random.normal(0, 400), constant(40)), ""},
          {ball_in(random.normal(-1000, 15), constant(40)), "km/s"},
          {ball_in(constant(-1), constant(1)), ""}})
        EXPECT_NE(refusal([&] { read_raw(dir, values, unit); }).find("negative"),
                  std::string::npos);
}

TEST(scan_background, noise_ends_four_deviations_above_its_mode) {
    const TempDir dir;
    Draws random;
    const auto [volume, notes] =
        read_raw(dir, ball_in(random.normal(100, 5), random.normal(900, 100)));
    // The quantile of whole numbers moves the deviation by one.
    EXPECT_NEAR(volume.background, 120, 6);
    EXPECT_EQ(notes.size(), 1u);
    // All but 1 of 31,000 values of the noise, which is 84 % of the voxels.
    EXPECT_NEAR(double(active_voxels(volume)) / std::pow(kEdge, 3), 0.16, 0.02);
    // The magnitude of complex noise, as of magnetic resonance.
    const auto magnitude = [&] {
        std::normal_distribution<> part(0, 20);
        return std::hypot(part(random.generator), part(random.generator));
    };
    // The mode is 20; 2.94 times that is exceeded by 1.3 % of the noise.
    EXPECT_NEAR(read_raw(dir, ball_in(magnitude, constant(600))).volume.background, 59, 10);
}

TEST(scan_background, is_0_where_no_noise_is_sure) {
    const TempDir dir;
    Draws random;
    std::uniform_real_distribution<> uniform(0, 1);
    const auto even = [&] { return uniform(random.generator); };
    const auto log_normal = [&] {
        return std::exp(std::normal_distribution<>(0, 0.5)(random.generator));
    };
    const auto long_tail = [&] {
        return std::exp(std::normal_distribution<>(0, 2)(random.generator));
    };
    for (const std::vector<float>& values :
         {ball_in(constant(0), random.normal(900, 100)), ball_in(even, even),
          ball_in(log_normal, log_normal), ball_in(long_tail, long_tail),
          ball_in(constant(5), constant(9)),
          ball_in([&] { return std::abs(random.normal(0, 5)()); }, constant(900))}) {
        const auto [volume, notes] = read_raw(dir, values);
        EXPECT_EQ(volume.background, 0);
        EXPECT_TRUE(notes.empty());
    }
}

TEST(scan_background, a_stated_one_counts_and_is_not_reported) {
    const TempDir dir;
    Draws random;
    const std::vector<float> values = ball_in(random.normal(100, 5), constant(900));
    for (const double stated : {0.0, 250.0}) {
        VdbOptions options;
        options.values.background = stated;
        const auto [volume, notes] = read_raw(dir, values, "", options);
        EXPECT_EQ(volume.background, stated);
        EXPECT_EQ(measure_field(volume).upper, 900);
        EXPECT_TRUE(notes.empty());
    }
    const auto clipped = read_raw(dir, ball_in(random.normal(-1000, 5), constant(40)), "",
                                  {.values = {.clip_negative = true}});
    EXPECT_EQ(clipped.volume.background, 0);
    EXPECT_EQ(measure_field(clipped.volume).upper, 40);
    // As a measure of volume and as a field values are those of the file.
    EXPECT_EQ(read_raw(dir, values, "", {.ones = true}).volume.background, 0);
}

namespace {

/// The head as raw values plus a shift, read.
Volume shifted_head(const TempDir& dir, double shift) {
    constexpr int kSize = 64;
    const Volume head = sample_head({.size = kSize});
    const IndexBox box = active_box(head);
    std::vector<float> dense(kSize * kSize * kSize), values;
    copy_dense(head, box.lower, {kSize, kSize, kSize}, dense);
    for (int z = 0; z < kSize; ++z)
        for (int y = 0; y < kSize; ++y)
            for (int x = 0; x < kSize; ++x)
                values.push_back(static_cast<float>(
                    std::round(dense[std::size_t((x * kSize + y) * kSize + z)]) + shift));
    return read_raw(dir, values, "", {}, kSize).volume;
}

Gaussians model_of(const Volume& volume) {
    return convert_moments(volume, {.budget = 1500, .own_field = volume.name});
}

/// Picture of a scene, with values of its transfer function and range moved by a shift.
Picture drawn(const Scene& scene, Show show, double shift) {
    PictureRequest request;
    request.show = show, request.field = "value", request.width = request.height = 96;
    if (show == Show::volume)
        request.transfer.window.emplace(1040 + shift, 400);
    else
        request.transfer.range.emplace(500 + shift, 1500 + shift);
    return render(scene, request);
}

}  // namespace

TEST(scan_background, signed_scans_have_the_models_and_pictures_of_shifted_ones) {
    const TempDir dir;
    const Volume plain = shifted_head(dir, 0), hounsfield = shifted_head(dir, -1000);
    EXPECT_EQ(plain.background, 0);
    ASSERT_EQ(hounsfield.background, -1000);
    const Gaussians a = model_of(plain), b = model_of(hounsfield);
    EXPECT_EQ(a.mean, b.mean);
    EXPECT_EQ(a.scale, b.scale);
    EXPECT_EQ(a.rotation, b.rotation);
    EXPECT_EQ(a.density, b.density);
    const ScalarField &of_a = a.fields.scalar.at(0), &of_b = b.fields.scalar.at(0);
    EXPECT_EQ(of_b.background, -1000);
    EXPECT_EQ(of_b.upper, of_a.upper - 1000);
    ASSERT_EQ(of_a.value.size(), of_b.value.size());
    // Values near 2000 and 1000 are rounded to floats.
    for (std::size_t i = 0; i < of_a.value.size(); ++i) {
        ASSERT_NEAR(of_a.value[i] - 1000, of_b.value[i], 3e-4);
        // Planes are limited to the range of these values.
        const Vec3f difference = of_a.gradient[i] - of_b.gradient[i];
        ASSERT_LE(length(difference), 1e-4 * (1 + length(of_a.gradient[i]))) << i;
        ASSERT_NEAR(of_a.deviation[i], of_b.deviation[i], 1e-4 * (1 + of_a.deviation[i])) << i;
    }
    for (const Show show : {Show::volume, Show::maximum, Show::mean}) {
        const auto expect_same = [&](const Scene& one, const Scene& other) {
            const Picture expected = drawn(one, show, 0), found = drawn(other, show, -1000);
            EXPECT_GE(compare(expected.image, found.image).psnr_db, 70) << word_of(show);
        };
        expect_same(scene_of(plain), scene_of(hounsfield));
        expect_same(scene_of(a), scene_of(b));
    }
}

}  // namespace vog::test
