// vog/picture.h: Defaults of pictures: view, field, transfer function of values, colour scale and label of a request that leaves
// them open. Each is one function here, which the command, the window, Python, pages and vog-mpi call.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "vog/camera.h"
#include "vog/field_maps.h"
#include "vog/gaussians.h"
#include "vog/quantity.h"
#include "vog/value_counts.h"
#include "vog/value_transfer.h"
#include "vog/volume.h"
#include "vog/volume_picture.h"
#include "vog/voxel_field.h"

namespace vog {

/// Share of the largest column below which a picture of a field shows nothing.
inline constexpr double kLeastColumn = 1e-4;

/// View of the data: orbit_view, fitted to the picture.
/// width, height  pixels; renderers refuse those below 1
Camera default_view(const Subject& subject, int width, int height);

/// Extinction of a model that is drawn from many views, as exported splats are: auto_extinction of the fitted view `paper`.
double default_extinction(const Gaussians& model);

/// Scalar field of a volume or maximum picture: the one of this name; without a name the density itself, else the only one.
/// returns  null for a name that is not there, and where several could be meant
const ScalarField* scalar_to_show(const Fields& fields, const std::string& name = {});
/// The same for a list where a user chooses another: the first one where several could be meant.
const ScalarField* scalar_to_begin_with(const Fields& fields);

/// Names of the scalar fields, for errors: "density, temperature"; without any "none".
std::string scalar_names(const Fields& fields);

/// One number of a vector field at the voxels of a volume as a scalar field, "velocity.x", with its range over them.
/// part  "x", "y", "z" or "magnitude"
VoxelField component_of(VoxelField field, const std::string& part, const Volume& volume);

/// Name of the number that a quantity shows, with its unit: "column density [g/cm2]", "deviation of temperature [K]".
/// show   word of `vog render --show`: "T", "column", "mean", "deviation", "volume" or "maximum"
/// field  name of the shown part of the field (field_label); not used for T and column
/// unit   empty: none
std::string quantity_label(std::string_view show, const std::string& field,
                           const std::string& unit = {});

/// A map of values and the scale that colours it.
struct ColoredMap {
    ValueMap shown;  ///< NaN where nothing is shown
    ColorScale scale;
};
/// Map of "column", "mean" or "deviation" and its colour scale. Columns go from 0 to the largest, or over the four decades below it
/// (automatic_scale); fields from the 1st to the 99th percentile where the column is at least a thousandth of the largest
/// (fitted_scale).
/// fixed         scale in place of the fitted one
/// least_column  share of the largest column below which a field shows nothing
/// throws        vog::Error as fitted_scale does
ColoredMap colored_map(const FieldMaps& maps, std::string_view show, ScaleFit fit,
                       const std::optional<ColorScale>& fixed = {},
                       double least_column = kLeastColumn);

/// Values and space of the data of a volume picture.
struct ValueData {
    double lower = 0, upper = 0;  ///< least and largest value of the field
    ValueSpread spread{};         ///< its percentiles by mass
    Box box;                      ///< world units
    double mass = 0;              ///< integral of the density over the world
    bool is_measure = false;      ///< whether the field is the density itself
    ValueCounts counts{};  ///< for sums over processes; empty: the spread is that of the whole
};
ValueData value_data(const Gaussians& gaussians, const ScalarField& field);
/// volumes  which do not overlap
/// fields   [volumes] a scalar field at the voxels of each
/// box      of the whole, world units
ValueData value_data(std::span<const Volume> volumes, std::span<const VoxelField> fields,
                     const Box& box);

/// Range of values under a colour map, from the 1st to the 99th percentile of the data, weighted by mass: linear, or logarithmic over
/// four decades at most. Data of one value: from 0 to that value.
/// log     nothing: where they are above 0 and a decade apart or more
/// throws  vog::Error for a logarithmic range of values that are not above 0
ColorScale value_scale(const ValueData& data, std::optional<bool> log = {});
/// A hundredth of the diagonal of the data's box, to four digits: unit distance of opacities that a user states.
double rough_unit_distance(const Box& box);
/// Unit distance of a colour map whose opacity rises from 0 to 1 over a range of values: with it data of the median value, spread evenly
/// over the silhouette of their box, absorb about twice (choose_transfer.cpp), to two digits. Volumes and the models made of them have the same
/// one, since they have the same box, mass, and percentiles.
double map_unit_distance(const ValueData& data, const ColorScale& scale);

/// Transfer function of a volume picture as a user states it. At most one of `window` and `bands`; both replace colour maps.
struct TransferRequest {
    TransferPoints points;  ///< colour map over `range`, or a file's points (transfer_points)
    std::optional<TransferFunction> map{};           ///< over `range`, in place of points
    std::optional<std::pair<double, double>> range;  ///< least and largest value under a map
    std::optional<bool>
        log;  ///< whether a map is over logarithms; nothing: as value_scale, of a stated range not
    std::optional<std::pair<double, double>> window;  ///< centre and width (window_transfer)
    std::vector<ValueBand> bands;
    std::optional<double> threshold;      ///< nothing is shown below
    std::optional<double> unit_distance;  ///< world units
    bool may_be_empty = false;            ///< whether all values of the data may be transparent
};
/// Origin of a unit distance.
enum class UnitDistance {
    stated,  ///< by the request, or its file
    rough,   ///< rough_unit_distance, of stated opacities
    of_map,  ///< map_unit_distance
};
/// Transfer function with its defaults.
struct ChosenTransfer {
    ValueTransfer transfer;
    ColorScale scale;  ///< scale of a colour bar, linear or logarithmic
    UnitDistance unit_distance = UnitDistance::stated;
    double most_opacity = 0;  ///< largest over the data
};
/// Transfer function of a request. A colour map without opacities of its own becomes a ramp from 0 to 1.
/// throws  vog::Error for a window beside bands, a range beside points at values, a transfer function under which all of the data's
///         values are transparent, and as over_range, window_transfer and band_transfer do
ChosenTransfer choose_transfer(const TransferRequest& request, const ValueData& data);

}  // namespace vog
