// cuda_memory.cpp: Error checks, allocation and timing on the GPU.
#include "render/gpu/cuda_memory.h"

#include <fmt/core.h>

#include "vog/error.h"

namespace vog::gpu {

void check_cuda(cudaError_t code, const char* doing) {
    if (code == cudaSuccess) return;
    cudaGetLastError();  // clears the error, so that the next call does not return it again
    throw Error(fmt::format("cuda: {}: {}", doing, cudaGetErrorString(code)));
}

void require_cuda() {
    // The runtime is linked statically and loads the driver on first use. It answers 0 where there is none, and
    // takes older drivers up to its own number before the point.
    int driver = 0, runtime = 0, devices = 0;
    check_cuda(cudaDriverGetVersion(&driver), "asking for the driver");
    if (driver == 0)
        throw Error(
            "cuda: no NVIDIA driver (libcuda.so.1 cannot be loaded), expected a GPU and its "
            "driver");
    check_cuda(cudaRuntimeGetVersion(&runtime), "asking for the runtime");
    const cudaError_t counted = cudaGetDeviceCount(&devices);
    if (counted == cudaErrorInsufficientDriver) {
        cudaGetLastError();
        const auto version = [](int number) {
            return fmt::format("{}.{}", number / 1000, number % 1000 / 10);
        };
        throw Error(fmt::format(
            "cuda: the NVIDIA driver is for CUDA {}, this build needs one for CUDA {} or newer",
            version(driver), version(runtime)));
    }
    if (counted == cudaErrorNoDevice || (counted == cudaSuccess && devices == 0)) {
        cudaGetLastError();
        throw Error("cuda: no NVIDIA GPU, expected one");
    }
    check_cuda(counted, "looking for a GPU");
    check_cuda(cudaFree(nullptr), "starting the GPU");
}

void* allocate_on_gpu(std::size_t bytes, const char* what) {
    void* data = nullptr;
    const cudaError_t code = cudaMalloc(&data, bytes);
    if (code == cudaErrorMemoryAllocation) {
        cudaGetLastError();
        std::size_t free = 0, total = 0;
        check_cuda(cudaMemGetInfo(&free, &total), "querying free memory");
        constexpr double kMegabyte = 1e6;
        throw Error(fmt::format(
            "cuda: {} take {:.0f} MB of GPU memory, {:.0f} of {:.0f} MB are free", what,
            static_cast<double>(bytes) / kMegabyte, static_cast<double>(free) / kMegabyte,
            static_cast<double>(total) / kMegabyte));
    }
    check_cuda(code, what);
    return data;
}

GpuTimer::GpuTimer() {
    check_cuda(cudaEventCreate(&start_), "making an event");
    check_cuda(cudaEventCreate(&stop_), "making an event");
}

GpuTimer::~GpuTimer() {
    if (start_) cudaEventDestroy(start_);
    if (stop_) cudaEventDestroy(stop_);
}

void GpuTimer::start() { check_cuda(cudaEventRecord(start_), "timing"); }

void GpuTimer::stop() {
    check_cuda(cudaEventRecord(stop_), "timing");
    check_cuda(cudaEventSynchronize(stop_), "rendering");
    float elapsed = 0;
    check_cuda(cudaEventElapsedTime(&elapsed, start_, stop_), "timing");
    ms_ = double{elapsed};
}

}  // namespace vog::gpu
