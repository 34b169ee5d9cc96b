// look.h: how T becomes colour, as the editor has it: everything that may change without rendering.
#pragma once

#include <string>
#include <vector>

#include "vog/shade.h"

namespace vog::viewer {

/// Range, gamma and inversion move the map's colours along V; opacity points stand at V itself.
struct Look {
    std::string map = "inferno";  ///< a name, or the JSON file the colours came from
    TransferFunction base = named_transfer_function("inferno");
    std::vector<OpacityPoint> opacity;  ///< empty: opaque; else sorted by v
    float low = 0, high = 1;            ///< V of the map's first and last colour, low < high
    float gamma = 1;                    ///< colours at ((V - low) / (high - low))^gamma, (0, 10]
    bool invert = false;
    ShadeOptions shading;
    double extinction = 1;
};

/// Takes the colours of a map by name, or from a file, and that file's opacity with them.
/// throws vog::Error as load_transfer_function does; the look is then as it was
void load_map(Look& look, const std::string& name_or_file);

/// What vog::shade takes for this look: range, gamma and inversion are in the points. With a gamma
/// other than 1 the curve is drawn in straight pieces, within 1/255 of it.
TransferFunction transfer_function(const Look& look);

/// `--extinction ... --tf ... --background ...` for vog render; `tf_file` where the look is not a
/// map by name.
std::string look_flags(const Look& look, const std::string& tf_file);
/// Whether the map's name alone says it all.
bool is_plain(const Look& look);

}  // namespace vog::viewer
