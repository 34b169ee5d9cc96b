// lit_cells.cpp: pieces of rays through cells, cut where the transfer function has a point.
#include "render/reference/cells/lit_cells.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"

namespace vog::reference {

using namespace unstructured;

namespace {

/// Values of cells at their points: the mean of the cells there.
CellValues at_points(const CellRays& rays, const CellValues& values) {
    const Cells& cells = rays.cells();
    CellValues mean{values.name};
    mean.at_points = true;
    BigVector<float>& sum = mean.component.emplace_back(cells.points.size());
    std::vector<float> count(cells.points.size());
    for (const std::uint32_t n : rays.kept())
        for (std::uint64_t k = n ? cells.end[n - 1] : 0; k < cells.end[n]; ++k)
            sum[cells.corner[k]] += values.component.front()[n], ++count[cells.corner[k]];
    for (std::size_t n = 0; n < sum.size(); ++n)
        if (count[n] > 0) sum[n] /= count[n];
    return mean;
}

/// Mean gradient over each cell.
std::vector<Vec3f> gradients(const CellRays& rays, const CellValues& values) {
    const Cells& cells = rays.cells();
    std::vector<Vec3f> all(cells.size());
    vog::parallel_for(std::size_t{0}, rays.kept().size(), [&](std::size_t i) {
        const std::uint32_t n = rays.kept()[i];
        Shape shape = shape_of(cells, n);
        set_values(shape, cells, n, values);
        double whole = 0;
        Vec3d sum;
        for_each_tetrahedron(shape, [&](const std::array<const Corner*, 4>& c) {
            const auto edge = [&](std::size_t k) { return c[k]->place - c[0]->place; };
            const auto rise = [&](std::size_t k) { return c[k]->value[0] - c[0]->value[0]; };
            whole += six_volumes(c);
            sum = sum + rise(1) * cross(edge(2), edge(3)) + rise(2) * cross(edge(3), edge(1)) +
                  rise(3) * cross(edge(1), edge(2));
        });
        all[n] = vec_cast<float>(1 / whole * sum);
    });
    return all;
}

/// Divides the way between two values into parts so short that the light in the middle of each stands for the whole part.
/// part  called with shares of the way, [0, 1]
template <class Part>
void each_part(const std::vector<device::ValuePiece>& pieces, double from, double to,
               const Part& part) {
    if (from == to) return part(0.0, 1.0);
    const double low = std::min(from, to), high = std::max(from, to);
    auto piece = std::ranges::upper_bound(pieces, low, {}, &device::ValuePiece::start);
    if (piece != pieces.begin()) --piece;
    for (; piece != pieces.end() && piece->start < high; ++piece) {
        const double first = std::max(piece->start, low), last = std::min(piece->end, high);
        if (!(first < last) || piece->extinction == 0) continue;
        const bool constant = piece->extinction >= 0 && piece->color_slope[0] == 0 &&
                              piece->color_slope[1] == 0 && piece->color_slope[2] == 0;
        constexpr double kMost = 16;
        const double share = (last - first) / (piece->end - piece->start);
        const double count = constant ? 1 : std::clamp(std::ceil(kMost * share), 1.0, kMost);
        for (double n = 0; n < count; ++n) {
            const double a = (std::lerp(first, last, n / count) - from) / (to - from);
            const double b = (std::lerp(first, last, (n + 1) / count) - from) / (to - from);
            part(std::min(a, b), std::max(a, b));
        }
    }
}

}  // namespace

LitCells::LitCells(const CellRays& rays, const CellValues& values, const ValueTransfer& transfer,
                   const VolumeLook& look, const lights::Illumination& reached)
    : rays_(rays),
      values_(values),
      own_(&values == &rays.cells().density),
      light_(transfer, look, reached) {
    if (light_.has_gradients())
        gradient_ = gradients(rays, values.at_points ? values : at_points(rays, values));
}

void LitCells::add(Vec3d origin, Vec3d direction, Segment& within,
                   std::vector<LitPiece>& pieces) const {
    const WorldRay ray(origin, direction);
    thread_local std::vector<CellPiece> found;
    found.clear();
    rays_.add(origin, direction, within, found, &values_);
    for (const CellPiece& piece : found) {
        const double from = piece.first.value[0], to = piece.last.value[0];
        const auto gradient = [&] { return vec_cast<double>(gradient_[piece.cell]); };
        each_part(light_.pieces().pieces(), from, to, [&](double first, double last) {
            const CellPoint middle = piece.at(0.5 * (first + last));
            const auto t = [&](double share) {
                return std::lerp(piece.segment.first, piece.segment.last, share);
            };
            // Tangled cells have parts that count less than nothing: they are left out.
            if (!(middle.density >= 0)) return;
            light_.each_piece({t(first), t(last)}, middle.value[0], own_ ? 1 : middle.density, ray,
                              gradient, [&](Segment part, const ValueLight& light) {
                                  if (light.extinction > 0 && !part.empty())
                                      pieces.push_back({part, light});
                                  return true;
                              });
        });
    }
}

}  // namespace vog::reference
