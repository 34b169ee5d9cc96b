// emulated_gpu.cpp: The renderers of a GPU over every way of traversing a hierarchy.
#include "support/emulated_gpu.h"

#ifdef VOG_EMULATED_GPU

#include "emulation/emulation.h"
#include "render/gpu/gpu.h"

namespace vog::test {

std::vector<std::pair<std::string, GpuRender>> emulated_gpu_renderers() {
    using emulation::Traversal;
    std::vector<std::pair<std::string, GpuRender>> all;
    all.emplace_back("cuda",
                     [](const Gaussians& model, const Camera& camera, int width, int height) {
                         return CudaSplat(model).render(camera, width, height);
                     });
    for (const auto& [mode, mode_name] : {std::pair{Traversal::plain, "plain"},
                                          {Traversal::strict, "strict"},
                                          {Traversal::noisy, "noisy"}}) {
        const auto optix = [&](const std::string& name, const TraceOptions& options) {
            all.emplace_back(name + "_" + mode_name,
                             [options, mode = mode](const Gaussians& model, const Camera& camera,
                                                    int width, int height) {
                                 emulation::set_traversal(mode);
                                 return OptixModel(model).render(camera, width, height, options);
                             });
        };
        optix("optix_accumulate", {});
        optix("optix_collect", {.anyhit = AnyHit::collect});
        optix("optix_collect_by_16", {.anyhit = AnyHit::collect, .hits_per_slab = 16});
    }
    return all;
}

std::vector<EmulatedGpu> emulated_gpus() {
    using emulation::Traversal;
    std::vector<EmulatedGpu> all{{"cuda", Renderer::cuda, [] {}}};
    for (const auto& [mode, name] : {std::pair{Traversal::plain, "optix_plain"},
                                     {Traversal::strict, "optix_strict"},
                                     {Traversal::noisy, "optix_noisy"}})
        all.push_back({name, Renderer::optix, [mode = mode] { emulation::set_traversal(mode); }});
    return all;
}

void share_gl(bool draws, bool registers) {
    emulation::set_draws_gl(draws);
    emulation::set_registers_gl(registers);
}

}  // namespace vog::test

#else

namespace vog::test {

std::vector<std::pair<std::string, GpuRender>> emulated_gpu_renderers() { return {}; }
std::vector<EmulatedGpu> emulated_gpus() { return {}; }
void share_gl(bool, bool) {}

}  // namespace vog::test

#endif
