// drawn.cpp: Structures drawn from an input.
#include "drawn.h"

#include <algorithm>
#include <cmath>

namespace vog::fuzz {

namespace {

/// Scale of each axis, permuted, mirrored or sheared, and an offset.
Affine drawn_map(Numbers& numbers) {
    Affine map;
    const int kind = numbers.below(8);
    const double voxel = kind & 1 ? double{numbers.positive()} : 0.1;
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) {
            const bool diagonal = row == (kind & 4 ? (column + 1) % 3 : column);
            const double factor = kind & 2 ? numbers.share() - 0.25 : 0;
            map.linear(row, column) = voxel * (diagonal ? 1 + factor : 0.3 * factor);
        }
    if (numbers.flag())
        map.translation = {double{numbers.number()}, double{numbers.number()}, numbers.share()};
    return map;
}

std::int32_t drawn_index(Numbers& numbers, std::int32_t edge) {
    const int kind = numbers.byte();
    // Neighbours, some nodes away, or anywhere that OpenVDB's coordinates reach.
    const std::int32_t near = numbers.below(4) - 2, some = numbers.below(1024) - 512;
    if (kind < 160) return near * edge;
    if (kind < 240) return some * edge;
    const auto any = static_cast<std::int32_t>(static_cast<std::uint32_t>(numbers.bits(4)));
    return any / 2 / edge * edge;
}

/// A range, in order most often.
template <class Field>
void describe(Field& field, Numbers& numbers) {
    field.name = numbers.flag() ? numbers.text(8) : numbers.flag() ? "density" : "heat";
    field.unit = numbers.text(4);
    field.lower = numbers.share();
    field.upper = numbers.flag() ? double{numbers.number()} : field.lower + numbers.share();
}

}  // namespace

Volume drawn_volume(Numbers& numbers) {
    Volume volume;
    volume.name = "density";
    volume.source = "drawn";
    volume.world_from_index = drawn_map(numbers);
    const int leaves = 1 + numbers.below(8), tiles = numbers.below(8) < 6 ? 0 : numbers.below(3);
    for (int n = 0; n < leaves; ++n) {
        Leaf leaf;
        for (int axis = 0; axis < 3; ++axis) leaf.origin[axis] = drawn_index(numbers, kLeafEdge);
        const int voxels = numbers.flag() ? numbers.below(8) : kLeafVoxels;
        const float value = numbers.positive();
        const int stride = 1 + numbers.below(64);
        for (int k = 0; k < voxels; ++k)
            leaf.set(k * stride % kLeafVoxels, voxels < 8 ? numbers.number() : value);
        volume.leaves.push_back(leaf);
    }
    for (int n = 0; n < tiles; ++n) {
        Tile tile;
        tile.edge = numbers.flag() ? 8 : numbers.flag() ? 128 : 4096;
        for (int axis = 0; axis < 3; ++axis) tile.origin[axis] = drawn_index(numbers, tile.edge);
        tile.value = numbers.positive();
        const bool covers =
            std::any_of(volume.leaves.begin(), volume.leaves.end(), [&](const Leaf& leaf) {
                for (int axis = 0; axis < 3; ++axis)
                    if (leaf.origin[axis] < tile.origin[axis] ||
                        leaf.origin[axis] - tile.origin[axis] >= tile.edge)
                        return false;
                return true;
            });
        if (!covers && volume.tiles.empty()) volume.tiles.push_back(tile);
    }
    sort_nodes(volume);
    const auto same = [](const Leaf& a, const Leaf& b) { return a.origin == b.origin; };
    volume.leaves.erase(std::unique(volume.leaves.begin(), volume.leaves.end(), same),
                        volume.leaves.end());
    return volume;
}

Gaussians drawn_model(Numbers& numbers) {
    Gaussians model;
    const int count = 1 + numbers.below(64);
    const bool rotated = numbers.flag();
    if (numbers.flag()) model.cutoff = 8 * static_cast<float>(numbers.share());
    for (int n = 0; n < count; ++n) {
        model.mean.push_back({numbers.number(), numbers.number(), numbers.number()});
        model.scale.push_back({numbers.positive(), numbers.positive(), numbers.positive()});
        if (rotated)
            model.rotation.push_back(
                {1 + numbers.number(), numbers.number(), numbers.number(), numbers.number()});
        model.density.push_back(numbers.positive());
    }
    if (numbers.flag())
        for (std::size_t n = 0; n < model.size(); ++n)
            model.box.include(vec_cast<double>(model.mean[n]));
    if (numbers.flag()) model.origin = {1e9 * numbers.share(), double{numbers.number()}, 0};
    model.source_voxels = numbers.bits(3);
    model.source = numbers.text(20);
    model.method = numbers.text(8);
    model.options = numbers.text(20);
    model.summary = numbers.text(20);
    return model;
}

Fields drawn_fields(Numbers& numbers, std::size_t count) {
    Fields fields;
    const auto vector = [&] { return Vec3f{numbers.number(), numbers.number(), numbers.number()}; };
    const int kinds = numbers.byte();
    for (int n = 0; n < (kinds & 3); ++n) {
        ScalarField field;
        describe(field, numbers);
        for (std::size_t i = 0; i < count; ++i) {
            field.value.push_back(numbers.number());
            field.gradient.push_back(vector());
            field.deviation.push_back(numbers.flag() ? 0 : numbers.positive());
            field.skewness.push_back(6 * static_cast<float>(numbers.share()) - 3);
        }
        fields.scalar.push_back(field);
    }
    if (kinds & 4) {
        VectorField field;
        describe(field, numbers);
        for (std::size_t i = 0; i < count; ++i) {
            field.value.push_back(vector());
            for (BigVector<Vec3f>& component : field.gradient) component.push_back(vector());
            const float xx = numbers.positive(), yy = numbers.positive(), zz = numbers.positive();
            field.covariance.push_back({xx, numbers.number(), 0, yy, 0, zz});
        }
        fields.vector.push_back(field);
    }
    return fields;
}

}  // namespace vog::fuzz
