// gl_sums.cpp: CUDA's side of OpenGL buffers.
#include <fmt/core.h>

#include <GL/gl.h>  // before CUDA's header, which asks for it

#include <cuda_gl_interop.h>

#include "render/gpu/sums/gpu_sums.h"
#include "render/gpu/sums/sums_memory.h"
#include "vog/error.h"

namespace vog {

using namespace gpu;

bool GlSumsBuffer::possible() {
    int device = 0;
    unsigned count = 0;
    constexpr unsigned kMost = 16;
    int devices[kMost] = {};
    // Without a driver, a GPU or a context of this vendor each of these is an error, which is an answer here.
    const bool known = cudaGetDevice(&device) == cudaSuccess &&
                       cudaGLGetDevices(&count, devices, kMost, cudaGLDeviceListAll) == cudaSuccess;
    cudaGetLastError();
    for (unsigned n = 0; known && n < count && n < kMost; ++n)
        if (devices[n] == device) return true;
    return false;
}

struct GlSumsBuffer::State {
    cudaGraphicsResource_t resource = nullptr;
    cudaStream_t stream = nullptr;  ///< not that of the renderers: no wait for their next picture
    bool mapped = false;

    State() = default;
    State(const State&) = delete;
    State& operator=(const State&) = delete;
    ~State() {
        if (mapped) cudaGraphicsUnmapResources(1, &resource, stream);
        if (resource) cudaGraphicsUnregisterResource(resource);
        if (stream) cudaStreamDestroy(stream);
    }
};

GlSumsBuffer::GlSumsBuffer(unsigned buffer) : state_(std::make_unique<State>()) {
    if (!possible()) throw Error("cuda: another device draws the window");
    check_cuda(cudaStreamCreateWithFlags(&state_->stream, cudaStreamNonBlocking),
               "making a stream");
    check_cuda(cudaGraphicsGLRegisterBuffer(&state_->resource, buffer,
                                            cudaGraphicsRegisterFlagsWriteDiscard),
               "registering a buffer of OpenGL");
}

GlSumsBuffer::~GlSumsBuffer() = default;
GlSumsBuffer::GlSumsBuffer(GlSumsBuffer&&) noexcept = default;
GlSumsBuffer& GlSumsBuffer::operator=(GlSumsBuffer&&) noexcept = default;

void GlSumsBuffer::copy(const GpuSums& sums) {
    State& s = *state_;
    const GpuSums::State& from = sums.state();
    const std::size_t bytes = from.floats() * sizeof(float);
    // Mapping waits for OpenGL's reads of the buffer, unmapping lets OpenGL wait for the stream.
    check_cuda(cudaGraphicsMapResources(1, &s.resource, s.stream), "mapping a buffer of OpenGL");
    s.mapped = true;
    void* to = nullptr;
    std::size_t room = 0;
    check_cuda(cudaGraphicsResourceGetMappedPointer(&to, &room, s.resource),
               "mapping a buffer of OpenGL");
    if (room < bytes)
        throw Error(fmt::format("cuda: a buffer of OpenGL of {} bytes, expected {}", room, bytes));
    check_cuda(cudaMemcpyAsync(to, from.value.data(), bytes, cudaMemcpyDeviceToDevice, s.stream),
               "copying to OpenGL");
    s.mapped = false;
    check_cuda(cudaGraphicsUnmapResources(1, &s.resource, s.stream),
               "unmapping a buffer of OpenGL");
    // The sums' memory is the renderer's again.
    check_cuda(cudaStreamSynchronize(s.stream), "copying to OpenGL");
}

}  // namespace vog
