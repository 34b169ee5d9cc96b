// trace_bvh.cpp: Traversal by Embree 3 in place of OptiX. A Gaussian is a primitive of a user
// geometry; the geometry's intersect function is __intersection__, its filter function __anyhit__,
// and a filter that rejects its hit is optixIgnoreIntersection: the ray's interval is unchanged.
//
// `accumulate` uses rtcOccluded, whose traversal need not order the nodes, as for an OptiX ray with
// any-hit programs only. `collect` uses rtcIntersect: once its list is full, the filter accepts a
// hit beyond the list to shorten the ray, as an any-hit program that returns does.
#include "render/trace/trace_bvh.h"

#include <embree3/rtcore.h>
#include <fmt/core.h>

#include <atomic>
#include <exception>

#include "core/parallel.h"
#include "vog/error.h"

namespace vog::trace {

namespace {

struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
template <class Handle>
using Owned = std::unique_ptr<std::remove_pointer_t<Handle>, Release>;

/// Payload of a ray, appended to the context that Embree passes to its callbacks.
struct Query : RTCIntersectContext {
    const TraceModel* model;
    const device::Ray* ray;
    const float* shares;                ///< of the Gaussians, or null
    device::Hit hit;                    ///< with the current primitive: OptiX's attributes
    device::DepthSum sum{};             ///< result of accumulate
    std::uint32_t hits = 0;             ///< counted by accumulate
    device::HitList* list = nullptr;    ///< filled by collect
    const TraceField* field = nullptr;  ///< summed by accumulate, too
    FieldDepths sums{};

    Query(const TraceModel& traced, const device::Ray& along, const float* of_each)
        : model(&traced), ray(&along), shares(of_each) {
        rtcInitIntersectContext(this);
        flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }
};

void bounds_of(const RTCBoundsFunctionArguments* args) {
    const FloatBox& box =
        static_cast<const TraceModel*>(args->geometryUserPtr)->boxes[args->primID];
    RTCBounds& out = *args->bounds_o;
    out.lower_x = box.lower[0], out.lower_y = box.lower[1], out.lower_z = box.lower[2];
    out.upper_x = box.upper[0], out.upper_y = box.upper[1], out.upper_z = box.upper[2];
}

/// __intersection__: true if the ray meets the Gaussian, and its box if the model is boxed.
bool intersect_primitive(Query& query, unsigned index) {
    if (device::share_of(query.shares, index) == 0) return false;
    const device::Gaussian& g = query.model->gaussians[index];
    if (!device::intersect(g, *query.ray, query.model->cutoff2, query.hit)) return false;
    return !query.model->boxed || device::meets_box(g, *query.ray, query.model->scene);
}

/// Passes the hit at `entry` to the filter. returns true if the filter accepts it
template <class Arguments>
bool accepted(const Arguments* args, RTCRay& ray, unsigned index, float entry,
              void (*filter)(const Arguments*, const RTCFilterFunctionNArguments*)) {
    int valid = -1;
    const float farthest = ray.tfar;
    if (entry > farthest) return false;
    RTCHit hit{};
    hit.primID = index;
    hit.geomID = args->geomID;
    hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    ray.tfar = entry;
    RTCFilterFunctionNArguments to_filter{&valid,
                                          args->geometryUserPtr,
                                          args->context,
                                          reinterpret_cast<RTCRayN*>(&ray),
                                          reinterpret_cast<RTCHitN*>(&hit),
                                          1};
    filter(args, &to_filter);
    if (!valid) ray.tfar = farthest;
    return valid != 0;
}

void occluded(const RTCOccludedFunctionNArguments* args) {
    Query& query = *static_cast<Query*>(args->context);
    if (!*args->valid || !intersect_primitive(query, args->primID)) return;
    accepted(args, *reinterpret_cast<RTCRay*>(args->ray), args->primID, query.hit.entry(),
             rtcFilterOcclusion);
}

void intersected(const RTCIntersectFunctionNArguments* args) {
    Query& query = *static_cast<Query*>(args->context);
    if (!*args->valid || !intersect_primitive(query, args->primID)) return;
    RTCRayHit& out = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    if (accepted(args, out.ray, args->primID, query.hit.entry(), rtcFilterIntersection)) {
        out.hit.primID = args->primID;
        out.hit.geomID = args->geomID;
    }
}

/// Adds tau times the means of a field and of its square to the sums.
/// tau  of the chord on the ray
void add_field(Query& query, unsigned index, float tau) {
    const TraceField& field = *query.field;
    const device::Gaussian& g = query.model->gaussians[index];
    const device::Ray& ray = *query.ray;
    const device::FieldHit hit = device::field_hit(g, ray, query.model->cutoff2, {0, ray.end});
    if (!(hit.moments.zeroth > 0)) return;  // cut off, or shorter than the rounding of `intersect`
    if (ray.end < HUGE_VAL)
        tau = static_cast<float>(double{device::share_of(query.shares, index)} * double{g.density} *
                                 hit.moments.zeroth);
    const device::FieldPlane plane = field.vector.empty()
                                         ? device::plane_along(field.scalar[index], ray.direction)
                                         : device::plane_along(field.vector[index], ray.direction);
    const device::FieldMean mean =
        device::mean_along(plane, hit.from_mean, ray.direction, hit.moments);
    const device::SumRounding& rounding = query.model->rounding;
    device::add_depth(query.sums.column, tau, rounding);
    device::add_signed(query.sums.first, double{tau} * mean.first, rounding);
    device::add_signed(query.sums.second, double{tau} * mean.second, rounding);
}

/// __anyhit__ of accumulate.
void add_and_ignore(const RTCFilterFunctionNArguments* args) {
    Query& query = *static_cast<Query*>(args->context);
    const unsigned index = RTCHitN_primID(args->hit, 1, 0);
    const float tau = device::share_of(query.shares, index) *
                      device::clipped_depth(query.model->gaussians[index], query.hit, *query.ray);
    if (query.field)
        add_field(query, index, tau);
    else
        device::add_depth(query.sum, tau, query.model->rounding);
    ++query.hits;
    *args->valid = 0;
}

/// __anyhit__ of collect.
void collect_and_ignore(const RTCFilterFunctionNArguments* args) {
    Query& query = *static_cast<Query*>(args->context);
    const unsigned index = RTCHitN_primID(args->hit, 1, 0);
    const bool room = device::collect(*query.list, {query.hit.entry(), index});
    // The paper's boxes may lie before or behind the entries of their Gaussians: no shortening.
    if (room || query.model->boxed) *args->valid = 0;
}

RTCRay float_ray(const TraceModel& model, const device::Ray& ray, float from) {
    const device::Float3 origin = device::to_float(ray.origin - model.center);
    const device::Float3 direction = device::to_float(ray.direction);
    RTCRay out{};
    out.org_x = origin.x, out.org_y = origin.y, out.org_z = origin.z;
    out.dir_x = direction.x, out.dir_y = direction.y, out.dir_z = direction.z;
    out.tnear = from;
    out.tfar = ray.length + device::kRaySlack;
    out.mask = ~0u;
    return out;
}

/// State of a build that may be interrupted: exceptions must not pass through Embree.
struct Building {
    std::atomic<bool> ended{false};
    std::exception_ptr ended_by{};
};

/// Progress callback of Embree, on any of its threads. returns false to end the build
bool continue_build(void* data, double) {
    auto& building = *static_cast<Building*>(data);
    try {
        if (!building.ended) check_interrupt();
    } catch (...) {
        building.ended_by = std::current_exception();
        building.ended = true;
    }
    return !building.ended;
}

}  // namespace

struct TraceBvh::Embree {
    Owned<RTCDevice> device;
    Owned<RTCScene> scene;

    void check(const char* what) const {
        if (const RTCError code = rtcGetDeviceError(device.get()); code != RTC_ERROR_NONE)
            throw Error(fmt::format("trace: {}: Embree error {}{}", what, static_cast<int>(code),
                                    code == RTC_ERROR_OUT_OF_MEMORY ? " (out of memory)" : ""));
    }
};

TraceBvh::TraceBvh(const TraceModel& model) : embree_(std::make_unique<Embree>()), model_(model) {
    // TBB gives all later loops of this thread the floating-point mode of the first one. Embree's own
    // loops flush denormals to zero: T of 1e-40 would become 0 in every picture.
    vog::parallel_for(0, 1, [](int) {});
    embree_->device.reset(rtcNewDevice(nullptr));
    embree_->check("cannot start");
    embree_->scene.reset(rtcNewScene(embree_->device.get()));
    // Robust: rounding in the box test never misses a box.
    rtcSetSceneFlags(embree_->scene.get(), RTC_SCENE_FLAG_ROBUST);

    const Owned<RTCGeometry> geometry(
        rtcNewGeometry(embree_->device.get(), RTC_GEOMETRY_TYPE_USER));
    rtcSetGeometryUserPrimitiveCount(geometry.get(), static_cast<unsigned>(model.gaussians.size()));
    rtcSetGeometryUserData(geometry.get(), const_cast<TraceModel*>(&model));
    rtcSetGeometryBoundsFunction(geometry.get(), bounds_of, nullptr);
    rtcSetGeometryOccludedFunction(geometry.get(), occluded);
    rtcSetGeometryIntersectFunction(geometry.get(), intersected);
    rtcSetGeometryOccludedFilterFunction(geometry.get(), add_and_ignore);
    rtcSetGeometryIntersectFilterFunction(geometry.get(), collect_and_ignore);
    rtcCommitGeometry(geometry.get());
    rtcAttachGeometry(embree_->scene.get(), geometry.get());
    Building building;
    rtcSetSceneProgressMonitorFunction(embree_->scene.get(), continue_build, &building);
    rtcCommitScene(embree_->scene.get());
    if (building.ended_by) std::rethrow_exception(building.ended_by);
    embree_->check("cannot build the hierarchy");
    rtcSetSceneProgressMonitorFunction(embree_->scene.get(), nullptr, nullptr);
}

TraceBvh::~TraceBvh() = default;

std::uint32_t TraceBvh::accumulate(const device::Ray& ray, const float* shares,
                                   device::DepthSum& sum) const {
    Query query(model_, ray, shares);
    RTCRay along = float_ray(model_, ray, 0);
    rtcOccluded1(embree_->scene.get(), &query, &along);
    sum = query.sum;
    return query.hits;
}

FieldDepths TraceBvh::accumulate(const device::Ray& ray, const float* shares,
                                 const TraceField& field) const {
    Query query(model_, ray, shares);
    query.field = &field;
    RTCRay along = float_ray(model_, ray, 0);
    rtcOccluded1(embree_->scene.get(), &query, &along);
    return query.sums;
}

void TraceBvh::collect(const device::Ray& ray, const float* shares, device::HitList& list) const {
    Query query(model_, ray, shares);
    query.list = &list;
    const float from = device::slab_start(list, model_.boxed);
    RTCRayHit along{float_ray(model_, ray, from), {}};
    along.hit.geomID = along.hit.primID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(embree_->scene.get(), &query, &along);
}

}  // namespace vog::trace
