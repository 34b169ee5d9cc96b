// blocks.cpp: Kernels on the host: a fiber a thread, blocks one after another, threads of a block in an order that
// changes at every barrier.
#include <cuda_runtime.h>
#include <dlfcn.h>
#include <setjmp.h>
#include <ucontext.h>

#include <cstring>
#include <memory>
#include <mutex>
#include <vector>

#include "emulation.h"

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/common_interface_defs.h>
#endif

thread_local uint3 threadIdx, blockIdx;
thread_local dim3 blockDim, gridDim;

// First and last byte of shared memory, by the linker; none in a program without kernels that share.
extern "C" __attribute__((weak)) std::byte __start_vog_shared[], __stop_vog_shared[];

namespace vog::emulation {

namespace {

constexpr std::size_t kStackBytes = 256 * 1024;

#if defined(__SANITIZE_ADDRESS__)
/// libc's own function: the sanitizer's, in its place, clears the shadow of a stack that stays as it is.
void jump(jmp_buf to) {
    using Jump = void (*)(jmp_buf, int);
    static const Jump own =
        reinterpret_cast<Jump>(dlsym(dlopen("libc.so.6", RTLD_LAZY | RTLD_NOLOAD), "_longjmp"));
    own(to, 1);
}
#else
void jump(jmp_buf to) { _longjmp(to, 1); }
#endif

enum class State { ready, waiting, ended };

/// Runs one thread of a block after another. Made once: makecontext and swapcontext call the kernel of the operating
/// system, _setjmp and _longjmp do not.
struct Fiber {
    jmp_buf at;
    bool begun = false;
    std::unique_ptr<std::byte[]> stack = std::make_unique_for_overwrite<std::byte[]>(kStackBytes);
    State state = State::ended;
    void* sanitizer_stack = nullptr;
};

/// Threads of the block that runs. One block at a time in the process: shared memory exists once.
class Block {
  public:
    static Block& get() {
        static Block block;
        return block;
    }

    void run(unsigned threads, const std::function<void()>& body) {
        body_ = &body;
        if (fibers_.size() < threads) fibers_.resize(threads);
        for (unsigned n = 0; n < threads; ++n) fibers_[n].state = State::ready;
        if (__start_vog_shared)
            std::memset(__start_vog_shared, 0xff,
                        static_cast<std::size_t>(__stop_vog_shared - __start_vog_shared));
        for (unsigned phase = 0; resume_all(threads, phase); ++phase) {
        }
    }

    /// Called on a fiber: back to the scheduler until all threads have come here.
    void wait() {
        current_->state = State::waiting;
        leave(*current_);
    }

    /// The same, with a vote: whether any thread has said yes.
    bool wait_for_any(bool yes) {
        if (voters_++ == 0) vote_ = false;
        vote_ = vote_ || yes;
        wait();
        const bool any = vote_;
        --voters_;
        wait();  // nobody votes again before all have read
        return any;
    }

    std::mutex running;

  private:
    static void enter() {
        Block& block = get();
        block.arrived();
        while (true) {
            (*block.body_)();
            block.current_->state = State::ended;
            block.leave(*block.current_);
        }
    }

    /// Runs every thread to its next barrier or its end.
    /// returns  true if all wait at a barrier, false if all have ended
    bool resume_all(unsigned threads, unsigned phase) {
        // An odd step visits every thread of a power of two; others are visited in turn.
        const unsigned step = threads & (threads - 1) ? 1 : 2 * (phase * 37 + 48) + 1;
        unsigned ended = 0;
        for (unsigned k = 0; k < threads; ++k) {
            const unsigned n = (k * step + 13 * phase + 7) % threads;
            threadIdx = {n, 0, 0};
            current_ = &fibers_[n];
            resume(*current_);
            ended += current_->state == State::ended;
        }
        if (ended > 0 && ended < threads)
            refuse("a barrier that some threads of a block do not reach");
        return ended == 0;
    }

    void resume(Fiber& fiber) {
#if defined(__SANITIZE_ADDRESS__)
        void* own = nullptr;
        __sanitizer_start_switch_fiber(&own, fiber.stack.get(), kStackBytes);
#endif
        if (_setjmp(scheduler_) == 0) {
            if (fiber.begun) jump(fiber.at);
            fiber.begun = true;
            ucontext_t first;
            getcontext(&first);
            first.uc_stack.ss_sp = fiber.stack.get();
            first.uc_stack.ss_size = kStackBytes;
            first.uc_link = nullptr;
            makecontext(&first, enter, 0);
            setcontext(&first);
        }
#if defined(__SANITIZE_ADDRESS__)
        __sanitizer_finish_switch_fiber(own, nullptr, nullptr);
#endif
    }
    void leave(Fiber& fiber) {
#if defined(__SANITIZE_ADDRESS__)
        __sanitizer_start_switch_fiber(&fiber.sanitizer_stack, scheduler_stack_, scheduler_bytes_);
#endif
        if (_setjmp(fiber.at) == 0) jump(scheduler_);
        arrived();
    }
    void arrived() {
#if defined(__SANITIZE_ADDRESS__)
        __sanitizer_finish_switch_fiber(current_->sanitizer_stack, &scheduler_stack_,
                                        &scheduler_bytes_);
#endif
    }

#if defined(__SANITIZE_ADDRESS__)
    const void* scheduler_stack_ = nullptr;
    std::size_t scheduler_bytes_ = 0;
#endif
    std::vector<Fiber> fibers_;
    jmp_buf scheduler_{};
    Fiber* current_ = nullptr;
    unsigned voters_ = 0;
    bool vote_ = false;
    const std::function<void()>* body_ = nullptr;
};

void run_blocks(const cudaLaunchConfig_t& shape, const std::function<void()>& body) {
    Block& block = Block::get();
    const std::lock_guard lock(block.running);
    blockDim = shape.blockDim;
    gridDim = shape.gridDim;
    // From the last block to the first: no kernel may count on the order.
    for (unsigned n = shape.gridDim.x; n-- > 0;) {
        blockIdx = {n, 0, 0};
        block.run(shape.blockDim.x, body);
    }
}

}  // namespace

cudaError_t launch_blocks(const cudaLaunchConfig_t& shape, std::function<void()> body) {
    constexpr unsigned kMostThreads = 1024, kMostBlocks = 0x7fffffff;
    const unsigned threads = shape.blockDim.x, blocks = shape.gridDim.x;
    if (shape.blockDim.y != 1 || shape.blockDim.z != 1 || shape.gridDim.y != 1 ||
        shape.gridDim.z != 1)
        refuse("only launches of one dimension are emulated");
    if (threads == 0 || threads > kMostThreads || blocks == 0 || blocks > kMostBlocks)
        return cudaErrorInvalidConfiguration;
    add_work(shape.stream, [shape, held = std::move(body)] { run_blocks(shape, held); });
    return cudaSuccess;
}

}  // namespace vog::emulation

void __syncthreads() { vog::emulation::Block::get().wait(); }
int __syncthreads_or(int predicate) {
    return vog::emulation::Block::get().wait_for_any(predicate != 0);
}
