// cell_rays.cpp: cells whose boxes a ray meets, by Embree; the part of the ray in each of their tetrahedra, in double precision.
#include "render/reference/cells/cell_rays.h"

#include <embree3/rtcore.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "render/reference/reference_grid.h"
#include "vog/error.h"

namespace vog::reference {

using namespace unstructured;

namespace {

struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

/// Indices of the primitives whose boxes the ray meets, behind the context that Embree passes to its callbacks.
struct Query : RTCIntersectContext {
    std::vector<unsigned> found;
};

void collect(const RTCOccludedFunctionNArguments* args) {
    if (*args->valid) static_cast<Query*>(args->context)->found.push_back(args->primID);
}

}  // namespace

struct CellRays::Embree {
    const Cells& cells;
    std::span<const std::uint32_t> kept;
    Vec3d centre{};
    double radius = 0;
    std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release> device{rtcNewDevice(nullptr)};
    std::unique_ptr<std::remove_pointer_t<RTCScene>, Release> scene{rtcNewScene(device.get())};

    /// Box of a cell, wider by the rounding of floats.
    static void bounds_of(const RTCBoundsFunctionArguments* args) {
        const auto& of = *static_cast<const Embree*>(args->geometryUserPtr);
        const Shape shape = shape_of(of.cells, of.kept[args->primID]);
        Box box;
        for (std::size_t k = 0; k < shape.corners; ++k)
            box.include(shape.centre + shape.corner[k].place - of.centre);
        constexpr double kRounding = 1e-6;
        const Vec3d wider = kRounding * of.radius * Vec3d{1, 1, 1};
        const Vec3f lower = vec_cast<float>(box.lower - wider),
                    upper = vec_cast<float>(box.upper + wider);
        *args->bounds_o = {lower.x, lower.y, lower.z, 0, upper.x, upper.y, upper.z, 0};
    }
};

CellRays::CellRays(const Cells& cells, std::span<const std::uint32_t> kept) {
    vog::parallel_for(0, 1, [](int) {});  // before Embree's loops, as in TraceBvh
    embree_ = std::make_unique<Embree>(Embree{cells, kept});
    const Box box = bounds(cells);
    embree_->centre = box.center(), embree_->radius = box.radius() + cells.thickness;
    const RTCGeometry geometry = rtcNewGeometry(embree_->device.get(), RTC_GEOMETRY_TYPE_USER);
    rtcSetSceneFlags(embree_->scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(kept.size()));
    rtcSetGeometryUserData(geometry, embree_.get());
    rtcSetGeometryBoundsFunction(geometry, Embree::bounds_of, nullptr);
    rtcSetGeometryOccludedFunction(geometry, collect);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(embree_->scene.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(embree_->scene.get());
    if (const RTCError code = rtcGetDeviceError(embree_->device.get()); code != RTC_ERROR_NONE)
        throw Error(fmt::format("cells: Embree error {}", static_cast<int>(code)));
}
CellRays::~CellRays() = default;
const Cells& CellRays::cells() const { return embree_->cells; }
std::span<const std::uint32_t> CellRays::kept() const { return embree_->kept; }
double CellRays::radius() const { return embree_->radius; }

CellPoint CellPiece::at(double share) const {
    CellPoint point{std::lerp(first.density, last.density, share)};
    for (std::size_t c = 0; c < kMostValues; ++c)
        point.value[c] = std::lerp(first.value[c], last.value[c], share);
    return point;
}

void CellRays::add(Vec3d origin, Vec3d direction, Segment within, std::vector<CellPiece>& pieces,
                   const CellValues* values) const {
    const Embree& of = *embree_;
    // A ray in a face that two cells share would count in both or in none: all rays are beside theirs.
    constexpr double kBeside = 1e-10;
    origin = origin + kBeside * of.radius * Vec3d{0.61, 0.75, 0.27};
    // From the nearest point to the centre backwards, where floats are finest.
    const double stretch = length(direction);
    const Vec3d along = 1 / stretch * direction;
    const double before = dot(of.centre - origin, along) - 2 * of.radius;
    const Vec3d start = origin + before * along - of.centre;
    thread_local Query query;
    rtcInitIntersectContext(&query);
    query.found.clear();
    RTCRay ray{};
    ray.org_x = static_cast<float>(start.x), ray.org_y = static_cast<float>(start.y);
    ray.org_z = static_cast<float>(start.z), ray.dir_x = static_cast<float>(along.x);
    ray.dir_y = static_cast<float>(along.y), ray.dir_z = static_cast<float>(along.z);
    constexpr double kRounding = 1e-5;
    const auto within_tree = [&](double t, double slack) {
        return static_cast<float>(
            std::clamp(t * stretch - before + slack * of.radius, 0.0, 4 * of.radius));
    };
    ray.tnear = within_tree(within.first, -kRounding);
    ray.tfar = within_tree(within.last, kRounding);
    ray.mask = ~0u;
    rtcOccluded1(of.scene.get(), &query, &ray);
    std::ranges::sort(query.found);  // sums do not depend on the order of Embree's nodes
    for (const unsigned n : query.found) {
        const std::uint32_t cell = of.kept[n];
        Shape shape = shape_of(of.cells, cell);
        for (Corner& corner : shape.corner) corner.density = std::max(corner.density, 0.0);
        const std::array<double, kMostValues> mean =
            values ? set_values(shape, of.cells, cell, *values) : std::array<double, kMostValues>{};
        const std::size_t first = pieces.size();
        double whole = 0;
        for_each_tetrahedron(shape, [&](const std::array<const Corner*, 4>& corner) {
            const double volume = six_volumes(corner);
            whole += volume;
            if (volume == 0) return;
            const TetrahedronLine line(corner, origin - shape.centre, direction, within.first,
                                       within.last);
            if (!(line.first < line.last)) return;
            CellPiece piece{{line.first, line.last}, cell, line.at(line.first), line.at(line.last)};
            if (volume < 0) piece.first.density *= -1, piece.last.density *= -1;
            pieces.push_back(piece);
        });
        for (std::size_t k = first; k < pieces.size(); ++k)
            for (CellPoint* end : {&pieces[k].first, &pieces[k].last}) {
                if (whole < 0) end->density *= -1;
                for (std::size_t c = 0; c < kMostValues; ++c) end->value[c] += mean[c];
            }
    }
}

DepthImage render_cells_reference(const CellRays& rays, const Camera& camera, int width, int height,
                                  const ReferenceOptions& options) {
    return render_rays(
        [&](Vec3d origin, Vec3d direction, Segment within) {
            thread_local std::vector<CellPiece> pieces;
            pieces.clear();
            rays.add(origin, direction, within, pieces);
            double along = 0;
            for (const CellPiece& piece : pieces)
                along += (piece.segment.last - piece.segment.first) / 2 *
                         (piece.first.density + piece.last.density);
            return std::max(along * length(direction), 0.0);
        },
        camera, width, height, options);
}

}  // namespace vog::reference
