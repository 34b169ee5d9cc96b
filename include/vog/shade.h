// vog/shade.h: optical depth to colour. V = 1 - exp(-T); colour = transfer_function(V) where T > 0,
// background elsewhere. Source: Sharma & Schmalstieg, section 4.1. Changing colours never
// re-renders.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "vog/image.h"

namespace vog {

struct ColorPoint {
    float v = 0;                ///< visibility, [0, 1]
    float r = 0, g = 0, b = 0;  ///< display values, [0, 1]
};
struct OpacityPoint {
    float v = 0;
    float opacity = 1;  ///< [0, 1]
};

/// Piecewise linear in RGB and in opacity; constant beyond the first and last point. Two points of
/// one v make a step, which at v itself has the latter's value.
struct TransferFunction {
    std::string name;
    std::vector<ColorPoint> color;      ///< at least one, sorted by v
    std::vector<OpacityPoint> opacity;  ///< empty: opaque; else sorted by v
};

/// Colour at v in [0, 1], with the opacity in `a`.
Rgba color_at(const TransferFunction& tf, float v);

/// Names that named_transfer_function takes.
std::vector<std::string> transfer_function_names();
/// Case does not matter, nor '_' for '-'. throws vog::Error listing the names if there is none such
TransferFunction named_transfer_function(const std::string& name);

/// Reads a ParaView colour map (a JSON array of presets: RGBPoints, optional Points; the first
/// preset of the file), or our own JSON, where "colors" may also be a name:
///   {"name": "...", "colors": [[v, r, g, b], ...], "opacity": [[v, a], ...]}
/// ParaView's scalar range is mapped to V in [0, 1]. ColorSpace RGB, Lab, Diverging, HSV and Step,
/// and midpoints and sharpness of opacity, are honoured by sampling, to half an 8-bit step.
/// throws vog::Error naming the file and the key
TransferFunction read_transfer_function(const std::filesystem::path& file);
void write_transfer_function(const std::filesystem::path& file, const TransferFunction& tf);
/// `name_or_file`: a name, or else the path of a JSON file.
TransferFunction load_transfer_function(const std::string& name_or_file);

/// Colours at evenly spaced v from 0 to 1, as other programs' maps are: their alpha is opacity,
/// left out where all are 1. throws vog::Error for none, or a component off [0, 1]
TransferFunction sampled_transfer_function(const std::string& name, std::span<const Rgba> colors);

/// "black", "white" or "transparent". throws vog::Error listing them
Rgba named_background(const std::string& name);

struct ShadeOptions {
    Rgba background{0, 0, 0, 1};  ///< a = 0 for a picture to lay over others
    bool blend = false;  ///< the paper's blend: the map fades into the background as V -> 0
};

/// Shades every pixel with T > 0: mix(background, tf(V), opacity), opacity multiplied by V when
/// blending; the others are background. Over a clear background (a = 0) a pixel is tf(V) with
/// alpha = opacity, not multiplied into the colour.
/// throws vog::Error for a T that is negative or not finite, an invalid tf, a background off [0, 1]
/// cost   O(pixels), parallel, about 10 ns a pixel and core
Image shade(const DepthImage& depth, const TransferFunction& tf, const ShadeOptions& options = {});

}  // namespace vog
