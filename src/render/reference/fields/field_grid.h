// field_grid.h: A volume and a field at its voxels, prepared for rays: the walk of every picture of a field.
#pragma once

#include <cstddef>
#include <vector>

#include "render/reference/hierarchical_dda.h"
#include "render/reference/node_search.h"
#include "render/reference/reference.h"
#include "render/reference/reference_grid.h"
#include "vog/field_maps.h"
#include "vog/voxel_field.h"

namespace vog::reference {

/// Active voxel, or tile, on a ray.
struct FieldCell {
    double density = 0;
    double value = 0;  ///< the shown part of the field
    bool tile = false;
    Vec3i index{};    ///< of the voxel; of a tile its least
    Segment segment;  ///< part of the ray, t of the world ray
};

/// Whether a field is its volume's own values: it has none of its own.
bool is_own(const VoxelField& field);
/// renderer  for the message
/// throws    vog::Error unless there is one field for each volume, of it, with the part
void check_fields(std::span<const Volume> volumes, std::span<const VoxelField> fields,
                  FieldPart part, const char* renderer = "reference");

/// The volume and the field must outlive the grid.
class FieldGrid {
  public:
    /// field  one whose component has neither leaves nor tiles is the volume's own values
    /// throws vog::Error as voxel_grid does
    FieldGrid(const Volume& volume, const VoxelField& field, FieldPart part);

    /// Whether the field is the volume's own values.
    bool own() const { return own_; }
    const VoxelGrid::Data& data() const { return grid_.data(); }
    /// Voxels on the same lattice that are not this grid's, for gradients at its own. They must outlive the grid.
    void set_beside(const FieldGrid& others) { beside_ = &others; }

    /// Calls visit(FieldCell) for the active voxels on a ray within a segment of it, front to back, until visit
    /// returns false.
    template <class Visit>
    void walk(Vec3d origin, Vec3d direction, Segment within, Visit&& visit) const {
        const VoxelGrid::Data& grid = grid_.data();
        const GridRay ray = grid.voxel_ray(origin, direction);
        march_in_order(grid.root_cells, ray, Walk<Visit>{*this, ray, normalized(direction), visit},
                       within);
    }

    /// Voxels of a leaf, with the shown part of the field.
    class LeafCells {
      public:
        /// Bit z: whether the voxel (x, y, z) is active.
        unsigned active(int x, int y) const {
            return leaf_.mask[static_cast<std::size_t>(x)] >> 8 * y & 0xff;
        }
        double density(int offset) const {
            return double{leaf_.value[static_cast<std::size_t>(offset)]};
        }
        double value(int offset) const {
            return of_.leaf_value(towards_, index_, static_cast<std::uint32_t>(offset),
                                  density(offset));
        }

      private:
        friend class FieldGrid;
        LeafCells(const FieldGrid& of, Vec3d towards, std::size_t index)
            : of_(of), towards_(towards), index_(index), leaf_(of.volume_.leaves[index]) {}
        const FieldGrid& of_;
        Vec3d towards_;  ///< unit length
        std::size_t index_;
        const Leaf& leaf_;
    };
    /// Visits the leaves and tiles whose boxes pass a test, in local coordinates, in an order of the grid alone:
    ///   visitor.leaf(const LeafCells&, Vec3d lower)
    ///   visitor.tile(Vec3d lower, double edge, double density, double value)
    /// direction  of parallel rays, world
    /// near       as search() calls it
    template <class Near, class Visitor>
    void search_boxes(Vec3d direction, const Near& near, Visitor& visitor) const {
        search(grid_.data().root_cells, near,
               BoxSearch<Visitor>{*this, normalized(direction), visitor});
    }

    /// Gradient of a scalar field in a voxel by central differences, per world unit. Inactive neighbours have the
    /// background where the field is the volume's own, else that of the voxel; inside tiles it is 0.
    Vec3d gradient(const FieldCell& cell) const;

  private:
    /// Visitor of the nodes on a ray.
    template <class Visit>
    struct Walk {
        const FieldGrid& of;
        const GridRay& ray;
        Vec3d towards;  ///< unit length
        Visit& visit;
        bool goes_on = true;

        void leaf(const NanoLeaf& leaf, Vec3d lower, Segment segment) {
            if (!goes_on) return;
            const auto& data = *leaf.data();
            const std::size_t index = of.leaf_index_[static_cast<std::size_t>(&leaf - of.leaves_)];
            const Vec3i origin = of.volume_.leaves[index].origin;
            for_each_cell<3>(ray, lower, 1, segment, [&](std::uint32_t offset, Segment part) {
                if (!goes_on || !data.mValueMask.isOn(offset)) return;
                const double density{data.mValues[offset]};
                const auto n = static_cast<std::int32_t>(offset);
                goes_on = visit(FieldCell{density, of.leaf_value(towards, index, offset, density),
                                          false, origin + Vec3i{n >> 6, n >> 3 & 7, n & 7}, part});
            });
        }
        void tile(Vec3d lower, int, float value, Segment segment) {
            if (!goes_on) return;
            const Vec3i origin = of.tile_origin(lower);
            goes_on = visit(FieldCell{double{value}, of.tile_value(towards, origin, double{value}),
                                      true, origin, segment});
        }
    };

    /// Visitor of the nodes that pass a test.
    template <class Visitor>
    struct BoxSearch {
        const FieldGrid& of;
        Vec3d towards;  ///< unit length
        Visitor& visitor;

        void leaf(const NanoLeaf& leaf, Vec3d lower) {
            const std::size_t index = of.leaf_index_[static_cast<std::size_t>(&leaf - of.leaves_)];
            visitor.leaf(LeafCells(of, towards, index), lower);
        }
        void tile(Vec3d lower, double edge, float value) {
            visitor.tile(lower, edge, double{value},
                         of.tile_value(towards, of.tile_origin(lower), double{value}));
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
    double leaf_value(Vec3d towards, std::size_t leaf, std::uint32_t offset, double density) const {
        if (own_) return density + field_.background;
        return shown(towards,
                     [&](std::size_t c) { return field_.component[c].leaf[leaf][offset]; });
    }
    Vec3i tile_origin(Vec3d lower) const;
    double tile_value(Vec3d towards, Vec3i origin, double density) const;
    double neighbour(Vec3i index, double otherwise) const;

    const Volume& volume_;
    const VoxelField& field_;
    FieldPart part_;
    bool own_;
    VoxelGrid grid_;
    const FieldGrid* beside_ = nullptr;
    const NanoLeaf* leaves_ = nullptr;
    std::vector<std::size_t> leaf_index_;  ///< [NanoVDB's leaves] in volume_.leaves
};

/// Grids of volumes and their fields.
/// throws  vog::Error unless there is one field for each, and as FieldGrid does
std::vector<FieldGrid> field_grids(std::span<const Volume> volumes,
                                   std::span<const VoxelField> fields, FieldPart part);

}  // namespace vog::reference
