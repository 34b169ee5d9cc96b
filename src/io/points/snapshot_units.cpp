// snapshot_units.cpp: dimensions and factors of the arrays of snapshots.
#include "io/points/snapshot_units.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>

#include "vog/units.h"

namespace vog::point_files {

namespace {

/// Exponents of length, mass, velocity and temperature, and of the Hubble parameter h and the scale factor a.
struct Exponents {
    double length = 0, mass = 0, velocity = 0, temperature = 0, h = 0, a = 0;
};

/// Those of Gadget's arrays, whose lengths are comoving and per h.
const Exponents* known_exponents(const std::string& array) {
    static const std::map<std::string, Exponents> kKnown{
        {"Coordinates", {.length = 1, .h = -1, .a = 1}},
        {"SmoothingLength", {.length = 1, .h = -1, .a = 1}},
        {"SmoothingLengths", {.length = 1, .h = -1, .a = 1}},
        {"Velocities", {.velocity = 1, .a = 0.5}},
        {"Velocity", {.velocity = 1, .a = 0.5}},
        {"Masses", {.mass = 1, .h = -1}},
        {"Mass", {.mass = 1, .h = -1}},
        {"Density", {.length = -3, .mass = 1, .h = 2, .a = -3}},
        {"Densities", {.length = -3, .mass = 1, .h = 2, .a = -3}},
        {"InternalEnergy", {.velocity = 2}},
        {"InternalEnergies", {.velocity = 2}},
        {"Temperature", {.temperature = 1}},
        {"Temperatures", {.temperature = 1}},
    };
    const auto found = kKnown.find(array);
    return found == kKnown.end() ? nullptr : &found->second;
}

std::optional<double> first_of(const AttributeReader& read,
                               std::initializer_list<const char*> names) {
    for (const char* name : names)
        if (const std::optional<double> found = read(name)) return found;
    return {};
}

/// Sets the exponents that an array states: AREPO's scalings, SWIFT's exponents of its units.
/// returns  whether the dimensions are known
bool take_stated(const AttributeReader& own, Exponents& powers) {
    const auto take = [](const std::optional<double>& stated, double& power) {
        if (stated) power = *stated;
        return stated.has_value();
    };
    take(first_of(own, {"h_scaling", "h-scale-exponent", "h-scale exponent"}), powers.h);
    take(first_of(own, {"a_scaling", "aexp-scale-exponent", "a-scale exponent"}), powers.a);
    bool known = take(own("length_scaling"), powers.length);
    known |= take(own("mass_scaling"), powers.mass);
    known |= take(own("velocity_scaling"), powers.velocity);
    if (const std::optional<double> length = own("U_L exponent")) {
        known = true;
        powers.velocity = -own("U_t exponent").value_or(0);
        powers.length = *length - powers.velocity;
        powers.mass = own("U_M exponent").value_or(0);
        powers.temperature = own("U_T exponent").value_or(0);
    }
    return known;
}

/// Largest unit of length that a number of centimetres is at least nine tenths of.
const char* length_name(double cm) {
    constexpr double kAlmost = 0.9;
    for (const char* name : {"Mpc", "kpc", "pc", "au", "km", "m"})
        if (cm >= kAlmost * *unit_factor(name, "cm")) return name;
    return "cm";
}

}  // namespace

std::string snapshot_unit(const std::string& array, const AttributeReader& own,
                          const AttributeReader& common) {
    Exponents powers;
    bool known = false;
    if (const Exponents* usual = known_exponents(array)) powers = *usual, known = true;
    known |= take_stated(own, powers);
    if (!known) return {};
    const auto positive = [](std::optional<double> number) {
        return number && *number > 0 ? number : std::nullopt;
    };
    const double h = positive(common("HubbleParam")).value_or(1),
                 a = positive(common("Scale-factor"))
                         .value_or(1 / (1 + std::max(0.0, common("Redshift").value_or(0))));
    const double scale = std::pow(h, powers.h) * std::pow(a, powers.a);
    const std::optional<double> cm = positive(
        first_of(common, {"UnitLength_in_cm", "UnitLength_In_CGS", "Unit length in cgs (U_L)"}));
    const std::optional<double> gram =
        positive(first_of(common, {"UnitMass_in_g", "UnitMass_In_CGS", "Unit mass in cgs (U_M)"}));
    std::optional<double> speed =
        positive(first_of(common, {"UnitVelocity_in_cm_per_s", "UnitVelocity_In_CGS"}));
    if (const std::optional<double> second =
            positive(first_of(common, {"Unit time in cgs (U_t)", "UnitTime_in_s"}));
        !speed && second && cm)
        speed = *cm / *second;

    // Factor to centimetres, grams and seconds.
    std::optional<double> cgs =
        positive(own("Conversion factor to physical CGS (including cosmological corrections)"));
    if (!cgs)
        if (const auto stated = positive(first_of(
                own, {"to_cgs", "CGSConversionFactor",
                      "Conversion factor to CGS (not including cosmological corrections)"})))
            cgs = *stated * scale;
    if (!cgs) {
        if ((powers.length != 0 && !cm) || (powers.mass != 0 && !gram) ||
            (powers.velocity != 0 && !speed))
            return {};
        cgs = scale * std::pow(cm.value_or(1), powers.length) *
              std::pow(gram.value_or(1), powers.mass) *
              std::pow(speed.value_or(1), powers.velocity);
    }
    constexpr double kGalaxy = 1e36;  // g, 500 Msun: smaller masses are those of laboratories
    const std::string length = length_name(cm.value_or(array == "Coordinates" ? *cgs : 1));
    std::string unit;
    const auto add = [&](const std::string& name, double power) {
        const int whole = static_cast<int>(std::lround(power));
        if (whole == 0) return;
        const std::string one = unit_product("1", name, whole);
        unit = unit.empty() ? one : unit_product(unit, one);
    };
    add(gram && *gram < kGalaxy ? "g" : "Msun", powers.mass);
    // Divisors come last: other readers take all that follows a "/" as divided.
    if (powers.length > 0) add(length, powers.length);
    add("km/s", powers.velocity);
    if (powers.length < 0) add(length, powers.length);
    add("K", powers.temperature);
    if (unit.empty()) return {};
    std::string base;
    for (const auto& [name, power] : {std::pair{"g", powers.mass},
                                      {"cm", powers.length + powers.velocity},
                                      {"s", -powers.velocity},
                                      {"K", powers.temperature}})
        if (const int whole = static_cast<int>(std::lround(power)))
            base = base.empty() ? unit_product("1", name, whole)
                                : unit_product(base, unit_product("1", name, whole));
    const std::optional<double> factor = unit_factor(base, unit);
    if (!factor || !std::isfinite(*cgs * *factor)) return {};
    // Codes write their units with seven digits.
    constexpr double kRounding = 1e-5;
    const double number = *cgs * *factor;
    if (std::abs(number - 1) < kRounding) return unit;
    return unit_product(fmt::format("{:.7g}", number), unit);
}

}  // namespace vog::point_files
