// field_splat.cpp: Maps of a field by splatting: three sums a pixel over the same splats as T.
#include <fmt/core.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "render/clipping/clipped_gaussians.h"
#include "render/pixel_limits.h"
#include "render/splat/fields/field_planes.h"
#include "render/splat/fields/field_splat.h"
#include "render/splat/fields/projected_mean.h"
#include "render/splat/near_splats.h"
#include "render/splat/projected_splats.h"
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
    std::vector<std::uint32_t> whole,
        cut;  ///< splats of a tile that the clip leaves, and that it cuts
};

/// Scales the T of a splat.
/// returns  false where nothing is left, or its forms leave the range of floats
bool scale_depth(FarSplat& splat, double share) {
    constexpr double kLeast = 1e-6;
    if (!(share > kLeast)) return false;
    const auto by = static_cast<float>(1 / share);
    for (float* form : {&splat.ax, &splat.ay, &splat.a0, &splat.by, &splat.b0, &splat.cx, &splat.cy,
                        &splat.c0, &splat.dy, &splat.d0})
        *form *= by;
    splat.f0 *= by * by;
    splat.e02 *= by * by;
    return std::isfinite(splat.f0) && std::isfinite(splat.e02);
}

/// Peak of a splat that is not widened, in SplatModel::unit. Small ones have another than their Gaussian's, for their sum
/// over pixels (splat_widen-inl.h). e02 is 1 / (spread peak)², spread along the view; of parallel rays |W f|² / peak².
double peak_of(const FarSplat& splat, const Gaussians& gaussians, std::size_t i,
               const CameraFrame& frame) {
    const Vec3d scale = vec_cast<double>(gaussians.scale[i]);
    const Vec3d own = own_forward(gaussians, i, frame);
    const double root = std::sqrt(double{splat.e02});
    return frame.orthographic ? length(over(own, scale)) / root
                              : 1 / (length(times(own, scale)) * root);
}

/// One picture in progress.
struct Picture {
    const Gaussians& gaussians;
    const ShownField& shown;
    const CameraFrame& frame;  ///< relative to the model's origin
    const SplatModel& model;
    const FieldPolynomials& polynomials;
    const SplatKernels& kernels;
    const GaussianClip& clip;
    FieldMaps& maps;  ///< column, and in mean and deviation the other sums
    ProjectedSplats splats{};
    std::vector<std::uint8_t>
        cut{};  ///< [far splats] whether the clip cuts them; unused without a clip
    std::vector<PlaneSplat> planes{};
    std::vector<ViewSplat> views{};

    void add(std::size_t first, std::size_t last);
    void keep(SplatChunk& chunk);
    void add_cut(TileWork& work) const;
    void draw_tile(int t, bool first, bool last, TileWork& work) const;
};

/// Removes the splats that the clip hides, and marks those that it cuts.
void Picture::keep(SplatChunk& chunk) {
    std::erase_if(chunk.near,
                  [&](const NearSplat& splat) { return clip.of(splat.index) == Kept::none; });
    std::size_t kept = chunk.slot;
    for (std::size_t n = chunk.slot; n < chunk.slot + chunk.count; ++n) {
        const SplatOrigin origin = splats.origin[n];
        const Kept part = clip.of(origin.index);
        if (part == Kept::none) continue;
        FarSplat splat = splats.far[n];
        const bool is_point = part == Kept::part && origin.widened;
        if (is_point && !scale_depth(splat, clip.share_at_mean(origin.index, frame))) continue;
        splats.far[kept] = splat;
        splats.bounds[kept] = splats.bounds[n];
        splats.origin[kept] = origin;
        cut[kept] = part == Kept::part && !is_point;
        ++kept;
    }
    chunk.count = kept - chunk.slot;
}

/// Adds Gaussians first ... last - 1 to the sums.
void Picture::add(std::size_t first, std::size_t last) {
    splats.keep_origin = true;
    const std::size_t count = last - first;
    if (shown.along_rays)
        views.resize(std::max(views.size(), count));
    else
        planes.resize(std::max(planes.size(), count));
    if (!clip.empty()) cut.resize(std::max(cut.size(), count));
    const double share = model.limits.variance;
    splats.project(kernels, model, frame, first, last, [&](SplatChunk& chunk) {
        if (!clip.empty()) keep(chunk);
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

/// Adds splats that the clip cuts, ray by ray.
void Picture::add_cut(TileWork& work) const {
    for (const std::uint32_t n : work.cut) {
        const std::size_t i = splats.origin[n].index;
        NearSplat splat = near_splat(model, i, frame, whitening(gaussians, i));
        splat.bounds = splats.bounds[n];
        splat.density = peak_of(splats.far[n], gaussians, i, frame);
        add_near_field(splat, shown, gaussians, frame, double{model.cutoff}, &work.rays, work.sums);
    }
}

/// first, last  whether no other Gaussians came before, or follow
void Picture::draw_tile(int t, bool first, bool last, TileWork& work) const {
    FieldTile& tile = work.sums;
    bool has_rays = false;
    const auto find_rays = [&] {
        if (has_rays) return;
        has_rays = true;
        for (int y = 0; y < kTileHeight; ++y)
            for (int x = 0; x < kTileWidth; ++x) {
                const double column = tile.sum[0].column + x, row = tile.sum[0].row + y;
                work.rays.kept[y][x] =
                    clip.ray(frame.origin(column, row), frame.direction(column, row));
            }
    };
    for (TilePixels& sum : tile.sum) sum.column = splats.column_of(t), sum.row = splats.row_of(t);
    const FieldKernels& loops = field_kernels(kernels);
    const bool touched = splats.visit(t, frame, [&](const std::uint32_t* index, std::size_t count) {
        const FarSplat* far = splats.far.data();
        if (!clip.empty()) {
            work.whole.clear();
            work.cut.clear();
            for (std::size_t n = 0; n < count; ++n)
                (cut[index[n]] ? work.cut : work.whole).push_back(index[n]);
            if (!work.cut.empty()) find_rays();
            add_cut(work);
            index = work.whole.data(), count = work.whole.size();
        }
        if (shown.along_rays)
            loops.add_view(far, views.data(), index, count, polynomials, tile);
        else
            (frame.orthographic ? loops.add_parallel : loops.add_pinhole)(far, planes.data(), index,
                                                                          count, polynomials, tile);
    });
    const TileRays* rays = clip.empty() ? nullptr : &work.rays;
    if (rays && !splats.near.empty()) find_rays();
    for (const NearSplat& splat : splats.near)
        add_near_field(splat, shown, gaussians, frame, double{model.cutoff}, rays, tile);
    if (!touched && first && last) return clear(frame, splats.column_of(t), splats.row_of(t), maps);
    if (touched) {
        // Without the unit of T: the sums keep their digits where T itself is too small for a float.
        float* sums[3] = {maps.column.data(), maps.mean.data(), maps.deviation.data()};
        for (std::size_t n = 0; n < 3; ++n)
            kernels.finish_tile(tile.sum[n], frame, 1, !first, sums[n]);
    }
    if (last) finish(loops, shown, frame, model.unit, splats.column_of(t), splats.row_of(t), maps);
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
    Picture picture{gaussians, shown, frame, model, polynomials, kernels, clip, maps};
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
