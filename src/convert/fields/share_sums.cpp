// share_sums.cpp: sums of bricks, mapped to the world and added over levels.
#include "convert/fields/share_sums.h"

#include <array>
#include <utility>

#include "core/paging.h"
#include "core/parallel.h"

namespace vog::joint {

namespace {

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

}  // namespace

SharePlanes find_planes(const SharedFields& shared) {
    const std::span<const Volume> levels = shared.levels;
    const Layout& layout = shared.layout;
    const std::size_t size = shared.model.size(), count = layout.parts.size();
    const std::size_t width = kPositionSums + kValueSums * count;
    std::vector<BigVector<double>> sums(levels.size());
    for (std::size_t level = 0; level < levels.size(); ++level) {
        resize_kept(sums[level], width * size);
        const std::vector<Component> components =
            layout.components(levels[level], shared.fields, level);
        shared.divisions[level].add(
            width,
            [&](const DividedBrick& divided, std::span<const std::uint32_t>,
                std::span<double> parts) { add_joint_sums(divided, components, parts); },
            sums[level]);
    }
    SharePlanes found;
    resize_kept(found.planes, size * count);
    resize_kept(found.positions, size);
    std::vector<double> voxels;
    for (const Volume& volume : levels) voxels.push_back(voxel_volume(volume));
    vog::parallel_for(std::size_t{0}, size, [&](std::size_t i) {
        WorldSums& world = found.positions[i];
        for (std::size_t level = 0; level < levels.size(); ++level)
            add_positions(std::span(sums[level]).subspan(width * i, kPositionSums),
                          levels[level].world_from_index, voxels[level], world);
        for (std::size_t c = 0; c < count; ++c) {
            double value = 0;
            Vec3d along;
            for (std::size_t level = 0; level < levels.size(); ++level) {
                const double* s = &sums[level][width * i + kPositionSums + kValueSums * c];
                value += voxels[level] * s[0];
                along = along + voxels[level] * (levels[level].world_from_index.linear *
                                                 Vec3d{s[1], s[2], s[3]});
            }
            found.planes[count * i + c] = plane_of(world, value, along);
        }
    });
    for (std::size_t c = 0; c < count; ++c) {
        double mass = 0, sum = 0;
        for (std::size_t i = 0; i < size; ++i) {
            keep_memory_at(i);
            const double of_part = found.positions[i].mass;
            mass += of_part;
            if (of_part > 0) sum += of_part * found.planes[count * i + c].value;
        }
        for (std::size_t i = 0; i < size; ++i) {
            keep_memory_at(i);
            if (!(found.positions[i].mass > 0) && mass > 0)
                found.planes[count * i + c] = {sum / mass, {}};
        }
    }
    return found;
}

BigVector<double> find_residuals(const SharedFields& shared, const BigVector<WorldPlane>& planes) {
    const auto levels = shared.levels;
    const auto fields = shared.fields;
    const Layout& layout = shared.layout;
    const std::size_t size = shared.model.size(), count = layout.parts.size();
    const std::size_t width = layout.residual_sums;
    BigVector<double> all;
    resize_kept(all, width * size);
    for (std::size_t level = 0; level < levels.size(); ++level) {
        const std::vector<Component> components = layout.components(levels[level], fields, level);
        const Mat3 to_index = transpose(levels[level].world_from_index.linear);
        BigVector<double> sums;
        resize_kept(sums, width * size);
        shared.divisions[level].add(
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

}  // namespace vog::joint
