// trace_options.h: what every ray tracer checks of its options.
#pragma once

#include "vog/trace.h"

namespace vog::trace {

/// throws vog::Error for options out of range, or that exclude each other
void check_trace_options(const TraceOptions& options);
/// T at extinction 1 at which a ray ends; infinite: never.
double stop_depth(const TraceOptions& options);

}  // namespace vog::trace
