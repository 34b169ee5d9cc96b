// cuda_gl_interop.h: CUDA's view of OpenGL buffers, on buffers of the current context.
#pragma once

#include <cuda_runtime_api.h>

enum cudaGLDeviceList { cudaGLDeviceListAll = 1 };
enum cudaGraphicsRegisterFlags {
    cudaGraphicsRegisterFlagsNone = 0,
    cudaGraphicsRegisterFlagsReadOnly = 1,
    cudaGraphicsRegisterFlagsWriteDiscard = 2,
};
using cudaGraphicsResource_t = struct cudaGraphicsResource*;

cudaError_t cudaGLGetDevices(unsigned* count, int* devices, unsigned most, cudaGLDeviceList list);
cudaError_t cudaGraphicsGLRegisterBuffer(cudaGraphicsResource_t* resource, unsigned buffer,
                                         unsigned flags);
cudaError_t cudaGraphicsUnregisterResource(cudaGraphicsResource_t resource);
cudaError_t cudaGraphicsMapResources(int count, cudaGraphicsResource_t* resources,
                                     cudaStream_t stream = nullptr);
cudaError_t cudaGraphicsUnmapResources(int count, cudaGraphicsResource_t* resources,
                                       cudaStream_t stream = nullptr);
cudaError_t cudaGraphicsResourceGetMappedPointer(void** data, std::size_t* bytes,
                                                 cudaGraphicsResource_t resource);
