// traversal.cpp: The boxes of a hierarchy near a ray in a scrambled order, since any order is within what OptiX promises.
#include "device/traversal.h"

#include <cuda_runtime.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <string>
#include <vector>

#include "emulation.h"
#include "render/gpu/optix/optix_entry_points.h"

extern "C" {
extern vog::device::Launch launch;
void __raygen__accumulate();
void __raygen__collect();
void __intersection__gaussian();
void __anyhit__accumulate();
void __anyhit__collect();
void __miss__gaussian();
void __raygen__sums();
void __anyhit__sums();
void __raygen__slabs();
void __anyhit__slabs();
void __raygen__voxels();
void __intersection__voxels();
void __closesthit__voxels();
}

namespace vog::emulation {

namespace {

constexpr std::uint64_t kHierarchy = 0x5eed0b0c5ull, kInstance = 0x5eed11572ull;

/// Head of a hierarchy's memory; the boxes, their order and the nodes follow.
struct Hierarchy {
    std::uint64_t kind, boxes, nodes;
    std::uint64_t single_anyhit;
};
/// Box of some boxes: those of the order from `first` on, or of two nodes, the next one and `second`.
struct Node {
    PrimitiveBox box;
    std::uint32_t first, count;  ///< count 0: of two nodes
    std::uint32_t second;
};
constexpr std::size_t kLeaf = 8;
/// Leaves have more than half of kLeaf boxes, but for a hierarchy of fewer.
constexpr std::size_t most_nodes(std::size_t boxes) { return 2 * (boxes / (kLeaf / 2) + 1); }
struct Instance {
    std::uint64_t kind;
    const Hierarchy* hierarchy;
    std::uint32_t mask, record_offset;
};

const PrimitiveBox* boxes_of(const Hierarchy& hierarchy) {
    return reinterpret_cast<const PrimitiveBox*>(&hierarchy + 1);
}

std::uint32_t* order_of(const Hierarchy& hierarchy) {
    return reinterpret_cast<std::uint32_t*>(
        const_cast<PrimitiveBox*>(boxes_of(hierarchy) + hierarchy.boxes));
}
Node* nodes_of(const Hierarchy& hierarchy) {
    return reinterpret_cast<Node*>(order_of(hierarchy) + hierarchy.boxes);
}

/// Adds the nodes of a part of the order, halved at the median of its longest side.
void add_nodes(Hierarchy& hierarchy, std::size_t first, std::size_t count) {
    const PrimitiveBox* boxes = boxes_of(hierarchy);
    const std::span part(order_of(hierarchy) + first, count);
    PrimitiveBox around = boxes[part.front()];
    for (const std::uint32_t n : part)
        for (int axis = 0; axis < 3; ++axis) {
            around.lower[axis] = std::min(around.lower[axis], boxes[n].lower[axis]);
            around.upper[axis] = std::max(around.upper[axis], boxes[n].upper[axis]);
        }
    Node& node = nodes_of(hierarchy)[hierarchy.nodes++];
    node = {around, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count), 0};
    if (count <= kLeaf) return;
    int longest = 0;
    for (int axis = 1; axis < 3; ++axis)
        if (around.upper[axis] - around.lower[axis] > around.upper[longest] - around.lower[longest])
            longest = axis;
    const std::size_t half = count / 2;
    std::nth_element(part.begin(), part.begin() + static_cast<std::ptrdiff_t>(half), part.end(),
                     [&](std::uint32_t a, std::uint32_t b) {
                         return boxes[a].lower[longest] + boxes[a].upper[longest] <
                                boxes[b].lower[longest] + boxes[b].upper[longest];
                     });
    node.count = 0;
    add_nodes(hierarchy, first, half);
    node.second = static_cast<std::uint32_t>(hierarchy.nodes);
    add_nodes(hierarchy, first + half, count - half);
}

/// Constant during a launch.
struct LaunchState {
    Programs programs{};
    unsigned hit_records = 0;
    Traversal mode = Traversal::plain;
};
LaunchState running;

thread_local RayState state;
thread_local bool any_accepted = false;
thread_local bool anyhit_done = false;  ///< once for the current box, where that is asked for
thread_local unsigned ray_flags = 0;

constexpr unsigned kDisableAnyhit = 1, kDisableClosesthit = 8;

std::uint32_t scrambled(std::uint64_t value) {
    value = (value ^ value >> 31) * 0x9e3779b97f4a7c15ull;
    return static_cast<std::uint32_t>((value ^ value >> 29) * 0xbf58476d1ce4e5b9ull >> 32);
}

/// Narrows [enter, leave] to the part of the ray in the box.
void clip(const PrimitiveBox& box, const Ray& ray, float& enter, float& leave) {
    for (int axis = 0; axis < 3; ++axis) {
        const float o = ray.origin[axis], d = ray.direction[axis];
        if (d == 0) {
            if (o < box.lower[axis] || o > box.upper[axis]) leave = -1;
            continue;
        }
        const float a = (box.lower[axis] - o) / d, b = (box.upper[axis] - o) / d;
        enter = std::max(enter, std::min(a, b));
        leave = std::min(leave, std::max(a, b));
    }
}

/// Calls of the intersection program for a box.
int calls(const PrimitiveBox& box, const Ray& ray, std::uint32_t chance) {
    float enter = state.begin, leave = state.end;
    clip(box, ray, enter, leave);
    switch (running.mode) {
        case Traversal::plain:
            return enter <= leave;
        case Traversal::strict:
            return enter < leave;
        default:
            return enter <= leave ? 1 + (chance % 4 == 0) : chance % 16 == 0;
    }
}

/// Boxes that may be visited, the same as by tests of all: a node's part of a ray has those of its boxes, since each step of clip()
/// is monotonic. Noisy traversal adds some from anywhere.
void near_boxes(const Hierarchy& hierarchy, const Ray& ray, std::uint64_t seed,
                std::vector<std::uint32_t>& found) {
    found.clear();
    if (hierarchy.boxes == 0) return;
    const Node* nodes = nodes_of(hierarchy);
    const std::uint32_t* order = order_of(hierarchy);
    std::uint32_t stack[64] = {};
    for (int depth = 1; depth > 0;) {
        const std::uint32_t n = stack[--depth];
        const Node& node = nodes[n];
        float enter = ray.begin, leave = ray.end;
        clip(node.box, ray, enter, leave);
        if (!(enter <= leave)) continue;
        if (node.count > 0) {
            found.insert(found.end(), order + node.first, order + node.first + node.count);
        } else {
            stack[depth++] = n + 1;
            stack[depth++] = node.second;
        }
    }
    if (running.mode != Traversal::noisy) return;
    constexpr std::uint64_t kFromAnywhere = 8;
    for (std::uint64_t n = 0; n < kFromAnywhere; ++n)
        found.push_back(scrambled(seed + (n << 40)) % static_cast<std::uint32_t>(hierarchy.boxes));
    std::ranges::sort(found);
    found.erase(std::unique(found.begin(), found.end()), found.end());
}

void check(const Ray& ray, const Instance& instance) {
    if (instance.kind != kInstance) refuse("optixTrace through something else than a hierarchy");
    if (instance.hierarchy->kind != kHierarchy) refuse("an instance of a hierarchy that is gone");
    if (!(ray.begin >= 0 && ray.end >= ray.begin)) refuse("optixTrace with tmin beyond tmax");
    if ((instance.mask & ray.mask) == 0) refuse("optixTrace with a mask that hides everything");
    if (ray.record_stride != 1 || ray.miss_record != 0 ||
        ray.record_offset + instance.record_offset >= running.hit_records)
        refuse("optixTrace with records beyond the shader binding table");
}

}  // namespace

Program find_program(const char* name) {
    static const std::pair<const char*, Program> table[] = {
        {VOG_RAYGEN_ACCUMULATE, __raygen__accumulate},
        {VOG_RAYGEN_COLLECT, __raygen__collect},
        {VOG_INTERSECTION_GAUSSIAN, __intersection__gaussian},
        {VOG_ANYHIT_ACCUMULATE, __anyhit__accumulate},
        {VOG_ANYHIT_COLLECT, __anyhit__collect},
        {VOG_MISS_GAUSSIAN, __miss__gaussian},
        {VOG_RAYGEN_SUMS, __raygen__sums},
        {VOG_ANYHIT_SUMS, __anyhit__sums},
        {VOG_RAYGEN_SLABS, __raygen__slabs},
        {VOG_ANYHIT_SLABS, __anyhit__slabs},
        {VOG_RAYGEN_VOXELS, __raygen__voxels},
        {VOG_INTERSECTION_VOXELS, __intersection__voxels},
        {VOG_CLOSESTHIT_VOXELS, __closesthit__voxels},
    };
    for (const auto& [entry, program] : table)
        if (std::strcmp(entry, name) == 0) return program;
    return nullptr;
}

std::size_t hierarchy_bytes(std::size_t boxes) {
    return sizeof(Hierarchy) + boxes * (sizeof(PrimitiveBox) + sizeof(std::uint32_t)) +
           most_nodes(boxes) * sizeof(Node);
}

void write_hierarchy(void* memory, std::span<const PrimitiveBox> boxes, bool single_anyhit) {
    for (const PrimitiveBox& box : boxes)
        for (int axis = 0; axis < 3; ++axis)
            if (!(box.lower[axis] <= box.upper[axis])) refuse("a box that is inside out");
    auto* hierarchy = static_cast<Hierarchy*>(memory);
    *hierarchy = {kHierarchy, boxes.size(), 0, single_anyhit};
    std::memcpy(hierarchy + 1, boxes.data(), boxes.size_bytes());
    std::iota(order_of(*hierarchy), order_of(*hierarchy) + boxes.size(), 0u);
    if (!boxes.empty()) add_nodes(*hierarchy, 0, boxes.size());
}

void move_hierarchy(void* from, void* to) {
    auto* hierarchy = static_cast<Hierarchy*>(from);
    if (hierarchy->kind != kHierarchy) refuse("something else than a hierarchy is compacted");
    const std::size_t bytes = hierarchy_bytes(hierarchy->boxes);
    std::memcpy(to, from, bytes);
    std::memset(from, 0xee, bytes);
}

std::size_t instance_bytes() { return sizeof(Instance); }

void write_instance(void* memory, const void* hierarchy, unsigned mask, unsigned record_offset) {
    const auto* of = static_cast<const Hierarchy*>(hierarchy);
    if (of->kind != kHierarchy) refuse("an instance of something else than a hierarchy");
    *static_cast<Instance*>(memory) = {kInstance, of, mask, record_offset};
}

void run_programs(const Programs& programs, unsigned hit_records, const device::Launch& parameters,
                  unsigned width, unsigned height) {
    constexpr std::uint64_t kMostRays = 1u << 30;
    if (std::uint64_t{width} * height > kMostRays) refuse("a launch of more than 2^30 rays");
    finish_stream(nullptr);
    running = {programs, hit_records, traversal()};
    launch = parameters;
    const std::uint64_t rays = std::uint64_t{width} * height;
    // An odd step that shares no divisor with the rays visits each once.
    std::uint64_t step = 7919;
    while (std::gcd(step, rays) != 1) step += 2;
    tbb::parallel_for(std::uint64_t{0}, rays, [&](std::uint64_t n) {
        const std::uint64_t pixel = n * step % rays;
        state = {};
        state.column = static_cast<unsigned>(pixel % width);
        state.row = static_cast<unsigned>(pixel / width);
        programs.raygen();
    });
}

RayState& ray_state() { return state; }

void trace(std::uint64_t handle, const Ray& ray, std::span<unsigned> payload) {
    const auto& instance = *reinterpret_cast<const Instance*>(handle);
    check(ray, instance);
    if (payload.size() != device::kPayloadWords) refuse("another payload than the pipeline's");
    const Hierarchy& hierarchy = *instance.hierarchy;

    std::copy(payload.begin(), payload.end(), state.payload);
    state.begin = ray.begin, state.end = ray.end;
    ray_flags = ray.flags;
    any_accepted = false;
    const std::uint64_t seed = (std::uint64_t{state.row} << 32) + state.column;
    static thread_local std::vector<std::uint32_t> near;
    near_boxes(hierarchy, ray, seed, near);
    // A step that shares no divisor with their number visits each once.
    const std::size_t count = near.size();
    std::size_t at = scrambled(seed), step = at >> 8 | 1;
    while (count > 0 && std::gcd(step, count) > 1) step += 2;
    for (std::size_t k = 0; k < count; ++k, at += step) {
        const std::size_t n = near[at % count];
        const int repeats = calls(boxes_of(hierarchy)[n], ray, scrambled((seed << 20) + seed + n));
        state.primitive = static_cast<unsigned>(n);
        for (int call = 0; call < repeats; ++call) {
            anyhit_done = call > 0 && hierarchy.single_anyhit;
            running.programs.intersection();
        }
    }
    const Program last = !any_accepted                    ? running.programs.miss
                         : ray_flags & kDisableClosesthit ? nullptr
                                                          : running.programs.closesthit;
    if (last) last();
    std::copy(std::begin(state.payload), std::end(state.payload), payload.begin());
}

bool report(float t, std::initializer_list<unsigned> attributes) {
    const bool beyond = running.mode == Traversal::strict ? t >= state.end : t > state.end;
    if (!(t >= state.begin) || beyond || anyhit_done) return false;
    if (attributes.size() > device::kAttributeWords) refuse("more attributes than the pipeline's");
    const float end = state.end;
    std::copy(attributes.begin(), attributes.end(), state.attribute);
    state.end = t;
    state.ignored = false;
    if (running.programs.anyhit && !(ray_flags & kDisableAnyhit)) running.programs.anyhit();
    if (state.ignored) {
        state.end = end;
        return false;
    }
    any_accepted = true;
    return true;
}

}  // namespace vog::emulation
