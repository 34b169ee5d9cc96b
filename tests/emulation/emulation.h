// emulation.h: A GPU in host memory, for tests of the GPU renderers on machines without one. The program text of
// src/render/gpu is compiled as C++ against the headers of this folder in place of CUDA's and OptiX's:
//   cuda/    the CUDA runtime, kernels, CUB's two algorithms
//   device/  OptiX as its programs see it
// What a GPU leaves undefined is made harmful here: new memory holds 0xff bytes, freed memory 0xee, threads run in
// scrambled order, hierarchies call intersections in scrambled order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace vog::emulation {

/// Bytes of GPU memory; allocations beyond fail as CUDA's do. 8 GiB unless set.
void set_memory(std::size_t bytes);
std::size_t memory();
/// Bytes allocated and not freed.
std::size_t allocated();

/// How hierarchies are traversed; all three are within what OptiX promises.
enum class Traversal {
    plain,   ///< boxes that the ray meets up to its end, the end included
    strict,  ///< boxes that the ray meets before its end, the end excluded: ties are culled
    noisy,   ///< as plain, with calls for boxes that the ray misses, and several calls for one box
};
/// By the environment variable VOG_EMULATED_TRAVERSAL (plain, strict, noisy) unless set.
void set_traversal(Traversal traversal);
Traversal traversal();

/// Most primitives of a hierarchy, 2^29 unless set.
void set_most_primitives(std::size_t count);
std::size_t most_primitives();

/// The CUDA version that the driver is for, as cudaDriverGetVersion has it; 0: no driver. 13000 unless set.
void set_driver_version(int version);
int driver_version();

/// Whether the GPU draws OpenGL contexts of EGL, and whether buffers of theirs can be registered; true unless set.
void set_draws_gl(bool draws);
bool draws_gl();
void set_registers_gl(bool registers);
bool registers_gl();

/// True in builds with OptiX's headers: the host's calls go through OptiX's function table.
bool has_function_table();
/// Contexts and modules made so far, through the function table.
int contexts_made();
int modules_made();
void count_context();
void count_module();

/// Ends the process with one line: a use of the interface that a driver would refuse, or leaves undefined.
[[noreturn]] void refuse(const std::string& what);
/// Whether it throws std::runtime_error instead.
void set_refusals_throw(bool throws);

}  // namespace vog::emulation
