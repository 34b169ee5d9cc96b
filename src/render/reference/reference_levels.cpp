// reference_levels.cpp: Exact line integral through levels that hide each other.
// Each level is traversed separately in its own index space, which gives intervals of t, the same
// parameter for all levels. The finest level keeps its intervals, each coarser level the parts that
// no finer level covers. The result does not depend on how the lattices lie to each other.
#include "render/reference/reference_levels.h"

#include <algorithm>
#include <span>

#include "render/reference/hierarchical_dda.h"
#include "render/reference/levels_field.h"
#include "render/reference/reference.h"
#include "render/reference/reference_linear.h"

namespace vog {

using namespace reference;

namespace {

/// Interval of the ray inside active voxels of one value.
struct Span {
    double first, last;
    double value;
};

/// Visitor that collects the intervals inside active voxels, also those of value 0.
struct SpanCollector {
    const GridRay& ray;
    std::vector<Span>& spans;

    void leaf(const NanoLeaf& leaf, Vec3d lower, Segment segment) {
        const auto& data = *leaf.data();
        for_each_cell<3>(ray, lower, 1, segment, [&](std::uint32_t offset, Segment part) {
            if (data.mValueMask.isOn(offset)) add(part, data.mValues[offset]);
        });
    }
    void tile(Vec3d, int, float value, Segment segment) { add(segment, value); }
    void add(Segment part, float value) {
        if (!spans.empty() && spans.back().last == part.first && spans.back().value == value)
            spans.back().last = part.last;
        else
            spans.push_back({part.first, part.last, value});
    }
};

void collect_spans(const VoxelGrid::Data& grid, Vec3d origin, Vec3d direction, Segment within,
                   std::vector<Span>& spans) {
    spans.clear();
    const GridRay ray = grid.voxel_ray(origin, direction);
    march(grid.root_cells, ray, SpanCollector{ray, spans}, within);
    // In order already, except across cells of the root.
    const auto before = [](const Span& a, const Span& b) { return a.first < b.first; };
    if (!std::is_sorted(spans.begin(), spans.end(), before))
        std::sort(spans.begin(), spans.end(), before);
}

/// Appends a segment after all others, or extends the last one if they touch.
void append(std::vector<Segment>& segments, Segment next) {
    if (!segments.empty() && next.first <= segments.back().last)
        segments.back().last = std::max(segments.back().last, next.last);
    else
        segments.push_back(next);
}

/// Buffers of one thread for a ray.
struct Scratch {
    std::vector<Span> spans, domain;
    std::vector<Segment> covered, visible, both;
};

/// Sets `visible` to the parts of `domain` outside `covered`.
void find_visible(Scratch& scratch) {
    scratch.visible.clear();
    std::size_t at = 0;
    const std::vector<Segment>& covered = scratch.covered;
    for (const Span& span : scratch.domain) {
        double from = span.first;
        while (at < covered.size() && covered[at].last <= from) ++at;
        for (std::size_t n = at; n < covered.size() && covered[n].first < span.last; ++n) {
            if (covered[n].first > from) append(scratch.visible, {from, covered[n].first});
            from = std::max(from, covered[n].last);
        }
        if (from < span.last) append(scratch.visible, {from, span.last});
    }
}

/// Adds `visible` to `covered`: both are sorted and disjoint.
void cover_visible(Scratch& scratch) {
    scratch.both.clear();
    auto a = scratch.covered.begin(), b = scratch.visible.begin();
    while (a != scratch.covered.end() || b != scratch.visible.end()) {
        const bool first =
            b == scratch.visible.end() || (a != scratch.covered.end() && a->first < b->first);
        append(scratch.both, first ? *a++ : *b++);
    }
    scratch.covered.swap(scratch.both);
}

/// Integral of the spans' values over the visible segments.
double visible_sum(std::span<const Span> spans, std::span<const Segment> visible) {
    double sum = 0;
    std::size_t at = 0;
    for (const Span& span : spans) {
        while (at < visible.size() && visible[at].last <= span.first) ++at;
        double length = 0;
        for (std::size_t n = at; n < visible.size() && visible[n].first < span.last; ++n)
            length += std::min(span.last, visible[n].last) - std::max(span.first, visible[n].first);
        sum += span.value * length;
    }
    return sum;
}

}  // namespace

double reference::depth_along(const LevelGrids::Data& grids, Vec3d origin, Vec3d direction,
                              Segment within) {
    thread_local Scratch scratch;
    scratch.covered.clear();
    double sum = 0;
    for (const LevelGrids::Data::Level& level : grids.levels) {
        const VoxelGrid::Data& field = level.field.data();
        const bool constant = field.options.interpolation == Interpolation::constant;
        collect_spans(level.domain ? level.domain->data() : field, origin, direction, within,
                      scratch.domain);
        if (scratch.domain.empty()) continue;
        find_visible(scratch);
        if (constant) {
            if (level.domain) collect_spans(field, origin, direction, within, scratch.spans);
            sum += visible_sum(level.domain ? scratch.spans : scratch.domain, scratch.visible);
        } else {
            const GridRay ray = field.center_ray(origin, direction);
            for (const Segment segment : scratch.visible) sum += linear_sum(field, ray, segment);
        }
        cover_visible(scratch);
    }
    return sum * length(direction);
}

LevelGrids level_grids(const Levels& levels, const VoxelGridOptions& options) {
    validate(levels);
    auto data = std::make_shared<LevelGrids::Data>();
    const bool linear = options.interpolation == Interpolation::linear;
    for (const std::size_t n : finest_first(levels.volumes)) {
        const Volume& volume = levels.volumes[n];
        const Volume* domain = !levels.masks.empty() ? &levels.masks[n]
                               : linear              ? &volume
                                                     : nullptr;
        LevelGrids::Data::Level level{
            voxel_grid(linear ? extended_field(levels, n) : volume, options), {}};
        if (domain) level.domain = voxel_grid(*domain);
        data->levels.push_back(std::move(level));
    }
    return LevelGrids(std::move(data));
}

std::size_t LevelGrids::memory_bytes() const {
    std::size_t bytes = 0;
    for (const Data::Level& level : data_->levels)
        bytes += level.field.memory_bytes() + (level.domain ? level.domain->memory_bytes() : 0);
    return bytes;
}

}  // namespace vog
