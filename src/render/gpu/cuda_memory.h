// cuda_memory.h: Checked CUDA calls, and owners of GPU memory and timing events.
#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace vog::gpu {

/// throws vog::Error "cuda: <doing>: <CUDA's message>" unless `code` is success
void check_cuda(cudaError_t code, const char* doing);

/// throws vog::Error with one line naming the missing part: the driver, or a device
void require_cuda();

/// throws vog::Error with the bytes requested and the bytes free, if memory is short
void* allocate_on_gpu(std::size_t bytes, const char* what);

/// An array in GPU memory. `what` names it in errors.
template <class T>
class GpuArray {
  public:
    GpuArray() = default;
    GpuArray(std::size_t count, const char* what)
        : data_(count ? static_cast<T*>(allocate_on_gpu(count * sizeof(T), what)) : nullptr),
          size_(count) {}
    GpuArray(const std::vector<T>& values, const char* what) : GpuArray(values.size(), what) {
        if (size_) copy_from(values, what);
    }
    ~GpuArray() { cudaFree(data_); }
    GpuArray(GpuArray&& other) noexcept
        : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
    GpuArray& operator=(GpuArray&& other) noexcept {
        std::swap(data_, other.data_);
        std::swap(size_, other.size_);
        return *this;
    }

    T* data() const { return data_; }
    std::size_t size() const { return size_; }
    /// Grows to at least `count` elements; growing discards the contents.
    void reserve(std::size_t count, const char* what) {
        if (count <= size_) return;
        *this = GpuArray();
        *this = GpuArray(count, what);
    }
    /// Copies to the first elements, size() >= values.size().
    void copy_from(const std::vector<T>& values, const char* what) {
        check_cuda(
            cudaMemcpy(data_, values.data(), values.size() * sizeof(T), cudaMemcpyHostToDevice),
            what);
    }
    void copy_to(T* host, std::size_t count, const char* what) const {
        check_cuda(cudaMemcpy(host, data_, count * sizeof(T), cudaMemcpyDeviceToHost), what);
    }

  private:
    T* data_ = nullptr;
    std::size_t size_ = 0;
};

/// Device time between two points of the default stream.
class GpuTimer {
  public:
    GpuTimer();
    ~GpuTimer();
    GpuTimer(const GpuTimer&) = delete;
    GpuTimer& operator=(const GpuTimer&) = delete;
    void start();
    void stop();  ///< waits for the device
    double ms() const { return ms_; }
    void set_ms(double ms) { ms_ = ms; }  ///< of a picture of several

  private:
    cudaEvent_t start_ = nullptr, stop_ = nullptr;
    double ms_ = 0;
};

}  // namespace vog::gpu
