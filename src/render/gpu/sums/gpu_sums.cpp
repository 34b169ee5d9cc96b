// gpu_sums.cpp: Sums of a picture in GPU memory.
#include <fmt/core.h>

#include "render/gpu/sums/gpu_sums.h"
#include "render/gpu/sums/sums_memory.h"
#include "vog/error.h"

namespace vog {

using namespace gpu;

int gpu::lattice(const SumsSize& size, int SumsSize::*side) {
    constexpr int kMostRays = 64, kMostSide = 1 << 20;
    if (size.rays < 1 || size.rays > kMostRays)
        throw Error(fmt::format("{0} x {0} rays a pixel, expected 1 to {1}", size.rays, kMostRays));
    if (size.*side > kMostSide)
        throw Error(fmt::format("a picture of {} x {} pixels, expected at most {} each", size.width,
                                size.height, kMostSide));
    return size.rays * size.*side;
}

GpuSums::GpuSums() : state_(std::make_unique<State>()) {}
GpuSums::~GpuSums() = default;
GpuSums::GpuSums(GpuSums&&) noexcept = default;
GpuSums& GpuSums::operator=(GpuSums&&) noexcept = default;

int GpuSums::width() const { return state_->width; }
int GpuSums::height() const { return state_->height; }
int GpuSums::channels() const { return state_->channels; }

std::vector<float> GpuSums::fetch() const {
    std::vector<float> value(state_->floats());
    if (!value.empty()) state_->value.copy_to(value.data(), value.size(), "fetching the picture");
    return value;
}

SumsPass GpuSums::State::prepare(SumsKind kind, const SumsSize& size, int image_channels) {
    width = size.width, height = size.height, channels = image_channels;
    value.reserve(floats(), "the picture");
    SumsPass pass{};
    pass.kind = kind;
    pass.to = value.data();
    pass.width = width, pass.height = height, pass.channels = channels, pass.rays = size.rays;
    pass.scale = 1;
    return pass;
}

void GpuSums::State::clear() {
    check_cuda(cudaMemset(value.data(), 0, floats() * sizeof(float)), "clearing the picture");
    check_cuda(cudaStreamSynchronize(nullptr), "clearing the picture");
}

void GpuSums::State::finish(const SumsPass& pass) {
    launch_sums(pass);
    check_cuda(cudaStreamSynchronize(nullptr), "summing rays");
}

}  // namespace vog
