// cuda_model.cpp: Packs a model for the GPU: scene units and the kernel's polynomial.
#include "render/gpu/cuda_model.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>

#include "render/trace/splat_kernel.h"
#include "vog/error.h"

namespace vog::gpu {

CudaModel cuda_model(const Gaussians& gaussians, double kappa) {
    validate(gaussians);
    if (gaussians.size() >= std::numeric_limits<std::int32_t>::max())
        throw Error(fmt::format("cuda: {} Gaussians, expected fewer than 2^31", gaussians.size()));
    CudaModel model;
    model.origin = gaussians.origin;
    model.kernel = trace::splat_kernel(cutoff_of_kappa(kappa, gaussians.cutoff));

    Box bounds;
    for (std::size_t i = 0; i < gaussians.size(); ++i) bounds.include(support_box(gaussians, i));
    const double radius = bounds.empty() ? 0 : bounds.radius();
    if (radius > 0) model.unit = std::ldexp(1.0, std::ilogb(radius) + 1);
    const auto in_scene = [&](Vec3f v) {
        const Vec3d scaled = (1 / model.unit) * vec_cast<double>(v);
        return device::to_float({scaled.x, scaled.y, scaled.z});
    };
    model.gaussians.resize(gaussians.size());
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
        device::SplatGaussian& g = model.gaussians[i];
        const Quat q = gaussians.axis_aligned() ? Quat{} : gaussians.rotation[i];
        g.mean = in_scene(gaussians.mean[i]);
        g.scale = in_scene(gaussians.scale[i]);
        g.rotation[0] = q.w, g.rotation[1] = q.x, g.rotation[2] = q.y, g.rotation[3] = q.z;
        g.density = static_cast<float>(double{gaussians.density[i]} * model.unit);
    }
    return model;
}

}  // namespace vog::gpu
