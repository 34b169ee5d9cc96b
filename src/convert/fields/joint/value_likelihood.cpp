// value_likelihood.cpp: the loop over the samples of each kernel's runs.
#include "convert/fields/joint/value_likelihood.h"

#include <algorithm>
#include <array>

namespace vog::joint {

using moments::kRun;
using moments::RunKernel;

namespace {

/// Likelihood of the values at a run's samples, up to a factor that all Gaussians share.
/// at  first sample of the run
void multiply(const RunKernel& k, int x, int pair, std::span<const BrickValues> phi,
              const ValueNormal* normals, float* values) {
    alignas(64) float square[kRun] = {};
    float scale = 1;
    const std::size_t first = static_cast<std::size_t>((x << 6) + kRun * pair);
    const float dx = k.dx + k.step * static_cast<float>(x);
    for (std::size_t c = 0; c < phi.size(); ++c) {
        const auto& [plane, per_deviation] = normals[c];
        scale *= per_deviation;
        const float base = plane.value + plane.gradient.x * dx;
        const float* value = phi[c].of.data() + first;
        for (int n = 0; n < kRun; ++n) {
            const float dy = k.dy + k.step * static_cast<float>(2 * pair + n / kLeafEdge);
            const float dz = k.dz + k.step * static_cast<float>(n % kLeafEdge);
            const float z =
                per_deviation * (value[n] - base - plane.gradient.y * dy - plane.gradient.z * dz);
            square[n] += z * z;
        }
    }
    for (int n = 0; n < kRun; ++n) {
        // exp(-z^2 / 2) as in the E step, a Taylor polynomial to the 16th power, constant from 5.7 deviations on at
        // 1.5e-5: a voxel that no Gaussian expects belongs to those near it.
        const float u = std::min(1.0f, square[n] / 32);
        float t = 1 - u * (1 - 0.5f * u);
        t *= t, t *= t, t *= t, t *= t;
        values[n] *= scale * t;
    }
}

}  // namespace

void ValueLikelihood::weigh(const FieldBrick& brick, std::span<const std::uint32_t> gaussian,
                            moments::BrickScratch& scratch) const {
    std::array<BrickValues, 3> loaded;
    const std::span<BrickValues> phi(loaded.data(), components_.size());
    for (std::size_t c = 0; c < phi.size(); ++c) phi[c].load(components_[c], brick);
    scratch.sum.fill(0);
    for (std::size_t n = 0; n < scratch.runs.size(); ++n) {
        const RunKernel& k = scratch.runs[n];
        if (k.run_count() == 0) continue;
        float* values = scratch.values.get() + static_cast<std::size_t>(kRun) * k.first_run;
        for (int pair = k.y0; pair <= k.y1; ++pair)
            for (int x = k.x0; x <= k.x1; ++x, values += kRun) {
                multiply(k, x, pair, phi, &normals_[phi.size() * gaussian[n]], values);
                float* sum = scratch.sum.data() + (x << 6) + kRun * pair;
                for (int lane = 0; lane < kRun; ++lane) sum[lane] += values[lane];
            }
    }
}

}  // namespace vog::joint
