// visibility.cpp: optical depth of columns by projecting mass onto bins, without rays.
#include "convert/moments/cut/visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "compare/error_views.h"
#include "core/parallel.h"

namespace vog::moments {

namespace {

/// At most 512 bins along an edge, of at least 4 voxels.
constexpr double kMostBins = 512, kLeastEdge = 4;

constexpr std::size_t kMostPieces = 4 << 20;

/// Pieces that a brick is divided into along an edge.
int pieces_of(const Brick& brick, double bin_edge) {
    const double fours = 0.5 * kLeafEdge * brick.spacing / bin_edge;
    return fours <= 1 ? 2 : 2 * static_cast<int>(std::ceil(fours));
}

}  // namespace

std::size_t VisibilityWeight::Direction::bin(Vec3i place) const {
    const std::int32_t steps = place[along];
    std::size_t bin = 0;
    for (int axis = 0, n = 0; axis < 3; ++axis) {
        if (axis == along) continue;
        const std::int32_t at =
            std::clamp(place[axis] - steps * step[axis] - first[n], 0, size[n] - 1);
        bin = bin * static_cast<std::size_t>(size[n]) + static_cast<std::size_t>(at);
        ++n;
    }
    return bin;
}

Vec3i VisibilityWeight::place_of(Vec3d index) const {
    Vec3i place;
    for (int axis = 0; axis < 3; ++axis)
        place[axis] =
            static_cast<std::int32_t>(std::floor((index[axis] + 0.5 - lower_[axis]) / edge_));
    return place;
}

std::vector<VisibilityWeight::Piece> VisibilityWeight::pieces(std::span<const Brick> bricks) const {
    std::vector<Piece> all;
    all.reserve(8 * bricks.size());
    for (const Brick& brick : bricks) {
        const int pieces = pieces_of(brick, edge_), half = pieces / 2;
        const double side = kLeafEdge * brick.spacing / pieces;
        const BrickSums sums = brick_sums(brick);
        for (int n = 0; n < pieces * pieces * pieces; ++n) {
            const Vec3i at{n / (pieces * pieces), n / pieces % pieces, n % pieces};
            const auto four =
                static_cast<std::size_t>(at.x / half * 4 + at.y / half * 2 + at.z / half);
            if (!(sums.fours[four].mass > 0)) continue;
            const Vec3d lower = cube_center(brick.origin, 0) + side * vec_cast<double>(at);
            all.push_back({place_of(lower + Vec3d{0.5 * side, 0.5 * side, 0.5 * side}),
                           static_cast<float>(sums.fours[four].mass / (half * half * half))});
        }
    }
    return all;
}

void VisibilityWeight::set_bins(std::span<const Piece> pieces, Direction& direction,
                                const Affine& map) const {
    direction.bins.assign(
        static_cast<std::size_t>(direction.size[0]) * static_cast<std::size_t>(direction.size[1]),
        0);
    for (const Piece& piece : pieces) direction.bins[direction.bin(piece.place)] += piece.mass;
    // Mass over the face of a bin is depth along an axis in voxels; a diagonal step is longer.
    const double step = length(map.linear * vec_cast<double>(direction.step));
    for (float& bin : direction.bins) bin *= static_cast<float>(step / (edge_ * edge_));
}

VisibilityWeight::VisibilityWeight(const LatticeField& field) {
    constexpr std::int32_t kMost = std::numeric_limits<std::int32_t>::max();
    Vec3d upper{-1.0 * kMost, -1.0 * kMost, -1.0 * kMost};  // beyond int32 in the last brick
    lower_ = {kMost, kMost, kMost};
    double largest = 1;
    for (const Brick& brick : field.bricks) {
        largest = std::max(largest, brick.spacing);
        for (int axis = 0; axis < 3; ++axis) {
            lower_[axis] = std::min(lower_[axis], brick.origin[axis]);
            upper[axis] = std::max(upper[axis], brick.origin[axis] + kLeafEdge * brick.spacing);
        }
    }
    if (field.bricks.empty()) return;
    const Vec3d size = upper - vec_cast<double>(lower_);
    // A sample of the largest brick at least, so that a brick has at most 8^3 pieces.
    edge_ = std::max({kLeastEdge, std::max({size.x, size.y, size.z}) / kMostBins, largest});
    // 8 pieces a brick are the fewest; only many large tiles have more than that and kMostPieces.
    const auto piece_count = [&] {
        std::size_t count = 0;
        for (const Brick& brick : field.bricks) {
            const auto pieces = static_cast<std::size_t>(pieces_of(brick, edge_));
            count += pieces * pieces * pieces;
        }
        return count;
    };
    while (piece_count() > std::max(kMostPieces, 8 * field.bricks.size())) edge_ *= 2;

    for (int n = 14; n < 27; ++n) {  // the 13 of 27 steps after (0, 0, 0)
        Direction direction;
        direction.step = {n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1};
        direction.along = direction.step.x ? 0 : direction.step.y ? 1 : 2;
        const auto bins = [&](int axis) {
            return static_cast<std::int32_t>(size[axis] / edge_) + 1;
        };
        for (int axis = 0, k = 0; axis < 3; ++axis) {
            if (axis == direction.along) continue;
            const std::int32_t shift = direction.step[axis] * (bins(direction.along) - 1);
            direction.first[k] = std::min(0, -shift);
            direction.size[k] = bins(axis) + std::abs(shift);
            ++k;
        }
        directions_.push_back(std::move(direction));
    }
    const std::vector<Piece> all = pieces(field.bricks);
    vog::parallel_for(std::size_t{0}, directions_.size(), [&](std::size_t n) {
        set_bins(all, directions_[n], field.world_from_index);
    });

    // The automatic extinction of pictures: the 99th percentile of non-zero T becomes 4.
    std::vector<float> depths;
    for (const Direction& direction : directions_)
        std::copy_if(direction.bins.begin(), direction.bins.end(), std::back_inserter(depths),
                     [](float depth) { return depth > 0; });
    if (depths.empty()) return;
    const auto high =
        depths.begin() + static_cast<std::ptrdiff_t>(0.99 * double(depths.size() - 1));
    std::nth_element(depths.begin(), high, depths.end());
    const float extinction = 4 / *high;
    for (Direction& direction : directions_)
        for (float& bin : direction.bins)  // most are empty
            bin = bin > 0 ? std::exp(-2 * extinction * bin) : 1;
}

double VisibilityWeight::operator()(Vec3d index) const {
    const Vec3i place = place_of(index);
    double sum = 0;
    for (const Direction& direction : directions_)
        sum += static_cast<double>(direction.bins[direction.bin(place)]);
    return comparison::kDepthErrorWeight + sum / static_cast<double>(directions_.size());
}

}  // namespace vog::moments
