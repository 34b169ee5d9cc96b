// model_json.h: descriptions of models and their fields as JSON, in compact files and in manifests of sites.
#pragma once

#include <fmt/core.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "data/fields/field_arrays.h"
#include "vog/error.h"
#include "vog/gaussians.h"

namespace vog {

inline nlohmann::ordered_json vector_json(Vec3d v) { return {v.x, v.y, v.z}; }
/// throws  vog::Error for a number that is not finite, nlohmann::json::exception for another type
inline Vec3d vector_of(const nlohmann::ordered_json& json) {
    const auto v = json.get<std::array<double, 3>>();
    for (const double x : v)
        if (!std::isfinite(x)) throw Error("a number that is not finite");
    return {v[0], v[1], v[2]};
}

/// Six digits, rounded up or down: boxes and errors may grow, not shrink.
inline double six_digits(double v, bool up) {
    constexpr double kSlack = 6e-6;  // of six digits' rounding, 5e-6, and a bit
    return std::stod(fmt::format("{:.6g}", v + (up ? kSlack : -kSlack) * std::abs(v)));
}

inline nlohmann::ordered_json box_json(const Box& box) {
    return {vector_json(box.lower), vector_json(box.upper)};
}
/// throws  as vector_of; vog::Error for a box that is inside out
inline Box box_from(const nlohmann::ordered_json& json) {
    const Box box{vector_of(json.at(0)), vector_of(json.at(1))};
    if (box.empty()) throw Error("a box whose lower corner is above the upper one");
    return box;
}

/// Adds cutoff, origin, texts, box and content.
inline void put_description(nlohmann::ordered_json& json, const Gaussians& model) {
    json["cutoff"] = model.cutoff;
    json["origin"] = vector_json(model.origin);
    json["source_voxels"] = model.source_voxels;
    json["source"] = model.source;
    json["method"] = model.method;
    json["options"] = model.options;
    json["summary"] = model.summary;
    if (!model.box.empty()) json["box"] = box_json(model.box);
    if (!model.content.voxels.empty()) json["voxels"] = box_json(model.content.voxels);
    if (const Standing& standing = model.content.standing; standing.known()) {
        json["up"] = vector_json(standing.up);
        if (standing.front != Vec3d{}) json["front"] = vector_json(standing.front);
    }
    if (const Units& units = model.content.units; units != Units{})
        json["units"] = {{"length", units.length}, {"density", units.density}};
    if (model.content.by_value) json["by_value"] = true;
    for (const Vec3d& point : model.content.hull) json["hull"].push_back(vector_json(point));
}
/// Sets cutoff, origin, texts, box and content.
/// throws  as vector_of
inline void take_description(const nlohmann::ordered_json& json, Gaussians& model) {
    model.cutoff = json.at("cutoff");
    model.origin = vector_of(json.at("origin"));
    model.source_voxels = json.at("source_voxels");
    model.source = json.at("source"), model.method = json.at("method");
    model.options = json.at("options"), model.summary = json.at("summary");
    if (json.contains("box")) model.box = box_from(json["box"]);
    if (json.contains("voxels")) model.content.voxels = box_from(json["voxels"]);
    if (json.contains("up")) model.content.standing.up = vector_of(json["up"]);
    if (json.contains("front")) model.content.standing.front = vector_of(json["front"]);
    if (json.contains("units"))
        model.content.units = {json["units"].at("length"), json["units"].at("density")};
    model.content.by_value = json.value("by_value", false);
    if (json.contains("hull"))
        for (const auto& point : json["hull"]) model.content.hull.push_back(vector_of(point));
}

/// Name, kind, unit, range and spread of each field, scalar ones first.
inline nlohmann::ordered_json fields_json(const Fields& fields) {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    const auto add = [&](const auto& field, const char* kind) {
        all.push_back({{"name", field.name},
                       {"kind", kind},
                       {"unit", field.unit},
                       {"lower", field.lower},
                       {"upper", field.upper}});
    };
    for (const ScalarField& field : fields.scalar) {
        add(field, field.is_measure ? "measure" : "scalar");
        if (const ValueSpread& s = field.spread; s.known)
            all.back()["spread"] = {s.low, s.middle, s.high};
        if (field.background != 0) all.back()["background"] = field.background;
    }
    for (const VectorField& field : fields.vector) add(field, "vector");
    return all;
}
/// throws  vog::Error for fields in another order or of another kind, and as check_descriptions
inline Fields fields_of(const nlohmann::ordered_json& json) {
    Fields fields;
    const auto set = [](auto& field, const nlohmann::ordered_json& from) {
        field.name = from.at("name"), field.unit = from.at("unit");
        field.lower = from.at("lower"), field.upper = from.at("upper");
    };
    for (const nlohmann::ordered_json& field : json) {
        const std::string kind = field.at("kind");
        if (kind == "vector") {
            set(fields.vector.emplace_back(), field);
        } else if (kind == "scalar" || kind == "measure") {
            if (!fields.vector.empty()) throw Error("a scalar field behind a vector field");
            set(fields.scalar.emplace_back(), field);
            fields.scalar.back().is_measure = kind == "measure";
            fields.scalar.back().background = field.value("background", 0.0);
            if (!field.contains("spread")) continue;
            const Vec3d spread = vector_of(field["spread"]);
            fields.scalar.back().spread = {spread.x, spread.y, spread.z, true};
        } else {
            throw Error(fmt::format("a field of the kind {}", kind));
        }
    }
    check_descriptions(fields);
    return fields;
}

}  // namespace vog
