// points.cpp: bounds, joining, validation and named values of particles.
#include "vog/points.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/paging.h"
#include "vog/error.h"

namespace vog {

namespace {

std::string where(const Points& points) { return points.source.empty() ? "points" : points.source; }

const PointAttribute* find_attribute(const Points& points, const std::string& name) {
    const auto found = std::ranges::find(points.attributes, name, &PointAttribute::name);
    return found == points.attributes.end() ? nullptr : &*found;
}

/// Attribute with the speed of each particle, for data without velocity vectors; null if absent.
const PointAttribute* speed_attribute(const Points& points) {
    const PointAttribute* speed = find_attribute(points, "speed");
    return speed ? speed : find_attribute(points, "velocity");
}

}  // namespace

std::uint64_t clip_negative(Points& points, const std::string& name) {
    const auto found = std::ranges::find(points.attributes, name, &PointAttribute::name);
    if (found == points.attributes.end()) return 0;
    std::uint64_t clipped = 0;
    for (float& value : found->value) {
        clipped += value < 0;
        value = std::max(value, 0.0f);
    }
    return clipped;
}

Box bounds(const Points& points) {
    Box box;
    for (std::size_t n = 0; n < points.size(); ++n) {
        box.include(points.position[n]);
        keep_memory_at(n);
    }
    return box;
}

void append(Points& points, const Points& other) {
    if (points.size() == 0) {
        points = other;
        return;
    }
    const auto require_unit = [&](const std::string& what, const std::string& more,
                                  const std::string& own) {
        const auto shown = [](const std::string& unit) {
            return unit.empty() ? "no unit" : "'" + unit + "'";
        };
        if (more != own)
            throw Error(fmt::format("{}: {} in {}, expected {} as in {}", where(other), what,
                                    shown(more), shown(own), where(points)));
    };
    require_unit("positions", other.length_unit, points.length_unit);
    const auto same_names = [](const PointAttribute& a, const PointAttribute& b) {
        return a.name == b.name;
    };
    if (points.velocity.empty() != other.velocity.empty() ||
        !std::ranges::equal(points.attributes, other.attributes, same_names))
        throw Error(fmt::format("{}: has {}, expected those of {}: {}", where(other),
                                fmt::join(point_value_names(other), ", "), where(points),
                                fmt::join(point_value_names(points), ", ")));
    require_unit("velocities", other.velocity_unit, points.velocity_unit);
    for (std::size_t n = 0; n < points.attributes.size(); ++n)
        require_unit("'" + points.attributes[n].name + "'", other.attributes[n].unit_name,
                     points.attributes[n].unit_name);
    if (points.box.empty()) points.box = other.box;
    append_kept(points.position, other.position);
    append_kept(points.velocity, other.velocity);
    const auto multiply = [](BigVector<float>& values, std::size_t first, double factor) {
        for (std::size_t n = first; n < values.size(); ++n)
            values[n] = static_cast<float>(factor * double{values[n]});
    };
    const auto is_zero = [](const PointAttribute& attribute) {  // in any unit
        return std::ranges::none_of(attribute.value, [](float v) { return std::abs(v) > 0; });
    };
    for (std::size_t n = 0; n < points.attributes.size(); ++n) {
        PointAttribute& own = points.attributes[n];
        const PointAttribute& more = other.attributes[n];
        const double unit = own.unit == more.unit || is_zero(more) ? own.unit
                            : is_zero(own)                         ? more.unit
                                                                   : std::max(own.unit, more.unit);
        const std::size_t count = own.value.size();
        if (own.unit < unit) multiply(own.value, 0, own.unit / unit);
        append_kept(own.value, more.value);
        if (more.unit < unit) multiply(own.value, count, more.unit / unit);
        own.unit = unit;
    }
}

void validate(const Points& points) {
    const std::size_t count = points.size();
    const auto refuse = [&](const std::string& what) {
        throw Error(fmt::format("{}: {}", where(points), what));
    };
    if (count == 0) refuse("no particles");
    // Conversion counts cells and their children in 32 bits.
    if (count > 0x7fffffff) refuse(fmt::format("{} particles, expected at most 2^31 - 1", count));
    if (!points.velocity.empty() && points.velocity.size() != count)
        refuse(fmt::format("{} velocities for {} particles", points.velocity.size(), count));
    for (std::size_t n = 0; n < count; ++n) {
        const Vec3d p = points.position[n];
        if (!std::isfinite(p.x + p.y + p.z))
            refuse(fmt::format("the position of particle {} is not finite", n));
        if (const Vec3f v = points.velocity.empty() ? Vec3f{} : points.velocity[n];
            std::isinf(v.x) || std::isinf(v.y) || std::isinf(v.z))
            refuse(fmt::format("the velocity of particle {} is not finite", n));
        keep_memory_at(n);
    }
    for (const PointAttribute& attribute : points.attributes) {
        if (attribute.value.size() != count)
            refuse(fmt::format("{} values of '{}' for {} particles", attribute.value.size(),
                               attribute.name, count));
        for (std::size_t n = 0; n < count; ++n) {
            if (std::isinf(attribute.value[n]))
                refuse(fmt::format("'{}' of particle {} is not finite", attribute.name, n));
            keep_memory_at(n);
        }
    }
}

std::vector<std::string> point_value_names(const Points& points) {
    std::vector<std::string> names{"count"};
    if (!points.velocity.empty() || speed_attribute(points)) names.emplace_back("speed");
    for (const PointAttribute& attribute : points.attributes)
        if (std::ranges::find(names, attribute.name) == names.end())
            names.push_back(attribute.name);
    return names;
}

SmoothingRadius smoothing_radius(const Points& points) {
    for (const auto& [name, factor] : {std::pair{"SmoothingLength", 1.0},
                                       {"smoothing_length", 1.0},
                                       {"hsml", 1.0},
                                       {"SmoothingLengths", 1.825742}})
        if (find_attribute(points, name)) return {name, factor};
    return {};
}

std::string point_value_unit(const Points& points, const std::string& name) {
    if (name == "count") return "1";
    if (name == "speed" && !points.velocity.empty()) return points.velocity_unit;
    const PointAttribute* attribute =
        name == "speed" ? speed_attribute(points) : find_attribute(points, name);
    if (!attribute || attribute->unit_name.empty()) return {};
    return attribute->unit == 1 ? attribute->unit_name
                                : fmt::format("{:g} {}", attribute->unit, attribute->unit_name);
}

void require_values(const Points& points, const std::string& name, const BigVector<float>& values) {
    for (std::size_t n = 0; n < values.size(); ++n)
        if (std::isnan(values[n]))
            throw Error(
                fmt::format("{}: '{}' of particle {} is missing, expected a number "
                            "(--skip-nonfinite leaves such particles out)",
                            where(points), name, n));
}

BigVector<float> point_values(const Points& points, const std::string& name, bool missing) {
    BigVector<float> values;
    values.reserve(points.size());
    const auto take = [&](const auto& value_of) {
        for (std::size_t n = 0; n < points.size(); ++n) {
            values.push_back(value_of(n));
            keep_memory_at(n);
        }
        if (!missing) require_values(points, name, values);
        return values;
    };
    if (name == "count") return take([](std::size_t) { return 1.0f; });
    if (name == "speed" && !points.velocity.empty())
        return take([&](std::size_t n) {
            return static_cast<float>(length(vec_cast<double>(points.velocity[n])));
        });
    const PointAttribute* attribute =
        name == "speed" ? speed_attribute(points) : find_attribute(points, name);
    if (!attribute)
        throw Error(fmt::format("{}: no value named '{}' (it has: {})", where(points), name,
                                fmt::join(point_value_names(points), ", ")));
    return take([&](std::size_t n) { return attribute->value[n]; });
}

}  // namespace vog
