// add_fields.cpp: fields of a finished model: joint moments of position and value over each Gaussian's part of the
// voxels, then the plane through them and what it leaves.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "convert/fields/division.h"
#include "convert/moments/covariance_adjugate.h"
#include "core/paging.h"
#include "core/parallel.h"
#include "vog/convert_fields.h"
#include "vog/error.h"

namespace vog {

using namespace joint;

namespace {

/// Components of all fields, one after another, and how their numbers are scaled.
struct Layout {
    struct Part {
        std::size_t field, component;
        float reference, unit;
    };
    std::vector<Part> parts;
    std::vector<std::size_t> first_part;  ///< [fields]
    std::vector<std::size_t> first_sum;   ///< [fields] of the residuals
    std::size_t residual_sums = 0;

    explicit Layout(std::span<const std::vector<VoxelField>> fields) {
        for (std::size_t f = 0; f < fields.size(); ++f) {
            const VoxelField& field = fields[f].front();
            first_part.push_back(parts.size());
            first_sum.push_back(residual_sums);
            residual_sums += field.is_vector() ? kVectorSums : kScalarSums;
            double lower = field.lower, upper = field.upper;
            for (const VoxelField& level : fields[f])
                lower = std::min(lower, level.lower), upper = std::max(upper, level.upper);
            // A vector's range is that of its magnitude: components lie on both sides of 0.
            const double middle = field.is_vector() ? 0 : 0.5 * (lower + upper);
            const double half = field.is_vector() ? upper : 0.5 * (upper - lower);
            const double unit = half > 0 ? std::exp2(std::clamp(std::ilogb(half), -120, 120)) : 1;
            for (std::size_t c = 0; c < field.component.size(); ++c)
                parts.push_back({f, c, static_cast<float>(middle), static_cast<float>(unit)});
        }
    }
    std::vector<Component> components(const Volume& volume,
                                      std::span<const std::vector<VoxelField>> fields,
                                      std::size_t level) const {
        std::vector<Component> all;
        for (const Part& part : parts)
            all.push_back({&volume, &fields[part.field][level].component[part.component],
                           part.reference, part.unit});
        return all;
    }
};

/// Plane of a component about a Gaussian's mean, in the component's unit; gradient per world unit.
struct WorldPlane {
    double value = 0;
    Vec3d gradient;
};

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
    // In units of the spread, whose squares may leave the range of doubles otherwise.
    std::array<double, 6> c{};
    double trace = 0;
    std::size_t n = 0;
    for (int row = 0; row < 3; ++row)
        for (int column = row; column < 3; ++column) {
            c[n++] = sums.second(row, column) / sums.mass - center[row] * center[column];
            if (row == column) trace += c[n - 1];
        }
    if (!(trace > 0)) return {mean, {}};
    for (double& entry : c) entry /= trace;
    const auto [adjugate, det] = moments::adjugate_of(c);
    if (!(det > 0)) return {mean, {}};
    const auto& a = adjugate;
    const Vec3d w = (1 / trace) * with;
    const Vec3d gradient = (1 / det) * Vec3d{a[0] * w.x + a[1] * w.y + a[2] * w.z,
                                             a[1] * w.x + a[3] * w.y + a[4] * w.z,
                                             a[2] * w.x + a[4] * w.y + a[5] * w.z};
    return {mean - dot(gradient, center), gradient};
}

std::unique_ptr<Division> division_of(const Gaussians& model, const Volume& volume,
                                      const FieldOptions& options) {
    return options.shares == FieldShares::cells ? cell_division(model, volume, options.block_voxels)
                                                : soft_division(model, volume);
}

/// First pass: planes of all components.
/// masses  out: [Gaussians]
BigVector<WorldPlane> find_planes(const Gaussians& model, std::span<const Volume> levels,
                                  std::span<const std::unique_ptr<Division>> divisions,
                                  std::span<const std::vector<VoxelField>> fields,
                                  const Layout& layout, BigVector<double>& masses) {
    const std::size_t size = model.size(), count = layout.parts.size();
    const std::size_t width = kPositionSums + kValueSums * count;
    std::vector<BigVector<double>> sums(levels.size());
    for (std::size_t level = 0; level < levels.size(); ++level) {
        resize_kept(sums[level], width * size);
        const std::vector<Component> components = layout.components(levels[level], fields, level);
        divisions[level]->add(
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
                                 std::span<const std::unique_ptr<Division>> divisions,
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
        divisions[level]->add(
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

float as_float(double number) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(number, -kMost, kMost));
}
Vec3f as_floats(Vec3d v) { return {as_float(v.x), as_float(v.y), as_float(v.z)}; }

/// Residuals below this share of the field's range are rounding of floats.
constexpr double kRounding = 1e-6;

ScalarField scalar_field(const VoxelField& about, const Layout& layout, std::size_t f,
                         const BigVector<WorldPlane>& planes, const BigVector<double>& residuals,
                         const BigVector<double>& masses) {
    ScalarField field{about.name, about.unit, about.lower, about.upper, false, {}, {}, {}, {}};
    const std::size_t size = masses.size(), count = layout.parts.size();
    const auto [index, component, reference, unit] = layout.parts[layout.first_part[f]];
    resize_kept(field.value, size), resize_kept(field.gradient, size);
    resize_kept(field.deviation, size), resize_kept(field.skewness, size);
    for (std::size_t i = 0; i < size; ++i) {
        keep_memory_at(i);
        const WorldPlane& plane = planes[count * i + layout.first_part[f]];
        field.value[i] = as_float(double{reference} + double{unit} * plane.value);
        field.gradient[i] = as_floats(double{unit} * plane.gradient);
        if (!(masses[i] > 0)) continue;
        const double* sums = &residuals[layout.residual_sums * i + layout.first_sum[f]];
        const double variance = std::max(sums[0] / masses[i], 0.0), r = std::sqrt(variance);
        if (r < kRounding) continue;
        constexpr double kMostSkewness = 3;
        field.deviation[i] = as_float(double{unit} * r);
        field.skewness[i] = static_cast<float>(
            std::clamp(sums[1] / (masses[i] * variance * r), -kMostSkewness, kMostSkewness));
    }
    return field;
}

VectorField vector_field(const VoxelField& about, const Layout& layout, std::size_t f,
                         const BigVector<WorldPlane>& planes, const BigVector<double>& residuals,
                         const BigVector<double>& masses) {
    VectorField field{about.name, about.unit, about.lower, about.upper, {}, {}, {}};
    const std::size_t size = masses.size(), count = layout.parts.size();
    const double unit = double{layout.parts[layout.first_part[f]].unit};
    resize_kept(field.value, size), resize_kept(field.covariance, size);
    for (auto& gradient : field.gradient) resize_kept(gradient, size);
    for (std::size_t i = 0; i < size; ++i) {
        keep_memory_at(i);
        for (std::size_t c = 0; c < 3; ++c) {
            const WorldPlane& plane = planes[count * i + layout.first_part[f] + c];
            field.value[i][static_cast<int>(c)] = as_float(unit * plane.value);
            field.gradient[c][i] = as_floats(unit * plane.gradient);
        }
        if (!(masses[i] > 0)) continue;
        const double* sums = &residuals[layout.residual_sums * i + layout.first_sum[f]];
        for (std::size_t n = 0; n < kVectorSums; ++n) {
            const double entry = sums[n] / masses[i];
            field.covariance[i][n] = as_float(unit * unit * entry);
        }
    }
    return field;
}

/// Whether a field is the volume's own values.
bool is_measure(const VoxelField& field) {
    const VoxelValues& values = field.component.front();
    return !field.is_vector() && values.leaf.empty() && values.tile.empty();
}

/// Range over all levels.
VoxelField about(const std::vector<VoxelField>& levels) {
    VoxelField all;
    all.name = levels.front().name, all.unit = levels.front().unit;
    all.lower = levels.front().lower, all.upper = levels.front().upper;
    for (const VoxelField& level : levels)
        all.lower = std::min(all.lower, level.lower), all.upper = std::max(all.upper, level.upper);
    return all;
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
    std::vector<std::unique_ptr<Division>> divisions;
    for (const Volume& volume : levels) divisions.push_back(division_of(model, volume, options));
    BigVector<double> masses;
    const BigVector<WorldPlane> planes =
        find_planes(model, levels, divisions, fields, layout, masses);
    if (options.progress) options.progress(0.5);
    const BigVector<double> residuals =
        find_residuals(model, levels, divisions, fields, layout, planes);
    for (std::size_t f = 0; f < fields.size(); ++f) {
        const VoxelField range = about(fields[f]);
        if (fields[f].front().is_vector())
            model.fields.vector.push_back(
                vector_field(range, layout, f, planes, residuals, masses));
        else
            model.fields.scalar
                .emplace_back(scalar_field(range, layout, f, planes, residuals, masses))
                .is_measure = std::ranges::all_of(fields[f], is_measure);
    }
    if (options.progress) options.progress(1);
}

}  // namespace vog
