// joint_sums.cpp: the loops over runs of samples.
#include "convert/fields/joint_sums.h"

#include <algorithm>

#include "convert/moments/cells/morton_nodes.h"
#include "core/parallel.h"

namespace vog::joint {

using moments::BrickFloats;
using moments::kRun;
using moments::RunKernel;

namespace {

/// Offset of a run's first sample in a leaf, and its position from the mean.
struct Run {
    int offset;
    float x, y;  ///< of the first of its two rows
};

/// Calls take(run, values) for the runs of a kernel, in their order.
template <class Take>
void for_each_run(const RunKernel& k, const float* values, const Take& take) {
    const float* from = values + static_cast<std::size_t>(kRun) * k.first_run;
    for (int pair = k.y0; pair <= k.y1; ++pair)
        for (int x = k.x0; x <= k.x1; ++x, from += kRun)
            take(Run{(x << 6) + kRun * pair, k.dx + k.step * static_cast<float>(x),
                     k.dy + k.step * static_cast<float>(2 * pair)},
                 from);
}

/// Places of a run's 16 samples along y and z, from those of the first.
struct LanePlaces {
    alignas(64) float y[kRun], z[kRun];
    explicit LanePlaces(const RunKernel& k) {
        for (int n = 0; n < kRun; ++n) {
            y[n] = n < kLeafEdge ? 0 : k.step;
            z[n] = k.dz + k.step * static_cast<float>(n % kLeafEdge);
        }
    }
};

/// Sums of 16 lanes, in a fixed order.
double sum_of(const float* lanes) {
    double sum = 0;
    for (int n = 0; n < kRun; ++n) sum += double{lanes[n]};
    return sum;
}

void add_scalar_residuals(const RunKernel& k, const float* values, const float* weight,
                          const float* phi, const Plane& plane, double* to) {
    const LanePlaces places(k);
    alignas(64) float in_rows[kRun], square[kRun] = {}, cube[kRun] = {};
    for (int n = 0; n < kRun; ++n)
        in_rows[n] = plane.gradient.y * places.y[n] + plane.gradient.z * places.z[n];
    for_each_run(k, values, [&](Run run, const float* from) {
        const float base = plane.value + plane.gradient.x * run.x + plane.gradient.y * run.y;
        const float *shared = weight + run.offset, *value = phi + run.offset;
        for (int n = 0; n < kRun; ++n) {
            const float z = value[n] - base - in_rows[n];
            const float part = from[n] * shared[n] * z * z;
            square[n] += part;
            cube[n] += part * z;
        }
    });
    to[0] += sum_of(square);
    to[1] += sum_of(cube);
}

void add_vector_residuals(const RunKernel& k, const float* values, const float* weight,
                          const BrickValues* phi, const Plane* plane, double* to) {
    const LanePlaces places(k);
    alignas(64) float in_rows[3][kRun], sums[kVectorSums][kRun] = {};
    for (int c = 0; c < 3; ++c)
        for (int n = 0; n < kRun; ++n)
            in_rows[c][n] = plane[c].gradient.y * places.y[n] + plane[c].gradient.z * places.z[n];
    for_each_run(k, values, [&](Run run, const float* from) {
        float base[3];
        for (int c = 0; c < 3; ++c)
            base[c] = plane[c].value + plane[c].gradient.x * run.x + plane[c].gradient.y * run.y;
        for (int n = 0; n < kRun; ++n) {
            const auto at = static_cast<std::size_t>(run.offset + n);
            const float share = from[n] * weight[at];
            const float x = phi[0].of[at] - base[0] - in_rows[0][n];
            const float y = phi[1].of[at] - base[1] - in_rows[1][n];
            const float z = phi[2].of[at] - base[2] - in_rows[2][n];
            sums[0][n] += share * x * x, sums[1][n] += share * x * y, sums[2][n] += share * x * z;
            sums[3][n] += share * y * y, sums[4][n] += share * y * z, sums[5][n] += share * z * z;
        }
    });
    for (std::size_t s = 0; s < kVectorSums; ++s) to[s] += sum_of(sums[s]);
}

/// Residual of a sample from a plane.
double residual(const BrickValues& phi, int sample, const Plane& plane, Vec3d from_mean) {
    return double{phi.of[static_cast<std::size_t>(sample)]} - double{plane.value} -
           dot(vec_cast<double>(plane.gradient), from_mean);
}

}  // namespace

std::vector<FieldBrick> field_bricks(const Volume& volume) {
    std::vector<FieldBrick> bricks;
    for (const moments::MortonNode& node : moments::morton_nodes(volume)) {
        check_interrupt();
        FieldBrick one{{node.origin, 1, nullptr, 0}, node.index};
        if (node.tile) {
            one.brick.value = volume.tiles[node.index].value;
            one.brick.spacing = static_cast<double>(node.edge) / kLeafEdge;
            if (one.brick.value <= 0) continue;
        } else {
            one.brick.leaf = &volume.leaves[node.index];
            if (std::ranges::none_of(one.brick.leaf->value, [](float value) { return value > 0; }))
                continue;
        }
        bricks.push_back(one);
    }
    return bricks;
}

void BrickValues::load(const Component& component, const FieldBrick& brick) {
    const VoxelValues& values = *component.values;
    const bool own = values.leaf.empty() && values.tile.empty();
    const float reference = component.reference, per_unit = 1 / component.unit;
    if (brick.brick.leaf) {
        const float* from = own ? brick.brick.leaf->value.data() : values.leaf[brick.node].data();
        for (std::size_t n = 0; n < kLeafVoxels; ++n) of[n] = per_unit * (from[n] - reference);
    } else {
        of.fill(per_unit * ((own ? brick.brick.value : values.tile[brick.node]) - reference));
    }
}

double DividedBrick::mass(int sample) const {
    return double{brick->brick.sample(sample)} * brick->brick.sample_volume();
}

Vec3d DividedBrick::from_mean(int sample, std::size_t n) const {
    const RunKernel& run = scratch->runs[n];
    const double step = brick->brick.spacing;
    return Vec3d{double{run.dx}, double{run.dy}, double{run.dz}} +
           step * Vec3d{double(sample >> 6), double(sample >> 3 & 7), double(sample & 7)};
}

void add_joint_sums(const DividedBrick& divided, std::span<const Component> components,
                    std::span<double> parts) {
    moments::BrickScratch& scratch = *divided.scratch;
    const std::size_t kernels = scratch.runs.size();
    const std::size_t width = kPositionSums + kValueSums * components.size();
    const double spacing = divided.brick->brick.spacing;
    const double box = moments::kBoxVariance * spacing * spacing;
    std::vector<moments::MomentSums> sums(kernels);
    moments::add_responsibilities(scratch.runs, scratch.values.get(), scratch.sum, sums);
    for (const auto [sample, kernel] : divided.uncovered)
        moments::add_shifted(sums[kernel], {divided.mass(sample), {}, {}},
                             divided.from_mean(sample, kernel));
    for (std::size_t n = 0; n < kernels; ++n) {
        double* to = &parts[width * n];
        const moments::MomentSums& s = sums[n];
        to[0] = s.mass, to[1] = s.first.x, to[2] = s.first.y, to[3] = s.first.z;
        for (std::size_t m = 0; m < 6; ++m) to[4 + m] = s.second[m];
        for (const std::size_t m : {0, 3, 5}) to[4 + m] += box * s.mass;
    }
    BrickValues phi;
    alignas(64) BrickFloats weighted;
    for (std::size_t c = 0; c < components.size(); ++c) {
        phi.load(components[c], *divided.brick);
        for (std::size_t n = 0; n < kLeafVoxels; ++n) weighted[n] = scratch.sum[n] * phi.of[n];
        std::ranges::fill(sums, moments::MomentSums{});
        moments::add_responsibilities(scratch.runs, scratch.values.get(), weighted, sums);
        for (const auto [sample, kernel] : divided.uncovered)
            moments::add_shifted(
                sums[kernel],
                {divided.mass(sample) * double{phi.of[static_cast<std::size_t>(sample)]}, {}, {}},
                divided.from_mean(sample, kernel));
        for (std::size_t n = 0; n < kernels; ++n) {
            double* to = &parts[width * n + kPositionSums + kValueSums * c];
            to[0] = sums[n].mass;
            to[1] = sums[n].first.x, to[2] = sums[n].first.y, to[3] = sums[n].first.z;
        }
    }
}

void add_residual_sums(const DividedBrick& divided, std::span<const Component> components,
                       std::span<const Plane> planes, std::size_t width, std::size_t first,
                       std::span<double> parts) {
    const moments::BrickScratch& scratch = *divided.scratch;
    const std::size_t count = components.size();
    std::array<BrickValues, 3> phi;
    for (std::size_t c = 0; c < count; ++c) phi[c].load(components[c], *divided.brick);
    for (std::size_t n = 0; n < scratch.runs.size(); ++n) {
        const RunKernel& run = scratch.runs[n];
        if (run.run_count() == 0) continue;
        double* to = &parts[width * n + first];
        if (count == 1)
            add_scalar_residuals(run, scratch.values.get(), scratch.sum.data(), phi[0].of.data(),
                                 planes[n], to);
        else
            add_vector_residuals(run, scratch.values.get(), scratch.sum.data(), phi.data(),
                                 &planes[3 * n], to);
    }
    for (const auto [sample, kernel] : divided.uncovered) {
        const Vec3d at = divided.from_mean(sample, kernel);
        const double m = divided.mass(sample);
        double* to = &parts[width * kernel + first];
        double z[3] = {};
        for (std::size_t c = 0; c < count; ++c)
            z[c] = residual(phi[c], sample, planes[count * kernel + c], at);
        if (count == 1) {
            to[0] += m * z[0] * z[0], to[1] += m * z[0] * z[0] * z[0];
            continue;
        }
        std::size_t s = 0;
        for (std::size_t row = 0; row < 3; ++row)
            for (std::size_t column = row; column < 3; ++column) to[s++] += m * z[row] * z[column];
    }
}

}  // namespace vog::joint
