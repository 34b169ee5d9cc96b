// surface_rays.h: Surfaces as pieces of rays that hide what lies behind: triangles, and planes with the values of a field.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "render/by_value/lighting.h"
#include "render/by_value/value_pieces.h"
#include "render/light/illumination.h"
#include "render/reference/fields/ray_light.h"
#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/surface.h"

namespace vog::layers {

/// Triangles in Embree's hierarchy.
class SurfaceBvh {
  public:
    using Color = std::array<float, 3>;
    struct Hit {
        double t;
        Vec3d
            normal;  ///< smooth where triangles meet at less than 40 degrees; of any length and side
        Color color;
    };

    /// throws  vog::Error for triangles of points that are not there or not finite
    explicit SurfaceBvh(std::shared_ptr<const Surface> surface);
    ~SurfaceBvh();
    SurfaceBvh(const SurfaceBvh&) = delete;
    SurfaceBvh& operator=(const SurfaceBvh&) = delete;

    /// The nearest triangle on a ray, exact on its plane.
    std::optional<Hit> hit(Vec3d origin, Vec3d direction, reference::Segment within) const;
    /// World units between two hits of a ray.
    double least_gap() const { return 1e-6 * radius_; }
    const Box& box() const { return box_; }
    /// Adds an optical depth over one cell to the cells that triangles pass.
    void add_extinction(double depth, lights::ExtinctionLattice& lattice) const;

  private:
    struct Embree;
    std::shared_ptr<const Surface> surface_;
    std::vector<Vec3f> normal_;  ///< [points]
    Box box_;
    Vec3d center_;
    double radius_;
    std::unique_ptr<Embree> embree_;
};

/// Triangles as opaque pieces of rays, lit by their normals: by the picture's light, or from the eye where it has none.
class SurfaceRays : public reference::LitRays {
  public:
    /// color  in place of those of the points
    SurfaceRays(const SurfaceBvh& surface, std::optional<SurfaceBvh::Color> color, double opacity,
                const VolumeLook& look, const lights::Illumination& reached);
    void add(Vec3d origin, Vec3d direction, reference::Segment& within,
             std::vector<reference::LitPiece>& pieces) const override;

  private:
    const SurfaceBvh& surface_;
    std::optional<SurfaceBvh::Color> color_;
    double opacity_;
    by_value::Lighting lighting_;
    device::LightLattice lattice_;
};

/// A plane with the values at the pixels of a picture, in their colours.
class PlaneRays : public reference::LitRays {
  public:
    /// values    [height * width] NaN where the plane has a hole
    /// transfer  whose opacities are those of the plane; 0 is a hole
    PlaneRays(const ClipPlane& plane, std::vector<float> values, const ValueTransfer& transfer,
              const CameraFrame& frame);
    void add(Vec3d origin, Vec3d direction, reference::Segment& within,
             std::vector<reference::LitPiece>& pieces) const override;

  private:
    ClipPlane plane_;
    std::vector<float> values_;
    by_value::ValuePieces pieces_of_;
    double unit_distance_;
    const CameraFrame& frame_;
};

}  // namespace vog::layers
