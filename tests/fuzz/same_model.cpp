// same_model.cpp: Equality of models after their way through a file.
#include "same_model.h"

#include <algorithm>

#include "fuzz_target.h"
#include "vog/ply.h"

namespace vog::fuzz {

namespace {

/// Whether two fields have the same name, unit and range.
template <class Field>
bool same_description(const Field& a, const Field& b) {
    return a.name == b.name && a.unit == b.unit && a.lower == b.lower && a.upper == b.upper;
}

bool same_values(const Fields& a, const Fields& b) {
    bool same = std::ranges::equal(
        a.scalar, b.scalar, [](const ScalarField& one, const ScalarField& other) {
            return same_description(one, other) && same_bytes(one.value, other.value) &&
                   same_bytes(one.gradient, other.gradient) &&
                   same_bytes(one.deviation, other.deviation) &&
                   same_bytes(one.skewness, other.skewness);
        });
    same = same && std::ranges::equal(
                       a.vector, b.vector, [](const VectorField& one, const VectorField& other) {
                           bool alike = same_description(one, other) &&
                                        same_bytes(one.value, other.value) &&
                                        same_bytes(one.covariance, other.covariance);
                           for (std::size_t c = 0; c < 3; ++c)
                               alike = alike && same_bytes(one.gradient[c], other.gradient[c]);
                           return alike;
                       });
    return same;
}

bool same_arrays(const Gaussians& a, const Gaussians& b) {
    return same_bytes(a.mean, b.mean) && same_bytes(a.scale, b.scale) &&
           same_bytes(a.rotation, b.rotation) && same_bytes(a.density, b.density) &&
           same_values(a.fields, b.fields);
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
