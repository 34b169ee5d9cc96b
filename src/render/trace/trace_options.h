// trace_options.h: Checks of TraceOptions for the ray tracers on CPU and GPU.
#pragma once

#include "render/trace/trace.h"

namespace vog::trace {

/// throws vog::Error for options out of range, or that exclude each other
void check_trace_options(const TraceOptions& options);
/// Optical depth at extinction 1 at which a ray ends; infinite: never.
double stop_depth(const TraceOptions& options);

}  // namespace vog::trace
