// request_members.cpp: Table of the members of requests: keys, texts, what each changes, and values.
#include "render/picture/request/request_member.h"
#include "vog/shade.h"

namespace vog {

namespace requests {

namespace {

constexpr double kMost = std::numeric_limits<double>::max(), kLeast = 5e-324;
constexpr Range kAny{-kMost, kMost, "a number"}, kFromZero{0, kMost, "a number from 0"},
    kShare{0, 1, "a number from 0 to 1"};

constexpr const char *kQuantity = "Quantity", *kColour = "Colour", *kPicture = "Picture",
                     *kVolume = "Volume rendering (`show` volume)",
                     *kSlice = "Slices (`show` slice)", *kClip = "Clipping",
                     *kRenderer = "Renderer", *kRays = "Ray tracing";
constexpr const char *kOfFields = "mean deviation volume maximum slice",
                     *kOfScales = "column mean deviation volume maximum slice",
                     *kSlicers = "splat reference";

std::vector<std::string> words_of_show() { return {show_words().begin(), show_words().end()}; }
std::vector<std::string> words_of_renderers() {
    std::vector<std::string> words;
    for (const RendererInfo& one : renderers()) words.emplace_back(one.name);
    return words;
}
/// "splat: models and particles, exact, object order; trace: ..."
std::string renderers_text() {
    std::vector<std::string> texts;
    for (const RendererInfo& one : renderers())
        texts.push_back(fmt::format("{}: {}", one.name, one.description));
    return fmt::format("{}. Default: splat or reference", fmt::join(texts, "; "));
}

/// Extinction, a number or "auto".
Values extinction_values() {
#define VOG_MEMBER(path) \
    [](auto& r) -> auto& { return r.path; }
    const Values number_or_none =
        open(VOG_MEMBER(extinction), {kLeast, kMost, "auto or a number above 0"});
    return {
        number_or_none.write,
        [read = number_or_none.read](const std::string& key, const Json& value, PictureRequest& r) {
            read(key, value == "auto" ? Json() : value, r);
        }};
}

RequestMember member(std::string key, std::string group, std::string takes, std::string text,
                     std::string unset = {}, std::vector<std::string> choices = {},
                     std::string shows = {}, std::string renderers = {}, bool many = false,
                     bool verbatim = false) {
    return {std::move(key),   std::move(group),     std::move(takes),
            std::move(text),  std::move(unset),     std::move(choices),
            std::move(shows), std::move(renderers), many,
            verbatim};
}

std::vector<Entry> quantity_entries() {
    const std::vector<std::string> scales{"auto", "linear", "log", "symmetric"};
    return {
        {member("show", kQuantity, "",
                "Quantity to draw. T: optical depth, coloured by V = 1 - exp(-T). column: column "
                "density, the integral of density along the ray, world units (for particles: "
                "number or value per area). mean, deviation: mean and standard deviation of "
                "`field` along the ray, weighted by density. volume: volume rendering of `field` "
                "with a transfer function (`tf`, `window` or `bands`). maximum: largest value of "
                "`field` along the ray. slice: density on `plane`, or `field` weighted by density",
                "T", words_of_show()),
         choice(VOG_MEMBER(show), words_of_show())},
        {member("field", kQuantity, "NAME",
                "Field for mean, deviation, volume, maximum and slice: temperature; velocity (of a "
                "vector field, the component along the view, positive away from the eye), "
                "velocity.x, .y, .z, or velocity.magnitude (root mean square). Default: volume, "
                "maximum and slice show the density; a page starts with the first field",
                "", {}, kOfFields, "", false, true),
         plain(VOG_MEMBER(field))},
        {member("range", kQuantity, "LO,HI",
                "Values of the first and last colour. Default, from the first picture: column "
                "densities from 0 to the largest (log: from the 5th percentile, at most four "
                "decades), fields from the 1st to the 99th percentile; volume: these percentiles "
                "of the data, weighted by mass",
                "", {}, kOfScales),
         pair(VOG_MEMBER(transfer.range), true, "LO,HI, two numbers, the first below the second")},
        {member("scale", kQuantity, "",
                "Colour scale: linear, log, symmetric (for fields: range centred at 0) or auto. "
                "auto is log if half of the values would lie in the lowest quarter of a linear "
                "scale (volume: if values are above 0 and span a decade or more), otherwise linear",
                "auto", scales, kOfScales),
         choice(VOG_MEMBER(fit), scales)},
        {member("units", kQuantity, "UNIT",
                "Unit of the quantity, such as 'g/cm2'. Numbers are converted if the data have "
                "units (fields, dense images, snapshots, their models); otherwise it only labels "
                "the colour bar and the report. Default: the data's unit",
                "", {}, "column mean deviation maximum slice", "", false, true),
         plain(VOG_MEMBER(unit))},
        {member("least_column", kQuantity, "SHARE",
                "Share of the largest column below which pictures of fields stay empty, because "
                "there is almost nothing to average. Files of values contain every pixel",
                fmt::format("{}", kLeastColumn), {}, "mean deviation"),
         plain(VOG_MEMBER(least_column), kShare)},
    };
}

std::vector<Entry> colour_entries() {
    return {
        {member("tf", kColour, "NAME|FILE",
                fmt::format("Transfer function from V = 1 - exp(-T), or from values in `range`, to "
                            "colour: a JSON file (vog's or ParaView's), a table of labels or one "
                            "of {}. Default: {}, for maps {}",
                            fmt::join(transfer_function_names(), ", "), default_map(Show::depth),
                            default_map(Show::column))),
         transfer_values()},
        {member("extinction", kColour, "NUMBER",
                "Extinction, the factor from density to optical depth T. auto makes the 99th "
                "percentile of the first picture's non-zero T 4, or as close to 4 as keeps the "
                "picture from being too dark or overexposed",
                "auto", {}, "T"),
         extinction_values()},
        {member("background", kColour, "COLOUR",
                "Background colour: R,G,B in [0, 1], black, white or transparent", "black"),
         background_values()},
        {member("blend", kColour, "",
                "Blend colours with the background by V, as the paper does: they fade out towards "
                "V = 0",
                "", {}, "T"),
         plain(VOG_MEMBER(shading.blend))},
    };
}

std::vector<Entry> volume_entries() {
    const VolumeLook look;
    return {
        {member("window", kVolume, "CENTRE,WIDTH",
                "Medical window: grey and, in volumes, opacity rise from CENTRE-WIDTH/2 to "
                "CENTRE+WIDTH/2",
                "", {}, "volume slice"),
         pair(VOG_MEMBER(transfer.window), false, "CENTRE,WIDTH, a width above 0")},
        {member(
             "bands", kVolume, "LO,HI,COLOUR,OPACITY|VALUE,COLOUR",
             fmt::format("Values from LO to below HI in one colour (#rrggbb or a name: {}) and "
                         "opacity, or a surface at VALUE, opaque up to the next band. Repeatable",
                         color_names()),
             "", {}, "volume", "", true),
         bands_values()},
        {member("threshold", kVolume, "VALUE", "Show nothing below this value", "", {}, "volume"),
         open(VOG_MEMBER(transfer.threshold), kAny)},
        {member("gradient_opacity", kVolume, "MAGNITUDE:FACTOR,...",
                "Factor of the extinction, 0 to 1, by the magnitude of the field's gradient (its "
                "unit per world unit, or a percentage of the steepest), linear between ascending "
                "magnitudes, as in 2%:0,12%:1: shows boundaries and hides even matter",
                "", {}, "volume"),
         gradient_values()},
        {member("unit_distance", kVolume, "LENGTH",
                "World length to which opacities refer: extinction = -ln(1 - opacity) / unit "
                "distance. Default: from the `tf` file, else a hundredth of the box's diagonal. "
                "For a named colour map: the length at which data of the median value, spread "
                "evenly over the silhouette of their box, have an optical depth of 2",
                "", {}, "volume"),
         open(VOG_MEMBER(transfer.unit_distance),
              {kLeast, kMost, "a finite length above 0, world units"})},
    };
}

std::vector<Entry> light_entries() {
    const VolumeLook look;
    return {
        {member(
             "light", kVolume, "head|studio|[camera:]X,Y,Z[=STRENGTH]",
             "Blinn-Phong shading by the gradient of the values, with light from the eye (head), "
             "from a world direction (towards the light), or from one that turns with the view "
             "(camera: right, up, towards the viewer). studio: instead of shading, `shadows`, "
             "`ambient_occlusion` and three octaves of `scattering`. Repeatable: lights add up",
             "", {}, "volume", "", true),
         light_values()},
        {member("shadows", kVolume, "",
                "Cast shadows: matter absorbs light on its way. It comes from the directions of "
                "`light`, otherwise of `light_from`",
                "", {}, "volume"),
         plain(VOG_MEMBER(look.shadows))},
        {member("light_from", kVolume, "head|[camera:]X,Y,Z[=STRENGTH]",
                "Direction towards a light that casts `shadows`, as of `light`, without shading "
                "surfaces. Repeatable. Default: the upper left of the view",
                "", {}, "volume", "", true),
         light_from_values()},
        {member("ambient_occlusion", kVolume, "",
                "Darken hollows: matter absorbs ambient light, which comes from all directions. "
                "All light is ambient unless `light` or `shadows` is given",
                "", {}, "volume"),
         plain(VOG_MEMBER(look.occlusion))},
        {member("scattering", kVolume, "OCTAVES",
                "Octaves of multiple scattering, which brighten shadows; 8 suits clouds", "1", {},
                "volume"),
         plain(VOG_MEMBER(look.octaves), {1, kMostOctaves, "1 to 16"})},
        {member("asymmetry", kVolume, "G",
                "Asymmetry of the Henyey-Greenstein phase function, with `shadows`: above 0 light "
                "scatters forward, and edges in front of the light shine; 0.6 suits clouds",
                "0", {}, "volume"),
         plain(VOG_MEMBER(look.asymmetry), {-0.99, 0.99, "-0.99 to 0.99"})},
        {member("light_weights", kVolume, "AMBIENT,DIFFUSE,SPECULAR,POWER",
                "Weights of `light` and the power of highlights",
                fmt::format("{},{},{},{}", look.ambient, look.diffuse, look.specular, look.power),
                {}, "volume"),
         weights_values()},
    };
}

std::vector<Entry> slab_entries() {
    return {
        {member("slabs", kVolume, "N",
                "Depth slabs of a model's picture with splat, cuda or optix. More slabs approach "
                "exact depth order (`renderer` trace) but cost memory and time. Default: 32, with "
                "light 64, for maximum 128",
                "", {}, "volume maximum", "splat cuda optix"),
         open(VOG_MEMBER(slabs), {1, 1024, "1 to 1024"})},
        {member("precision", kVolume, "ERROR",
                "Largest error of colour and opacity, from 0 to 1, at which a model's pixel is "
                "interpolated from half the resolution; it is estimated from neighbouring pixels. "
                "0: draw every pixel",
                fmt::format("{}", kVolumePrecision), {}, "volume", "splat"),
         plain(VOG_MEMBER(precision), {0, 1, "0 to 1"})},
        {member("layers", kVolume, "[FILE,]KEY=VALUE,...",
                "Layer of a picture with several fields, instead of `field` and `tf`: a FILE "
                "(default: the input) with its own field, tf, range, scale, window, band, iso, "
                "threshold and unit-distance, such as stars.ply,field=age,tf=inferno,range=0,1. "
                "Where layers overlap, their extinctions add up. Repeatable",
                "", {}, "volume", "splat reference", true),
         layers_values()},
        {member("clip", kClip, "X0,Y0,Z0,X1,Y1,Z1",
                "Keep only this box of the world, cut exactly on every ray. Pages and windows "
                "start with it"),
         box_values()},
        {member("clip_lights", kClip, "0|1",
                "Whether clips also cut what absorbs light: with 0, matter that is cut off still "
                "casts shadows",
                "1", {}, "volume"),
         clip_lights_values()},
        {member("clip_planes", kClip, "NX,NY,NZ,D",
                "Keep only the side of a plane where a world point x has n.x >= d. Repeatable", "",
                {}, "", "", true),
         planes_values()},
    };
}

std::vector<Entry> slice_entries() {
    return {
        {member("plane", kSlice, "AXIS[=POSITION]|NX,NY,NZ,D",
                "Plane of the slice: x, y or z with a position in world units (z=0.5); for scans "
                "axial, coronal or sagittal with the coordinate up, to the front or to the right "
                "(axial=12); or the world points x with n.x = d. Default position: the middle of "
                "the data. The view is orthographic along the normal. Scans are shown as "
                "radiologists view them, with letters at the sides",
                "", {}, "slice", kSlicers),
         plane_values()},
        {member("thickness", kSlice, "LENGTH",
                "Average over this length across the plane, world units: the mean of density, or "
                "of `field` weighted by density",
                "", {}, "slice", kSlicers),
         open(VOG_MEMBER(thickness), {kLeast, kMost, "a finite length above 0, world units"})},
    };
}

std::vector<Entry> picture_entries() {
    return {
        {member("size", kPicture, "WxH",
                "Size of the picture in pixels, or one number for a square", "512x512"),
         size_values()},
        {member("color_bar", kPicture, "",
                "Add a colour bar with ticks to the right of the picture, which becomes wider. "
                "Orthographic pictures along an axis also get coordinates on the left and below"),
         plain(VOG_MEMBER(marks.color_bar))},
        {member("axes", kPicture, "",
                "Draw the outline of the data's box with coordinates along its edges. A fitted "
                "picture shows all of it"),
         plain(VOG_MEMBER(marks.axes))},
        {member("scale_bar", kPicture, "",
                "Draw a scale bar of a round length, world units, at the depth of the camera's "
                "target"),
         plain(VOG_MEMBER(marks.scale_bar))},
        {member("title", kPicture, "TEXT", "Text above the picture, which becomes taller", "", {},
                "", "", false, true),
         plain(VOG_MEMBER(marks.title))},
    };
}

std::vector<Entry> renderer_entries() {
    const std::vector<std::string> hits{"accumulate", "collect"}, readings{"constant", "linear"};
    return {
        {member("renderer", kRenderer, "", renderers_text(), "", words_of_renderers()),
         renderer_values()},
        {member("pixel_error", kRenderer, "PIXELS",
                "Largest error, in pixels, of a coarser Gaussian that splat, cuda or optix draws "
                "instead of finer ones. 0: draw all Gaussians. Default: 1 for splat; cuda and "
                "optix draw all. Needs the hierarchy that vog convert writes; if a model has none, "
                "this option builds it",
                "", {}, "T column mean deviation", "splat optix cuda"),
         open(VOG_MEMBER(options.pixel_error), kFromZero)},
        {member("kappa", kRenderer, "SHARE",
                "Cut kernels where they fall to this share of their peak, instead of at the "
                "model's own cutoff: k = sqrt(-2 ln kappa)",
                "", {}, "", "splat trace optix cuda"),
         plain(VOG_MEMBER(options.kappa), {0, 0.999, "0, or 1.3e-14 to 0.999"})},
        {member("aabb_sigma", kRenderer, "RADII",
                "The paper's bounding boxes: a ray counts a Gaussian only if it meets the box of "
                "this many times the paper's radii; 0: no boxes",
                "0", {}, "T column mean deviation volume maximum", "splat trace optix"),
         plain(VOG_MEMBER(options.aabb_sigma), kFromZero)},
        {member(
             "interpolation", kRenderer, "",
             "Voxels in the reference renderer: constant (exact), or linear between their centres",
             "constant", readings, "", "reference"),
         choice(VOG_MEMBER(options.voxels.interpolation), readings)},
        {member("step", kRenderer, "VOXELS",
                "Step of linear interpolation; 0 integrates every cell exactly",
                fmt::format("{}", VoxelGridOptions{}.step_voxels), {}, "", "reference"),
         plain(VOG_MEMBER(options.voxels.step_voxels), kFromZero)},
        {member("samples", kRenderer, "N",
                "Rays per pixel with reference and optix: the mean of N x N rays; 1: one ray "
                "through the pixel's centre",
                "1", {}, "", "reference optix"),
         plain(VOG_MEMBER(options.samples), {1, 64, "1 to 64"})},
        {member("anyhit", kRays, "",
                "How trace and optix treat hits: accumulate adds each at once; collect, like the "
                "paper, gathers them, sorts by entry and integrates front to back",
                "accumulate", hits, "T column", "trace optix"),
         choice(VOG_MEMBER(options.trace.anyhit), hits)},
        {member("hits_per_slab", kRays, "N",
                "Hits stored per pass of collect; rays with more hits take several passes",
                fmt::format("{}", TraceOptions{}.hits_per_slab), {}, "T column", "trace optix"),
         plain(VOG_MEMBER(options.trace.hits_per_slab), {1, 256, "1 to 256"})},
        {member("stop_transmittance", kRays, "SHARE",
                "With collect, end a ray once its transmittance is below this; 0: never", "0", {},
                "T", "trace optix"),
         plain(VOG_MEMBER(options.trace.stop_transmittance), {0, 0.999999, "0 to 0.999999"})},
        {member("camera", "", "", ""), camera_values()},
    };
#undef VOG_MEMBER
}

}  // namespace

const std::vector<Entry>& entries() {
    static const std::vector<Entry> all = [] {
        std::vector<Entry> joined;
        for (const auto& part :
             {quantity_entries(), colour_entries(), volume_entries(), light_entries(),
              slab_entries(), slice_entries(), picture_entries(), renderer_entries()})
            joined.insert(joined.end(), part.begin(), part.end());
        return joined;
    }();
    return all;
}

const Entry& entry_of(const std::string& key) {
    std::vector<std::string> keys;
    for (const Entry& entry : entries()) {
        if (entry.schema.key == key) return entry;
        keys.push_back(entry.schema.key);
    }
    throw RequestError(key,
                       fmt::format(": no member of a request, expected {}", fmt::join(keys, ", ")));
}

}  // namespace requests

std::span<const RequestMember> request_schema() {
    static const std::vector<RequestMember> all = [] {
        std::vector<RequestMember> members;
        for (const requests::Entry& entry : requests::entries())
            if (entry.schema.key != "camera") members.push_back(entry.schema);
        return members;
    }();
    return all;
}

}  // namespace vog
