// module.cpp: The device module that optix_device.cpp hands to OptiX: a word in place of PTX, by which the function
// table knows that the programs are those of this library.
#include "emulation.h"
#include "render/gpu/optix/optix_entry_points.h"

namespace vog::gpu {

const char kOptixPrograms[] = "// emulated device module\n";
const std::size_t kOptixProgramsBytes = sizeof(kOptixPrograms);

}  // namespace vog::gpu

namespace vog::emulation {

bool has_function_table() { return true; }

}  // namespace vog::emulation
