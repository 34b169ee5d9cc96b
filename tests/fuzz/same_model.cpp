// same_model.cpp: Equality of models after their way through a file.
#include "same_model.h"

#include "fuzz_target.h"
#include "vog/ply.h"

namespace vog::fuzz {

namespace {

bool same_arrays(const Gaussians& a, const Gaussians& b) {
    return same_bytes(a.mean, b.mean) && same_bytes(a.scale, b.scale) &&
           same_bytes(a.rotation, b.rotation) && same_bytes(a.density, b.density);
}

}  // namespace

void expect_round_trip(const Gaussians& model, const Hierarchy& hierarchy) {
    const std::filesystem::path file = scratch_file("again.ply");
    if (!accepted([&] { write_ply(file, model, hierarchy); })) return;
    Gaussians again;
    Hierarchy nodes;
    const bool read = accepted([&] { again = read_ply(file, &nodes); });
    expect(read, "a model that is written is read");
    expect(same_arrays(again, model), "Gaussians survive bit for bit");
    expect(again.cutoff == model.cutoff, "the cutoff survives");
    expect(again.origin == model.origin, "the origin survives");
    expect(again.box.lower == model.box.lower && again.box.upper == model.box.upper,
           "the box survives");
    expect(again.source_voxels == model.source_voxels, "the count of voxels survives");
    expect(same_arrays(nodes.nodes, hierarchy.nodes), "nodes survive bit for bit");
    expect(same_bytes(nodes.first_node, hierarchy.first_node) &&
               same_bytes(nodes.first_leaf, hierarchy.first_leaf) &&
               same_bytes(nodes.node_count, hierarchy.node_count) &&
               same_bytes(nodes.leaf_count, hierarchy.leaf_count) &&
               same_bytes(nodes.radius, hierarchy.radius) &&
               same_bytes(nodes.error, hierarchy.error),
           "the hierarchy survives bit for bit");
}

}  // namespace vog::fuzz
