// vog/quantity.h: Pictures of a quantity in its unit: column density maps, colour bars, numbers.
// Column density is the integral of density along a ray, T / extinction: density times world
// length; of particles number or value per area.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/image.h"
#include "vog/shade.h"

namespace vog {

/// Column density of a depth image: T at extinction 1.
/// throws  vog::Error for a T that is negative or not finite
[[nodiscard]] DepthImage column_density(const DepthImage& depth);

/// Map from values to positions in a transfer function, [0, 1].
struct ColorScale {
    enum class Kind {
        visibility,  ///< 1 - exp(-value), of T: as shade() does; low and high are not used
        linear,      ///< (value - low) / (high - low)
        log,         ///< log(value / low) / log(high / low)
    };
    Kind kind = Kind::visibility;
    double low = 0, high = 1;  ///< values at positions 0 and 1, finite, low < high; log: low > 0
};
/// Position of a value; values beyond the range are at its ends.
/// throws  vog::Error for an invalid scale
double scale_position(const ColorScale& scale, double value);

/// Fit of a scale to values.
enum class ScaleFit {
    /// Logarithmic where no value is below 0 and half of those above 0 would lie in the lowest quarter of a linear scale, else
    /// linear; of volumes as value_scale (vog/picture.h) has it.
    automatic,
    linear,     ///< from the 1st to the 99th percentile
    log,        ///< the same percentiles of the values above 0, at most four decades
    symmetric,  ///< linear, -a to a, a the 99th percentile of the magnitudes
};
/// Scale of all values of images: linear from 0 to the largest, or logarithmic from the 5th percentile of the values above 0, one to
/// four decades. Images without a value above 0 have the largest value 1.
/// throws  vog::Error for a value that is negative or not finite
ColorScale automatic_scale(std::span<const DepthImage> images, ScaleFit fit);

/// Shades values, such as column densities, by a scale: tf(position) where a value is above 0,
/// the background elsewhere, mixed by the opacity as shade() does.
/// throws  vog::Error as shade() does, for an invalid scale, and for options.blend, which needs V
Image shade_values(const DepthImage& values, const TransferFunction& tf, const ColorScale& scale,
                   const ShadeOptions& options = {});

/// Values of either sign per pixel, rows from the top; NaN: nothing is there.
struct ValueMap {
    int width = 0, height = 0;  ///< pixels
    std::vector<float> value;   ///< [height * width]
};
/// Scale of values; those that are NaN do not count. Equal values get a range around them.
/// throws  vog::Error for ScaleFit::log without a value above 0
ColorScale fitted_scale(std::span<const float> values, ScaleFit fit);
/// Shades a map by a scale: tf(position), and the background where the map is NaN.
/// throws  vog::Error as shade_values does
Image shade_map(const ValueMap& map, const TransferFunction& tf, const ColorScale& scale,
                const ShadeOptions& options = {});

/// Values with a tick, ascending: 1, 2 or 5 times a power of ten apart; decades of a logarithmic
/// scale, with 2 and 5 between where there is room; of visibility values up to T = 5.
/// least_gap  least distance between ticks, as positions
std::vector<double> scale_ticks(const ColorScale& scale, double least_gap);
/// A tick's value: "0.05", "20", "1e-7".
std::string tick_text(double value);
/// A name with its unit in brackets, where it has one.
std::string with_unit(const std::string& name, const std::string& unit);

/// Coordinates along two sides of a picture.
struct SideTicks {
    struct Side {
        double
            first = 0,
            last =
                0;  ///< at the outer edges of the picture, world units; from the left, or from below
        std::string name;  ///< "x [kpc]"
    };
    Side across, up;
};
/// Coordinates of an orthographic picture along the axes of the world; none for other cameras.
/// unit  of length; empty: none
std::optional<SideTicks> side_ticks(const Camera& camera, int width, int height,
                                    const std::string& unit = {});

/// Marks of the world's lengths over a picture.
struct PictureFrame {
    Camera camera;
    Box box;                  ///< Box of the data, world units
    std::string length_unit;  ///< empty: none
    bool axes = false;        ///< outline of the box, with ticks and coordinates along three edges
    bool scale_bar = false;   ///< a length at the depth of look_at, at the lower left
};
/// Draws the marks into a picture; edges behind the data are fainter.
/// background  ink is black or white, whichever differs more
/// throws      vog::Error for a unit without glyphs, or an invalid camera
void draw_frame(Image& picture, const PictureFrame& frame, const Rgba& background = {0, 0, 0, 1});

/// Colour bar, title and coordinates around a picture.
struct Annotation {
    std::string title;                 ///< above the picture; empty: none
    std::string label;                 ///< beside the colour bar: "column density [g/cm2]"
    bool color_bar = true;             ///< right of the picture
    std::optional<SideTicks> sides{};  ///< left of the picture and below it
};
/// Adds a colour bar with ticks on the right, a title above, and coordinates at the left and below; the picture itself is unchanged. A picture lower than its label gets a margin below. Text is a bitmap font of ASCII and the signs of units (¹ ² ³ ⁻
/// ° µ × ·), in whole multiples of 5x7 pixels, about 1/36 of the picture's height.
/// background  colour of the margins; text is black or white, whichever differs more
/// throws      vog::Error for a character without a glyph, text that does not fit, an invalid scale
///             or tf
Image annotated(const Image& picture, const TransferFunction& tf, const ColorScale& scale,
                const Annotation& annotation, Rgba background = {0, 0, 0, 1});

/// Writes values as float32: .npy (NumPy, [height, width]) or .exr (one channel Y), by extension.
/// Written beside the file and renamed when whole.
/// throws  vog::Error for another extension, or if the file cannot be written
/// record  as write_png has it, for .exr
void write_values(const std::filesystem::path& file, const DepthImage& values,
                  const std::string& record = {});
/// Writes a map as .npy, NaN included.
/// throws  vog::Error as for depth images
void write_map(const std::filesystem::path& file, const ValueMap& map);

/// Channel of an EXR.
struct NamedValues {
    std::string name;               ///< "column", "mean"
    std::span<const float> values;  ///< [height * width]
};
/// Writes channels of float32 by their names to one .exr, NaN included.
/// throws  vog::Error as for depth images, and for channels of another size
void write_channels(const std::filesystem::path& file, int width, int height,
                    std::span<const NamedValues> channels, const std::string& record = {});

}  // namespace vog
