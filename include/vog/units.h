// vog/units.h: units in texts, "g/cm2" or "Msun kpc**-2", and the factors between them.
#pragma once

#include <optional>
#include <string>

namespace vog {

/// Length in metres: number * 10^power. The factors are apart because powers of ten above 1 are exact in doubles.
struct LengthUnit {
    double number;
    int power;
};
/// A unit of length by its name, those of OME, FITS and programs: "um", "kpc"; null: none of them.
const LengthUnit* length_unit(const std::string& name);
/// The name under which length_unit has a unit: "um" for "µm", "micron" and "micrometer"; other names as they are.
std::string length_unit_name(const std::string& unit);

/// Factor from numbers in one unit to numbers in another: 3.0856775814913673e21 from "kpc" to "cm". Units are products of names
/// with whole exponents (cm2, cm^-2, cm**2, cm²), apart by blanks, * or ., and divided by what follows a /, and may have a number in front. Names that are not known,
/// such as HU or counts, are units of their own.
/// returns  nothing where the two do not measure the same, or one is no such product
std::optional<double> unit_factor(const std::string& from, const std::string& to);

/// Checks that what is put into one space has one unit of length. A unit that is not known fits all.
/// where, of  the places in the message: "a.nii: lengths in 'um', expected 'mm' as in b.nii"
/// throws     vog::Error where the units differ
void require_same_length(const std::string& unit, const std::string& where,
                         const std::string& expected, const std::string& of);

/// Text of the unit a * b^power: "g/cm3 kpc" of "g/cm3" and "kpc", "Msun/kpc2" of "Msun/kpc3" and "kpc". Names and numbers are
/// collected in the order in which they come. Empty where a text is empty, or power is not 1 and a text is no product.
std::string unit_product(const std::string& a, const std::string& b, int power = 1);

}  // namespace vog
