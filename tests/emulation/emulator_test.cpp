// emulator_test.cpp: The emulated GPU finds what it is there to find.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <numeric>
#include <vector>

#include <cuda_runtime.h>

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>

#include "emulation/emulation.h"

namespace vog::test {

namespace {

constexpr unsigned kThreads = 64;

void order_kernel(std::vector<unsigned>* order) { order->push_back(threadIdx.x); }

void diverging_kernel() {
    if (threadIdx.x < 3) __syncthreads();
}

/// Sums of 2n + 1 over the block, right only if every thread waits for the others.
void sum_kernel(unsigned* sum) {
    static unsigned values[kThreads];
    values[threadIdx.x] = 2 * threadIdx.x + 1;
    for (unsigned half = kThreads / 2; half > 0; half /= 2) {
        __syncthreads();
        if (threadIdx.x < half) values[threadIdx.x] += values[threadIdx.x + half];
    }
    if (threadIdx.x == 0) atomicAdd(sum, values[0]);
}

cudaLaunchConfig_t blocks(unsigned count, unsigned threads = kThreads) {
    cudaLaunchConfig_t shape = {};
    shape.gridDim = dim3(count);
    shape.blockDim = dim3(threads);
    return shape;
}

}  // namespace

TEST(emulator, threads_run_in_a_scrambled_order_and_each_once) {
    std::vector<unsigned> order, sorted(kThreads);
    const cudaLaunchConfig_t shape = blocks(1);
    ASSERT_EQ(cudaLaunchKernelEx(&shape, order_kernel, &order), cudaSuccess);
    EXPECT_TRUE(order.empty());  // nothing waited for it
    ASSERT_EQ(cudaDeviceSynchronize(), cudaSuccess);
    std::iota(sorted.begin(), sorted.end(), 0);
    EXPECT_NE(order, sorted);
    EXPECT_TRUE(std::is_permutation(order.begin(), order.end(), sorted.begin(), sorted.end()));
}

TEST(emulator, barriers_hold_threads_back) {
    unsigned sum = 0;
    const cudaLaunchConfig_t shape = blocks(5);
    ASSERT_EQ(cudaLaunchKernelEx(&shape, sum_kernel, &sum), cudaSuccess);
    ASSERT_EQ(cudaDeviceSynchronize(), cudaSuccess);
    EXPECT_EQ(sum, 5 * kThreads * kThreads);
}

TEST(emulator, shapes_beyond_a_gpus_are_refused) {
    for (const cudaLaunchConfig_t& shape : {blocks(0), blocks(1, 0), blocks(1, 1025)}) {
        unsigned sum = 0;
        EXPECT_EQ(cudaLaunchKernelEx(&shape, sum_kernel, &sum), cudaErrorInvalidConfiguration);
    }
}

TEST(emulator_death, a_barrier_that_not_all_threads_reach_ends_the_process) {
    const cudaLaunchConfig_t shape = blocks(1);
    EXPECT_DEATH(
        {
            (void)cudaLaunchKernelEx(&shape, diverging_kernel);
            (void)cudaDeviceSynchronize();
        },
        "not reach");
}

TEST(emulator_death, copies_and_frees_of_other_memory_end_the_process) {
    void* data = nullptr;
    ASSERT_EQ(cudaMalloc(&data, 100), cudaSuccess);
    std::vector<char> host(200);
    EXPECT_DEATH((void)cudaMemcpy(host.data(), data, 101, cudaMemcpyDeviceToHost), "allocation");
    EXPECT_DEATH((void)cudaMemcpy(data, host.data(), 101, cudaMemcpyHostToDevice), "allocation");
    EXPECT_DEATH((void)cudaMemset(host.data(), 0, 1), "allocation");
    EXPECT_DEATH((void)cudaFree(host.data()), "not allocated");
    EXPECT_EQ(cudaFree(data), cudaSuccess);
    EXPECT_DEATH((void)cudaFree(data), "not allocated");
}

TEST(emulator_death, memory_that_is_never_freed_fails_the_process) {
    EXPECT_EXIT(
        {
            void* data = nullptr;
            (void)cudaMalloc(&data, 8);
            std::exit(0);
        },
        testing::ExitedWithCode(EXIT_FAILURE), "never freed");
}

TEST(emulator, new_memory_is_not_zero_and_its_amount_is_limited) {
    const std::size_t before = emulation::memory(), used = emulation::allocated();
    emulation::set_memory(used + 1000);
    void *first = nullptr, *second = nullptr;
    ASSERT_EQ(cudaMalloc(&first, 600), cudaSuccess);
    EXPECT_EQ(static_cast<unsigned char*>(first)[599], 0xff);
    EXPECT_EQ(cudaMalloc(&second, 600), cudaErrorMemoryAllocation);
    EXPECT_EQ(cudaGetLastError(), cudaErrorMemoryAllocation);
    EXPECT_EQ(cudaGetLastError(), cudaSuccess);
    std::size_t free = 0, total = 0;
    (void)cudaMemGetInfo(&free, &total);
    EXPECT_EQ(free, 400u);
    EXPECT_EQ(cudaFree(first), cudaSuccess);
    emulation::set_memory(before);
}

TEST(emulator, copies_in_a_stream_are_there_once_it_is_waited_for) {
    void *from = nullptr, *to = nullptr;
    ASSERT_EQ(cudaMalloc(&from, 8), cudaSuccess);
    ASSERT_EQ(cudaMalloc(&to, 8), cudaSuccess);
    ASSERT_EQ(cudaMemset(from, 7, 8), cudaSuccess);
    cudaStream_t stream = nullptr;
    ASSERT_EQ(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), cudaSuccess);
    ASSERT_EQ(cudaMemcpyAsync(to, from, 8, cudaMemcpyDeviceToDevice, stream), cudaSuccess);
    std::uint64_t value = 0;
    ASSERT_EQ(cudaMemcpy(&value, to, 8, cudaMemcpyDeviceToHost), cudaSuccess);
    EXPECT_EQ(value, ~std::uint64_t{0});
    ASSERT_EQ(cudaStreamSynchronize(stream), cudaSuccess);
    ASSERT_EQ(cudaMemcpy(&value, to, 8, cudaMemcpyDeviceToHost), cudaSuccess);
    EXPECT_EQ(value, 0x0707070707070707u);
    EXPECT_EQ(cudaStreamDestroy(stream), cudaSuccess);
    EXPECT_DEATH((void)cudaStreamSynchronize(stream), "gone");
    EXPECT_EQ(cudaFree(from), cudaSuccess);
    EXPECT_EQ(cudaFree(to), cudaSuccess);
}

TEST(emulator, prefix_sums_wrap_in_the_type_of_their_input_as_cubs_do) {
    const std::vector<std::uint32_t> in{0xffffffffu, 2, 5};
    std::vector<std::uint64_t> out(3);
    std::vector<std::byte> scratch(4096);
    std::size_t bytes = 0;
    ASSERT_EQ(cub::DeviceScan::InclusiveSum(nullptr, bytes, in.data(), out.data(), 3), cudaSuccess);
    ASSERT_EQ(cub::DeviceScan::InclusiveSum(scratch.data(), bytes, in.data(), out.data(), 3),
              cudaSuccess);
    EXPECT_EQ(out, (std::vector<std::uint64_t>{0xffffffffu, 1, 6}));
    EXPECT_DEATH(
        (void)cub::DeviceScan::InclusiveSum(scratch.data(), --bytes, in.data(), out.data(), 3),
        "scratch");
}

TEST(emulator, sorts_are_stable_and_end_in_either_half) {
    for (const int bits : {3, 8, 9, 17}) {
        std::vector<std::uint32_t> keys(500), other_keys(500), values(500), other_values(500);
        for (std::uint32_t n = 0; n < 500; ++n)
            keys[n] = n * 2654435761u >> (32 - bits), values[n] = n;
        cub::DoubleBuffer<std::uint32_t> key(keys.data(), other_keys.data());
        cub::DoubleBuffer<std::uint32_t> value(values.data(), other_values.data());
        std::size_t bytes = 0;
        (void)cub::DeviceRadixSort::SortPairs(nullptr, bytes, key, value, 500, 0, bits);
        std::vector<std::byte> scratch(bytes);
        (void)cub::DeviceRadixSort::SortPairs(scratch.data(), bytes, key, value, 500, 0, bits);
        EXPECT_EQ(key.Current() == keys.data(), (bits + 7) / 8 % 2 == 0) << bits;
        for (int n = 1; n < 500; ++n) {
            ASSERT_LE(key.Current()[n - 1], key.Current()[n]) << bits;
            if (key.Current()[n - 1] == key.Current()[n]) {
                ASSERT_LT(value.Current()[n - 1], value.Current()[n]) << bits;
            }
        }
    }
}

}  // namespace vog::test
