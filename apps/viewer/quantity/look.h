// look.h: shading settings of the window, from T to colour; changing them renders nothing again.
#pragma once

#include <string>
#include <vector>

#include "vog/shade.h"

namespace vog::viewer {

/// Colour map with range, gamma and inversion, which move its colours along V = 1 - exp(-T), and
/// opacity points at given V.
struct Look {
    std::string map = kDefaultMap;  ///< name of a map, or JSON file of the colours
    TransferFunction base = named_transfer_function(kDefaultMap);
    std::vector<OpacityPoint> opacity;  ///< empty: opaque; else sorted by v
    float low = 0, high = 1;            ///< V of the map's first and last colour, low < high
    float gamma = 1;                    ///< colours at ((V - low) / (high - low))^gamma, (0, 10]
    bool invert = false;
    ShadeOptions shading;
    double extinction = 1;  ///< factor on density, > 0
};

/// Sets the colours to those of a named map, or to the colours and opacity of a JSON file.
/// throws vog::Error as load_transfer_function does, and leaves the look unchanged
void load_map(Look& look, const std::string& name_or_file);

/// Transfer function of the look, with range, gamma and inversion applied to its points. A gamma
/// other than 1 is approximated by linear pieces, within 1/255.
TransferFunction transfer_function(const Look& look);

/// Colours of maps over their scale: the look's map, gamma and inversion, without its range of visibility; opacity is
/// that of the map's file.
TransferFunction map_function(const Look& look);

}  // namespace vog::viewer
