// arrangement.h: arrangement of volumes whose voxels are read on request.
#pragma once

#include <functional>
#include <span>
#include <string>

#include "data/volume_partition.h"
#include "vog/levels.h"

namespace vog {

/// Volume of which any nodes can be read.
struct VolumeOutline {
    std::string name;   ///< grid name
    std::string label;  ///< name for messages: "a.vdb 'density'"
    Affine world_from_index;
    /// Reads the nodes for which choice(origin, edge) is true; it is called once for each node.
    std::function<Volume(const NodeChoice& choice)> read_where;
};

/// As arrangement_of(Levels). Reads nodes only where volumes may overlap, and stops at the first
/// voxel that does.
Arrangement arrangement_of(std::span<const VolumeOutline> outlines);

/// Name of a volume in messages: "a.vdb 'density'"; without a source "'density'".
std::string volume_label(const std::string& source, const std::string& name);

}  // namespace vog
