// ray_light.h: Light along a ray from pieces of constant extinction and colour.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "render/reference/hierarchical_dda.h"
#include "vog/value_transfer.h"

namespace vog::reference {

/// Light along a ray, front to back.
struct Compositor {
    // A ray ends at a ten-thousandth of a display step: less than the promised 1e-6.
    static constexpr double kOpaque = 1e-4 / 255;

    double r = 0, g = 0, b = 0, transmittance = 1;

    bool opaque() const { return transmittance < kOpaque; }
    /// Adds a piece of constant extinction and colour.
    /// depth  its extinction times its length
    void add(double depth, double red, double green, double blue) {
        const double passed = std::exp(-depth), weight = transmittance * (1 - passed);
        r += weight * red, g += weight * green, b += weight * blue;
        transmittance *= passed;
    }
};

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
