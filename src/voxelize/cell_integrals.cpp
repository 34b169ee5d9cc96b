// cell_integrals.cpp: integrals of one truncated Gaussian over the voxels of a box.
#include "voxelize/cell_integrals.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "vog/error.h"

namespace vog::voxelization {

namespace {

constexpr double kRootTwoPi = 2.50662827463100050242;

/// Gauss-Legendre rule on [-1, 1].
struct Rule {
    std::size_t count;
    std::array<double, 8> node, weight;
};
// Source: Abramowitz and Stegun, table 25.4.
constexpr Rule kRules[] = {
    {2, {-0.5773502691896257, 0.5773502691896257}, {1, 1}},
    {3,
     {-0.7745966692414834, 0, 0.7745966692414834},
     {0.5555555555555556, 0.8888888888888888, 0.5555555555555556}},
    {4,
     {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563, 0.8611363115940526},
     {0.3478548451374538, 0.6521451548625461, 0.6521451548625461, 0.3478548451374538}},
    {6,
     {-0.9324695142031521, -0.6612093864662645, -0.2386191860831969, 0.2386191860831969,
      0.6612093864662645, 0.9324695142031521},
     {0.1713244923791704, 0.3607615730481386, 0.4679139345726910, 0.4679139345726910,
      0.3607615730481386, 0.1713244923791704}},
    {8,
     {-0.9602898564975363, -0.7966664774136267, -0.5255324099163290, -0.1834346424956498,
      0.1834346424956498, 0.5255324099163290, 0.7966664774136267, 0.9602898564975363},
     {0.1012285362903763, 0.2223810344533745, 0.3137066458778873, 0.3626837833783620,
      0.3626837833783620, 0.3137066458778873, 0.2223810344533745, 0.1012285362903763}}};

/// Rule for a piece across which u changes by `change`: errors below 1e-5 of the piece's integral, of either sign.
const Rule& rule_for(double change) {
    return change < 0.35  ? kRules[0]
           : change < 0.8 ? kRules[1]
           : change < 1.2 ? kRules[2]
           : change < 2   ? kRules[3]
                          : kRules[4];
}
constexpr double kLongestPiece = 2.5;  // of u; longer ones are divided
// Kinks along u1, places where a face across another axis touches the slice, are weak: an area there sets in with power
// 3/2. Of up to 8 faces every kink ends a piece; with more of them pieces, then narrow, have at least the rule of 6 nodes.
// On the two models of docs/voxelize.md this is 1e-4 of relative L2 from pieces between all kinks, at a third of the time.
constexpr int kFewFaces = 8;
constexpr double kChangeWithKinks = 1.35;
// Where a slice is small the chords, cosines of the angle, set the rule: a quarter of a turn has 6 nodes, half a turn 8.
constexpr double kChangeByAngle = 0.78;

/// Calls visit(node, weight) for the nodes of the piece [a, b].
/// change  of u across the piece
template <class Visit>
void integrate(double a, double b, double change, const Visit& visit) {
    const int parts = std::max(1, static_cast<int>(std::ceil(change / kLongestPiece)));
    const Rule& rule = rule_for(change / parts);
    const double half = 0.5 * (b - a) / parts;
    for (int part = 0; part < parts; ++part)
        for (std::size_t n = 0; n < rule.count; ++n)
            visit(a + half * (2 * part + 1 + rule.node[n]), half * rule.weight[n]);
}

/// Appends the places p of [lower, upper] at which a line a p + b q = c meets the circle p^2 + q^2 = radius^2.
void add_meetings(double a, double b, double c, double radius, double lower, double upper,
                  std::vector<double>& places) {
    const double square = a * a + b * b;
    const double rest = radius * radius * square - c * c;
    if (!(rest > 0)) return;
    const double root = b * std::sqrt(rest);
    for (const double p : {(c * a - root) / square, (c * a + root) / square})
        if (p > lower && p < upper) places.push_back(p);
}

/// Ends of pieces: `faces`, ascending, and the kinks between them that lie farther than kNear from the one before and
/// from the next face. A kink that is left out is one of a piece shorter than that.
/// kinks  is sorted
void merge_ends(std::span<const double> faces, std::vector<double>& kinks,
                std::vector<double>& ends) {
    constexpr double kNear = 0.005;
    std::ranges::sort(kinks);
    ends.assign(1, faces.front());
    std::size_t kink = 0;
    for (const double face : faces.subspan(1)) {
        for (; kink < kinks.size() && kinks[kink] < face; ++kink)
            if (kinks[kink] > ends.back() + kNear && kinks[kink] < face - kNear)
                ends.push_back(kinks[kink]);
        ends.push_back(face);
    }
}

/// Voxel of an index coordinate.
int voxel_of(double x) { return static_cast<int>(std::floor(x + 0.5)); }

}  // namespace

NormalTable::NormalTable() {
    for (std::size_t n = 0; n < kSize; ++n) {
        const double t = static_cast<double>(n) / kPerUnit;
        node_[n].value = 0.5 * std::erfc(t / std::numbers::sqrt2);
        node_[n].slope = -std::exp(-0.5 * t * t) / (kRootTwoPi * kPerUnit);
    }
}

IndexGaussian index_gaussian(const Gaussians& model, std::size_t i,
                             const Affine& index_from_world) {
    IndexGaussian result;
    result.cutoff = model.cutoff;
    const Vec3d s = vec_cast<double>(model.scale[i]);
    result.weight = double{model.density[i]} * s.x * s.y * s.z;
    result.box = {{0, 0, 0}, {-1, -1, -1}};
    if (!(result.weight > 0)) return result;
    // Rows of B = L R diag(s): index coordinates of u.
    const Mat3 rotation = model.axis_aligned() ? Mat3{} : matrix_from_quat(model.rotation[i]);
    const Mat3 turned = index_from_world.linear * rotation;
    std::array<Vec3d, 3> row;
    for (int axis = 0; axis < 3; ++axis) {
        const Vec3d r = turned.row[static_cast<std::size_t>(axis)];
        row[static_cast<std::size_t>(axis)] = {r.x * s.x, r.y * s.y, r.z * s.z};
    }
    const Vec3d center = index_from_world(world_mean(model, i));
    constexpr double kFarthest = 1 << 30;
    for (int axis = 0; axis < 3; ++axis) {
        const double extent = result.cutoff * length(row[static_cast<std::size_t>(axis)]);
        const double lower = center[axis] - extent, upper = center[axis] + extent;
        if (!(lower > -kFarthest && upper < kFarthest))
            throw Error(fmt::format(
                "{}: Gaussian {} lies at voxels {:.4g} to {:.4g} along {}, expected indices within "
                "2^30: a larger voxel size",
                model.source.empty() ? "model" : model.source, i, lower, upper, "xyz"[axis]));
        result.box.lower[axis] = voxel_of(lower);
        result.box.upper[axis] = voxel_of(upper);
    }

    // Narrowest: the axis with the largest |row of B^-T|, one over the standard deviation at fixed other coordinates.
    const std::array<Vec3d, 3> dual{cross(row[1], row[2]), cross(row[2], row[0]),
                                    cross(row[0], row[1])};
    int inner = 0;
    for (int axis = 1; axis < 3; ++axis)
        if (length(dual[static_cast<std::size_t>(axis)]) >
            length(dual[static_cast<std::size_t>(inner)]))
            inner = axis;
    int outer = (inner + 1) % 3, middle = (inner + 2) % 3;
    if (length(row[static_cast<std::size_t>(outer)]) <
        length(row[static_cast<std::size_t>(middle)]))
        std::swap(outer, middle);
    result.axis = {outer, middle, inner};
    for (std::size_t n = 0; n < 3; ++n) result.center[n] = center[result.axis[n]];

    // B = G Q, rows made orthogonal in turn; a row that lies in those before it keeps a part of 1e-12.
    constexpr double kLeast = 1e-12;
    const Vec3d b1 = row[static_cast<std::size_t>(outer)],
                b2 = row[static_cast<std::size_t>(middle)],
                b3 = row[static_cast<std::size_t>(inner)];
    result.g11 = length(b1);
    const Vec3d q1 = (1 / result.g11) * b1;
    result.g21 = dot(b2, q1);
    const Vec3d r2 = b2 - result.g21 * q1;
    result.g22 = std::max(length(r2), kLeast * length(b2));
    const Vec3d q2 = (1 / result.g22) * r2;
    result.g31 = dot(b3, q1);
    result.g32 = dot(b3, q2);
    result.g33 = std::max(length(b3 - result.g31 * q1 - result.g32 * q2), kLeast * length(b3));
    return result;
}

void field_planes(const Gaussians& model, std::size_t i, const Affine& world_from_index,
                  const IndexGaussian& gaussian, std::vector<IndexGaussian::Plane>& planes) {
    planes.clear();
    const auto add = [&](float value, Vec3f gradient) {
        // Change by index coordinate, in the order of integration, then by u: G^T.
        const Vec3d by_index = transpose(world_from_index.linear) * vec_cast<double>(gradient);
        const double d1 = by_index[gaussian.axis[0]], d2 = by_index[gaussian.axis[1]],
                     d3 = by_index[gaussian.axis[2]];
        planes.push_back({value,
                          {d1 * gaussian.g11 + d2 * gaussian.g21 + d3 * gaussian.g31,
                           d2 * gaussian.g22 + d3 * gaussian.g32, d3 * gaussian.g33}});
    };
    for (const ScalarField& field : model.fields.scalar)
        if (!field.is_measure) add(field.value[i], field.gradient[i]);
    for (const VectorField& field : model.fields.vector)
        for (int axis = 0; axis < 3; ++axis)
            add(field.value[i][axis], field.gradient[static_cast<std::size_t>(axis)][i]);
}

/// Gaussian and box of one call of CellSums::add.
struct CellSums::Frame {
    const IndexGaussian& gaussian;
    std::span<const IndexGaussian::Plane> planes;
    const NormalTable& normal;
    std::array<int, 3> lower, upper;       ///< box, in the order of integration
    std::array<int, 3> first, last;        ///< voxels of the whole support, likewise
    std::array<std::ptrdiff_t, 3> stride;  ///< of the sums, likewise
    std::ptrdiff_t base;                   ///< place of voxel `lower`
};

CellSums::CellSums(Vec3i size, std::size_t channels)
    : size_(size),
      voxels_(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y) *
              static_cast<std::size_t>(size.z)),
      channels_(channels),
      sums_(voxels_ * channels) {}

void CellSums::clear(Vec3i lower) {
    lower_ = lower;
    std::ranges::fill(sums_, 0.0);
}

void CellSums::add(const IndexGaussian& gaussian, std::span<const IndexGaussian::Plane> planes,
                   const IndexBox& box, const NormalTable& normal) {
    const std::array<std::ptrdiff_t, 3> stride{std::ptrdiff_t{size_.y} * size_.z, size_.z, 1};
    Frame frame{gaussian, planes, normal, {}, {}, {}, {}, {}, 0};
    bool one_voxel = true;
    for (std::size_t n = 0; n < 3; ++n) {
        const int axis = gaussian.axis[n];
        frame.first[n] = gaussian.box.lower[axis];
        frame.last[n] = gaussian.box.upper[axis];
        frame.lower[n] = std::max(frame.first[n], box.lower[axis]);
        frame.upper[n] = std::min(frame.last[n], box.upper[axis]);
        if (frame.lower[n] > frame.upper[n]) return;
        frame.stride[n] = stride[static_cast<std::size_t>(axis)];
        frame.base += (frame.lower[n] - lower_[axis]) * frame.stride[n];
        one_voxel = one_voxel && frame.first[n] == frame.last[n];
    }
    const double k = gaussian.cutoff;
    if (one_voxel) {  // the whole mass; first moments are 0
        const double mass = gaussian.weight * kRootTwoPi * kRootTwoPi * kRootTwoPi * mass_within(k);
        double* const sum = sums_.data() + frame.base;
        *sum += mass;
        for (std::size_t c = 0; c < planes.size(); ++c)
            sum[(c + 1) * voxels_] += planes[c].value * mass;
        return;
    }

    // Pieces of u1: between faces across axis 1, and where faces across the others touch the support's slice.
    const double least = std::max(-k, (frame.lower[0] - 0.5 - gaussian.center[0]) / gaussian.g11);
    const double most = std::min(k, (frame.upper[0] + 0.5 - gaussian.center[0]) / gaussian.g11);
    if (!(least < most)) return;
    faces_.assign(1, least);
    for (int face = frame.lower[0]; face < frame.upper[0]; ++face) {
        const double u1 = (face + 0.5 - gaussian.center[0]) / gaussian.g11;
        if (u1 > least && u1 < most) faces_.push_back(u1);
    }
    faces_.push_back(most);
    kinks_.clear();
    const double width3 = std::hypot(gaussian.g32, gaussian.g33);
    const int across = frame.last[1] - frame.first[1] + frame.last[2] - frame.first[2];
    const bool few = across <= kFewFaces;
    if (few) {
        for (int face = frame.first[1]; face < frame.last[1]; ++face)
            add_meetings(gaussian.g21, gaussian.g22, face + 0.5 - gaussian.center[1], k, least,
                         most, kinks_);
        for (int face = frame.first[2]; face < frame.last[2]; ++face)
            add_meetings(gaussian.g31, width3, face + 0.5 - gaussian.center[2], k, least, most,
                         kinks_);
    }
    merge_ends(faces_, kinks_, outer_);
    // A face at a slant crosses the slice while u1 changes by the slice's width over the slant.
    const double slant = std::max(
        {1.0, std::abs(gaussian.g21) / gaussian.g22, std::abs(gaussian.g31) / gaussian.g33});
    for (std::size_t n = 0; n + 1 < outer_.size(); ++n) {
        const double step = outer_[n + 1] - outer_[n];
        if (!(step > 0)) continue;
        const double change = std::max(step, std::min(step * slant, kLongestPiece));
        integrate(
            outer_[n], outer_[n + 1], few ? change : std::max(change, kChangeWithKinks),
            [&](double u1, double weight) { add_slice(frame, u1, gaussian.weight * weight); });
    }
}

void CellSums::add_slice(const Frame& frame, double u1, double weight) {
    const IndexGaussian& g = frame.gaussian;
    const int x1 = std::clamp(voxel_of(g.center[0] + g.g11 * u1), frame.lower[0], frame.upper[0]);
    const std::ptrdiff_t at = frame.base + (x1 - frame.lower[0]) * frame.stride[0];
    const double radius = std::sqrt(std::max(0.0, g.cutoff * g.cutoff - u1 * u1));
    if (!(radius > 0)) return;
    const double m2 = g.center[1] + g.g21 * u1, m3 = g.center[2] + g.g31 * u1;
    // Pieces of u2, in its angle u2 = radius sin(angle): there the chord's length has no root at its ends.
    const double least = std::max(-radius, (frame.lower[1] - 0.5 - m2) / g.g22);
    const double most = std::min(radius, (frame.upper[1] + 0.5 - m2) / g.g22);
    if (!(least < most)) return;
    faces_.assign(1, least);
    const int first2 = std::max(frame.lower[1], voxel_of(m2 + g.g22 * least));
    const int last2 = std::min(frame.upper[1], voxel_of(m2 + g.g22 * most));
    for (int face = first2; face < last2; ++face) {
        const double u2 = (face + 0.5 - m2) / g.g22;
        if (u2 > least && u2 < most) faces_.push_back(u2);
    }
    faces_.push_back(most);
    // Faces across axis 3 that meet the slice at all.
    kinks_.clear();
    const double reach = radius * std::hypot(g.g32, g.g33);
    const int first3 = std::max(frame.first[2], voxel_of(m3 - reach)),
              last3 = std::min(frame.last[2], voxel_of(m3 + reach));
    for (int face = first3; face < last3; ++face)
        add_meetings(g.g32, g.g33, face + 0.5 - m3, radius, least, most, kinks_);
    merge_ends(faces_, kinks_, inner_);
    const double slant = first3 < last3 ? std::abs(g.g32) / g.g33 : 0;
    for (std::size_t n = 0; n + 1 < inner_.size(); ++n) {
        const double from = inner_[n], to = inner_[n + 1], step = to - from;
        if (!(step > 0)) continue;
        const double middle = 0.5 * (from + to);
        const int x2 = std::clamp(voxel_of(m2 + g.g22 * middle), frame.lower[1], frame.upper[1]);
        const std::ptrdiff_t line = at + (x2 - frame.lower[1]) * frame.stride[1];
        const double change = std::max(step, std::min(step * slant, kLongestPiece));
        // The chord's length is a root at u2 = +-radius: near them by the angle of u2 = radius sin(angle).
        if (radius - std::abs(middle) > 1.5 * step) {
            integrate(from, to, change, [&](double u2, double part) {
                add_line(frame, u1, u2, weight * part, line);
            });
            continue;
        }
        const double least_angle = std::asin(std::clamp(from / radius, -1.0, 1.0));
        const double most_angle = std::asin(std::clamp(to / radius, -1.0, 1.0));
        const double turn = most_angle - least_angle;
        integrate(least_angle, most_angle, std::max({change, radius * turn, kChangeByAngle * turn}),
                  [&](double angle, double part) {
                      add_line(frame, u1, radius * std::sin(angle),
                               weight * part * radius * std::cos(angle), line);
                  });
    }
}

void CellSums::add_line(const Frame& frame, double u1, double u2, double weight,
                        std::ptrdiff_t at) {
    const IndexGaussian& g = frame.gaussian;
    const double square = u1 * u1 + u2 * u2;
    const double half = std::sqrt(std::max(0.0, g.cutoff * g.cutoff - square));
    weight *= std::exp(-0.5 * square);
    const double m3 = g.center[2] + g.g31 * u1 + g.g32 * u2;
    const int first = std::max(frame.lower[2], voxel_of(m3 - g.g33 * half));
    const int last = std::min(frame.upper[2], voxel_of(m3 + g.g33 * half));
    if (first > last) return;
    const double per_u3 = 1 / g.g33;
    double from = std::clamp((first - 0.5 - m3) * per_u3, -half, half);
    double tail_from = frame.normal.tail(from);
    const double scale = weight * kRootTwoPi;
    double* sum = sums_.data() + at + (first - frame.lower[2]) * frame.stride[2];
    for (int x3 = first; x3 <= last; ++x3, sum += frame.stride[2]) {
        const double to = std::clamp((x3 + 0.5 - m3) * per_u3, -half, half);
        const double tail_to = frame.normal.tail(to);
        const double mass =
            scale * std::max(0.0, tail_to - tail_from + (from < 0 && to >= 0 ? 1.0 : 0.0));
        *sum += mass;
        if (channels_ > 1) {
            const double moment =
                weight * (std::exp(-0.5 * from * from) - std::exp(-0.5 * to * to));
            for (std::size_t c = 0; c < frame.planes.size(); ++c) {
                const IndexGaussian::Plane& plane = frame.planes[c];
                sum[(c + 1) * voxels_] +=
                    (plane.value + plane.slope[0] * u1 + plane.slope[1] * u2) * mass +
                    plane.slope[2] * moment;
            }
        }
        from = to;
        tail_from = tail_to;
    }
}

}  // namespace vog::voxelization
