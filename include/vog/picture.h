// vog/picture.h: A picture: a request that every front end fills, its defaults, and the renderer that draws it.
//   PictureRequest -> resolve -> PictureRenderer::draw -> Sums -> finish -> Picture
// Each default (view, field, transfer function of values, colour scale, label) is one function here, which the command, the
// window, Python, pages and vog-mpi call.
#pragma once

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "vog/camera.h"
#include "vog/error.h"
#include "vog/field_maps.h"
#include "vog/gaussians.h"
#include "vog/progress.h"
#include "vog/quantity.h"
#include "vog/renderer.h"
#include "vog/scene.h"
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

struct SlicePlane;
/// View of a slice: orthographic, from the side that the plane's normal points to, framed on the data's cross-section. Along x it has y to
/// the right and z up, along y z and x, along z x and y. Scans are in radiological convention: axial from the feet, coronal from the
/// front, sagittal from the left.
/// plane  with its normal and offset
/// share  of the picture's width or height that the cross-section covers
Camera slice_view(const Subject& subject, const SlicePlane& plane, int width, int height,
                  double share = 1);

/// Box that axes outline, world units: of the active voxels, where they are known.
Box outline_of(const Subject& subject);
struct PictureRequest;
/// The part of the data that a fitted view of the picture frames: the part that the clip leaves, or all where it leaves nothing;
/// with axes their box, with room for the coordinates around it. Distances are still in radii of the box of all.
Subject shown_by(const PictureRequest& request, const Subject& subject);

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

/// Quantity of a picture.
enum class Show {
    depth,      ///< optical depth T, coloured by V = 1 - exp(-T)
    column,     ///< integral of the density along the ray
    mean,       ///< mean of a field along the ray, weighted by density
    deviation,  ///< standard deviation of a field along the ray, weighted by density
    volume,     ///< emission and absorption under a transfer function of a field's values
    maximum,    ///< largest value of a field on the ray
    slice,      ///< density, or a field weighted by it, on a plane or averaged across it
};
/// Words of `vog render --show`, by the enum's order: "T", "column", "mean", "deviation", "volume", "maximum", "slice".
std::span<const char* const> show_words();
const char* word_of(Show show);
/// throws  vog::Error listing the words, for another one
Show show_named(std::string_view word);
/// Whether a quantity is T at some extinction: depth and column.
inline bool is_depth(Show show) { return show == Show::depth || show == Show::column; }
/// Whether a quantity is a map of a field along rays: mean and deviation.
inline bool is_field_map(Show show) { return show == Show::mean || show == Show::deviation; }
/// Whether a quantity shows the values of one scalar field at each point: volume and maximum.
inline bool is_by_value(Show show) { return show == Show::volume || show == Show::maximum; }
/// Whether the colours of a quantity are over a scale.
inline bool has_scale(Show show) { return show != Show::depth && show != Show::volume; }

/// Name of the number that a quantity shows, with its unit: "column density [g/cm2]", "deviation of temperature [K]".
/// field  name of the shown part of the field (field_label); not used for T and column
/// unit   empty: none
std::string quantity_label(Show show, const std::string& field, const std::string& unit = {});

/// A map of values and the scale that colours it.
struct ColoredMap {
    ValueMap shown;  ///< NaN where nothing is shown
    ColorScale scale;
};
/// Map of a column, mean or deviation and its colour scale. Columns go from 0 to the largest, or logarithmically from the 5th
/// percentile (automatic_scale); fields from the 1st to the 99th percentile where the column is at least a thousandth of the largest
/// (fitted_scale).
/// fixed         scale in place of the fitted one
/// least_column  share of the largest column below which a field shows nothing
/// throws        vog::Error as fitted_scale does
ColoredMap colored_map(const FieldMaps& maps, Show show, ScaleFit fit,
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
    double background =
        0;          ///< value of the field at which the density is 0; only of the density itself
    Box content{};  ///< box of Content::hull, world units; empty: not known
};
ValueData value_data(const Gaussians& gaussians, const ScalarField& field);
/// volumes  which do not overlap
/// fields   [volumes] a scalar field at the voxels of each
/// box      of the whole, world units
ValueData value_data(std::span<const Volume> volumes, std::span<const VoxelField> fields,
                     const Box& box);

/// Magnitude of the gradient of a scene's scalar field below which 99 % of the mass lies, unit of the field per world unit: of a
/// model's Gaussians, or of voxels by central differences. 0 for cells and without data.
double steepest_gradient(const Scene& scene, const std::string& field);

/// Range of values under a colour map, from the 1st to the 99th percentile of the data, weighted by mass: linear, or logarithmic over
/// four decades at most. Data of one value: from 0 to that value.
/// log     nothing: where they are above 0 and a decade apart or more, without a background
/// throws  vog::Error for a logarithmic range of values that are not above 0
ColorScale value_scale(const ValueData& data, std::optional<bool> log = {});
/// A hundredth of the diagonal of the data's box, to four digits: unit distance of opacities that a user states. For a field beside the
/// density, which weighs its extinction, times the mean density in the box of what is shown.
double rough_unit_distance(const ValueData& data);
/// map_unit_distance is the opacity of `middle`, at least 0.1, times `thickness`, rounded to two digits.
struct MapUnit {
    double middle = 0;     ///< median value by mass
    double thickness = 0;  ///< world units
};
MapUnit map_unit(const ValueData& data);
/// Unit distance of a colour map whose opacity rises from 0 to 1 over a range of values: with it data of the median value, spread evenly
/// over the silhouette of their box, absorb about twice (choose_transfer.cpp), to two digits. Volumes and the models made of them have the same
/// one, since they have the same box, mass, and percentiles.
double map_unit_distance(const ValueData& data, const ColorScale& scale);

/// Transfer function of a volume picture as a user states it. At most one of `window` and `bands`; both replace colour maps.
struct TransferRequest {
    TransferPoints points;  ///< colour map over `range`, or a file's points (transfer_points)
    std::optional<std::pair<double, double>> range;  ///< least and largest value under a map
    std::optional<bool>
        log;  ///< whether a map is over logarithms; nothing: as value_scale, of a stated range not
    std::optional<std::pair<double, double>> window;  ///< centre and width (window_transfer)
    std::vector<ValueBand> bands;
    std::optional<double> threshold;          ///< nothing is shown below
    std::optional<double> unit_distance;      ///< world units
    std::vector<GradientOpacity> gradient{};  ///< ValueTransfer::gradient; none: that of the points
    bool gradient_of_steepest = false;        ///< magnitudes are shares of steepest_gradient()
    bool may_be_empty = false;                ///< whether all values of the data may be transparent
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

/// Map of a quantity whose user has not chosen one. T and volumes fade out, so that theirs begins with a visible hue; maps of values
/// begin with a dark one, which makes no edge at the rim of supports.
const char* default_map(Show show);

/// Plane of a slice.
struct SlicePlane {
    /// "x", "y", "z", or of scans "axial" (position along the patient's up), "coronal" (front) and "sagittal" (right); empty: the normal.
    std::string axis{};
    Vec3d normal{};                  ///< any length > 0; of an axis set by resolve()
    std::optional<double> offset{};  ///< dot(normal, x); nothing: the middle of the data
    friend bool operator==(const SlicePlane&, const SlicePlane&) = default;
};
/// Names of SlicePlane::axis.
std::span<const char* const> slice_axes();

/// A field, a slice or a surface in a volume picture of several.
struct Layer {
    std::size_t input = 0;  ///< place of its data among the front end's inputs, from 0
    std::string file{};     ///< input that a user names in place of `input`
    std::string grid{};     ///< grid of that file; empty: as its reader chooses
    bool visible = true;
    std::string field{};  ///< as PictureRequest::field
    TransferRequest transfer{};
    ScaleFit fit = ScaleFit::automatic;
    /// Draws the field only on a plane, in the colours of its values. Where a threshold or bands show nothing, the plane has a hole.
    std::optional<SlicePlane> plane{};
    /// Colour of a surface; nothing: those of its points, else a light grey.
    std::optional<std::array<float, 3>> color{};
    std::optional<double> opacity{};  ///< opacity of a plane or a surface, (0, 1]; nothing: 1
};

/// A grid of a file.
struct Channel {
    std::string grid;
    double most = 1;  ///< largest value; 0: there is nothing to see
};
/// Layers of the channels of an image, in colours that microscopes use: grids "c0", "c1", ..., or "red", "green" and "blue", which have
/// one range. Channels without values above 0 are left out.
/// grids    all grids of the file
/// returns  none for other names, or a single one
std::vector<Layer> layers_of_channels(std::span<const Channel> grids);

/// Marks of a picture for readers of papers.
struct Marks {
    bool color_bar =
        false;  ///< with ticks, at the right; coordinates at the other sides where the view is along axes
    bool axes = false;       ///< outline of the data's box, with ticks
    bool scale_bar = false;  ///< a round length
    std::string title{};     ///< above; empty: none

    bool any() const { return color_bar || axes || scale_bar || !title.empty(); }
};

/// Error of colour and opacity, estimated, up to which a pixel of a model's volume is interpolated.
inline constexpr double kVolumePrecision = 1 / 200.0;

/// A picture as a user asks for it. Open members have defaults, which resolve() sets.
struct PictureRequest {
    Show show = Show::depth;
    /// "temperature", "velocity" (along the view), "velocity.x"; empty: of volume and maximum scalar_to_show.
    std::string field{};
    /// Colours and, of volumes, opacities. A map without points: default_map.
    TransferRequest transfer{};
    /// Fields of a volume picture that are drawn together, in place of `field`, `transfer` and `fit`: where they overlap, their
    /// extinctions add up, and their colours mix by these. Planes and surfaces hide what lies behind them.
    std::vector<Layer> layers{};
    ScaleFit fit = ScaleFit::automatic;  ///< fit of an open range; log: scale of a stated one, too
    double least_column = kLeastColumn;  ///< share of the largest column, for means and deviations
    std::string unit{};                  ///< unit of the shown numbers; empty: the data's
    std::optional<double> extinction{};  ///< factor on density in T; nothing: auto_extinction
    ShadeOptions shading{};              ///< background and blend
    VolumeLook look{};               ///< light of a volume; its clip is not used: options.clip is
    std::optional<Camera> camera{};  ///< nothing: default_view
    int width = 512, height = 512;   ///< pixels
    std::optional<Renderer> renderer{};  ///< nothing: splat of models, reference of voxels
    RenderOptions options{};             ///< options of the renderer, and the clip
    std::optional<int> slabs{};  ///< depth slabs of volume and maximum; nothing: depth_slabs()
    double precision = kVolumePrecision;  ///< error up to which pixels of volumes are interpolated
    std::optional<SlicePlane> plane{};    ///< plane of a slice
    std::optional<double> thickness{};    ///< slab that is averaged, > 0; nothing: the plane
    Marks marks{};
};
/// Whether a picture shows a field: slices may show the density itself.
inline bool shows_field(const PictureRequest& request) {
    return is_field_map(request.show) || is_by_value(request.show) ||
           (request.show == Show::slice && !request.field.empty());
}
/// Whether opacity depends on gradients, too.
inline bool has_gradient(const TransferRequest& transfer) {
    return !transfer.gradient.empty() || !transfer.points.points.gradient.empty();
}
/// The request's depth slabs, or as many as what it shows has by default.
inline int depth_slabs(const PictureRequest& request) {
    const bool fine = request.look.is_lit() || has_gradient(request.transfer) ||
                      std::ranges::any_of(request.layers, has_gradient, &Layer::transfer);
    const int light = fine ? kLitSlabs : kVolumeSlabs;
    return request.slabs.value_or(request.show == Show::maximum ? kMaximumSlabs : light);
}

/// A request without open members but those that depend on the drawn numbers (extinction, ranges of maps), and an open field: other
/// data have another name for their own values.
struct ResolvedPicture {
    PictureRequest request;
    FieldChoice field{};        ///< for all but T, column, and slices of density
    ChosenTransfer chosen{};    ///< for volume
    TransferFunction colors{};  ///< for all other quantities
    std::string name, unit;  ///< name and unit of the shown number: "deviation of temperature", "K"
    double factor = 1;       ///< from the data's unit to `unit`
    double background = 0;   ///< value where the density is 0, added to slices of density
    bool unit_is_label = false;  ///< the data state none, and the requested unit is only a label
    std::vector<ResolvedPicture> layers{};  ///< [request.layers] hidden ones are empty
    const Camera& camera() const { return *request.camera; }
};
/// A member of a request that contradicts the data or other members.
class RequestError : public Error {
  public:
    /// member  "units", "range", "scale", "step", "anyhit"
    /// text    " K: the data are in g, expected ..."
    RequestError(const std::string& member, std::string text)
        : Error(member + text), member_(member), text_(std::move(text)) {}
    const std::string& member() const { return member_; }
    const std::string& text() const { return text_; }

  private:
    std::string member_, text_;
};

/// Sets every default.
/// throws  RequestError for a unit that does not convert; vog::Error for a field that the scene lacks, and as choose_transfer does
ResolvedPicture resolve(PictureRequest request, const Scene& scene);
/// The same picture under the colours, scale and marks of a request; its numbers are in its unit already.
/// throws  vog::Error for another transfer function of a volume, whose light is drawn under it
ResolvedPicture recolored(ResolvedPicture picture, PictureRequest request);
/// Values of the scalar field of a volume picture, over all processes.
ValueData value_data(const Scene& scene, const std::string& field);

/// Numbers per pixel as they are drawn, before colours: planes of [height * width], rows from the top; those that a quantity has not
/// are empty.
struct Sums {
    int width = 0, height = 0;           ///< pixels
    std::vector<float> column;           ///< T at extinction 1
    std::vector<float> mean, deviation;  ///< as FieldMaps
    std::vector<float> maximum;          ///< NaN where nothing is
    std::vector<float> slice;            ///< NaN outside of the data
    std::vector<Rgba> light;             ///< premultiplied colour, no background
};

/// Facts on the last picture.
struct DrawReport {
    std::optional<CutReport> cut{};       ///< for models with levels of detail
    std::optional<TraceReport> traced{};  ///< for T by rays
    std::optional<double> gpu_ms{};  ///< device time, milliseconds; nothing: not drawn by a GPU
};

/// Renderer of a scene: prepared with the first picture and kept for later ones under other cameras, sizes, clips and transfer
/// functions. Not for two threads at once; each picture uses all threads.
class PictureRenderer {
  public:
    explicit PictureRenderer(Scene scene);
    ~PictureRenderer();
    PictureRenderer(PictureRenderer&&) noexcept;
    PictureRenderer& operator=(PictureRenderer&&) noexcept;

    const Scene& scene() const;
    /// Prepares the data for pictures like this one, as the first draw() does otherwise.
    void prepare(const ResolvedPicture& picture);
    /// sums      receives the picture, its memory is reused; with several processes it is complete only on the root
    /// progress  called with the finished fraction; not by all renderers
    /// throws    vog::Error for options that are not the renderer's, and as the renderer itself does
    void draw(const ResolvedPicture& picture, Sums& sums, const Progress& progress = {});
    const DrawReport& report() const;

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// A finished picture, with its numbers and how it was made.
struct Picture {
    Image image;            ///< with its marks
    Sums sums;              ///< in the unit of `made`; column at the extinction
    ColorScale scale;       ///< scale of the colours
    double extinction = 1;  ///< factor on density in T
    ResolvedPicture made;   ///< with the extinction and the range that the drawn numbers gave
    std::vector<float> opacity{};  ///< [height * width] of a volume

    /// [height * width] the shown numbers, T at the extinction; of volumes the opacity.
    std::span<const float> values() const;
    /// T at the extinction, or the column; of other quantities the column of their field, which may be empty.
    DepthImage depth() const;
};
/// Colours and marks of drawn numbers.
/// throws  vog::Error for numbers beyond the range of floats, and as the scales and transfer functions do
Picture finish(Sums sums, const ResolvedPicture& picture, const Scene& scene);
/// One picture: resolve, draw and finish.
[[nodiscard]] Picture render(const Scene& scene, const PictureRequest& request = {});
/// T at extinction 1 of a request for T or a column, without colours and marks: resolve and draw.
[[nodiscard]] DepthImage bare_depth(PictureRenderer& renderer, const PictureRequest& request,
                                    const Progress& progress = {});
/// Writes the numbers of a picture: .npy, or .exr with a channel Y (T, column), "maximum", "opacity" (of a volume), or all three of
/// column, mean and deviation.
/// throws  vog::Error as write_values does
/// record  as write_png has it, for .exr
void write_numbers(const std::filesystem::path& file, const Picture& picture,
                   const std::string& record = {});

}  // namespace vog
