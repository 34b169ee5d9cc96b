// gpus.cpp: The renderers of a GPU, emulated ones over every way of traversing a hierarchy.
#include "support/gpus.h"

#include "render/gpu/chords/gpu_pictures.h"
#include "render/gpu/gpu.h"
#include "support/scenes.h"
#include "vog/error.h"
#ifdef VOG_EMULATED_GPU
#include "emulation/emulation.h"
#endif

namespace vog::test {

#ifdef VOG_EMULATED_GPU

std::vector<Gpu> gpus() {
    using emulation::Traversal;
    std::vector<Gpu> all{{"cuda", Renderer::cuda, [] {}}};
    for (const auto& [mode, name] : {std::pair{Traversal::plain, "optix_plain"},
                                     {Traversal::strict, "optix_strict"},
                                     {Traversal::noisy, "optix_noisy"}})
        all.push_back({name, Renderer::optix, [mode = mode] { emulation::set_traversal(mode); }});
    return all;
}

bool share_gl(bool draws, bool registers) {
    emulation::set_draws_gl(draws);
    emulation::set_registers_gl(registers);
    return true;
}

void GpuTest::TearDown() {
    emulation::set_traversal(emulation::Traversal::plain);
    EXPECT_EQ(emulation::allocated(), 0u) << "GPU memory that a renderer has kept";
}

#else

std::vector<Gpu> gpus() {
    static const std::vector<Gpu> found = [] {
        std::vector<Gpu> all;
        for (const auto& [name, renderer] :
             {std::pair{"cuda", Renderer::cuda}, {"optix", Renderer::optix}})
            try {
                const GpuPictures works(renderer, random_gaussians(1, 0.1, 0.2, 1));
                all.push_back({name, renderer, [] {}});
            } catch (const Error&) {  // no such renderer, driver or device
            }
        return all;
    }();
    return found;
}

bool share_gl(bool, bool) { return false; }

void GpuTest::TearDown() {}

#endif

std::vector<std::pair<std::string, GpuRender>> gpu_renderers() {
    std::vector<std::pair<std::string, GpuRender>> all;
    for (const Gpu& gpu : gpus()) {
        if (gpu.renderer == Renderer::cuda) {
            all.emplace_back(
                gpu.name, [](const Gaussians& model, const Camera& camera, int width, int height) {
                    return CudaSplat(model).render(camera, width, height);
                });
            continue;
        }
        for (const auto& [program, options] :
             {std::pair{"_accumulate", TraceOptions{}},
              {"_collect", TraceOptions{.anyhit = AnyHit::collect}},
              {"_collect_by_16", TraceOptions{.anyhit = AnyHit::collect, .hits_per_slab = 16}}})
            all.emplace_back(gpu.name + program, [options, prepare = gpu.prepare](
                                                     const Gaussians& model, const Camera& camera,
                                                     int width, int height) {
                prepare();
                return OptixModel(model).render(camera, width, height, options);
            });
    }
    return all;
}

}  // namespace vog::test
