// vdb_points_write.cpp: writing of particles as an OpenVDB PointDataGrid, as in the paper: voxels
// of about one particle, attribute P with the position in its voxel, then the other attributes.
#include <openvdb/points/PointDataGrid.h>

#include "core/parallel.h"
#include "data/point_grid.h"
#include "io/points/points_files.h"
#include "io/vdb/vdb_volume.h"

namespace vog {

using namespace vdb;

namespace {

using openvdb::Index;
namespace vp = openvdb::points;
using PointLeaf = vp::PointDataTree::LeafNodeType;
using Descriptor = vp::AttributeSet::Descriptor;

/// Descriptors with P, then with velocity (if present) and each attribute appended: one more from
/// each to the next, because OpenVDB appends attributes to a leaf one by one.
std::vector<Descriptor::Ptr> describe(const Points& points) {
    const auto vector = vp::TypedAttributeArray<openvdb::Vec3f>::attributeType();
    const auto number = vp::TypedAttributeArray<float>::attributeType(),
               wide = vp::TypedAttributeArray<double>::attributeType();
    std::vector<Descriptor::Ptr> chain{Descriptor::create(vector)};
    if (!points.velocity.empty())
        chain.push_back(chain.back()->duplicateAppend("velocity", vector));
    for (const PointAttribute& attribute : points.attributes)
        chain.push_back(
            chain.back()->duplicateAppend(attribute.name, attribute.unit == 1 ? number : wide));
    return chain;
}

openvdb::Vec3f to_openvdb(Vec3f v) { return {v.x, v.y, v.z}; }

/// Writes value_of(n) for the n-th point of a leaf.
template <class Value, class ValueOf>
void fill(PointLeaf& leaf, std::size_t column, Index count, const ValueOf& value_of) {
    vp::AttributeWriteHandle<Value> handle(leaf.attributeArray(column));
    for (Index n = 0; n < count; ++n) handle.set(n, value_of(n));
}

PointLeaf* make_leaf(const Points& points, const LeafOrder& order, double voxel_size,
                     std::size_t first, std::size_t last,
                     const std::vector<Descriptor::Ptr>& descriptors) {
    const auto count = static_cast<Index>(last - first);
    const Vec3i corner =
        LeafOrder::voxel(order.key[first] >> LeafOrder::kLeafBits << LeafOrder::kLeafBits);
    auto* leaf = new PointLeaf(openvdb::Coord(corner.x, corner.y, corner.z), 0, false);
    leaf->initializeAttributes(descriptors.front(), count);
    for (std::size_t n = 1; n < descriptors.size(); ++n) {
        Descriptor::Ptr with_next = descriptors[n];
        leaf->appendAttribute(*descriptors[n - 1], with_next, n);
    }

    // End of each voxel's points.
    std::vector<PointLeaf::ValueType> ends(PointLeaf::SIZE, 0);
    for (std::size_t n = first; n < last; ++n)
        ends[order.key[n] & (PointLeaf::SIZE - 1)] =
            PointLeaf::ValueType(static_cast<Index>(n + 1 - first));
    for (std::size_t voxel = 1; voxel < ends.size(); ++voxel)
        if (ends[voxel] < ends[voxel - 1]) ends[voxel] = ends[voxel - 1];
    leaf->setOffsets(ends);

    const auto index = [&](Index n) { return order.index[first + n]; };
    std::size_t column = 0;
    fill<openvdb::Vec3f>(*leaf, column++, count, [&](Index n) {
        const Vec3d voxel = vec_cast<double>(LeafOrder::voxel(order.key[first + n]));
        return to_openvdb(
            vec_cast<float>((1 / voxel_size) * (points.position[index(n)] - order.origin) - voxel));
    });
    if (!points.velocity.empty())
        fill<openvdb::Vec3f>(*leaf, column++, count,
                             [&](Index n) { return to_openvdb(points.velocity[index(n)]); });
    for (const PointAttribute& attribute : points.attributes) {
        const auto stored = [&](Index n) { return attribute.value[index(n)]; };
        if (attribute.unit == 1)
            fill<float>(*leaf, column++, count, stored);
        else
            fill<double>(*leaf, column++, count,
                         [&](Index n) { return attribute.unit * double{stored(n)}; });
    }
    return leaf;
}

}  // namespace

void point_files::write_points_vdb(const std::filesystem::path& file, const Points& points) {
    openvdb::initialize();
    for (const PointAttribute& attribute : points.attributes)
        if (attribute.name == "P" || attribute.name == "velocity" ||
            !Descriptor::validName(attribute.name))
            throw Error(
                fmt::format("{}: cannot write: attribute name '{}', expected letters, digits or _, "
                            "and neither P nor velocity",
                            file.string(), attribute.name));
    const double voxel_size = point_voxel_size(points);
    const LeafOrder order = leaf_order(points, voxel_size);
    std::vector<std::size_t> first;  // first point of each leaf
    for (std::size_t n = 0; n < order.key.size(); ++n)
        if (n == 0 ||
            order.key[n] >> LeafOrder::kLeafBits != order.key[n - 1] >> LeafOrder::kLeafBits)
            first.push_back(n);
    first.push_back(order.key.size());

    const auto grid = openvdb::gridPtrCast<vp::PointDataGrid>(
        openvdb::GridBase::createGrid(vp::PointDataGrid::gridType()));
    grid->setName("points");
    const double h = voxel_size;
    set_transform(*grid, {{{Vec3d{h, 0, 0}, {0, h, 0}, {0, 0, h}}}, order.origin}, file.string());
    const std::vector<Descriptor::Ptr> descriptors = describe(points);
    std::vector<PointLeaf*> leaves(first.size() - 1);
    vog::parallel_for(std::size_t{0}, leaves.size(), [&](std::size_t n) {
        leaves[n] = make_leaf(points, order, h, first[n], first[n + 1], descriptors);
    });
    for (PointLeaf* leaf : leaves) grid->tree().addLeaf(leaf);  // the tree owns it
    write_vdb_grids(file, 1, [&](std::size_t) { return GridToWrite{grid, {}}; });
}

}  // namespace vog
