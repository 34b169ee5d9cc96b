// particle_fields.cpp: values of particles by name, and their moments over each Gaussian's particles.
#include "convert/particles/particle_fields.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "convert/lod/field_moments.h"
#include "core/paging.h"
#include "core/parallel.h"
#include "data/fields/field_limits.h"
#include "vog/error.h"
#include "vog/value_counts.h"

namespace vog::particles {

using namespace moments;

namespace {

const PointAttribute* attribute_of(const Points& points, const std::string& name) {
    const auto found = std::ranges::find(points.attributes, name, &PointAttribute::name);
    return found == points.attributes.end() ? nullptr : &*found;
}

/// The three components of a vector; none where there is no vector of this name.
std::vector<BigVector<float>> vector_values(const Points& points, const std::string& name) {
    std::vector<BigVector<float>> components;
    if (name == "velocity" && !points.velocity.empty()) {
        for (int axis = 0; axis < 3; ++axis) {
            BigVector<float>& values = components.emplace_back();
            values.reserve(points.size());
            for (std::size_t n = 0; n < points.size(); ++n) {
                values.push_back(points.velocity[n][axis]);
                keep_memory_at(n);
            }
        }
        return components;
    }
    for (const char* axis : {"_x", "_y", "_z"})
        if (const PointAttribute* one = attribute_of(points, name + axis))
            components.push_back(one->value);
    if (components.size() != 3) components.clear();
    return components;
}

/// Least and largest value, of vectors by magnitude, of particles with mass.
std::pair<double, double> range_of(const ParticleValues& field, const BigVector<float>& mass) {
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;
    for (std::size_t n = 0; n < mass.size(); ++n) {
        keep_memory_at(n);
        if (!(mass[n] > 0)) continue;
        const auto at = [&](std::size_t c) { return double{field.component[c][n]}; };
        const double value =
            field.component.size() == 1 ? at(0) : length(Vec3d{at(0), at(1), at(2)});
        lower = std::min(lower, value), upper = std::max(upper, value);
    }
    return {lower, upper};
}

/// One Gaussian and its particles.
struct GaussianParticles {
    std::span<const std::uint32_t> particles;
    std::span<const Moments> parts;
    const lod::Merger& merger;
    std::size_t gaussian;

    template <std::size_t components, class Field>
    void set(const ParticleValues& values, Field& field) const {
        std::vector<lod::FieldMoments<components>> of(particles.size());
        for (std::size_t k = 0; k < of.size(); ++k)
            for (std::size_t c = 0; c < components; ++c)
                of[k].value[c] = double{values.component[c][particles[k]]};
        lod::set_field(field, gaussian, lod::merged(merger, std::span(std::as_const(of))));
    }
};

}  // namespace

std::vector<ParticleValues> particle_values(const Points& points,
                                            std::span<const PointField> fields) {
    std::vector<ParticleValues> all;
    for (const PointField& field : fields) {
        ParticleValues values;
        values.name = field.name.empty() ? field.values : field.name;
        if (std::ranges::find(all, values.name, &ParticleValues::name) != all.end())
            throw Error(fmt::format("{}: a second field named '{}', expected a name of its own",
                                    points.source.empty() ? "points" : points.source, values.name));
        if (!attribute_of(points, field.values))
            values.component = vector_values(points, field.values);
        const PointAttribute* const part = attribute_of(points, field.values + "_x");
        values.unit = values.component.empty() ? point_value_unit(points, field.values)
                      : part                   ? part->unit_name
                                               : points.velocity_unit;
        if (values.component.empty())
            values.component.push_back(point_values(points, field.values));
        for (const BigVector<float>& component : values.component)
            require_values(points, values.name, component);
        all.push_back(std::move(values));
    }
    return all;
}

void add_particle_fields(Gaussians& model, const Points& points,
                         std::span<const ParticleValues> fields, const Members& members,
                         const BigVector<float>& mass, const BigVector<double>& radius) {
    const std::size_t size = model.size();
    std::vector<std::pair<const ParticleValues*, std::size_t>> scalar, vector;
    for (const ParticleValues& values : fields) {
        const auto [lower, upper] = range_of(values, mass);
        if (values.component.size() == 1) {
            ValueCounts counts;
            for (std::size_t n = 0; n < mass.size(); ++n) {
                counts.add(values.component.front()[n], double{mass[n]});
                keep_memory_at(n);
            }
            ScalarField field{values.name,     values.unit, lower, upper, false,
                              counts.spread(), {},          {},    {},    {}};
            field.value.resize(size), field.gradient.resize(size);
            field.deviation.resize(size), field.skewness.resize(size);
            scalar.emplace_back(&values, model.fields.scalar.size());
            model.fields.scalar.push_back(std::move(field));
        } else {
            VectorField field{values.name, values.unit, lower, upper, {}, {}, {}};
            field.value.resize(size), field.covariance.resize(size);
            for (auto& gradient : field.gradient) gradient.resize(size);
            vector.emplace_back(&values, model.fields.vector.size());
            model.fields.vector.push_back(std::move(field));
        }
    }
    vog::parallel_for(std::size_t{0}, size, [&](std::size_t i) {
        const std::size_t first = i ? members.end[i - 1] : 0;
        const std::span<const std::uint32_t> own(members.particle.data() + first,
                                                 members.end[i] - first);
        std::vector<Moments> parts;
        for (const std::uint32_t n : own) {
            const double variance = radius[n] * radius[n];
            parts.push_back({double{mass[n]},
                             points.position[n] - model.origin,
                             {variance, 0, 0, variance, 0, variance}});
        }
        const lod::Merger merger(joined_moments(parts), parts);
        const GaussianParticles group{own, parts, merger, i};
        for (const auto& [values, k] : scalar) group.set<1>(*values, model.fields.scalar[k]);
        for (const auto& [values, k] : vector) group.set<3>(*values, model.fields.vector[k]);
    });
    limit_planes(model);
}

}  // namespace vog::particles
