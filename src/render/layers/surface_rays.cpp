// surface_rays.cpp: rays through triangles by Embree 3, and through planes.
#include "render/layers/surface_rays.h"

#include <embree3/rtcore.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "render/slice/slice_points.h"
#include "vog/error.h"

namespace vog::layers {

using reference::LitPiece, reference::Segment;

namespace {

constexpr SurfaceBvh::Color kGrey{0.8f, 0.8f, 0.8f};

Vec3d corner_of(const Surface& surface, std::size_t triangle, std::size_t corner) {
    return surface.point[surface.triangle[triangle][corner]];
}
/// Of twice the triangle's area.
Vec3d normal_of(const Surface& surface, std::size_t triangle) {
    const Vec3d a = corner_of(surface, triangle, 0);
    return cross(corner_of(surface, triangle, 1) - a, corner_of(surface, triangle, 2) - a);
}

}  // namespace

struct SurfaceBvh::Embree {
    RTCDevice device = rtcNewDevice(nullptr);
    RTCScene scene = rtcNewScene(device);
    ~Embree() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
};

SurfaceBvh::SurfaceBvh(std::shared_ptr<const Surface> surface) : surface_(std::move(surface)) {
    const Surface& s = *surface_;
    for (const auto& triangle : s.triangle)
        for (const std::uint32_t p : triangle)
            if (p >= s.point.size() || !finite(s.point[p]))
                throw Error(
                    fmt::format("surface: a triangle of point {}, expected finite points, 0 to {}",
                                p, s.point.size() - 1));
    for (const Vec3d& point : s.point)
        if (finite(point)) box_.include(point);
    center_ = box_.empty() ? Vec3d{} : box_.center();
    radius_ = std::max(box_.empty() ? 0.0 : box_.radius(), 1e-300);
    normal_.resize(s.point.size());
    std::vector<Vec3d> sums(s.point.size());
    for (std::size_t n = 0; n < s.triangle.size(); ++n)
        for (const std::uint32_t p : s.triangle[n])
            sums[p] = sums[p] + (1 / radius_ / radius_) * normal_of(s, n);
    for (std::size_t p = 0; p < sums.size(); ++p)
        if (const double size = length(sums[p]); size > 0)
            normal_[p] = vec_cast<float>((1 / size) * sums[p]);
    vog::parallel_for(0, 1, [](int) {});  // before Embree's loops (trace_bvh.cpp)
    embree_ = std::make_unique<Embree>();
    rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), s.point.size()));
    auto* corners = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), s.triangle.size()));
    if (points && corners) {
        for (const Vec3d& point : s.point)
            for (int axis = 0; axis < 3; ++axis)
                *points++ = static_cast<float>((point[axis] - center_[axis]) / radius_);
        for (const auto& triangle : s.triangle) corners = std::ranges::copy(triangle, corners).out;
        rtcCommitGeometry(geometry);
        rtcAttachGeometry(embree_->scene, geometry);
        rtcCommitScene(embree_->scene);
    }
    rtcReleaseGeometry(geometry);
    if (const RTCError code = rtcGetDeviceError(embree_->device); code != RTC_ERROR_NONE)
        throw Error(fmt::format("surface: Embree error {}", static_cast<int>(code)));
}
SurfaceBvh::~SurfaceBvh() = default;

std::optional<SurfaceBvh::Hit> SurfaceBvh::hit(Vec3d origin, Vec3d direction,
                                               Segment within) const {
    // In radii from the middle, from a point beside the triangles: 32-bit floats are fine there.
    const double speed = length(direction) / radius_;
    const Vec3d from = (1 / radius_) * (origin - center_),
                along = (1 / length(direction)) * direction;
    const double nearest = -dot(from, along);
    // Far beside the triangles, which lie within a radius of the middle.
    if (!(length(from + nearest * along) < 2)) return {};
    const double start = std::max(within.first, (nearest - 2) / speed);
    // Behind them, or so far away that doubles lose them: Embree ends the program for such rays.
    if (!(std::abs(start * speed - nearest) < 3)) return {};
    const Vec3f at = vec_cast<float>(from + start * speed * along), to = vec_cast<float>(along);
    RTCRayHit ray{};
    ray.ray.org_x = at.x, ray.ray.org_y = at.y, ray.ray.org_z = at.z;
    ray.ray.dir_x = to.x, ray.ray.dir_y = to.y, ray.ray.dir_z = to.z;
    ray.ray.tfar = static_cast<float>((within.last - start) * speed);
    ray.ray.mask = ~0u;
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    if (!(ray.ray.tfar > 0)) return {};
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(embree_->scene, &context, &ray);
    if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    const Surface& s = *surface_;
    const std::size_t n = ray.hit.primID;
    const Vec3d normal = normal_of(s, n);
    const double size = length(normal), slope = dot(normal, direction);
    Hit hit{start + double{ray.ray.tfar} / speed, {}, kGrey};
    if (std::abs(slope) > 1e-3 * size * length(direction))
        hit.t = dot(normal, corner_of(s, n, 0) - origin) / slope;
    constexpr double kCrease = 0.766;  // cos 40 degrees
    const double u = double{ray.hit.u}, v = double{ray.hit.v}, share[3] = {1 - u - v, u, v};
    if (!s.color.empty()) hit.color = {};
    for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t p = s.triangle[n][c];
        const Vec3d smooth = vec_cast<double>(normal_[p]), flat = (1 / size) * normal;
        hit.normal = hit.normal + share[c] * (dot(smooth, flat) > kCrease ? smooth : flat);
        if (s.color.empty()) continue;
        for (std::size_t k = 0; k < 3; ++k)
            hit.color[k] += static_cast<float>(share[c]) * s.color[p][k];
    }
    return hit;
}

void SurfaceBvh::add_extinction(double depth, lights::ExtinctionLattice& lattice) const {
    const double extinction = depth / lattice.edge;
    for (std::size_t n = 0; n < surface_->triangle.size(); ++n) {
        const Vec3d a = corner_of(*surface_, n, 0), u = corner_of(*surface_, n, 1) - a,
                    v = corner_of(*surface_, n, 2) - a;
        const double longest = std::max({length(u), length(v), length(v - u)});
        // Points half a cell apart.
        const int steps = static_cast<int>(std::ceil(std::min(2 * longest / lattice.edge, 4096.0)));
        for (int i = 0; i <= steps; ++i)
            for (int j = 0; i + j <= steps; ++j) {
                const Vec3d place =
                    (1 / lattice.edge) * (a + (double(i) / std::max(steps, 1)) * u +
                                          (double(j) / std::max(steps, 1)) * v - lattice.first);
                // The cells around a point, by their shares: one alone lets slanted light pass between it and the next.
                for (int corner = 0; corner < 8; ++corner) {
                    int cell[3];
                    double share = extinction;
                    bool inside = true;
                    for (int axis = 0; axis < 3; ++axis) {
                        const double floor = std::floor(place[axis]);
                        const int step = corner >> axis & 1;
                        cell[axis] = static_cast<int>(floor) + step;
                        share *= step ? place[axis] - floor : 1 - (place[axis] - floor);
                        inside = inside && cell[axis] >= 0 && cell[axis] < lattice.size[axis];
                    }
                    if (!inside) continue;
                    const std::size_t to = lattice.at(cell[0], cell[1], cell[2]);
                    lattice.sum[to] = std::max(lattice.sum[to], share);
                    if (!lattice.whole.empty())
                        lattice.whole[to] = std::max(lattice.whole[to], share);
                }
            }
    }
}

namespace {

/// A look that shades surfaces: without a light of its own by one at the eye.
VolumeLook shaded(VolumeLook look) {
    look.light = true;
    return look;
}

}  // namespace

SurfaceRays::SurfaceRays(const SurfaceBvh& surface, std::optional<SurfaceBvh::Color> color,
                         double opacity, const VolumeLook& look,
                         const lights::Illumination& reached)
    : surface_(surface),
      color_(color),
      opacity_(opacity),
      lighting_(shaded(look)),
      lattice_(reached.lattice()) {
    lattice_.inside = 0;
}

void SurfaceRays::add(Vec3d origin, Vec3d direction, Segment& within,
                      std::vector<LitPiece>& pieces) const {
    const double stretch = length(direction);
    const Vec3d towards_eye = (-1 / stretch) * direction;
    const auto plain = [](Vec3d v) { return device::Double3{v.x, v.y, v.z}; };
    constexpr int kMostHits = 1000;
    Segment rest = within;
    for (int n = 0; n < kMostHits; ++n) {
        const auto hit = surface_.hit(origin, direction, rest);
        if (!hit) return;
        const device::ReachedLight reached =
            device::reached_at(lattice_, plain(origin + hit->t * direction), plain(towards_eye));
        const auto [body, shine] = lighting_(hit->normal, towards_eye, reached);
        const SurfaceBvh::Color color = color_.value_or(hit->color);
        const auto part = [&](std::size_t c) {
            return std::min(body * double{color[c]} + shine, 1.0);
        };
        reference::add_surface(hit->t, opacity_, {0, part(0), part(1), part(2)}, stretch, within,
                               pieces);
        if (opacity_ >= 1) return;
        rest.first = hit->t + surface_.least_gap() / stretch;
    }
}

PlaneRays::PlaneRays(const ClipPlane& plane, std::vector<float> values,
                     const ValueTransfer& transfer, const CameraFrame& frame)
    : plane_(plane),
      values_(std::move(values)),
      pieces_of_(transfer),
      unit_distance_(transfer.unit_distance),
      frame_(frame) {}

void PlaneRays::add(Vec3d origin, Vec3d direction, Segment& within,
                    std::vector<LitPiece>& pieces) const {
    const double slope = dot(plane_.normal, direction);
    const double t = (plane_.offset - dot(plane_.normal, origin)) / slope;
    if (slope == 0 || !(t > within.first && t < within.last)) return;
    const auto pixel = slices::SlicePoints(frame_, plane_, {}).pixel_of(origin + t * direction);
    if (!pixel) return;
    const auto column = std::clamp(std::lround(pixel->column), 0l, frame_.width - 1l);
    const auto row = std::clamp(std::lround(pixel->row), 0l, frame_.height - 1l);
    const double value = double{values_[static_cast<std::size_t>(row * frame_.width + column)]};
    if (std::isnan(value)) return;
    const ValueLight light = pieces_of_(value);
    if (!(light.extinction > 0)) return;
    const double opacity = -std::expm1(-light.extinction * unit_distance_);
    reference::add_surface(t, opacity > kMostOpacity - 1e-5 ? 1 : opacity, light, length(direction),
                           within, pieces);
}

}  // namespace vog::layers
