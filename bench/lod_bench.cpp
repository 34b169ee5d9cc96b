// lod_bench.cpp: pictures of ever finer data: all Gaussians, and the cut through their hierarchy.
// Arguments: voxels of the cloud along an edge, pixels along one of the picture, hundredths of a
// pixel error (0: everything is drawn). Cells of 2^3 voxels, the paper view. Besides the time: what
// is drawn (an item is a Gaussian of that), and the PSNR of V against the mean of T of the voxels
// over each pixel. A size of 1024 takes a minute to make and 6 GB.
#include <benchmark/benchmark.h>

#include <map>

#include "render/reference/reference.h"
#include "render/splat/splat.h"
#include "support.h"
#include "vog/compare.h"
#include "vog/convert_moments.h"
#include "vog/progress.h"
#include "vog/shade.h"

namespace {

struct Data {
    vog::Gaussians model;
    vog::Hierarchy hierarchy;
    std::vector<vog::VoxelGrid> voxels;
    std::map<int, vog::DepthImage> truth;  ///< by pixels
};

Data& data(int size) {
    static std::map<int, Data> made;
    auto found = made.find(size);
    if (found != made.end()) return found->second;
    made.clear();  // one cloud in memory
    Data& cloud = made[size];
    const vog::Volume volume = vog::sample_cloud({.size = size});
    vog::MomentOptions options;
    options.block_voxels = 2;
    cloud.model = vog::convert_moments(volume, options);
    cloud.hierarchy = vog::build_hierarchy(cloud.model, {vog::inverse(volume.world_from_index)});
    cloud.voxels.push_back(vog::voxel_grid(volume));
    return cloud;
}

/// T of the voxels, mean over rays x rays of each pixel, at the extinction of a shaded picture.
const vog::DepthImage& truth(Data& cloud, const vog::Camera& camera, int pixels) {
    constexpr int kAcross = 2048;  // rays along an edge of the picture
    const auto [at, is_new] = cloud.truth.try_emplace(pixels, pixels, pixels);
    vog::DepthImage& mean = at->second;
    if (!is_new) return mean;
    const int rays = std::max(1, kAcross / pixels);
    const vog::DepthImage all =
        vog::render_reference(cloud.voxels, camera, pixels * rays, pixels * rays);
    const float share = 1 / static_cast<float>(rays * rays);
    for (int row = 0; row < all.height; ++row)
        for (int column = 0; column < all.width; ++column)
            mean.at(column / rays, row / rays) += share * all.at(column, row);
    vog::set_extinction(mean, vog::auto_extinction(mean));
    return mean;
}

void frame(benchmark::State& state) {
    Data& cloud = data(static_cast<int>(state.range(0)));
    const int pixels = static_cast<int>(state.range(1));
    const vog::Camera camera = vog::paper_view(cloud.model.box);
    vog::SplatOptions options;
    options.hierarchy = &cloud.hierarchy;
    options.cut.pixel_error = 0.01 * static_cast<double>(state.range(2));
    vog::SplatRenderer renderer(cloud.model, options);
    vog::DepthImage image = renderer.render(camera, pixels, pixels);
    const vog::CutReport cut = renderer.cut_report();
    if (state.range(2) == 0 &&
        image.depth != vog::render_splat(cloud.model, camera, pixels, pixels).depth) {
        state.SkipWithError("without an error the cut is not the model");
        return;
    }
    const vog::DepthImage& exact = truth(cloud, camera, pixels);
    vog::DepthImage shown = image;
    vog::set_extinction(shown, exact.extinction);
    state.counters["psnr_db"] = vog::compare(exact, shown).grey.psnr_db;
    for (auto _ : state) renderer.render(camera, pixels, pixels, image);
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(cut.drawn()));
    state.counters["gaussians"] = static_cast<double>(cloud.model.size());
    state.counters["drawn"] = static_cast<double>(cut.drawn());
    state.counters["visited"] = static_cast<double>(cut.visited);
    state.counters["threads"] = vog::thread_count();
}

void views(benchmark::internal::Benchmark* bench) {
    vog::bench::measure(bench);
    bench->ArgNames({"size", "pixels", "error"});
    for (const int size : {128, 256, 512, 1024})
        for (const int pixels : {1024, 256})
            for (const int error : {0, 100, 200, 400}) bench->Args({size, pixels, error});
}

BENCHMARK(frame)->Apply(views);

}  // namespace
