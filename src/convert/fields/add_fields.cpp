// add_fields.cpp: fields of a finished model: joint moments of position and value over each Gaussian's part of the
// voxels, then the plane through them and what it leaves.
#include <fmt/core.h>

#include <deque>
#include <optional>
#include <utility>

#include "convert/fields/cell_fields.h"
#include "convert/fields/field_entries.h"
#include "convert/fields/soft_division.h"
#include "core/paging.h"
#include "core/parallel.h"
#include "vog/convert_fields.h"
#include "vog/error.h"

namespace vog {

using namespace joint;

namespace {

/// Sums of one Gaussian in world units.
struct WorldSums {
    double mass = 0;
    Vec3d first;
    Mat3 second{{Vec3d{}, Vec3d{}, Vec3d{}}};
};

/// Adds sums of positions in a volume's index space to those of the world.
void add_positions(std::span<const double> sums, const Affine& map, double voxel,
                   WorldSums& world) {
    const Mat3 second{{Vec3d{sums[4], sums[5], sums[6]},
                       Vec3d{sums[5], sums[7], sums[8]},
                       {sums[6], sums[8], sums[9]}}};
    const Mat3 turned = map.linear * second * transpose(map.linear);
    world.mass += voxel * sums[0];
    world.first = world.first + voxel * (map.linear * Vec3d{sums[1], sums[2], sums[3]});
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            world.second(row, column) += voxel * turned(row, column);
}

/// The plane of least squares.
/// value, along  sums of value, and of value times position
WorldPlane plane_of(const WorldSums& sums, double value, Vec3d along) {
    if (!(sums.mass > 0)) return {};
    const double mean = value / sums.mass;
    const Vec3d center = (1 / sums.mass) * sums.first;
    const Vec3d with = (1 / sums.mass) * along - mean * center;
    std::array<double, 6> covariance{};
    std::size_t n = 0;
    for (int row = 0; row < 3; ++row)
        for (int column = row; column < 3; ++column)
            covariance[n++] = sums.second(row, column) / sums.mass - center[row] * center[column];
    const Vec3d gradient = least_squares(covariance, with);
    return {mean - dot(gradient, center), gradient};
}

/// First pass: planes of all components.
/// masses  out: [Gaussians]
BigVector<WorldPlane> find_planes(const Gaussians& model, std::span<const Volume> levels,
                                  const std::deque<SoftDivision>& divisions,
                                  std::span<const std::vector<VoxelField>> fields,
                                  const Layout& layout, BigVector<double>& masses) {
    const std::size_t size = model.size(), count = layout.parts.size();
    const std::size_t width = kPositionSums + kValueSums * count;
    std::vector<BigVector<double>> sums(levels.size());
    for (std::size_t level = 0; level < levels.size(); ++level) {
        resize_kept(sums[level], width * size);
        const std::vector<Component> components = layout.components(levels[level], fields, level);
        divisions[level].add(
            width,
            [&](const DividedBrick& divided, std::span<const std::uint32_t>,
                std::span<double> parts) { add_joint_sums(divided, components, parts); },
            sums[level]);
    }
    BigVector<WorldPlane> planes;
    resize_kept(planes, size * count);
    resize_kept(masses, size);
    std::vector<double> voxels;
    for (const Volume& volume : levels) voxels.push_back(voxel_volume(volume));
    vog::parallel_for(std::size_t{0}, size, [&](std::size_t i) {
        WorldSums world;
        for (std::size_t level = 0; level < levels.size(); ++level)
            add_positions(std::span(sums[level]).subspan(width * i, kPositionSums),
                          levels[level].world_from_index, voxels[level], world);
        masses[i] = world.mass;
        for (std::size_t c = 0; c < count; ++c) {
            double value = 0;
            Vec3d along;
            for (std::size_t level = 0; level < levels.size(); ++level) {
                const double* s = &sums[level][width * i + kPositionSums + kValueSums * c];
                value += voxels[level] * s[0];
                along = along + voxels[level] * (levels[level].world_from_index.linear *
                                                 Vec3d{s[1], s[2], s[3]});
            }
            planes[count * i + c] = plane_of(world, value, along);
        }
    });
    // Gaussians without a voxel have the mean of the field.
    for (std::size_t c = 0; c < count; ++c) {
        double mass = 0, sum = 0;
        for (std::size_t i = 0; i < size; ++i) {
            keep_memory_at(i);
            mass += masses[i];
            if (masses[i] > 0) sum += masses[i] * planes[count * i + c].value;
        }
        for (std::size_t i = 0; i < size; ++i) {
            keep_memory_at(i);
            if (!(masses[i] > 0) && mass > 0) planes[count * i + c] = {sum / mass, {}};
        }
    }
    return planes;
}

/// Second pass: sums of residuals, [Gaussians][Layout::residual_sums], mass in world units.
BigVector<double> find_residuals(const Gaussians& model, std::span<const Volume> levels,
                                 const std::deque<SoftDivision>& divisions,
                                 std::span<const std::vector<VoxelField>> fields,
                                 const Layout& layout, const BigVector<WorldPlane>& planes) {
    const std::size_t size = model.size(), count = layout.parts.size();
    const std::size_t width = layout.residual_sums;
    BigVector<double> all;
    resize_kept(all, width * size);
    for (std::size_t level = 0; level < levels.size(); ++level) {
        const std::vector<Component> components = layout.components(levels[level], fields, level);
        const Mat3 to_index = transpose(levels[level].world_from_index.linear);
        BigVector<double> sums;
        resize_kept(sums, width * size);
        divisions[level].add(
            width,
            [&](const DividedBrick& divided, std::span<const std::uint32_t> gaussian,
                std::span<double> parts) {
                std::vector<Plane> own;
                for (std::size_t f = 0; f < fields.size(); ++f) {
                    const std::size_t of_field = fields[f].front().component.size();
                    own.clear();
                    for (const std::uint32_t i : gaussian)
                        for (std::size_t c = 0; c < of_field; ++c) {
                            const WorldPlane& plane = planes[count * i + layout.first_part[f] + c];
                            own.push_back({static_cast<float>(plane.value),
                                           vec_cast<float>(to_index * plane.gradient)});
                        }
                    add_residual_sums(divided,
                                      std::span(components).subspan(layout.first_part[f], of_field),
                                      own, width, layout.first_sum[f], parts);
                }
            },
            sums);
        const double voxel = voxel_volume(levels[level]);
        for (std::size_t n = 0; n < all.size(); ++n) {
            keep_memory_at(n);
            all[n] += voxel * sums[n];
        }
    }
    return all;
}

/// By the densities of the Gaussians.
void add_by_shares(const Gaussians& model, std::span<const Volume> levels,
                   std::span<const std::vector<VoxelField>> fields, const Layout& layout,
                   const Progress& progress, FieldEntries& entries) {
    std::deque<SoftDivision> divisions;
    for (const Volume& volume : levels) divisions.emplace_back(model, volume);
    BigVector<double> masses;
    const BigVector<WorldPlane> planes =
        find_planes(model, levels, divisions, fields, layout, masses);
    if (progress) progress(0.5);
    const BigVector<double> residuals =
        find_residuals(model, levels, divisions, fields, layout, planes);
    for (std::size_t i = 0; i < model.size(); ++i) {
        keep_memory_at(i);
        entries.set(i, &planes[layout.parts.size() * i], &residuals[layout.residual_sums * i],
                    masses[i]);
    }
}

}  // namespace

void add_fields(Gaussians& model, std::span<const Volume> levels,
                std::span<const std::vector<VoxelField>> fields, const FieldOptions& options) {
    for (const std::vector<VoxelField>& field : fields) {
        if (field.size() != levels.size())
            throw Error(fmt::format("field {}: {} volumes, expected {}",
                                    field.empty() ? "" : field.front().name, field.size(),
                                    levels.size()));
        if (model.fields.find_scalar(field.front().name) ||
            model.fields.find_vector(field.front().name))
            throw Error(fmt::format("{}: the model has a field '{}' already", model.source,
                                    field.front().name));
    }
    if (fields.empty() || model.size() == 0) return;
    const Layout layout(fields);
    std::optional<FieldEntries> entries(std::in_place, fields, layout, model.size());
    const bool by_cells =
        options.cells && levels.size() == 1 &&
        add_by_cells(levels.front(), layout.components(levels.front(), fields, 0), layout,
                     {*options.cells, model.size()}, options.progress, *entries);
    if (!by_cells) {
        entries.emplace(fields, layout, model.size());
        add_by_shares(model, levels, fields, layout, options.progress, *entries);
    }
    std::move(*entries).move_to(model);
    if (options.progress) options.progress(1);
}

}  // namespace vog
