// field_splat.cpp: Maps of a field by splatting: three sums a pixel over the same splats as T.
#include <fmt/core.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "render/pixel_limits.h"
#include "render/splat/fields/field_planes.h"
#include "render/splat/fields/field_splat.h"
#include "render/splat/fields/projected_mean.h"
#include "render/splat/near/near_splats.h"
#include "vog/error.h"

namespace vog {

using namespace clipping;
using namespace splat;

namespace {

void check(const SplatOptions& options, int width, int height) {
    if (options.aabb_sigma != 0)
        throw Error("splat: bounding boxes (aabb_sigma) with a field, expected T or trace");
    if (width > kMaxSide || height > kMaxSide)
        throw Error(fmt::format("image size {}x{}: expected at most {} pixels a side", width,
                                height, kMaxSide));
}

/// Sums of a tile's pixels to column, mean and deviation.
void finish(const FieldKernels& loops, const ShownField& shown, const CameraFrame& frame,
            double unit, int left, int top, FieldMaps& maps) {
    const int right = std::min(left + kTileWidth, frame.width);
    const int bottom = std::min(top + kTileHeight, frame.height);
    for (int y = top; y < bottom; ++y) {
        const auto n = static_cast<std::size_t>(y) * static_cast<std::size_t>(maps.width) +
                       static_cast<std::size_t>(left);
        MapRow row{&maps.column[n],
                   &maps.mean[n],
                   &maps.deviation[n],
                   static_cast<std::size_t>(right - left),
                   unit,
                   shown.unit,
                   shown.reference.x};
        if (shown.along_rays) {
            const Vec3d first = frame.direction(left, y);
            row.along_rays = true;
            row.slope = dot(first, frame.right);
            row.slope_step = dot(frame.step_x, frame.right);
            row.rest2 = 1 + std::pow(dot(first, frame.up), 2);
            row.reference = dot(shown.reference, first);
            row.reference_step = dot(shown.reference, frame.step_x);
        }
        loops.finish(row);
    }
}

/// Pixels of a tile without any column.
void clear(const CameraFrame& frame, int left, int top, FieldMaps& maps) {
    const auto width = static_cast<std::size_t>(std::min(kTileWidth, frame.width - left));
    const int bottom = std::min(top + kTileHeight, frame.height);
    for (int y = top; y < bottom; ++y) {
        const auto n = static_cast<std::size_t>(y) * static_cast<std::size_t>(maps.width) +
                       static_cast<std::size_t>(left);
        std::fill_n(&maps.column[n], width, 0.0f);
        std::fill_n(&maps.mean[n], width, std::numeric_limits<float>::quiet_NaN());
        std::fill_n(&maps.deviation[n], width, std::numeric_limits<float>::quiet_NaN());
    }
}

/// Sums of a tile, and what a clip leaves of its rays.
struct TileWork {
    FieldTile sums;
    TileRays rays;
};

/// One picture in progress.
struct Picture {
    const Gaussians& gaussians;
    const ShownField& shown;
    const CameraFrame& frame;  ///< relative to the model's origin
    const SplatModel& model;
    const FieldPolynomials& polynomials;
    const SplatKernels& kernels;
    const SplatClip& clip;
    FieldMaps& maps;  ///< column, and in mean and deviation the other sums
    ProjectedSplats splats{};
    std::vector<PlaneSplat> planes{};
    std::vector<ViewSplat> views{};

    void add(std::size_t first, std::size_t last);
    void draw_tile(int t, bool first, bool last, TileWork& work) const;
};

/// Adds Gaussians first ... last - 1 to the sums.
void Picture::add(std::size_t first, std::size_t last) {
    splats.keep_origin = true;
    const std::size_t count = last - first;
    if (shown.along_rays)
        views.resize(std::max(views.size(), count));
    else
        planes.resize(std::max(planes.size(), count));
    const double share = model.limits.variance;
    splats.project(kernels, model, frame, first, last, [&](SplatChunk& chunk) {
        if (!clip.empty()) clip.keep(splats, chunk);
        for (std::size_t n = chunk.slot; n < chunk.slot + chunk.count; ++n)
            if (shown.along_rays)
                views[n] =
                    view_splat(shown, gaussians, splats.origin[n], splats.far[n], frame, share);
            else
                planes[n] =
                    plane_splat(shown, gaussians, splats.origin[n], splats.far[n], frame, share);
    });
    const bool is_last = last == gaussians.size();
    // 70 kB, sums all 0 between tiles: one for each thread, not for each task.
    tbb::enumerable_thread_specific<TileWork> tiles;
    struct Nothing {};
    draw_tiles<Nothing>(splats.bins,
                        [&](int t, Nothing) { draw_tile(t, first == 0, is_last, tiles.local()); });
}

/// first, last  whether no other Gaussians came before, or follow
void Picture::draw_tile(int t, bool first, bool last, TileWork& work) const {
    FieldTile& tile = work.sums;
    const int left = splats.column_of(t), top = splats.row_of(t);
    for (TilePixels& sum : tile.sum) sum.column = left, sum.row = top;
    LazyRays rays(clip, left, top, work.rays);
    const FieldKernels& loops = field_kernels(kernels);
    const FarSplat* far = splats.far.data();
    const bool touched = splats.visit(
        t, frame,
        [&](const std::uint32_t* index, std::size_t count) {
            if (shown.along_rays)
                loops.add_view(far, views.data(), index, count, polynomials, tile);
            else
                (frame.orthographic ? loops.add_parallel : loops.add_pinhole)(
                    far, planes.data(), index, count, polynomials, tile);
        },
        [&](const NearSplat& splat) {
            add_near_field(splat, shown, gaussians, frame, double{model.cutoff}, rays.of(splat),
                           tile);
        });
    if (!touched && first && last) return clear(frame, left, top, maps);
    if (touched) {
        // Without the unit of T: the sums keep their digits where T itself is too small for a float.
        float* sums[3] = {maps.column.data(), maps.mean.data(), maps.deviation.data()};
        for (std::size_t n = 0; n < 3; ++n)
            kernels.finish_tile(tile.sum[n], frame, 1, !first, sums[n]);
    }
    if (last) finish(loops, shown, frame, model.unit, left, top, maps);
}

/// Maps of a field of Gaussians, all of them.
void draw_maps(const Gaussians& gaussians, const FieldChoice& choice, const CameraFrame& frame,
               const SplatOptions& options, const GaussianClip& clip, float cutoff,
               FieldMaps& maps) {
    const ShownField shown = shown_field(gaussians, choice, frame, double{cutoff});
    const FieldPolynomials polynomials{fit_kernel(double{cutoff}),
                                       fit_chord_variance(double{cutoff})};
    const SplatModel model{&gaussians, unit_of(gaussians), cutoff, pixel_limits(double{cutoff}),
                           &polynomials.kernel};
    const SplatKernels& kernels =
        options.simd_target.empty() ? best_splat_kernels() : splat_kernels(options.simd_target);
    const int width = frame.width, height = frame.height;
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    const std::size_t size = gaussians.size(), batch = TileBins::most_splats(width, height);
    maps.width = width, maps.height = height;
    for (std::vector<float>* map : {&maps.column, &maps.mean, &maps.deviation}) {
        map->resize(pixels);
        if (size > batch) std::ranges::fill(*map, 0.0f);  // tiles of several batches are added up
    }
    const SplatClip kept{clip, model, frame};
    Picture picture{gaussians, shown, frame, model, polynomials, kernels, kept, maps};
    std::size_t first = 0;
    do {
        const std::size_t last = std::min(first + batch, size);
        picture.add(first, last);
        if (options.progress)
            options.progress(size > 0 ? static_cast<double>(last) / static_cast<double>(size) : 1);
        first = last;
    } while (first < size);
}

}  // namespace

void render_field_splat(const Gaussians& gaussians, const FieldChoice& choice, const Camera& camera,
                        int width, int height, const SplatOptions& options, FieldMaps& maps,
                        CutReport* report, const Clipping& clip) {
    const CameraFrame world_frame = frame_of(camera, width, height);
    check(options, width, height);
    validate(gaussians);
    const double cutoff = cutoff_of_kappa(options.kappa, gaussians.cutoff);
    std::optional<ViewCut> cut;
    if (options.hierarchy) cut.emplace(gaussians, *options.hierarchy, cutoff);
    const Gaussians& drawn = cut ? cut->choose(world_frame, options.cut) : gaussians;
    if (report) *report = cut ? cut->report() : CutReport{0, 0, gaussians.size()};
    const CameraFrame frame = relative_to(world_frame, gaussians.origin);
    const GaussianClip kept(clip, drawn, cutoff);
    const auto draw = [&](FieldPart part, const Progress& progress, FieldMaps& to) {
        SplatOptions own = options;
        own.progress = progress;
        draw_maps(drawn, {choice.field, part}, frame, own, kept, static_cast<float>(cutoff), to);
    };
    if (choice.part != FieldPart::magnitude) return draw(choice.part, options.progress, maps);
    maps = magnitude_maps(options.progress, [&](FieldPart part, const Progress& progress) {
        FieldMaps of_part;
        draw(part, progress, of_part);
        return of_part;
    });
}

FieldMaps render_field_splat(const Gaussians& gaussians, const FieldChoice& choice,
                             const Camera& camera, int width, int height,
                             const SplatOptions& options, CutReport* report, const Clipping& clip) {
    FieldMaps maps;
    render_field_splat(gaussians, choice, camera, width, height, options, maps, report, clip);
    return maps;
}

}  // namespace vog
