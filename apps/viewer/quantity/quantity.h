// quantity.h: quantities of pictures: visibility, column density, maps of a field, volume rendering by value, maxima; and the
// sums that are drawn for them.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vog/field_maps.h"
#include "vog/picture.h"
#include "vog/quantity.h"
#include "vog/volume_picture.h"

namespace vog::viewer {

/// Numbers of vog::Show are those of shade.frag, up to volume (shaded_as).
/// "Visibility", "Column density", ... for people.
const char* name_of(Show show);
/// Whether a quantity is of a field: mean, deviation, volume and maximum.
bool of_field(Show show);

/// Whether a quantity's colours are over a scale: column, mean, deviation and maximum.
inline bool has_scale(Show show) { return show != Show::depth && show != Show::volume; }

/// Quantity, and how it is drawn.
struct Quantity {
    Show show = Show::depth;
    FieldChoice field{};  ///< of mean, deviation, volume and maximum; an empty name: none
    VolumeLook look{};    ///< light of volume, and the clip of all quantities
    int slabs = 32;       ///< depth slabs of volume, 1 to 1024
    int maximum_slabs = kMaximumSlabs;  ///< of maximum
};
/// The quantity of shade.frag that shows the sums of another: a maximum is the mean of sums of column 1, a root mean square
/// the deviation from a mean of 0.
Show shaded_as(const Quantity& quantity);
/// Fields and parts that a quantity can be of: of volume and maximum scalar fields only, of mean root mean squares, too.
std::vector<FieldChoice> field_choices(const Fields& fields, Show show);
/// The field of a quantity by its text, or the one it begins with: of volume and maximum the density itself where the model has it.
/// text    as field_choice reads it; empty: the first choice
/// throws  vog::Error for a field that the model lacks, and for models without one
FieldChoice field_for(const Fields& fields, Show show, const std::string& text);
/// The text that field_choice reads: "temperature", "velocity", "velocity.x".
std::string text_of(const FieldChoice& choice);
/// Name and unit of what is shown: "deviation of temperature [K]".
std::string label_of(const Quantity& quantity, const Fields& fields);

/// Sums per pixel; rows from the top.
///   1 channel   T at extinction 1
///   4 channels  T, T times a field's mean, T times its mean square, 0, in the field's unit (unit_of), of a root mean
///               square with a mean of 0; or likewise a maximum, with 1 in place of T; or premultiplied colours
struct SumImage {
    int width = 0, height = 0, channels = 1;
    std::vector<float> value;  ///< [height][width][channels]
    std::span<const float> at(int column, int row) const {
        const auto first = static_cast<std::size_t>((row * width + column) * channels);
        return std::span(value).subspan(first, static_cast<std::size_t>(channels));
    }
};
/// T, or the column, in the first channel.
DepthImage depth_of(const SumImage& sums);
/// Image of the means over squares of factor x factor pixels.
SumImage shrunk(SumImage image, int factor);

/// What is drawn for a quantity. Quantities with equal ones share a picture: column density and visibility, mean and
/// deviation.
struct Drawn {
    enum class Kind { depth, field, light, maximum } kind = Kind::depth;
    FieldChoice field{};                              ///< of field, light and maximum
    VolumeLook look{};                                ///< of all but light the clip alone
    int slabs = 32;                                   ///< of light and maximum
    std::shared_ptr<const ValueTransfer> transfer{};  ///< of light; another one has another address
    int channels() const { return kind == Kind::depth && look.clip.empty() ? 1 : 4; }
    friend bool operator==(const Drawn& a, const Drawn& b);
};
Drawn drawn_for(const Quantity& quantity, std::shared_ptr<const ValueTransfer> transfer);

/// Numbers of a field in sums: (value - reference) / unit.
struct FieldUnit {
    double reference = 0, unit = 1;
};
/// By the range of the data: the middle and half the width of a scalar field, 0 and the largest magnitude of a vector.
FieldUnit unit_of(const Fields& fields, const std::string& field);

/// The map of a quantity from sums, NaN where nothing is shown.
/// show  shaded_as
/// unit  of the field
ValueMap shown_map(const SumImage& sums, Show show, FieldUnit unit);
/// Scale that fits a map, linear or logarithmic, as `vog render` fits it.
/// returns  0 to 1 where nothing is shown
ColorScale fitted_scale_of(const SumImage& sums, Show show, FieldUnit unit, bool log);
/// Largest first channel of the sums.
float largest_column(const SumImage& sums);

}  // namespace vog::viewer
