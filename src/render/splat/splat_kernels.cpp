// splat_kernels.cpp: Compiles the splat's loops for every SIMD target and chooses among them.
// foreach_target.h includes this file once per target: code outside HWY_NAMESPACE is guarded.
#include "render/splat/splat_kernels.h"

#include "render/splat/near/near_splats.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hwy/cache_control.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>

#include "render/device/pixel_limits.h"
#include "render/splat/splat.h"
#include "vog/error.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "render/splat/splat_kernels.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace vog::splat {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

#include "render/splat/splat_project-inl.h"
#include "render/splat/splat_rows-inl.h"

#include "render/splat/near/splat_near-inl.h"

const SplatKernels& wide_kernels() {
    static const SplatKernels kernels{HWY_TARGET, project<WideLanes>, add_far<WideLanes>,
                                      add_near<WideLanes>, finish_tile<WideLanes>};
    return kernels;
}

const SplatKernels& one_lane_kernels() {
    static const SplatKernels kernels{0, project<OneLane>, add_far<OneLane>, add_near<OneLane>,
                                      finish_tile<OneLane>};
    return kernels;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vog::splat
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace vog::splat {

namespace {

HWY_EXPORT(wide_kernels);
HWY_EXPORT(one_lane_kernels);

/// The kernels of every target this machine can run, best first, and the one-lane ones last.
std::vector<const SplatKernels*> runnable_kernels() {
    std::vector<const SplatKernels*> all;
    const std::int64_t supported = hwy::SupportedTargets();
    for (const auto entry : HWY_DISPATCH_TABLE(wide_kernels)) {
        if (entry == nullptr || entry == HWY_DISPATCH_TABLE(wide_kernels)[0]) continue;
        const SplatKernels* kernels = &entry();
        if (kernels->target == HWY_SCALAR) continue;  // the same as one lane
        if ((kernels->target & supported) &&
            std::find(all.begin(), all.end(), kernels) == all.end())
            all.push_back(kernels);
    }
    all.push_back(&HWY_STATIC_DISPATCH(one_lane_kernels)());
    return all;
}

std::string name_of(const SplatKernels& kernels) {
    return kernels.target == 0 ? "scalar" : hwy::TargetName(kernels.target);
}

/// Names of the runnable targets, best first.
std::vector<std::string> target_names() {
    std::vector<std::string> names;
    for (const SplatKernels* kernels : runnable_kernels()) names.push_back(name_of(*kernels));
    return names;
}

}  // namespace

const SplatKernels& best_splat_kernels() {
    static const SplatKernels& best = *runnable_kernels().front();
    return best;
}

const SplatKernels& splat_kernels(const std::string& target_name) {
    for (const SplatKernels* kernels : runnable_kernels())
        if (name_of(*kernels) == target_name) return *kernels;
    throw Error(fmt::format("no SIMD target '{}' on this machine (it has: {})", target_name,
                            fmt::join(target_names(), ", ")));
}

}  // namespace vog::splat

std::vector<std::string> vog::splat_targets() { return splat::target_names(); }
#endif  // HWY_ONCE
