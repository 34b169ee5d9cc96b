// graphics.cpp: Buffers of OpenGL as GPU memory: mapped, a copy in GPU memory, while OpenGL's own is mapped, too, so that OpenGL
// refuses to use it; unmapped, written back. Uses that a driver would refuse, or leaves undefined, end the process.
#include <cuda_gl_interop.h>
#include <cuda_runtime.h>
#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "emulation.h"

struct cudaGraphicsResource {
    GLuint buffer;
    unsigned flags;
    EGLContext context;
    std::size_t bytes;
    std::byte *memory, *gl_memory;  ///< null unless mapped
    std::vector<std::byte> before;  ///< contents, of buffers to be read alone
};

namespace {

using vog::emulation::refuse;

/// Registered buffers. Ends the process with a failure if one is left at exit.
class Registry {
  public:
    static Registry& get() {
        static Registry registry;
        return registry;
    }
    ~Registry() {
        if (resources_.empty()) return;
        std::fputs("emulated GPU: a buffer of OpenGL that was never unregistered\n", stderr);
        std::_Exit(EXIT_FAILURE);
    }
    void add(cudaGraphicsResource_t resource) {
        const std::lock_guard lock(using_);
        for (const cudaGraphicsResource_t each : resources_)
            if (each->buffer == resource->buffer && each->context == resource->context)
                refuse("a buffer of OpenGL that is registered twice");
        resources_.insert(resource);
    }
    void remove(cudaGraphicsResource_t resource) {
        const std::lock_guard lock(using_);
        resources_.erase(resource);
    }
    /// Ends the process unless the resource is one, on its context's thread, with its buffer unchanged.
    cudaGraphicsResource& known(cudaGraphicsResource_t resource) {
        const std::lock_guard lock(using_);
        if (!resources_.contains(resource)) refuse("a resource that is not registered");
        if (eglGetCurrentContext() != resource->context)
            refuse("a buffer of OpenGL without its context");
        if (!glIsBuffer(resource->buffer)) {
            resources_.erase(resource);
            delete resource;
            refuse("a buffer of OpenGL that was deleted before it was unregistered");
        }
        return *resource;
    }

  private:
    std::mutex using_;
    std::set<cudaGraphicsResource_t> resources_;
};

std::size_t bytes_of(GLuint buffer) {
    GLint64 bytes = 0;
    glBindBuffer(GL_COPY_READ_BUFFER, buffer);
    glGetBufferParameteri64v(GL_COPY_READ_BUFFER, GL_BUFFER_SIZE, &bytes);
    return static_cast<std::size_t>(bytes);
}

void map(cudaGraphicsResource& r) {
    if (r.memory) refuse("a buffer of OpenGL that is mapped twice");
    if (bytes_of(r.buffer) != r.bytes) refuse("a registered buffer of OpenGL with other memory");
    const auto size = static_cast<GLsizeiptr>(r.bytes);
    r.memory = static_cast<std::byte*>(vog::emulation::allocate_memory(r.bytes));
    if (!r.memory) refuse("no memory for a buffer of OpenGL");
    if (r.flags != cudaGraphicsRegisterFlagsWriteDiscard)
        glGetBufferSubData(GL_COPY_READ_BUFFER, 0, size, r.memory);
    if (r.flags == cudaGraphicsRegisterFlagsReadOnly) r.before.assign(r.memory, r.memory + r.bytes);
    r.gl_memory =
        static_cast<std::byte*>(glMapBufferRange(GL_COPY_READ_BUFFER, 0, size, GL_MAP_WRITE_BIT));
    glBindBuffer(GL_COPY_READ_BUFFER, 0);
    if (!r.gl_memory) refuse("a buffer of OpenGL that OpenGL has mapped");
}

void unmap(cudaGraphicsResource& r) {
    if (!r.memory) refuse("a buffer of OpenGL that is not mapped");
    if (!r.before.empty() && std::memcmp(r.before.data(), r.memory, r.bytes) != 0)
        refuse("a buffer of OpenGL that was registered for reading is written");
    std::memcpy(r.gl_memory, r.memory, r.bytes);
    vog::emulation::release_memory(std::exchange(r.memory, nullptr));
    r.gl_memory = nullptr;
    glBindBuffer(GL_COPY_READ_BUFFER, r.buffer);
    glUnmapBuffer(GL_COPY_READ_BUFFER);
    glBindBuffer(GL_COPY_READ_BUFFER, 0);
}

}  // namespace

using vog::emulation::result;

cudaError_t cudaGLGetDevices(unsigned* count, int* devices, unsigned most, cudaGLDeviceList) {
    *count = 0;
    if (!vog::emulation::draws_gl() || eglGetCurrentContext() == EGL_NO_CONTEXT)
        return result(cudaErrorNoDevice);
    *count = 1;
    if (most > 0) devices[0] = 0;
    return cudaSuccess;
}

cudaError_t cudaGraphicsGLRegisterBuffer(cudaGraphicsResource_t* resource, unsigned buffer,
                                         unsigned flags) {
    if (!vog::emulation::registers_gl()) return result(cudaErrorMapBufferObjectFailed);
    if (flags > cudaGraphicsRegisterFlagsWriteDiscard) refuse("flags of another kind of resource");
    if (eglGetCurrentContext() == EGL_NO_CONTEXT) refuse("a buffer of OpenGL without a context");
    if (!glIsBuffer(buffer)) return result(cudaErrorInvalidValue);
    const std::size_t bytes = bytes_of(buffer);
    glBindBuffer(GL_COPY_READ_BUFFER, 0);
    if (bytes == 0) return result(cudaErrorInvalidValue);
    std::unique_ptr<cudaGraphicsResource> made(new cudaGraphicsResource{
        buffer, flags, eglGetCurrentContext(), bytes, nullptr, nullptr, {}});
    Registry::get().add(made.get());
    *resource = made.release();
    return cudaSuccess;
}

cudaError_t cudaGraphicsUnregisterResource(cudaGraphicsResource_t resource) {
    if (Registry::get().known(resource).memory) refuse("a mapped buffer of OpenGL is unregistered");
    Registry::get().remove(resource);
    delete resource;
    return cudaSuccess;
}

cudaError_t cudaGraphicsMapResources(int count, cudaGraphicsResource_t* resources, cudaStream_t) {
    for (int n = 0; n < count; ++n) map(Registry::get().known(resources[n]));
    return cudaSuccess;
}

cudaError_t cudaGraphicsUnmapResources(int count, cudaGraphicsResource_t* resources,
                                       cudaStream_t stream) {
    vog::emulation::finish_stream(stream);  // OpenGL's commands wait for it
    for (int n = 0; n < count; ++n) unmap(Registry::get().known(resources[n]));
    return cudaSuccess;
}

cudaError_t cudaGraphicsResourceGetMappedPointer(void** data, std::size_t* bytes,
                                                 cudaGraphicsResource_t resource) {
    const cudaGraphicsResource& r = Registry::get().known(resource);
    if (!r.memory) refuse("the memory of a buffer of OpenGL that is not mapped");
    *data = r.memory;
    *bytes = r.bytes;
    return cudaSuccess;
}
