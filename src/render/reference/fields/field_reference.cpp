// field_reference.cpp: Maps of a field through the voxels themselves, constant in each voxel.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "render/pixel_tiles.h"
#include "render/reference/hierarchical_dda.h"
#include "render/reference/reference_grid.h"
#include "render/shown_field.h"
#include "vog/error.h"

namespace vog {

using namespace reference;

namespace {

/// Sums of a measure over one ray, or the rays of a pixel, with the field relative to its first value on
/// them: a field that hardly varies keeps its digits.
struct FirstRelative {
    RaySums sums{};
    double reference = 0;
    bool met = false;

    void add(double weight, double value) {
        if (!(weight > 0)) return;
        if (!met) reference = value, met = true;
        const double difference = value - reference;
        sums.column += weight;
        sums.first += weight * difference;
        sums.second += weight * difference * difference;
    }
};

bool before(Vec3i a, Vec3i b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }
/// Index of the node with this origin among nodes sorted by origin.
template <class Nodes>
std::size_t index_of(const Nodes& nodes, Vec3i origin) {
    const auto found =
        std::lower_bound(nodes.begin(), nodes.end(), origin,
                         [](const auto& node, Vec3i at) { return before(node.origin, at); });
    return static_cast<std::size_t>(found - nodes.begin());
}

/// A volume and the field at its voxels.
class FieldGrid {
  public:
    FieldGrid(const Volume& volume, const VoxelField& field, FieldPart part)
        : volume_(volume), field_(field), part_(part), grid_(voxel_grid(volume)) {
        // NanoVDB has the leaves in an order of its own.
        const auto& tree = grid_.data().tree.grid().tree();
        const std::uint32_t count = tree.nodeCount(0);
        if (count > 0) leaves_ = tree.getFirstNode<0>();
        for (std::uint32_t n = 0; n < count; ++n) {
            const auto origin = leaves_[n].origin();
            leaf_index_.push_back(index_of(volume.leaves, Vec3i{origin[0], origin[1], origin[2]}));
        }
    }

    /// Adds the voxels on a ray.
    void add(Vec3d origin, Vec3d direction, FirstRelative& to) const {
        const VoxelGrid::Data& grid = grid_.data();
        const GridRay ray = grid.voxel_ray(origin, direction);
        march(grid.root_cells, ray, Walk{*this, ray, normalized(direction), length(direction), to});
    }

  private:
    /// Visitor of the voxels on a ray.
    struct Walk {
        const FieldGrid& of;
        const GridRay& ray;
        Vec3d towards;   ///< unit length
        double stretch;  ///< world units of one t
        FirstRelative& to;

        void leaf(const NanoLeaf& leaf, Vec3d lower, Segment segment) {
            const float* weights = leaf.data()->mValues;
            const std::size_t index = of.leaf_index_[static_cast<std::size_t>(&leaf - of.leaves_)];
            for_each_cell<3>(ray, lower, 1, segment, [&](std::uint32_t offset, Segment part) {
                const double weight = double{weights[offset]} * (part.last - part.first) * stretch;
                if (weight > 0)
                    to.add(weight, of.shown(towards, [&](std::size_t c) {
                        return of.field_.component[c].leaf[index][offset];
                    }));
            });
        }
        void tile(Vec3d lower, int, float value, Segment segment) {
            const Vec3d corner = lower + of.grid_.data().corner;
            const Vec3i origin{static_cast<std::int32_t>(std::llround(corner.x)),
                               static_cast<std::int32_t>(std::llround(corner.y)),
                               static_cast<std::int32_t>(std::llround(corner.z))};
            const std::size_t index = index_of(of.volume_.tiles, origin);
            to.add(double{value} * (segment.last - segment.first) * stretch,
                   of.shown(towards,
                            [&](std::size_t c) { return of.field_.component[c].tile[index]; }));
        }
    };

    /// The shown part of the components at a voxel.
    template <class Component>
    double shown(Vec3d towards, const Component& component) const {
        switch (part_) {
            case FieldPart::view:
                return towards.x * double{component(0)} + towards.y * double{component(1)} +
                       towards.z * double{component(2)};
            case FieldPart::y:
                return double{component(1)};
            case FieldPart::z:
                return double{component(2)};
            default:
                return double{component(0)};
        }
    }

    const Volume& volume_;
    const VoxelField& field_;
    FieldPart part_;
    VoxelGrid grid_;
    const NanoLeaf* leaves_ = nullptr;
    std::vector<std::size_t> leaf_index_;  ///< [NanoVDB's leaves] in volume_.leaves
};

/// throws vog::Error for a field that is not of this volume, or lacks the part
void check(const Volume& volume, const VoxelField& field, FieldPart part) {
    if (field.is_vector() != (part != FieldPart::value) || field.component.empty())
        throw Error(fmt::format("reference: field '{}' has {} components, expected {}", field.name,
                                field.component.size(), part == FieldPart::value ? 1 : 3));
    for (const VoxelValues& values : field.component)
        if (values.leaf.size() != volume.leaves.size() || values.tile.size() != volume.tiles.size())
            throw Error(fmt::format(
                "reference: field '{}' has {} leaves and {} tiles, expected the volume's {} and {}",
                field.name, values.leaf.size(), values.tile.size(), volume.leaves.size(),
                volume.tiles.size()));
}

}  // namespace

FieldMaps render_field_reference(std::span<const Volume> volumes,
                                 std::span<const VoxelField> fields, FieldPart part,
                                 const Camera& camera, int width, int height,
                                 const ReferenceOptions& options) {
    if (volumes.size() != fields.size())
        throw Error(fmt::format("reference: {} volumes and {} fields, expected one for each",
                                volumes.size(), fields.size()));
    check_samples(options.samples);
    std::vector<FieldGrid> grids;
    for (std::size_t n = 0; n < volumes.size(); ++n) {
        check(volumes[n], fields[n], part);
        grids.emplace_back(volumes[n], fields[n], part);
    }
    const CameraFrame frame = frame_of(camera, width, height);
    FieldMaps maps = empty_maps(width, height);
    const int samples = options.samples;
    for_each_pixel(width, height, options.progress, [&](int column, int row) {
        check_interrupt();
        FirstRelative pixel;
        for (int y = 0; y < samples; ++y)
            for (int x = 0; x < samples; ++x) {
                const double at_x = column + sample_offset(x, samples);
                const double at_y = row + sample_offset(y, samples);
                for (const FieldGrid& grid : grids)
                    grid.add(frame.origin(at_x, at_y), frame.direction(at_x, at_y), pixel);
            }
        const std::size_t n = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(column);
        set_pixel(maps, n, pixel.sums, pixel.sums.column / (samples * samples), pixel.reference, 1);
    });
    return maps;
}

}  // namespace vog
