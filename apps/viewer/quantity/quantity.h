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
/// Whether a quantity shows a field.
inline bool of_field(Show show) { return !is_depth(show); }

/// Quantity, and how it is drawn.
struct Quantity {
    Show show = Show::depth;
    FieldChoice field{};         ///< where a field is shown; an empty name: none
    VolumeLook look{};           ///< light of volume, and the clip of all quantities
    std::optional<int> slabs{};  ///< PictureRequest::slabs
};
/// The quantity of shade.frag that shows the sums of another: a largest value is the mean of sums of column 1, a root mean
/// square the deviation from a mean of 0.
Show shaded_as(const Quantity& quantity);
/// Fields and parts that a quantity can show: by value scalar fields only, of mean root mean squares, too.
std::vector<FieldChoice> field_choices(const Fields& fields, Show show);
/// The field of a quantity by its text, or the one it begins with: by value the density itself where the model has it.
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
///               square with a mean of 0; or the same of a largest value, with 1 in place of T; or premultiplied colours
struct SumImage {
    int width = 0, height = 0, channels = 1;
    std::vector<float> value;  ///< [height][width][channels]
    std::span<const float> at(int column, int row) const {
        const auto first = static_cast<std::size_t>((row * width + column) * channels);
        return std::span(value).subspan(first, static_cast<std::size_t>(channels));
    }
};
/// Image of the means over squares of factor x factor pixels.
SumImage shrunk(SumImage image, int factor);

/// Picture of the sums of a quantity, which some share: columns and visibility, deviations and means. Colours do not count.
/// transfer  of volume
ResolvedPicture sums_of(PictureRequest request, const FieldChoice& field,
                        const ValueTransfer* transfer = nullptr);
/// Whether two such pictures are the same, camera and size included.
bool same_sums(const ResolvedPicture& a, const ResolvedPicture& b);
/// Whether they are, but for transfer function and light: the Gaussians add up to the same moments in slabs.
bool same_moments(const ResolvedPicture& a, const ResolvedPicture& b);
/// Whether two pictures have sums of one kind and field, which another view leaves comparable.
bool same_kind(const ResolvedPicture& a, const ResolvedPicture& b);
/// Channels of the sums of such a picture (SumImage).
int channels_of(const ResolvedPicture& picture);

/// Numbers of a field in sums: (value - reference) / unit.
struct FieldUnit {
    double reference = 0, unit = 1;
};
/// By the range of the data: the middle and half the width of a scalar field, 0 and the largest magnitude of a vector.
FieldUnit unit_of(const Fields& fields, const std::string& field);

/// Numbers of a picture from its sums, and sums from its numbers.
/// picture  of sums_of
/// unit     of the field
Sums numbers_of(const SumImage& sums, const ResolvedPicture& picture, FieldUnit unit);
SumImage sums_from(Sums numbers, const ResolvedPicture& picture, FieldUnit unit);
/// T, or the column.
DepthImage depth_of(const Sums& numbers);
/// Scale that fits the numbers, as `vog render` fits it.
/// returns  0 to 1 where nothing is shown
ColorScale fitted_scale_of(const Sums& numbers, Show show, ScaleFit fit);
/// Largest column; of largest values 1, the column of their sums.
float largest_column(const Sums& numbers);

}  // namespace vog::viewer
