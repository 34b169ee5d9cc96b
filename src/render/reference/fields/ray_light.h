// ray_light.h: Light along a ray from pieces of constant extinction and colour, and what a ray meets as such pieces.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include "render/by_value/lighting.h"
#include "render/by_value/value_pieces.h"
#include "render/by_value/volume_image.h"
#include "render/device/voxels/ray_sums.h"
#include "render/light/illumination.h"
#include "render/reference/hierarchical_dda.h"
#include "render/reference/reference.h"
#include "render/shown_field.h"
#include "vog/value_transfer.h"
#include "vog/voxel_field.h"

namespace vog::reference {

/// Light along a ray, front to back.
using Compositor = device::RayLight;

/// Ray of a pixel.
struct WorldRay {
    Vec3d origin, direction;
    double stretch;     ///< world units of one t
    Vec3d towards_eye;  ///< unit length

    WorldRay(Vec3d from, Vec3d along)
        : origin(from),
          direction(along),
          stretch(length(along)),
          towards_eye((-1 / stretch) * along) {}
};

/// Light of a field's values: extinction per world unit and colour.
class FieldLight {
  public:
    /// reached  light at points of the world, which must outlive this
    FieldLight(const ValueTransfer& transfer, const VolumeLook& look,
               const lights::Illumination& reached)
        : pieces_(transfer), lighting_(look), lattice_(reached.lattice()), edge_(reached.edge()) {}

    const by_value::ValuePieces& pieces() const { return pieces_; }
    /// Whether light depends on the field's gradient.
    bool has_gradients() const { return lighting_.on() || pieces_.has_gradient(); }
    /// weight    factor of the extinction
    /// gradient  returns that of the field, world
    template <class Gradient>
    ValueLight lit(double value, double weight, const WorldRay& ray, double t,
                   const Gradient& gradient) const {
        ValueLight light = pieces_(value);
        light.extinction *= weight;
        if (!(light.extinction > 0)) return light;
        const Vec3d slope = has_gradients() ? gradient() : Vec3d{};
        if (pieces_.has_gradient()) light.extinction *= pieces_.factor(length(slope));
        if (!(light.extinction > 0) || !(lighting_.on() || lattice_.any())) return light;
        const device::ReachedLight reached = device::reached_at(
            lattice_, plain(ray.origin + t * ray.direction), plain(ray.towards_eye));
        const auto [body, shine] = lighting_(slope, ray.towards_eye, reached);
        for (double* c : {&light.r, &light.g, &light.b}) *c = std::min(body * *c + shine, 1.0);
        return light;
    }
    /// Calls visit(segment, light) for parts of a segment of one value, none longer than half a cell of the lattice, as long as it
    /// returns true.
    template <class Gradient, class Visit>
    bool each_piece(Segment whole, double value, double weight, const WorldRay& ray,
                    const Gradient& gradient, const Visit& visit) const {
        const double extent = whole.last - whole.first;
        const double count = std::ceil(std::max(2 * extent * ray.stretch / edge_, 1.0));
        for (double n = 0; n < count; ++n) {
            const Segment part{whole.first + n / count * extent,
                               n + 1 < count ? whole.first + (n + 1) / count * extent : whole.last};
            if (!visit(part, lit(value, weight, ray, 0.5 * (part.first + part.last), gradient)))
                return false;
        }
        return true;
    }

  private:
    by_value::ValuePieces pieces_;
    by_value::Lighting lighting_;
    device::LightLattice lattice_;
    double edge_;
};

/// Piece of a ray in one of several volumes.
struct LitPiece {
    Segment segment;
    ValueLight light;
};

/// Length of the piece of a surface, in shares of its t: short beside all others, which it hides.
inline constexpr double kSurfaceLength = 1e-9;
/// Whether a run is one of a surface.
inline bool is_surface(const Segment& run) {
    return run.last - run.first < 1.5 * kSurfaceLength * run.last;
}
/// Appends a surface; an opaque one ends the ray.
/// opacity  (0, 1]
/// color    its extinction has no effect
/// stretch  world units of one t
/// within   of the ray, ends with an opaque surface
inline void add_surface(double t, double opacity, ValueLight color, double stretch, Segment& within,
                        std::vector<LitPiece>& pieces) {
    constexpr double kOpaqueDepth = 40;
    const double extent = kSurfaceLength * t;
    const double depth = opacity < 1 ? std::min(-std::log1p(-opacity), kOpaqueDepth) : kOpaqueDepth;
    color.extinction = depth / (extent * stretch);
    pieces.push_back({{t, t + extent}, color});
    if (opacity >= 1) within.last = std::min(within.last, t);
}

/// What rays meet, as pieces of light.
class LitRays {
  public:
    virtual ~LitRays() = default;
    /// Appends the pieces on a ray, in any order.
    /// within  ends where nothing behind is visible
    virtual void add(Vec3d origin, Vec3d direction, Segment& within,
                     std::vector<LitPiece>& pieces) const = 0;
};

/// A field at the voxels of volumes as pieces of light.
class VoxelRays : public LitRays {
  public:
    /// volumes, fields  as of render_volume_reference; they must outlive this, as `reached` must
    /// reached          light at points of the world
    /// throws           vog::Error as render_volume_reference does
    VoxelRays(std::span<const Volume> volumes, std::span<const VoxelField> fields,
              const ValueTransfer& transfer, const VolumeLook& look,
              const lights::Illumination& reached, const VoxelGridOptions& voxels,
              const OtherVoxels& others = {});
    ~VoxelRays() override;
    VoxelRays(const VoxelRays&) = delete;
    VoxelRays& operator=(const VoxelRays&) = delete;

    void add(Vec3d origin, Vec3d direction, Segment& within,
             std::vector<LitPiece>& pieces) const override;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The picture of several such, exactly: extinctions add up. Clips as of render_volume_reference.
/// layers  surfaces first: what they hide takes no time. Of several processes the pieces of all make the picture of the root
[[nodiscard]] VolumeImage render_layers_reference(std::span<const std::unique_ptr<LitRays>> layers,
                                                  const Camera& camera, int width, int height,
                                                  const ReferenceOptions& options,
                                                  const VolumeLook& look);

/// Calls visit(segment, light) for runs of one light, front to back, until it returns false. Where pieces overlap, extinctions add up.
/// pieces  are sorted
template <class Visit>
void for_each_run_of_light(std::vector<LitPiece>& pieces, const Visit& visit) {
    std::sort(pieces.begin(), pieces.end(), [](const LitPiece& a, const LitPiece& b) {
        return a.segment.first < b.segment.first;
    });
    thread_local std::vector<LitPiece> active;
    active.clear();
    double at = 0;
    for (std::size_t next = 0; next < pieces.size() || !active.empty();) {
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
        if (!visit(Segment{at, until},
                   ValueLight{extinction, r / extinction, g / extinction, b / extinction}))
            return;
        at = until;
        std::erase_if(active, [&](const LitPiece& piece) { return piece.segment.last <= at; });
    }
}

/// Composites the pieces of several volumes.
/// stretch  world units of one t
inline void composite(std::vector<LitPiece>& pieces, double stretch, Compositor& to) {
    for_each_run_of_light(pieces, [&](const Segment& run, const ValueLight& light) {
        to.add(light.extinction * (run.last - run.first) * stretch, light.r, light.g, light.b);
        return !to.opaque();
    });
}

}  // namespace vog::reference
