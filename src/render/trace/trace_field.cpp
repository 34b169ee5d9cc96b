// trace_field.cpp: Planes of a shown field in scene units.
#include "render/trace/trace_field.h"

#include "core/parallel.h"

namespace vog::trace {

namespace {

device::Float3 times(double s, device::Float3 v) {
    return device::to_float(s * device::to_double(v));
}

}  // namespace

TraceField trace_field(const ShownField& shown, std::size_t size, double scene_unit) {
    TraceField field;
    if (shown.along_rays)
        field.vector.resize(size);
    else
        field.scalar.resize(size);
    vog::parallel_for(std::size_t{0}, size, [&](std::size_t i) {
        if (shown.along_rays) {
            device::VectorPlane plane = shown.vector_plane(i);
            for (device::Float3& g : plane.gradient) g = times(scene_unit, g);
            field.vector[i] = plane;
        } else {
            const device::FieldPlane plane = shown.plane(i);
            field.scalar[i] = {static_cast<float>(plane.value),
                               device::to_float(scene_unit * plane.gradient),
                               static_cast<float>(plane.variance)};
        }
    });
    return field;
}

}  // namespace vog::trace
