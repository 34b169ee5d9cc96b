// splat_kernel.cpp: Copies a fitted polynomial and the limits of small Gaussians.
#include "render/trace/splat_kernel.h"

#include <algorithm>
#include <cstdint>

#include "render/kernel_polynomial.h"
#include "render/pixel_limits.h"

namespace vog::trace {

device::SplatKernel splat_kernel(double cutoff) {
    device::SplatKernel model{};
    const KernelPolynomial fitted = fit_kernel(cutoff);
    device::Kernel& kernel = model.kernel;
    kernel.degree = static_cast<std::int32_t>(fitted.coefficient.size()) - 1;
    std::copy(fitted.coefficient.begin(), fitted.coefficient.end(), kernel.coefficient);
    kernel.slope = fitted.slope;
    kernel.shift = fitted.shift;
    kernel.cutoff2 = static_cast<float>(cutoff * cutoff);
    const PixelLimits limits = pixel_limits(cutoff);
    model.cutoff = cutoff;
    model.least2 = limits.least2;
    model.sampled2 = limits.sampled2;
    model.variance = limits.variance;
    model.mass = limits.mass;
    return model;
}

}  // namespace vog::trace
