// surface_volume.cpp: voxels of a model in which its surface is smooth.
#include <algorithm>
#include <cmath>
#include <vector>

#include "vog/periodic.h"
#include "vog/voxelize.h"

namespace vog {

namespace {

double smooth_edge(const Gaussians& model) {
    const Box box = view_box(model);
    const Vec3d edges = box.upper - box.lower;
    std::vector<double> sizes;
    for (const Vec3f& s : model.scale) sizes.push_back(std::cbrt(double{s.x} * s.y * s.z));
    if (sizes.empty()) return 1;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::ranges::nth_element(sizes, middle);
    return std::max(1.5 * *middle, std::max({edges.x, edges.y, edges.z}) / 256);
}

}  // namespace

Volume surface_volume(const Gaussians& model, double voxel_size) {
    const double edge = voxel_size != 0 ? voxel_size : smooth_edge(model);
    Volume volume = voxelize(model, voxel_lattice(model, edge)).volume;
    volume.standing = model.content.standing;
    for (const ScalarField& field : model.fields.scalar)
        if (field.is_measure) volume.background = field.background;
    return volume;
}

}  // namespace vog
