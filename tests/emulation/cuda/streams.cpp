// streams.cpp: Work that waits: kernels, events and copies run where a GPU must have run them at the latest, so that results that
// nothing waited for are not there.
#include <cuda_runtime.h>

#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <utility>
#include <vector>

#include "emulation.h"

struct CUevent_st {
    std::chrono::steady_clock::time_point time;
};
struct CUstream_st {
    std::vector<std::function<void()>> work;
};

namespace vog::emulation {

namespace {

/// Streams by address; the default one, that of null, is always there.
class Streams {
  public:
    static Streams& get() {
        static Streams streams;
        return streams;
    }
    ~Streams() {
        if (!made_.empty()) refuse("a stream that was never destroyed");
    }
    cudaStream_t make() {
        const std::lock_guard lock(using_);
        return *made_.insert(new CUstream_st).first;
    }
    void destroy(cudaStream_t stream) {
        const std::lock_guard lock(using_);
        run(known(stream));
        made_.erase(stream);
        delete stream;
    }
    void add(cudaStream_t stream, std::function<void()> work) {
        const std::lock_guard lock(using_);
        known(stream).work.push_back(std::move(work));
    }
    void wait(cudaStream_t stream) {
        const std::lock_guard lock(using_);
        run(known(stream));
    }
    void wait_for_all() {
        const std::lock_guard lock(using_);
        run(default_);
        for (const cudaStream_t stream : made_) run(*stream);
    }

  private:
    CUstream_st& known(cudaStream_t stream) {
        if (!stream) return default_;
        if (!made_.contains(stream)) refuse("a stream that is gone");
        return *stream;
    }
    static void run(CUstream_st& stream) {
        for (const std::function<void()>& each : std::exchange(stream.work, {})) each();
    }
    std::recursive_mutex using_;
    CUstream_st default_;
    std::set<cudaStream_t> made_;
};

}  // namespace

void add_work(cudaStream_t stream, std::function<void()> work) {
    Streams::get().add(stream, std::move(work));
}
void finish_stream(cudaStream_t stream) { Streams::get().wait(stream); }

}  // namespace vog::emulation

using vog::emulation::Streams;

cudaError_t cudaDeviceSynchronize() {
    Streams::get().wait_for_all();
    return cudaSuccess;
}
cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned flags) {
    // Others wait for the default stream, and it for them.
    if (flags != cudaStreamNonBlocking)
        vog::emulation::refuse("a stream that blocks the default one");
    *stream = Streams::get().make();
    return cudaSuccess;
}
cudaError_t cudaStreamDestroy(cudaStream_t stream) {
    Streams::get().destroy(stream);
    return cudaSuccess;
}
cudaError_t cudaStreamSynchronize(cudaStream_t stream) {
    Streams::get().wait(stream);
    return cudaSuccess;
}

cudaError_t cudaEventCreate(cudaEvent_t* event) {
    *event = new CUevent_st;
    return cudaSuccess;
}
cudaError_t cudaEventDestroy(cudaEvent_t event) {
    Streams::get().wait_for_all();
    delete event;
    return cudaSuccess;
}
cudaError_t cudaEventRecord(cudaEvent_t event, cudaStream_t stream) {
    Streams::get().add(stream, [event] { event->time = std::chrono::steady_clock::now(); });
    return cudaSuccess;
}
cudaError_t cudaEventSynchronize(cudaEvent_t) {
    Streams::get().wait(nullptr);
    return cudaSuccess;
}
cudaError_t cudaEventElapsedTime(float* ms, cudaEvent_t start, cudaEvent_t stop) {
    *ms = std::chrono::duration<float, std::milli>(stop->time - start->time).count();
    return cudaSuccess;
}
