// field_maps_bench.cpp: Cost of the three maps of a field (column, mean, deviation) over that of T alone, by the
// splat renderer, in one run: `paper` view of a model by moments. Each picture is compared with the closed form
// in double precision before it is timed. The same through the voxels under parallel rays: by boxes, and by walks on
// every ray, which any clip chooses.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "render/reference/reference.h"
#include "render/shown_field.h"
#include "render/splat/fields/field_splat.h"
#include "support.h"
#include "vog/convert_moments.h"
#include "vog/field_maps.h"

namespace {

/// The volume's model with a scalar and a vector field that vary from Gaussian to Gaussian.
const vog::Gaussians& model() {
    static const vog::Gaussians made = [] {
        vog::MomentOptions options;
        options.block_voxels = 4;
        vog::Gaussians model = vog::convert_moments(vog::bench::volume(), options);
        vog::ScalarField scalar;
        vog::VectorField vector;
        scalar.name = "temperature";
        vector.name = "velocity";
        const float per_radius = static_cast<float>(1 / vog::view_box(model).radius());
        for (const vog::Vec3f mean : model.mean) {
            const vog::Vec3f at = 9 * per_radius * mean;
            const vog::Vec3f wave{std::sin(at.x), std::sin(at.y), std::sin(at.z)};
            const vog::Vec3f slope{per_radius * wave.y, per_radius * wave.z, per_radius * wave.x};
            scalar.value.push_back(300 + wave.x + wave.y);
            scalar.gradient.push_back(slope);
            scalar.deviation.push_back(0.1f);
            scalar.skewness.push_back(0);
            vector.value.push_back(wave);
            for (auto& gradient : vector.gradient) gradient.push_back(slope);
            vector.covariance.push_back({0.1f, 0.01f, 0, 0.1f, 0, 0.1f});
        }
        model.fields.scalar.push_back(scalar);
        model.fields.vector.push_back(vector);
        return model;
    }();
    return made;
}

vog::Camera camera(bool parallel) {
    const vog::Box box = vog::view_box(model());
    vog::Camera camera = vog::paper_view(box);
    if (parallel) camera.orthographic_width = 2.2 * box.radius();
    return camera;
}

/// True if the middle of the picture is the sum of the closed form, Gaussians smaller than two pixels being
/// drawn otherwise: to a thousandth of the range.
bool is_right(const vog::FieldMaps& maps, const vog::FieldChoice& choice,
              const vog::Camera& camera) {
    const vog::CameraFrame frame = vog::frame_of(camera, maps.width, maps.height);
    const int x = maps.width / 2, y = maps.height / 2;
    vog::FieldSums all;
    for (std::size_t i = 0; i < model().size(); ++i) {
        const vog::FieldSums sums =
            vog::field_sums(model(), choice, i, frame.origin(x, y), frame.direction(x, y));
        all.column += sums.column, all.first += sums.first, all.second += sums.second;
    }
    const double mean = all.first / all.column;
    const double deviation = std::sqrt(all.second / all.column - mean * mean);
    const auto n = static_cast<std::size_t>(y) * static_cast<std::size_t>(maps.width) +
                   static_cast<std::size_t>(x);
    return std::abs(maps.column[n] - all.column) <= 1e-2 * all.column &&
           std::abs(maps.mean[n] - mean) <= 1e-2 && std::abs(maps.deviation[n] - deviation) <= 1e-2;
}

void depth(benchmark::State& state, bool parallel, int size) {
    const vog::Camera view = camera(parallel);
    vog::SplatRenderer renderer(model());
    vog::DepthImage image;
    for (auto _ : state) {
        renderer.render(view, size, size, image);
        benchmark::DoNotOptimize(image.depth.data());
    }
    state.counters["gaussians"] = static_cast<double>(model().size());
}

void maps(benchmark::State& state, const vog::FieldChoice& choice, bool parallel, int size) {
    const vog::Camera view = camera(parallel);
    if (!is_right(vog::render_field_splat(model(), choice, view, size, size), choice, view)) {
        state.SkipWithError("the maps are not the closed form");
        return;
    }
    vog::FieldMaps maps;
    for (auto _ : state) {
        vog::render_field_splat(model(), choice, view, size, size, {}, maps);
        benchmark::DoNotOptimize(maps.mean.data());
    }
}

vog::Camera voxel_camera() {
    const vog::Box box = vog::world_box(vog::bench::volume());
    vog::Camera camera = vog::paper_view(box);
    camera.orthographic_width = 2.2 * box.radius();
    return camera;
}
/// Pixels that a voxel, a cube, covers.
double pixels_per_voxel(int size) {
    const vog::CameraFrame frame = vog::frame_of(voxel_camera(), size, size);
    const double edge = frame.pixels_per_unit * std::cbrt(vog::voxel_volume(vog::bench::volume()));
    const vog::Vec3d along = frame.forward;
    return edge * edge * (std::abs(along.x) + std::abs(along.y) + std::abs(along.z));
}
vog::FieldMaps voxel_maps(bool boxes, int size) {
    const vog::Volume& volume = vog::bench::volume();
    const std::vector<vog::VoxelField> fields{vog::measure_field(volume)};
    const vog::Camera camera = voxel_camera();
    vog::ReferenceOptions options;
    if (!boxes) options.clip.planes.push_back({{0, 0, 1}, -1e15});
    return vog::render_field_reference({&volume, 1}, fields, vog::FieldPart::value, camera, size,
                                       size, options);
}
void voxels(benchmark::State& state, bool boxes, int size) {
    const std::vector<float> one = voxel_maps(true, 64).column,
                             other = voxel_maps(false, 64).column;
    for (std::size_t n = 0; n < one.size(); ++n)
        if (std::abs(one[n] - other[n]) > 1e-6f * other[n] + 1e-12f) {
            state.SkipWithError("boxes and rays have different columns");
            return;
        }
    for (auto _ : state) benchmark::DoNotOptimize(voxel_maps(boxes, size).mean.data());
    state.counters["pixels_per_voxel"] = pixels_per_voxel(size);
}

const bool kRegistered = [] {
    for (const int size : {128, 256, 512, 1024, 2048})
        for (const bool boxes : {true, false})
            benchmark::RegisterBenchmark(
                ((boxes ? "voxels/boxes/" : "voxels/rays/") + std::to_string(size)).c_str(),
                [=](benchmark::State& state) { voxels(state, boxes, size); })
                ->Unit(benchmark::kMillisecond)
                ->UseRealTime();
    for (const bool parallel : {false, true})
        for (const int size : {512, 1024}) {
            const std::string end =
                std::string(parallel ? "/parallel/" : "/pinhole/") + std::to_string(size);
            const auto add = [&](const std::string& name, auto&& run) {
                benchmark::RegisterBenchmark((name + end).c_str(), run)
                    ->Unit(benchmark::kMillisecond)
                    ->UseRealTime();
            };
            add("T", [=](benchmark::State& state) { depth(state, parallel, size); });
            add("scalar", [=](benchmark::State& state) {
                maps(state, {"temperature", vog::FieldPart::value}, parallel, size);
            });
            add("along_view", [=](benchmark::State& state) {
                maps(state, {"velocity", vog::FieldPart::view}, parallel, size);
            });
        }
    return true;
}();

}  // namespace
