// vog/shade.h: colours of optical depth T by a transfer function.
//   V = 1 - exp(-T);  colour = transfer_function(V) where T > 0, background elsewhere
// V is one minus transmittance, [0, 1]. New colours need no new rendering.
// Source: Sharma & Schmalstieg, section 4.1.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "vog/image.h"

namespace vog {

/// Control point of a transfer function's colour.
struct ColorPoint {
    float v = 0;                ///< V, [0, 1]
    float r = 0, g = 0, b = 0;  ///< red, green, blue as displayed, [0, 1]
};
/// Control point of a transfer function's opacity.
struct OpacityPoint {
    float v = 0;        ///< V, [0, 1]
    float opacity = 1;  ///< weight of the colour against the background, [0, 1]
};

/// Transfer function from V to colour and opacity, each piecewise linear between its points and
/// constant beyond the first and last. Two points of one v make a step; at v the second one holds.
struct TransferFunction {
    std::string name;                   ///< "inferno"; may be empty
    std::vector<ColorPoint> color;      ///< at least one, sorted by v
    std::vector<OpacityPoint> opacity;  ///< sorted by v; empty: opacity 1
};

/// Map of pictures whose user has not chosen one: inferno without its dark end, so that thin fog has a colour on black.
inline constexpr const char* kDefaultMap = "ember";

/// Colour of a transfer function at one V, with the opacity as alpha.
/// v       [0, 1]
/// throws  vog::Error for a v out of range or an invalid tf
Rgba color_at(const TransferFunction& tf, float v);

/// Names that named_transfer_function takes: "gray", "viridis", "inferno", ...
std::vector<std::string> transfer_function_names();
/// Opaque transfer function by name, upper or lower case, '_' as good as '-'.
/// throws  vog::Error listing the names for an unknown one
TransferFunction named_transfer_function(const std::string& name);

/// Reads a transfer function from vog's own JSON, where "colors" may also be a name,
///   {"name": "...", "colors": [[v, r, g, b], ...], "opacity": [[v, a], ...]}
/// or the first preset of a ParaView colour map (a JSON array of presets with RGBPoints and
/// optional Points). ParaView's scalar range becomes V in [0, 1]. ColorSpace RGB, Lab, Diverging,
/// HSV and Step, midpoints and sharpness are sampled, exact to half an 8-bit step.
/// throws  vog::Error naming the file and the key
TransferFunction read_transfer_function(const std::filesystem::path& file);
/// Writes vog's own JSON, beside the file, renamed when whole.
/// throws  vog::Error for an invalid tf, or if the file cannot be written
void write_transfer_function(const std::filesystem::path& file, const TransferFunction& tf);
/// Transfer function by name, or else read from a JSON file.
/// name_or_file  a name of transfer_function_names, or a path
/// throws        vog::Error as read_transfer_function does
TransferFunction load_transfer_function(const std::string& name_or_file);

/// Transfer function of colours at evenly spaced V, the first at 0, the last at 1.
/// name    name of the result
/// colors  at least one, components in [0, 1]; alpha is the opacity
/// throws  vog::Error for no colour, or a component out of range
TransferFunction sampled_transfer_function(const std::string& name, std::span<const Rgba> colors);

/// Background colour by name: "black", "white" or "transparent" (alpha 0).
/// throws  vog::Error listing the names for an unknown one
Rgba named_background(const std::string& name);

/// Options of shade.
struct ShadeOptions {
    Rgba background{0, 0, 0, 1};  ///< components in [0, 1]; a = 0: a picture to lay over others
    bool blend =
        false;  ///< multiply opacity by V, as the paper does: a fade to the background, in the colours of fading()
};
/// V below which colours fade out, so that the ends of supports make no edges.
inline constexpr float kRim = 0.05f;
/// Colours that fade: those from the first one of a luma of 0.2 on, over all of [0, 1]. Dark colours of small opacity would make a
/// dark rim over any brighter background. Maps that are dark beyond V = 0.5 stay.
TransferFunction fading(const TransferFunction& tf);

/// Shades a depth image. Where T > 0, a pixel is mix(background, tf(V), opacity min(V / kRim, 1)), with blend
/// mix(background, fading(tf)(V), opacity V), elsewhere the background. Over a transparent background (a = 0) a pixel is tf(V) with alpha = opacity, not
/// multiplied into the colour.
/// throws  vog::Error for a T that is negative or not finite, an invalid tf, or a background with a
///         component off [0, 1]
/// cost    O(pixels), parallel, about 10 ns a pixel and core
Image shade(const DepthImage& depth, const TransferFunction& tf, const ShadeOptions& options = {});

}  // namespace vog
