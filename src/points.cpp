// points.cpp: what is true of particles whatever file they came from.
#include "vog/points.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vog/error.h"

namespace vog {

namespace {

std::string where(const Points& points) { return points.source.empty() ? "points" : points.source; }

const PointAttribute* find_attribute(const Points& points, const std::string& name) {
    const auto found = std::ranges::find(points.attributes, name, &PointAttribute::name);
    return found == points.attributes.end() ? nullptr : &*found;
}

/// The attribute that holds the speed where there is no velocity.
const PointAttribute* speed_attribute(const Points& points) {
    const PointAttribute* speed = find_attribute(points, "speed");
    return speed ? speed : find_attribute(points, "velocity");
}

}  // namespace

Box bounds(const Points& points) {
    Box box;
    for (const Vec3d& p : points.position) box.include(p);
    return box;
}

void append(Points& points, const Points& other) {
    if (points.size() == 0) {
        points = other;
        return;
    }
    const auto same_names = [](const PointAttribute& a, const PointAttribute& b) {
        return a.name == b.name;
    };
    if (points.velocity.empty() != other.velocity.empty() ||
        !std::ranges::equal(points.attributes, other.attributes, same_names))
        throw Error(fmt::format("{}: has {}, expected those of {}: {}", where(other),
                                fmt::join(point_value_names(other), ", "), where(points),
                                fmt::join(point_value_names(points), ", ")));
    const auto join = [](auto& to, const auto& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    join(points.position, other.position);
    join(points.velocity, other.velocity);
    for (std::size_t n = 0; n < points.attributes.size(); ++n)
        join(points.attributes[n].value, other.attributes[n].value);
}

void validate(const Points& points) {
    const std::size_t count = points.size();
    const auto refuse = [&](const std::string& what) {
        throw Error(fmt::format("{}: {}", where(points), what));
    };
    if (count == 0) refuse("no particles");
    // Cells and their children are counted in 32 bits.
    if (count > 0x7fffffff) refuse(fmt::format("{} particles, expected at most 2^31 - 1", count));
    if (!points.velocity.empty() && points.velocity.size() != count)
        refuse(fmt::format("{} velocities for {} particles", points.velocity.size(), count));
    const auto finite = [](const auto& v) { return std::isfinite(v.x + v.y + v.z); };
    for (std::size_t n = 0; n < count; ++n) {
        if (!finite(points.position[n]))
            refuse(fmt::format("the position of particle {} is not finite", n));
        if (!points.velocity.empty() && !finite(points.velocity[n]))
            refuse(fmt::format("the velocity of particle {} is not finite", n));
    }
    for (const PointAttribute& attribute : points.attributes) {
        if (attribute.value.size() != count)
            refuse(fmt::format("{} values of '{}' for {} particles", attribute.value.size(),
                               attribute.name, count));
        const auto bad = std::ranges::find_if_not(attribute.value,
                                                  [](float value) { return std::isfinite(value); });
        if (bad != attribute.value.end())
            refuse(fmt::format("'{}' of particle {} is not finite", attribute.name,
                               bad - attribute.value.begin()));
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

BigVector<float> point_values(const Points& points, const std::string& name) {
    if (name == "count") return BigVector<float>(points.size(), 1.0f);
    if (name == "speed" && !points.velocity.empty()) {
        BigVector<float> speed(points.size());
        std::ranges::transform(points.velocity, speed.begin(), [](Vec3f v) {
            return static_cast<float>(length(vec_cast<double>(v)));
        });
        return speed;
    }
    const PointAttribute* attribute =
        name == "speed" ? speed_attribute(points) : find_attribute(points, name);
    if (!attribute)
        throw Error(fmt::format("{}: no value named '{}' (it has: {})", where(points), name,
                                fmt::join(point_value_names(points), ", ")));
    return attribute->value;
}

}  // namespace vog
