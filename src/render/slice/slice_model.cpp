// slice_model.cpp: A model on a plane: the ellipses in which the plane cuts its Gaussians, added up at the points of pixels.
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/parallel.h"
#include "render/pixel_tiles.h"
#include "render/shown_field.h"
#include "render/slice/slice.h"
#include "render/slice/slice_points.h"

namespace vog {

using namespace slices;

namespace {

/// A Gaussian that the plane cuts, and the pixels that may lie on it.
struct CutGaussian {
    std::size_t index;
    int left, top, right, bottom;  ///< both ends included
};

/// Gaussians that a plane cuts.
class Cuts {
  public:
    Cuts(const Gaussians& gaussians, const SlicePoints& points, const ClipPlane& plane,
         double cutoff)
        : gaussians_(gaussians), points_(points), plane_(plane), cutoff_(cutoff) {}

    /// In the model's order, for any number of threads.
    std::vector<CutGaussian> all() const {
        using List = std::vector<CutGaussian>;
        return tbb::parallel_reduce(
            tbb::blocked_range<std::size_t>(0, gaussians_.size(), 1 << 14), List{},
            [&](const tbb::blocked_range<std::size_t>& range, List part) {
                for (std::size_t i = range.begin(); i < range.end(); ++i)
                    if (const auto cut = cut_of(i)) part.push_back(*cut);
                return part;
            },
            [](List a, const List& b) {
                a.insert(a.end(), b.begin(), b.end());
                return a;
            });
    }

  private:
    std::optional<CutGaussian> cut_of(std::size_t i) const {
        // x = mean + A y, |y| <= k; the plane is m . y = ahead, m = A^T n: a disc about y0.
        const Vec3d mean = vec_cast<double>(gaussians_.mean[i]);
        const Vec3d scale = vec_cast<double>(gaussians_.scale[i]);
        const double ahead = plane_.offset - dot(plane_.normal, mean);
        const double largest = std::max({scale.x, scale.y, scale.z});
        if (std::abs(ahead) >= cutoff_ * largest * length(plane_.normal)) return {};
        const Mat3 turn =
            gaussians_.axis_aligned() ? Mat3{} : matrix_from_quat(gaussians_.rotation[i]);
        const auto to_world = [&](Vec3d y) {
            return turn * Vec3d{scale.x * y.x, scale.y * y.y, scale.z * y.z};
        };
        const Vec3d own = transpose(turn) * plane_.normal;
        const Vec3d m{scale.x * own.x, scale.y * own.y, scale.z * own.z};
        const double m2 = dot(m, m), radius2 = cutoff_ * cutoff_ - ahead * ahead / m2;
        if (!(radius2 > 0)) return {};
        const Vec3d center = mean + to_world((ahead / m2) * m);
        const int least = std::abs(m.x) <= std::min(std::abs(m.y), std::abs(m.z)) ? 0
                          : std::abs(m.y) <= std::abs(m.z)                        ? 1
                                                                                  : 2;
        Vec3d axis;
        axis[least] = 1;
        const Vec3d first = normalized(cross(m, axis)), second = normalized(cross(m, first));
        const Vec3d u = std::sqrt(radius2) * to_world(first),
                    v = std::sqrt(radius2) * to_world(second);
        return within(i, {center - u - v, center + u - v, center - u + v, center + u + v});
    }
    /// Pixels between the corners of a parallelogram around the ellipse.
    std::optional<CutGaussian> within(std::size_t i, const std::array<Vec3d, 4>& corners) const {
        const int width = points_.frame().width, height = points_.frame().height;
        double left = width, right = -1, top = height, bottom = -1;
        for (const Vec3d& corner : corners) {
            const auto pixel = points_.pixel_of(corner);
            if (!pixel) return CutGaussian{i, 0, 0, width - 1, height - 1};
            left = std::min(left, pixel->column), right = std::max(right, pixel->column);
            top = std::min(top, pixel->row), bottom = std::max(bottom, pixel->row);
        }
        // Half a pixel of room for rounding.
        const CutGaussian cut{i, static_cast<int>(std::ceil(std::max(left - 0.5, 0.0))),
                              static_cast<int>(std::ceil(std::max(top - 0.5, 0.0))),
                              static_cast<int>(std::floor(std::min(right + 0.5, width - 1.0))),
                              static_cast<int>(std::floor(std::min(bottom + 0.5, height - 1.0)))};
        if (cut.left > cut.right || cut.top > cut.bottom) return {};
        return cut;
    }

    const Gaussians& gaussians_;
    const SlicePoints& points_;
    const ClipPlane& plane_;
    double cutoff_;
};

/// A picture in progress: a band of rows at a time.
struct SlicePicture {
    const Gaussians& gaussians;
    const ShownField* shown;  ///< null: density alone
    const SlicePoints& points;
    double cutoff;
    const std::vector<CutGaussian>& cuts;
    const ScalarField* labels;  ///< that `cuts` are sorted by; null: other values
    FieldMaps& maps;

    void draw_row(int row) const;
    void add(const CutGaussian& cut, int row, const std::vector<std::optional<Vec3d>>& at,
             std::vector<RaySums>& sums) const;
};

void SlicePicture::add(const CutGaussian& cut, int row, const std::vector<std::optional<Vec3d>>& at,
                       std::vector<RaySums>& sums) const {
    const Mat3 whiten = whitening(gaussians, cut.index);
    const Vec3d mean = vec_cast<double>(gaussians.mean[cut.index]);
    const double peak{gaussians.density[cut.index]}, most = cutoff * cutoff;
    const bool along_rays = shown && shown->along_rays;
    device::FieldPlane field{};
    if (shown && !along_rays) field = shown->plane(cut.index);
    for (int column = cut.left; column <= cut.right; ++column) {
        const auto n = static_cast<std::size_t>(column);
        if (!at[n]) continue;
        const Vec3d from = *at[n] - mean, white = whiten * from;
        const double q = dot(white, white);
        if (q > most) continue;
        const double weight = peak * std::exp(-0.5 * q);
        sums[n].column += weight;
        if (!shown) continue;
        if (along_rays)
            field =
                shown->plane_along(cut.index, normalized(points.frame().direction(column, row)));
        const double value = double{field.value} + dot(vec(field.gradient), from);
        sums[n].first += weight * value;
        sums[n].second += weight * (value * value + double{field.variance});
    }
}

void SlicePicture::draw_row(int row) const {
    const auto width = static_cast<std::size_t>(points.frame().width);
    std::vector<std::optional<Vec3d>> at(width);
    for (std::size_t n = 0; n < width; ++n) at[n] = points.at(static_cast<double>(n), row);
    std::vector<RaySums> sums(width), densest(labels ? width : 0);
    std::vector<double> of_others(densest.size());
    const CutGaussian* before = nullptr;
    const auto end_label = [&] {
        for (std::size_t n = 0; n < densest.size(); ++n) {
            if (sums[n].column > densest[n].column) std::swap(sums[n], densest[n]);
            of_others[n] += sums[n].column;
            sums[n] = {};
        }
    };
    for (const CutGaussian& cut : cuts) {
        if (row < cut.top || cut.bottom < row) continue;
        if (labels && before && labels->value[before->index] != labels->value[cut.index])
            end_label();
        add(cut, row, at, sums);
        before = &cut;
    }
    if (labels) end_label(), sums.swap(densest), of_others.resize(width);
    for (std::size_t n = 0; n < width; ++n) {
        const double reference = shown ? shown->reference_along(normalized(
                                             points.frame().direction(static_cast<double>(n), row)))
                                       : 0;
        const double column = sums[n].column + (labels ? of_others[n] : 0);
        set_pixel(maps, static_cast<std::size_t>(row) * width + n, sums[n], column, reference,
                  shown ? shown->unit : 0);
        float& mean = maps.mean[static_cast<std::size_t>(row) * width + n];
        if (labels) mean = std::rint(mean);
    }
}

}  // namespace

FieldMaps slice_model(const Gaussians& gaussians, const FieldChoice& choice, const Camera& camera,
                      int width, int height, const SliceOptions& options) {
    if (choice.part == FieldPart::magnitude)
        return magnitude_maps(options.progress, [&](FieldPart part, const Progress& progress) {
            SliceOptions one = options;
            one.progress = progress;
            return slice_model(gaussians, {choice.field, part}, camera, width, height, one);
        });
    validate(options.clip);
    const double cutoff = cutoff_of_kappa(options.kappa, double{gaussians.cutoff});
    const CameraFrame world = frame_of(camera, width, height);
    const CameraFrame frame = relative_to(world, gaussians.origin);
    const Clipping clip = relative_to(options.clip, gaussians.origin);
    const ClipPlane plane{options.plane.normal,
                          options.plane.offset - dot(options.plane.normal, gaussians.origin)};
    const SlicePoints points(frame, plane, clip);
    std::optional<ShownField> shown;
    if (!choice.field.empty()) shown = shown_field(gaussians, choice, frame, cutoff);
    std::vector<CutGaussian> cuts = Cuts(gaussians, points, plane, cutoff).all();
    const ScalarField* const labels =
        options.labels ? gaussians.fields.find_scalar(choice.field) : nullptr;
    if (labels)
        std::ranges::stable_sort(cuts, {},
                                 [&](const CutGaussian& cut) { return labels->value[cut.index]; });
    FieldMaps maps = empty_maps(width, height);
    const SlicePicture picture{gaussians, shown ? &*shown : nullptr, points, cutoff, cuts, labels,
                               maps};
    struct Nothing {};
    for_each_tile(
        PixelTiles{width, height, width, 1}, options.progress,
        [&](int, int row) {
            picture.draw_row(row);
            return Nothing{};
        },
        [](Nothing) {});
    return maps;
}

}  // namespace vog
