// memory.cpp: GPU memory as host memory, events as host time, and what a test may set of the GPU.
#include <cuda_runtime.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "emulation.h"

namespace vog::emulation {

namespace {
std::atomic<bool> refusals_throw = false;
}  // namespace

void set_refusals_throw(bool throws) { refusals_throw = throws; }

void refuse(const std::string& what) {
    if (refusals_throw) throw std::runtime_error(what);
    std::fputs(("emulated GPU: " + what + "\n").c_str(), stderr);
    std::abort();
}

namespace {

/// Allocations, first bytes to sizes. Ends the process with a failure if one is left at exit.
class Memory {
  public:
    static Memory& get() {
        static Memory memory;
        return memory;
    }
    ~Memory() {
        if (blocks_.empty()) return;
        std::fputs("emulated GPU: memory that was never freed\n", stderr);
        std::_Exit(EXIT_FAILURE);
    }

    void* allocate(std::size_t bytes) {
        const std::lock_guard lock(using_);
        if (bytes > limit - std::min(limit, used_)) return nullptr;
        // Of exactly this size, so that the address sanitizer sees what is written behind it.
        void* data = nullptr;
        constexpr std::size_t kAlignment = 256;
        if (posix_memalign(&data, kAlignment, bytes) != 0) return nullptr;
        std::memset(data, 0xff, bytes);
        blocks_[static_cast<std::byte*>(data)] = bytes;
        used_ += bytes;
        return data;
    }
    void release(void* data) {
        const std::lock_guard lock(using_);
        const auto block = blocks_.find(static_cast<std::byte*>(data));
        if (block == blocks_.end()) refuse("cudaFree of memory that is not allocated");
        std::memset(data, 0xee, block->second);
        used_ -= block->second;
        blocks_.erase(block);
        std::free(data);
    }
    /// Ends the process unless the bytes lie in one allocation.
    void require(const void* data, std::size_t bytes, const char* what) {
        const std::lock_guard lock(using_);
        const auto* at = static_cast<const std::byte*>(data);
        auto block = blocks_.upper_bound(const_cast<std::byte*>(at));
        if (bytes == 0) return;
        if (block != blocks_.begin()) {
            --block;
            if (at + bytes <= block->first + block->second) return;
        }
        refuse(std::string(what) + ": not within one allocation");
    }
    std::size_t used() {
        const std::lock_guard lock(using_);
        return used_;
    }

    std::size_t limit = std::size_t{8} << 30;

  private:
    std::mutex using_;
    std::map<std::byte*, std::size_t> blocks_;
    std::size_t used_ = 0;
};

Traversal traversal_of_environment() {
    const char* name = std::getenv("VOG_EMULATED_TRAVERSAL");
    const std::string mode = name ? name : "plain";
    if (mode != "plain" && mode != "strict" && mode != "noisy")
        refuse("VOG_EMULATED_TRAVERSAL: '" + mode + "', expected plain, strict or noisy");
    return mode == "strict"  ? Traversal::strict
           : mode == "noisy" ? Traversal::noisy
                             : Traversal::plain;
}
Traversal& current_traversal() {
    static Traversal mode = traversal_of_environment();
    return mode;
}

std::size_t primitive_limit = std::size_t{1} << 29;
int driver = CUDART_VERSION;
int contexts = 0, modules = 0;
bool gl_drawn = true, gl_registered = true;

}  // namespace

void* allocate_memory(std::size_t bytes) { return Memory::get().allocate(bytes); }
void release_memory(void* data) { Memory::get().release(data); }
void set_memory(std::size_t bytes) { Memory::get().limit = bytes; }
std::size_t memory() { return Memory::get().limit; }
std::size_t allocated() { return Memory::get().used(); }
void set_traversal(Traversal mode) { current_traversal() = mode; }
Traversal traversal() { return current_traversal(); }
void set_most_primitives(std::size_t count) { primitive_limit = count; }
std::size_t most_primitives() { return primitive_limit; }
void set_driver_version(int version) { driver = version; }
int driver_version() { return driver; }
void set_draws_gl(bool draws) { gl_drawn = draws; }
bool draws_gl() { return gl_drawn; }
void set_registers_gl(bool registers) { gl_registered = registers; }
bool registers_gl() { return gl_registered; }
int contexts_made() { return contexts; }
int modules_made() { return modules; }
void count_context() { ++contexts; }
void count_module() { ++modules; }

}  // namespace vog::emulation

using vog::emulation::finish_stream;
using vog::emulation::Memory;

namespace {

cudaError_t last_error = cudaSuccess;

}  // namespace

cudaError_t vog::emulation::result(cudaError_t code) {
    if (code != cudaSuccess) last_error = code;
    return code;
}
using vog::emulation::result;

cudaError_t cudaGetLastError() { return std::exchange(last_error, cudaSuccess); }

const char* cudaGetErrorString(cudaError_t code) {
    switch (code) {
        case cudaSuccess:
            return "no error";
        case cudaErrorMemoryAllocation:
            return "out of memory";
        case cudaErrorInvalidConfiguration:
            return "invalid configuration argument";
        case cudaErrorInsufficientDriver:
            return "CUDA driver version is insufficient for CUDA runtime version";
        case cudaErrorNoDevice:
            return "no CUDA-capable device is detected";
        case cudaErrorMapBufferObjectFailed:
            return "mapping of buffer object failed";
        default:
            return "invalid argument";
    }
}

cudaError_t cudaDriverGetVersion(int* version) {
    *version = vog::emulation::driver;
    return cudaSuccess;
}

cudaError_t cudaRuntimeGetVersion(int* version) {
    *version = CUDART_VERSION;
    return cudaSuccess;
}

cudaError_t cudaGetDeviceCount(int* count) {
    *count = 1;
    // Drivers run what was built for any version of the same number before the point.
    constexpr int kMajor = 1000;
    if (vog::emulation::driver / kMajor < CUDART_VERSION / kMajor)
        return result(cudaErrorInsufficientDriver);
    return cudaSuccess;
}

cudaError_t cudaGetDevice(int* device) {
    *device = 0;
    return cudaSuccess;
}

cudaError_t cudaMalloc(void** data, std::size_t bytes) {
    *data = Memory::get().allocate(bytes);
    return result(*data ? cudaSuccess : cudaErrorMemoryAllocation);
}

cudaError_t cudaFree(void* data) {
    if (!data) return cudaSuccess;
    finish_stream(nullptr);
    Memory::get().release(data);
    return cudaSuccess;
}

cudaError_t cudaMemGetInfo(std::size_t* free, std::size_t* total) {
    *total = Memory::get().limit;
    *free = *total - std::min(*total, Memory::get().used());
    return cudaSuccess;
}

cudaError_t cudaMemcpy(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind) {
    finish_stream(nullptr);
    if (kind == cudaMemcpyHostToDevice || kind == cudaMemcpyDeviceToDevice)
        Memory::get().require(to, bytes, "cudaMemcpy to the GPU");
    if (kind == cudaMemcpyDeviceToHost || kind == cudaMemcpyDeviceToDevice)
        Memory::get().require(from, bytes, "cudaMemcpy from the GPU");
    if (bytes > 0) std::memcpy(to, from, bytes);
    return cudaSuccess;
}

cudaError_t cudaMemcpyAsync(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind,
                            cudaStream_t stream) {
    if (!stream || kind != cudaMemcpyDeviceToDevice)
        vog::emulation::refuse("only copies on the GPU in streams of their own are emulated");
    vog::emulation::add_work(stream, [=] {
        Memory::get().require(to, bytes, "cudaMemcpyAsync to the GPU");
        Memory::get().require(from, bytes, "cudaMemcpyAsync from the GPU");
        if (bytes > 0) std::memcpy(to, from, bytes);
    });
    return cudaSuccess;
}

cudaError_t cudaMemset(void* data, int value, std::size_t bytes) {
    finish_stream(nullptr);
    Memory::get().require(data, bytes, "cudaMemset");
    std::memset(data, value, bytes);
    return cudaSuccess;
}
