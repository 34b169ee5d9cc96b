// snapshot_units.h: units of the arrays of a snapshot, from the numbers that Gadget, AREPO, EAGLE and SWIFT state.
#pragma once

#include <functional>
#include <optional>
#include <string>

namespace vog::point_files {

/// Number of an attribute by its name; none: there is no such attribute.
using AttributeReader = std::function<std::optional<double>(const char* name)>;

/// Unit of an array, physical: a factor with the Hubble parameter and the scale factor of the snapshot, and Msun, kpc, km/s
/// or the like: "1.476233 kpc". Empty: not known.
/// array   name: Coordinates, Masses, ...
/// own     attributes of the array: SWIFT's and EAGLE's conversion factors, AREPO's to_cgs
/// common  attributes of the snapshot: UnitLength_in_cm, HubbleParam, Redshift, ...
std::string snapshot_unit(const std::string& array, const AttributeReader& own,
                          const AttributeReader& common);

}  // namespace vog::point_files
