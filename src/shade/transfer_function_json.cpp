// transfer_function_json.cpp: reading of ParaView's JSON colour maps and vog's own format
// (docs/transfer_functions.md), writing of the latter.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "shade/color_spaces.h"
#include "shade/transfer_function.h"
#include "shade/transfer_json.h"
#include "shade/values/unit_range.h"
#include "vog/error.h"
#include "vog/value_transfer.h"

namespace vog {

using namespace shading;
namespace {

using nlohmann::json;

double number(const json& value, const std::string& where) {
    if (!value.is_number())
        throw Error(fmt::format("{}: {}, expected a number", where, value.type_name()));
    return value.get<double>();
}

/// Boolean, or number as ParaView writes it (0 is false); false if absent.
bool flag(const json& object, const char* key, const std::string& where) {
    const auto found = object.find(key);
    if (found == object.end()) return false;
    if (found->is_boolean()) return found->get<bool>();
    return number(*found, where + key) != 0;
}

/// Rows of numbers, the first of which is sorted.
using Rows = std::vector<std::vector<double>>;

void require_sorted(const Rows& rows, const std::string& where) {
    if (rows.empty()) throw Error(fmt::format("{}: no points, expected at least one", where));
    for (std::size_t i = 1; i < rows.size(); ++i)
        if (rows[i][0] < rows[i - 1][0])
            throw Error(fmt::format("{}: point {} at {} after {}, expected sorted points", where, i,
                                    rows[i][0], rows[i - 1][0]));
}

/// Rows of ParaView's flat lists: [x, r, g, b, x, r, g, b, ...].
Rows flat_rows(const json& list, std::size_t columns, const std::string& where) {
    if (!list.is_array())
        throw Error(fmt::format("{}: {}, expected an array", where, list.type_name()));
    if (list.size() % columns != 0)
        throw Error(
            fmt::format("{}: {} numbers, expected a multiple of {}", where, list.size(), columns));
    Rows rows(list.size() / columns);
    for (std::size_t i = 0; i < list.size(); ++i)
        rows[i / columns].push_back(number(list[i], fmt::format("{}[{}]", where, i)));
    require_sorted(rows, where);
    return rows;
}

/// Rows of vog's nested lists: [[v, r, g, b], [v, r, g, b], ...].
Rows nested_rows(const json& list, std::size_t columns, const std::string& where) {
    if (!list.is_array())
        throw Error(fmt::format("{}: {}, expected an array", where, list.type_name()));
    Rows rows;
    for (const json& entry : list) {
        const std::string place = fmt::format("{}[{}]", where, rows.size());
        if (!entry.is_array() || entry.size() != columns)
            throw Error(fmt::format("{}: expected an array of {} numbers", place, columns));
        std::vector<double>& row = rows.emplace_back();
        for (const json& value : entry) row.push_back(number(value, place));
    }
    require_sorted(rows, where);
    return rows;
}

ColorPoint color_point(double v, const std::vector<double>& row) {
    return {static_cast<float>(v), static_cast<float>(row[1]), static_cast<float>(row[2]),
            static_cast<float>(row[3])};
}

struct ColorMapSpace {
    ColorSpace space = ColorSpace::kRgb;
    bool step = false;  ///< constant intervals with the colour of their right end
};

ColorMapSpace color_map_space(const json& preset, const std::string& where) {
    const auto key = preset.find("ColorSpace");
    if (key == preset.end()) return {};
    const std::string name = key->is_string() ? key->get<std::string>() : key->dump();
    if (name == "RGB") return {};
    if (name == "Step") return {ColorSpace::kRgb, true};
    if (name == "Lab" || name == "CIELAB") return {ColorSpace::kLab, false};
    if (name == "Diverging") return {ColorSpace::kDiverging, false};
    if (name == "HSV")
        return {flag(preset, "HSVWrap", where) ? ColorSpace::kHsvWrapped : ColorSpace::kHsv, false};
    throw Error(fmt::format("{}ColorSpace: '{}', expected RGB, Lab, CIELAB, Diverging, HSV or Step",
                            where, name));
}

std::vector<ColorPoint> with_steps(const std::vector<ColorPoint>& control) {
    std::vector<ColorPoint> points;
    for (std::size_t i = 1; i < control.size(); ++i) {
        ColorPoint left = control[i];
        left.v = control[i - 1].v;
        points.push_back(left);
        points.push_back(control[i]);
    }
    return points;
}

/// VTK's vtkPiecewiseFunction: from y0 to y1 over s in [0, 1], through their mean at `midpoint`;
/// linear at sharpness 0, a step at 1.
double sharpened(double y0, double y1, double midpoint, double sharpness, double s) {
    midpoint = std::clamp(midpoint, 1e-5, 1 - 1e-5);
    s = s < midpoint ? 0.5 * s / midpoint : 0.5 + 0.5 * (s - midpoint) / (1 - midpoint);
    if (sharpness < 0.01) return (1 - s) * y0 + s * y1;
    // Moves s towards the ends, then a Hermite curve with equal slopes at both.
    const double power = 1 + 10 * sharpness;
    s = s < 0.5 ? 0.5 * std::pow(2 * s, power) : 1 - 0.5 * std::pow(2 * (1 - s), power);
    const double rise = s * s * (3 - 2 * s), lean = s * (1 - s) * (1 - 2 * s);
    const double slope = (1 - sharpness) * (y1 - y0);
    return std::clamp(y0 + rise * (y1 - y0) + lean * slope, std::min(y0, y1), std::max(y0, y1));
}

/// Opacity from ParaView's list [x, opacity, midpoint, sharpness, ...].
std::vector<ValueOpacity> paraview_opacity(const json& list, const std::string& where) {
    const Rows rows = flat_rows(list, 4, where);
    for (const auto& row : rows)
        for (std::size_t c = 1; c < 4; ++c)
            if (!(row[c] >= 0 && row[c] <= 1))
                throw Error(fmt::format(
                    "{}: point at {} has {}, expected opacity, midpoint and sharpness in [0, 1]",
                    where, row[0], row[c]));
    std::vector<ValueOpacity> points;
    const auto add = [&](double x, double opacity) { points.push_back({x, opacity}); };
    add(rows[0][0], rows[0][1]);
    for (std::size_t i = 1; i < rows.size(); ++i) {
        const std::vector<double>&a = rows[i - 1], &b = rows[i];
        const double width = b[0] - a[0];
        const auto x_at = [&](double s) { return std::min(a[0] + s * width, b[0]); };
        if (a[3] > 0.99) {  // VTK's step at the midpoint
            add(x_at(a[2]), a[1]);
            add(x_at(a[2]), b[1]);
        } else if (width > 0) {
            const auto curve = [&](double s) -> Color {
                return {sharpened(a[1], b[1], a[2], a[3], s), 0, 0};
            };
            for (const auto& [s, value] : sample_curve(curve)) add(x_at(s), value[0]);
        }
        add(b[0], b[1]);
    }
    return points;
}

void set_unit_distance(const json& value, const std::string& where, TransferPoints& read) {
    const double length = number(value, where);
    if (!(length > 0 && std::isfinite(length)))
        throw Error(fmt::format("{}: {}, expected a length > 0", where, length));
    read.points.unit_distance = length;
    read.has_unit_distance = true;
}

TransferPoints from_paraview(const json& preset, const std::string& where) {
    TransferFunction tf;
    TransferPoints read;
    read.at_values = true;
    if (const auto name = preset.find("Name"); name != preset.end() && name->is_string())
        read.points.name = name->get<std::string>();
    const auto list = preset.find("RGBPoints");
    if (list == preset.end())
        throw Error(fmt::format(
            "{}no RGBPoints{}", where,
            preset.contains("IndexedColors") ? " (a map of categories has no range)" : ""));
    if (flag(preset, "UseLogScale", where))
        throw Error(fmt::format("{}UseLogScale: expected a linear map", where));

    // Colours are sampled at shares of the scalars' range; control points keep their scalars.
    const Rows rows = flat_rows(*list, 4, where + "RGBPoints");
    const double lowest = rows.front()[0], range = rows.back()[0] - lowest;
    if (!(range > 0 && std::isfinite(range)))
        throw Error(
            fmt::format("{}RGBPoints: scalars from {} to {}, expected a finite range above 0",
                        where, lowest, rows.back()[0]));
    std::map<float, double> scalars;
    for (const auto& row : rows) {
        tf.color.push_back(color_point((row[0] - lowest) / range, row));
        scalars.emplace(tf.color.back().v, row[0]);
    }
    require_valid(where + "RGBPoints", tf);
    const ColorMapSpace space = color_map_space(preset, where);
    tf.color = space.step ? with_steps(tf.color) : sample_colors(space.space, tf.color);
    for (const ColorPoint& point : tf.color) {
        const auto scalar = scalars.find(point.v);
        const double value =
            scalar != scalars.end() ? scalar->second : lowest + double{point.v} * range;
        read.points.color.push_back({value, point.r, point.g, point.b});
    }
    read.lower = lowest, read.upper = rows.back()[0];
    if (const auto points = preset.find("Points"); points != preset.end() && !points->is_null())
        read.points.opacity = paraview_opacity(*points, where + "Points");
    if (const auto unit = preset.find("ScalarOpacityUnitDistance"); unit != preset.end())
        set_unit_distance(*unit, where + "ScalarOpacityUnitDistance", read);
    return read;
}

/// "domain": [lo, hi]
void set_domain(const json& value, const std::string& where, TransferPoints& read) {
    if (!value.is_array() || value.size() != 2)
        throw Error(fmt::format("{}: expected an array of 2 numbers", where));
    read.lower = number(value[0], where), read.upper = number(value[1], where);
    if (!(read.lower < read.upper) || !std::isfinite(read.upper - read.lower))
        throw Error(fmt::format("{}: {} to {}, expected the first below the second", where,
                                read.lower, read.upper));
    read.at_values = true;
}

TransferPoints from_vog(const json& object, const std::string& where) {
    for (const auto& [key, value] : object.items())
        if (key != "name" && key != "colors" && key != "opacity" && key != "domain" &&
            key != "unit_distance" && key != "gradient_opacity")
            throw Error(
                fmt::format("{}unknown key '{}', expected name, colors, opacity, domain, "
                            "unit_distance and gradient_opacity",
                            where, key));
    TransferPoints read;
    if (const auto domain = object.find("domain"); domain != object.end())
        set_domain(*domain, where + "domain", read);
    if (const auto unit = object.find("unit_distance"); unit != object.end())
        set_unit_distance(*unit, where + "unit_distance", read);
    const json& colors = object.at("colors");
    if (colors.is_string()) {
        const std::string name = colors.get<std::string>();
        if (!is_transfer_function_name(name))
            throw Error(fmt::format("{}colors: '{}', expected points or one of {}", where, name,
                                    transfer_function_name_list()));
        const TransferFunction named = named_transfer_function(name);
        read.points.name = named.name;
        for (const ColorPoint& point : named.color)
            read.points.color.push_back({read.lower + double{point.v} * (read.upper - read.lower),
                                         point.r, point.g, point.b});
    } else {
        for (const auto& row : nested_rows(colors, 4, where + "colors"))
            read.points.color.push_back({row[0], static_cast<float>(row[1]),
                                         static_cast<float>(row[2]), static_cast<float>(row[3])});
    }
    if (const auto opacity = object.find("opacity"); opacity != object.end())
        for (const auto& row : nested_rows(*opacity, 2, where + "opacity"))
            read.points.opacity.push_back({row[0], row[1]});
    if (const auto gradient = object.find("gradient_opacity"); gradient != object.end())
        for (const auto& row : nested_rows(*gradient, 2, where + "gradient_opacity"))
            read.points.gradient.push_back({row[0], row[1]});
    validate(read.points.gradient);
    if (const auto name = object.find("name"); name != object.end()) {
        if (!name->is_string())
            throw Error(fmt::format("{}name: {}, expected a string", where, name->type_name()));
        read.points.name = name->get<std::string>();
    }
    return read;
}

TransferPoints from_json(const json& root, const std::string& where) {
    if (root.is_array()) {
        if (root.empty() || !root.front().is_object())
            throw Error(fmt::format("{}an array without a preset, expected ParaView's", where));
        return from_paraview(root.front(), where);
    }
    if (root.is_object() && root.contains("RGBPoints")) return from_paraview(root, where);
    if (root.is_object() && root.contains("colors")) return from_vog(root, where);
    throw Error(
        fmt::format("{}no transfer function, expected an array of ParaView presets (RGBPoints) or "
                    "an object with colors",
                    where));
}

/// Text of a list of points, one a line: formatted here, not by the JSON library, with shortest digits.
/// columns  numbers of a point
template <class Point, class Columns>
std::string points_text(const char* key, const std::vector<Point>& points, const Columns& columns) {
    std::string text = fmt::format(",\n  \"{}\": [", key);
    const char* separator = "\n";
    for (const Point& point : points) {
        text += fmt::format("{}    [{}]", separator, columns(point));
        separator = ",\n";
    }
    return text + "\n  ]";
}

std::string name_text(const std::string& name) {
    return fmt::format("{{\n  \"name\": {}",
                       json(name).dump(-1, ' ', true, json::error_handler_t::replace));
}

}  // namespace

TransferPoints shading::points_of(const json& root, const std::string& where) {
    TransferPoints read = from_json(root, where);
    require_valid(where.substr(0, where.size() - 2), over_unit_range(read));
    return read;
}

nlohmann::ordered_json shading::points_json(const TransferPoints& given) {
    const ValueTransfer& points = given.points;
    if (!given.at_values && is_transfer_function_name(points.name) &&
        transfer_points(points.name).points == points)
        return points.name;
    nlohmann::ordered_json json{{"name", points.name}};
    if (given.at_values) json["domain"] = {given.lower, given.upper};
    if (given.has_unit_distance) json["unit_distance"] = points.unit_distance;
    json["colors"] = nlohmann::ordered_json::array();
    for (const ValueColor& p : points.color) json["colors"].push_back({p.value, p.r, p.g, p.b});
    for (const ValueOpacity& p : points.opacity) json["opacity"].push_back({p.value, p.opacity});
    for (const auto& [at, factor] : points.gradient)
        json["gradient_opacity"].push_back({at, factor});
    return json;
}

void write_transfer_function(const std::filesystem::path& file, const TransferFunction& tf) {
    require_valid("transfer function " + tf.name, tf);
    std::string text =
        name_text(tf.name) + points_text("colors", tf.color, [](const ColorPoint& p) {
            return fmt::format("{}, {}, {}, {}", p.v, p.r, p.g, p.b);
        });
    if (!tf.opacity.empty())
        text += points_text("opacity", tf.opacity, [](const OpacityPoint& p) {
            return fmt::format("{}, {}", p.v, p.opacity);
        });
    text += "\n}\n";
    write_file(file, [&](std::ofstream& out) { out << text; });
}

TransferPoints transfer_points(const ValueTransfer& transfer) {
    validate(transfer);
    const double low = std::min(transfer.color.front().value, transfer.opacity.front().value);
    const double high = std::max(transfer.color.back().value, transfer.opacity.back().value);
    return {transfer, true, low, high > low ? high : low + std::max(std::abs(low), 1.0), true};
}

void write_value_transfer(const std::filesystem::path& file, const ValueTransfer& transfer) {
    const TransferPoints points = transfer_points(transfer);
    std::string text = name_text(transfer.name) +
                       fmt::format(",\n  \"domain\": [{}, {}],\n  \"unit_distance\": {}",
                                   points.lower, points.upper, transfer.unit_distance) +
                       points_text("colors", transfer.color,
                                   [](const ValueColor& p) {
                                       return fmt::format("{}, {}, {}, {}", p.value, p.r, p.g, p.b);
                                   }) +
                       points_text("opacity", transfer.opacity, [](const ValueOpacity& p) {
                           return fmt::format("{}, {}", p.value, p.opacity);
                       });
    if (!transfer.gradient.empty())
        text += points_text("gradient_opacity", transfer.gradient, [](const GradientOpacity& p) {
            return fmt::format("{}, {}", p.magnitude, p.factor);
        });
    text += "\n}\n";
    write_file(file, [&](std::ofstream& out) { out << text; });
}

}  // namespace vog
