// trace_options.cpp: Checks of TraceOptions, and the depth at which rays end.
#include "render/trace/trace_options.h"

#include <fmt/core.h>

#include <cmath>
#include <limits>

#include "render/device/any_hit.h"
#include "vog/error.h"
#include "vog/renderer.h"

namespace vog::trace {

void check_trace_options(const TraceOptions& options) {
    if (options.hits_per_slab < 1 || options.hits_per_slab > device::kMaxHitsPerSlab)
        throw Error(fmt::format("trace: {} hits a slab, expected 1 to {}", options.hits_per_slab,
                                device::kMaxHitsPerSlab));
    if (!(options.stop_transmittance >= 0 && options.stop_transmittance < 1))
        throw Error(fmt::format("trace: stop transmittance {}, expected in [0, 1)",
                                options.stop_transmittance));
    if (options.stop_transmittance > 0 && options.anyhit != AnyHit::collect)
        throw Error(
            "trace: a stop transmittance with any-hit accumulate, expected collect: rays end in "
            "the order of hits");
    if (!(options.extinction > 0 && std::isfinite(options.extinction)))
        throw Error(
            fmt::format("trace: extinction {}, expected a finite number > 0", options.extinction));
}

double stop_depth(const TraceOptions& options) {
    return options.stop_transmittance > 0
               ? -std::log(options.stop_transmittance) / options.extinction
               : std::numeric_limits<double>::infinity();
}

}  // namespace vog::trace
