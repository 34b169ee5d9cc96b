// ray_light.h: Light along a ray from pieces of constant extinction and colour.
#pragma once

#include <algorithm>
#include <limits>
#include <vector>

#include "render/device/voxels/ray_sums.h"
#include "render/reference/hierarchical_dda.h"
#include "vog/value_transfer.h"

namespace vog::reference {

/// Light along a ray, front to back.
using Compositor = device::RayLight;

/// Piece of a ray in one of several volumes.
struct LitPiece {
    Segment segment;
    ValueLight light;
};

/// Composites the pieces of several volumes; where they overlap, extinctions add up.
/// stretch  world units of one t
inline void composite(std::vector<LitPiece>& pieces, double stretch, Compositor& to) {
    std::sort(pieces.begin(), pieces.end(), [](const LitPiece& a, const LitPiece& b) {
        return a.segment.first < b.segment.first;
    });
    thread_local std::vector<LitPiece> active;
    active.clear();
    double at = 0;
    for (std::size_t next = 0; (next < pieces.size() || !active.empty()) && !to.opaque();) {
        if (active.empty()) at = pieces[next].segment.first;
        while (next < pieces.size() && pieces[next].segment.first <= at)
            active.push_back(pieces[next++]);
        double until = next < pieces.size() ? pieces[next].segment.first
                                            : std::numeric_limits<double>::infinity();
        double extinction = 0, r = 0, g = 0, b = 0;
        for (const LitPiece& piece : active) {
            const ValueLight& light = piece.light;
            until = std::min(until, piece.segment.last);
            extinction += light.extinction;
            r += light.extinction * light.r, g += light.extinction * light.g;
            b += light.extinction * light.b;
        }
        to.add(extinction * (until - at) * stretch, r / extinction, g / extinction, b / extinction);
        at = until;
        std::erase_if(active, [&](const LitPiece& piece) { return piece.segment.last <= at; });
    }
}

}  // namespace vog::reference
