// packed_cells.cpp: conversion of moments to float32 and to Gaussians.
#include "convert/moments/cells/packed_cells.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/parallel.h"

namespace vog::moments {

PackedCells::PackedCells(std::span<const Brick> bricks) {
    constexpr double kMost = std::numeric_limits<double>::infinity();
    Vec3d lower{kMost, kMost, kMost}, upper{-kMost, -kMost, -kMost};
    for (const Brick& brick : bricks)
        for (int axis = 0; axis < 3; ++axis) {
            const double from = brick.origin[axis];
            lower[axis] = std::min(lower[axis], from);
            upper[axis] = std::max(upper[axis], from + kLeafEdge * brick.spacing);
        }
    if (!bricks.empty()) middle_ = 0.5 * (lower + upper);
}

void PackedCells::set(std::size_t i, const Moments& cell) {
    const auto& c = cell.covariance;
    mean_[i] = vec_cast<float>(cell.mean - middle_);
    variance_[i] = vec_cast<float>(Vec3d{c[0], c[3], c[5]});
    rest_[i] = {static_cast<float>(cell.mass), static_cast<float>(c[1]), static_cast<float>(c[2]),
                static_cast<float>(c[4])};
}

void PackedCells::push_back(const Moments& cell) {
    mean_.emplace_back(), variance_.emplace_back(), rest_.emplace_back();
    set(size() - 1, cell);
}

void PackedCells::reserve(std::size_t count) {
    mean_.reserve(count), variance_.reserve(count), rest_.reserve(count);
}

void PackedCells::append(const PackedCells& others) {
    const auto add = [](auto& to, const auto& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    add(mean_, others.mean_), add(variance_, others.variance_), add(rest_, others.rest_);
}

Gaussians PackedCells::to_gaussians(const MomentFrame& frame) && {
    Gaussians model;
    model.mean = std::move(mean_);
    model.scale = std::move(variance_);
    model.rotation = std::move(rest_);
    model.density.resize(model.size());
    vog::parallel_for(std::size_t{0}, model.size(), [&](std::size_t i) {
        set_gaussian(model, i, unpacked(model.mean[i], model.scale[i], model.rotation[i]), frame);
    });
    if (frame.axis_aligned) model.rotation = BigVector<Quat>();
    return model;
}

PackedCells joined_cells(std::vector<PackedCells> parts, const PackedCells& none) {
    PackedCells cells = none;
    std::size_t count = 0;
    for (const PackedCells& part : parts) count += part.size();
    cells.reserve(count);
    for (PackedCells& part : parts) {
        cells.append(part);
        part = PackedCells();
    }
    return cells;
}

}  // namespace vog::moments
