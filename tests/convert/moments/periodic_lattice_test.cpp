// periodic_lattice_test.cpp: models of periodic meshes know no faces: voxels moved round by half a box make the model moved
// likewise, and the mass is kept.
#include "convert/moments/periodic_lattice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "render/splat/splat.h"
#include "vog/convert_fields.h"
#include "vog/convert_moments.h"
#include "vog/periodic.h"

namespace vog {

using namespace moments;

namespace {

constexpr int kEdge = 32;        ///< voxels along an edge of the box
constexpr double kVoxel = 0.25;  ///< world units
const Affine kMap{{{Vec3d{kVoxel, 0, 0}, {0, kVoxel, 0}, {0, 0, kVoxel}}},
                  {0.5 * kVoxel, 0.5 * kVoxel, 0.5 * kVoxel}};
const Box kBox{{}, {kEdge * kVoxel, kEdge* kVoxel, kEdge* kVoxel}};

/// A clump in a corner, of which every face cuts a part, above a wave and moved round by `shift` voxels along each axis.
Volume clump(int shift) {
    std::vector<float> value;
    for (int n = 0; n < kEdge * kEdge * kEdge; ++n) {
        double r2 = 0, wave = 1;
        for (int at : {n / (kEdge * kEdge), n / kEdge % kEdge, n % kEdge}) {
            const int own = (at + kEdge - shift) % kEdge;
            const double d = own < kEdge / 2 ? own + 0.5 : own + 0.5 - kEdge;
            r2 += d * d;
            wave *= 1 + 0.5 * std::sin(2 * std::numbers::pi * own / kEdge);
        }
        value.push_back(static_cast<float>(20 * std::exp(-r2 / 30) + 0.2 * wave));
    }
    const DenseBlock block{value.data(), {kEdge, kEdge, kEdge}, {kEdge * kEdge, kEdge, 1}, {}};
    return volume_from_dense({&block, 1}, kMap);
}

constexpr std::size_t kPixels = std::size_t{kEdge} * kEdge;

/// Mean T of the inside of the box along z for each column of voxels, by rays in the quarters of its edges.
std::vector<double> columns_of(Gaussians model) {
    if (!periodic_box(model)) add_periodic_images(model, kBox);
    constexpr int kRays = 4;
    const Vec3d middle = 0.5 * (kBox.lower + kBox.upper);
    Camera camera{middle + Vec3d{0, 0, 100}, middle, {0, 1, 0}};
    camera.orthographic_width = kEdge * kVoxel;
    SplatRenderer renderer(model);
    renderer.set_clip(inside_period({}, model));
    const DepthImage image = renderer.render(camera, kRays * kEdge, kRays * kEdge);
    std::vector<double> columns(kPixels);
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            columns[static_cast<std::size_t>(y / kRays * kEdge + x / kRays)] +=
                double{image.at(x, y)} / (kRays * kRays);
    return columns;
}
/// The same of the voxels.
std::vector<double> columns_of(const Volume& volume) {
    std::vector<float> value(kPixels * kEdge);
    copy_dense(volume, {0, 0, 0}, {kEdge, kEdge, kEdge}, value);
    std::vector<double> columns(kPixels);
    for (std::size_t n = 0; n < value.size(); ++n) {
        const std::size_t x = n / kPixels, y = n / kEdge % kEdge;
        columns[(kEdge - 1 - y) * kEdge + x] += kVoxel * double{value[n]};
    }
    return columns;
}

/// Relative L2 of columns that are moved round by `shift` pixels.
double distance_of(const std::vector<double>& moved, const std::vector<double>& still,
                   std::size_t shift) {
    double square = 0, norm = 0;
    for (std::size_t n = 0; n < kPixels; ++n) {
        const std::size_t x = (n + shift) % kEdge, y = (n / kEdge + shift) % kEdge;
        const double d = moved[kEdge * y + x] - still[n];
        square += d * d, norm += still[n] * still[n];
    }
    return std::sqrt(square / norm);
}

TEST(periodic_lattice, boxes_of_whole_leaves_have_indices) {
    const auto box = leaf_period(kBox, kMap);
    ASSERT_TRUE(box);
    EXPECT_EQ(box->lower, (Vec3i{0, 0, 0}));
    EXPECT_EQ(box->upper, (Vec3i{kEdge - 1, kEdge - 1, kEdge - 1}));
    EXPECT_FALSE(leaf_period({}, kMap));
    Box other = kBox;
    other.upper.y -= kVoxel;
    EXPECT_FALSE(leaf_period(other, kMap)) << "31 voxels";
    Affine sheared = kMap;
    sheared.linear(0, 1) = 0.1;
    EXPECT_FALSE(leaf_period(kBox, sheared));
    EXPECT_TRUE(image_shifts({}, kMap).empty());
    const std::vector<Vec3d> shifts = image_shifts(kBox, kMap);
    ASSERT_EQ(shifts.size(), 26u);
    EXPECT_NEAR(length(shifts.back()), std::sqrt(3.0) * kEdge, 1e-9);
}

struct Cut {
    const char* name;
    int block = 0;
    std::size_t budget = 0;
    int soft_steps = -1;
    double error = 0;
    bool is_exact = false;  ///< whether a moved volume gives the moved model, but for rounding
};
std::ostream& operator<<(std::ostream& out, const Cut& cut) { return out << cut.name; }

class periodic_meshes : public testing::TestWithParam<Cut> {
  protected:
    static Gaussians model(const Volume& volume, bool periodic) {
        MomentOptions options;
        options.block_voxels = GetParam().block, options.budget = GetParam().budget;
        options.soft_steps = GetParam().soft_steps, options.error = GetParam().error;
        options.mass_threshold = 0;
        if (periodic) options.periodic = kBox;
        MomentReport report;
        Gaussians made = convert_moments(volume, options, &report);
        EXPECT_NEAR(report.mass_ratio, 1, 1e-6);
        return made;
    }
};

/// The model of voxels moved round by half a box draws the picture moved likewise: octrees and windows are the same, soft
/// steps and cuts differ by less than the model from the voxels.
TEST_P(periodic_meshes, know_no_faces) {
    const Volume still = clump(0), moved = clump(kEdge / 2);
    Gaussians one = model(still, true);
    const std::vector<double> columns = columns_of(one);
    const double error = distance_of(columns, columns_of(still), 0);
    const double rolled = distance_of(columns_of(model(moved, true)), columns, kEdge / 2);
    EXPECT_LT(rolled, GetParam().soft_steps == 0 || GetParam().is_exact ? 1e-5 : error);
    add_periodic_images(one, kBox);
    EXPECT_NEAR(mass_without_images(one) / mass(still), 1, 1e-6);
    if (GetParam().soft_steps == 0 || GetParam().error > 0) return;
    const std::vector<double> open = columns_of(model(still, false));
    EXPECT_GT(distance_of(open, columns_of(still), 0), 1.5 * error) << "faces show";
}

INSTANTIATE_TEST_SUITE_P(cuts, periodic_meshes,
                         testing::Values(Cut{"hard", 4, 0, 0}, Cut{"voxels", 1, 0, -1, 0, true},
                                         Cut{"windows", 2, 0, -1, 0, true},
                                         Cut{"windows_and_steps", 4}, Cut{"large_cells", 16},
                                         Cut{"budget", 0, 600}, Cut{"error", 0, 0, -1, 0.08}),
                         [](const auto& made) { return made.param.name; });

/// The field is a wave that goes on through the faces.
TEST(periodic_fields, are_alike_at_faces_and_inside) {
    for (const int block : {0, 4}) {
        std::array<double, 2> mean{};
        for (const int shift : {0, kEdge / 2}) {
            const Volume volume = clump(shift);
            MomentOptions moments;
            moments.block_voxels = block, moments.budget = block ? 0 : 600;
            moments.periodic = kBox;
            const std::vector<std::vector<VoxelField>> fields{{measure_field(volume, "own")}};
            const Gaussians model = convert_for_field(volume, fields, moments, {.periodic = kBox});
            double sum = 0;
            for (std::size_t i = 0; i < model.size(); ++i)
                sum += mass(model, i) * double{model.fields.scalar.at(0).value[i]};
            mean[shift ? 1 : 0] = sum / mass(model);
        }
        EXPECT_NEAR(mean[0] / mean[1], 1, 2e-3) << block;
    }
}

}  // namespace
}  // namespace vog
