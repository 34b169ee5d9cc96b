// bind_convert.cpp: convert(), for volumes, levels and particles.
#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>

#include "arrays.h"
#include "data.h"
#include "sampled_fields.h"
#include "vog/cells.h"
#include "vog/convert_cells.h"
#include "vog/convert_fields.h"
#include "vog/convert_moments.h"
#include "vog/convert_paper.h"
#include "vog/convert_points.h"
#include "vog/error.h"
#include "vog/periodic.h"

namespace vog::python {

namespace {

using Model = std::shared_ptr<Gaussians>;

/// Keywords of options, in the order of the stub; None: the conversion's default.
constexpr const char* kKeywords[] = {"block",          "budget",
                                     "error",          "lod",
                                     "soft_steps",     "spread",
                                     "mass_threshold", "refine_seconds",
                                     "axis_aligned",   "measure",
                                     "value",          "radius",
                                     "neighbours",     "smoothing",
                                     "periodic",       "strategy",
                                     "dense_block",    "amplitude",
                                     "kappa",          "opacity_threshold",
                                     "minimum_radius", "variance_threshold",
                                     "similarity",     "tree_depth",
                                     "joint_field",    "joint_steps"};

/// Keyword arguments of convert(); None: not given. An option without effect on the conversion is
/// an error.
class Options {
  public:
    explicit Options(py::dict given) : given_(std::move(given)) {}

    /// Sets `value` to the option if it is given. throws TypeError for another type
    template <class T>
    void take(const char* name, T& value) {
        known_.emplace_back(name);
        const py::object option = given(name);
        if (option.is_none()) return;
        constexpr const char* kExpected = std::is_same_v<T, std::string> ? "a text"
                                          : std::is_same_v<T, bool>      ? "True or False"
                                          : std::is_integral_v<T>        ? "a whole number"
                                                                         : "a number";
        value = cast_to<T>(option, std::string("convert: ") + name, kExpected);
    }
    /// The option itself; None: not given.
    py::object take(const char* name) {
        known_.emplace_back(name);
        return given(name);
    }
    /// The same for numbers > 0. throws vog::Error for others
    template <class T>
    void take_positive(const char* name, T& value) {
        take(name, value);
        if (!given(name).is_none() && !(value > 0))
            throw Error(std::string("convert: ") + name + " " +
                        py::str(given(name)).cast<std::string>() + ", expected above 0");
    }
    /// throws vog::Error for a given option that has no effect: "without joint_field"
    void require(const char* name, bool has_effect, const char* otherwise) const {
        const py::object option = given(name);
        if (!option.is_none() && !option.is(py::bool_(false)) && !has_effect)
            throw Error(std::string("convert: ") + name + " has no effect " + otherwise);
    }
    /// throws vog::Error for a given option that take() has not read
    void refuse_others(const std::string& conversion) const {
        for (const auto& [name, option] : given_) {
            const auto text = name.cast<std::string>();
            if (option.is_none() || std::ranges::count(known_, text)) continue;
            std::string list;
            for (const std::string& known : known_) list += (list.empty() ? "" : ", ") + known;
            throw Error("convert: " + text + " does not go with " + conversion +
                        " (there are: " + list + ")");
        }
    }

  private:
    py::object given(const char* name) const {
        return given_.contains(name) ? py::object(given_[name]) : py::none();
    }
    py::dict given_;
    std::vector<std::string> known_;
};

CellChoice cut_of(Options& options) {
    CellChoice cut;
    options.take_positive("block", cut.block_voxels);
    options.take_positive("budget", cut.budget);
    options.take_positive("error", cut.error);
    options.take_positive("lod", cut.lod);
    return cut;
}

/// Options of cells of voxels and of particles.
template <class Target>
void take_cells(Options& options, Target& target) {
    const CellChoice cut = cut_of(options);
    set_cut(target, cut);
    options.take("mass_threshold", target.mass_threshold);
    options.take("axis_aligned", target.axis_aligned);
    options.take("measure", target.measure);
    options.require("measure", cut.block_voxels || cut.budget || cut.lod,
                    "without block, budget or lod");
}

MomentOptions moment_options(Options& options) {
    MomentOptions moments;
    take_cells(options, moments);
    options.take("soft_steps", moments.soft_steps);
    options.take("spread", moments.spread);
    options.take("refine_seconds", moments.refine_seconds);
    options.refuse_others("moments of volumes");
    return moments;
}

PaperOptions paper_options(Options& options) {
    int lod = 0;
    std::string strategy, amplitude = "mean";
    options.take_positive("lod", lod);
    PaperOptions paper = lod ? paper_lod(lod) : PaperOptions{};
    int dense_block = 0;
    options.take("strategy", strategy);
    options.take_positive("dense_block", dense_block);
    if (lod && (dense_block || !strategy.empty()))
        throw Error("convert: lod and strategy or dense_block exclude each other");
    if (!strategy.empty()) paper.strategy = strategy_from_name(strategy);
    if (dense_block) paper.dense_block = dense_block;
    options.take("amplitude", amplitude);
    if (amplitude != "mean" && amplitude != "mass")
        throw Error("convert: amplitude '" + amplitude + "', expected 'mean' or 'mass'");
    paper.amplitude = amplitude == "mass" ? Amplitude::mass : Amplitude::mean;
    options.take("kappa", paper.kappa);
    options.take("opacity_threshold", paper.opacity_threshold);
    options.take("minimum_radius", paper.minimum_radius_voxels);
    options.take("variance_threshold", paper.variance_threshold);
    options.take("similarity", paper.similarity);
    options.take("tree_depth", paper.tree_depth);
    const Strategy chosen = paper.strategy;
    options.require("dense_block", chosen <= Strategy::single_per_leaf,
                    "without strategy 'smart', 'strict' or 'single'");
    options.require("variance_threshold", chosen == Strategy::variance_clusters,
                    "without strategy 'variance'");
    options.require("similarity", chosen == Strategy::leaf_clusters,
                    "without strategy 'neighbours'");
    options.require("tree_depth", chosen == Strategy::tree_mirror, "without strategy 'tree'");
    options.refuse_others("the paper's conversion of volumes");
    return paper;
}

/// Box of `periodic`; an empty one: that of the data. None: not given, or False.
std::optional<Box> take_period(Options& options) {
    const py::object given = options.take("periodic");
    if (given.is_none() || given.is(py::bool_(false))) return {};
    if (given.is(py::bool_(true))) return Box{};
    const auto row = cast_to<py::array_t<double, py::array::c_style | py::array::forcecast>>(
        given, "convert: periodic", "True, an edge, three edges or two corners");
    return box_of_numbers(std::span(row.data(), static_cast<std::size_t>(row.size())));
}

/// Box of `periodic` for voxels.
std::optional<Box> period_of(const py::object& data, Options& options) {
    std::optional<Box> period = take_period(options);
    if (period && period->empty())
        period = py::isinstance<Volume>(data) ? domain_box({&data.cast<const Volume&>(), 1})
                                              : domain_box(levels_of(data)->volumes);
    if (period && period->empty())
        throw Error(
            "convert: periodic: the coarsest cells do not fill a box, so the data do not state the "
            "domain, expected an edge, three edges or two corners");
    return period;
}

/// Takes `smoothing`, the name of an attribute or an array, which becomes one of a copy of the particles.
void take_smoothing(Options& options, PointOptions& chosen, Points& copy, const Points& points) {
    const py::object given = options.take("smoothing");
    options.require("smoothing", chosen.radius == 0, "beside radius");
    if (given.is_none() || py::isinstance<py::str>(given)) {
        if (!given.is_none()) chosen.smoothing = given.cast<std::string>();
        return;
    }
    const py::array_t<float> row = row_of<float>(given, "convert: smoothing");
    copy = points;
    std::erase_if(copy.attributes,
                  [](const PointAttribute& one) { return one.name == "smoothing"; });
    copy.attributes.push_back({"smoothing", {row.data(), row.data() + row.size()}});
    chosen.smoothing = "smoothing";
}

PointOptions point_options(Options& options, Points& copy, const Points& given) {
    PointOptions points;
    take_cells(options, points);
    options.take("value", points.value);
    options.take("radius", points.radius);
    options.take("neighbours", points.neighbours);
    options.require("neighbours", points.radius == 0, "beside radius");
    if (!options.take("neighbours").is_none()) points.smoothing.clear();
    take_smoothing(options, points, copy, given);
    points.periodic = take_period(options);
    const bool cells = points.block_voxels || points.budget || points.error > 0;
    for (const char* name : {"mass_threshold", "axis_aligned"})
        options.require(name, cells, "without block, budget, error or lod");
    options.refuse_others("particles");
    return points;
}

/// Fills the caller's dict with the report, and warns where the measured error is above the target.
/// target_error  relative L2 of T; 0: none
void fill(const py::object& caller_dict, const MomentReport& report, double target_error) {
    if (target_error > 0 && report.measured_error > target_error &&
        !report.as_near_as_interpolation())
        warn({"convert: measured error " + std::to_string(report.measured_error) +
              " of the finest cut, expected at most " + std::to_string(target_error)});
    if (caller_dict.is_none()) return;
    py::dict dict = caller_dict;
    dict["mass_ratio"] = report.mass_ratio;
    dict["dropped_mass_share"] = report.dropped_mass_share;
    dict["dropped_cells"] = report.dropped_cells;
    const auto measured = [](double error) {
        return error < 0 ? py::object(py::none()) : py::object(py::float_(error));
    };
    dict["measured_error"] = measured(report.measured_error);
    dict["mean_error"] = measured(report.mean_error);
    dict["interpolation_error"] = measured(report.interpolation_error);
    dict["mean_interpolation_error"] = measured(report.mean_interpolation_error);
    dict["as_near_as_interpolation"] = report.as_near_as_interpolation();
    dict["view_note"] = report.view_note;
    dict["stopped_by_count"] = report.stopped_by_count;
    py::dict ms;
    for (const auto& [name, time] : report.stage_ms) ms[py::str(name)] = time;
    dict["stage_ms"] = ms;
}

/// Progress of a part of the work, from one fraction to another.
Progress between(const Progress& progress, double first, double last) {
    if (!progress) return {};
    return [=](double fraction) { progress(first + fraction * (last - first)); };
}
/// Fraction of the work after which fields are added.
double converted(const py::object& fields) {
    return no_fields(fields) ? 1 : fields.is_none() ? 0.9 : 0.6;
}

void add(const SampledFields& sampled, const FieldOptions& options, Gaussians& model) {
    if (!sampled.values.empty())
        unlocked([&] { add_fields(model, sampled.volumes, sampled.values, options); });
}

/// A model of an adaptive cut, which follows the fields, or one fitted to pictures of a field.
Model for_fields(const py::object& data, const MomentOptions& moments, FieldOptions options,
                 const SampledFields& sampled, const py::object& report_dict) {
    const bool fits = !options.joint_field.empty();
    // A typing error shall not wait for the conversion.
    if (fits) find_joint_field(options.joint_field, field_names(sampled.values));
    const bool by_value = moments.error > 0 || moments.refine_seconds > 0;
    JointReport joint;
    if (!report_dict.is_none() || by_value) options.joint_report = &joint;
    MomentReport report;
    const std::shared_ptr<const Levels> levels =
        py::isinstance<Volume>(data) ? nullptr : levels_of(data);
    Model model = unlocked([&] {
        if (!levels)
            return std::make_shared<Gaussians>(convert_for_field(
                sampled.volumes.front(), sampled.values, moments, options, &report));
        Composite mesh = composite(*levels);
        mesh.parts = sampled.volumes;
        return std::make_shared<Gaussians>(
            convert_for_field(mesh, sampled.values, moments, options, &report));
    });
    fill(report_dict, report, fits || moments.budget ? 0 : moments.error);
    if (moments.error > 0 && joint.value_error > moments.error)
        warn({"convert: error by value " + std::to_string(joint.value_error) +
              ", the least of all cuts that were tried, expected at most " +
              std::to_string(moments.error)});
    if (report_dict.is_none() || !fits) return model;
    py::dict dict(py::arg("error_before") = joint.error_before,
                  py::arg("error_after") = joint.error_after, py::arg("removed") = joint.removed);
    dict["value_error"] =
        joint.value_error < 0 ? py::object(py::none()) : py::object(py::float_(joint.value_error));
    report_dict["joint"] = dict;
    return model;
}

Model by_moments(const py::object& data, Options& options, const py::object& progress,
                 const py::object& report_dict, const py::object& fields) {
    FieldOptions field_options;
    field_options.periodic = period_of(data, options);
    options.take("joint_field", field_options.joint_field);
    options.take_positive("joint_steps", field_options.joint_steps);
    MomentOptions given = moment_options(options);
    given.periodic = field_options.periodic;
    const bool fits = !field_options.joint_field.empty();
    options.require("joint_steps", fits, "without joint_field");
    if (fits && no_fields(fields))
        throw Error("convert: joint_field and fields=False exclude each other");
    if (fits && given.spread != 1) throw Error("convert: joint_field does not go with spread");
    MomentOptions moments = given;
    const Progress whole = progress_of(progress);
    const SampledFields sampled = sampled_fields(data, fields, "convert");
    const bool cut_follows = !moments.block_voxels && !no_fields(fields);
    moments.progress = fits || cut_follows ? whole : between(whole, 0, converted(fields));
    const auto with_images = [&](Model model) {
        if (field_options.periodic) add_periodic_images(*model, *field_options.periodic);
        return model;
    };
    if (fits || cut_follows)
        return with_images(for_fields(data, moments, field_options, sampled, report_dict));
    MomentReport report;
    Model model;
    if (py::isinstance<Volume>(data)) {
        const auto& volume = data.cast<const Volume&>();
        model = unlocked(
            [&] { return std::make_shared<Gaussians>(convert_moments(volume, moments, &report)); });
    } else {
        const auto levels = levels_of(data);
        model = unlocked([&] {
            return std::make_shared<Gaussians>(
                convert_moments(composite(*levels), moments, &report));
        });
    }
    fill(report_dict, report, moments.block_voxels || moments.budget ? 0 : moments.error);
    field_options.cells = report.cells;
    field_options.progress = between(whole, converted(fields), 1);
    add(sampled, field_options, *model);
    return with_images(model);
}

Model by_paper(const py::object& data, Options& options, const py::object& progress,
               const py::object& fields) {
    PaperOptions paper = paper_options(options);
    const Progress whole = progress_of(progress);
    const SampledFields sampled = sampled_fields(data, fields, "convert");
    paper.progress = between(whole, 0, converted(fields));
    Model model;
    if (py::isinstance<Volume>(data)) {
        const auto& volume = data.cast<const Volume&>();
        model = unlocked([&] { return std::make_shared<Gaussians>(convert_paper(volume, paper)); });
    } else {
        const auto levels = levels_of(data);
        model = unlocked(
            [&] { return std::make_shared<Gaussians>(convert_paper(composite(*levels), paper)); });
    }
    FieldOptions field_options;
    field_options.progress = between(whole, converted(fields), 1);
    add(sampled, field_options, *model);
    return model;
}

/// fields of particles: names, or {name: column}.
std::vector<PointField> point_fields(const py::object& fields) {
    std::vector<PointField> all;
    if (fields.is_none() || no_fields(fields)) return all;
    const auto text = [](const py::handle& one) {
        if (!py::isinstance<py::str>(one))
            throw Error("convert: fields of Points: expected names of columns, or {name: column}");
        return one.cast<std::string>();
    };
    if (py::isinstance<py::dict>(fields)) {
        for (const auto& [name, column] : fields.cast<py::dict>())
            all.push_back({text(column), text(name)});
        return all;
    }
    if (py::isinstance<py::str>(fields) || !py::isinstance<py::iterable>(fields)) text(py::none());
    for (const py::handle& column : fields) all.push_back({text(column)});
    return all;
}

Model of_points(const Points& points, const std::string& method, Options& options,
                const py::object& progress, const py::object& report_dict,
                const py::object& fields) {
    const std::vector<PointField> carried = point_fields(fields);
    if (method == "paper") {
        std::string value = "speed";
        double radius = 0;
        float kappa = PaperOptions{}.kappa;
        options.take("value", value);
        options.take("radius", radius);
        options.take("kappa", kappa);
        options.refuse_others("the paper's particles");
        return unlocked([&] {
            return std::make_shared<Gaussians>(
                convert_points_paper(points, value, radius, kappa, carried));
        });
    }
    Points copy;  // where an array sets the radii of the kernels
    PointOptions point = point_options(options, copy, points);
    point.progress = progress_of(progress);
    point.fields = carried;
    MomentReport report;
    Model model = unlocked([&] {
        return std::make_shared<Gaussians>(
            convert_points(copy.size() ? copy : points, point, &report));
    });
    fill(report_dict, report, point.error);
    return model;
}

Model of_cells(const Cells& given, const std::string& method, Options& options,
               const py::object& progress, const py::object& report_dict,
               const py::object& fields) {
    if (method != "moments") throw Error("convert: cells go with method 'moments'");
    if (!no_fields(fields) && !fields.is_none())
        throw Error("convert: fields of Cells are their own, expected None, or False for none");
    CellOptions chosen;
    options.take_positive("budget", chosen.budget);
    options.take_positive("error", chosen.error);
    options.take("measure", chosen.measure);
    options.require("measure", chosen.budget != 0, "without budget");
    options.refuse_others("cells");
    chosen.progress = progress_of(progress);
    Cells bare;
    if (no_fields(fields)) {
        bare = given;
        bare.fields.clear();
        chosen.own_field = false;
    }
    const Cells& cells = no_fields(fields) ? bare : given;
    CellNotes notes;
    MomentReport report;
    Model model = unlocked(
        [&] { return std::make_shared<Gaussians>(convert_cells(cells, chosen, &notes, &report)); });
    if (const std::string text = notes_text(notes, cells); !text.empty()) warn({text});
    fill(report_dict, report, chosen.error);
    return model;
}

Model convert(const py::object& data, const std::string& method, const py::object& fields,
              const py::object& progress, const py::object& report, const py::kwargs& given) {
    py::module_::import("vog._messages")
        .attr("refuse_unknown")("convert", given, std::to_array(kKeywords));
    if (method != "moments" && method != "paper")
        throw Error("convert: method '" + method + "', expected 'moments' or 'paper'");
    if (!report.is_none() && !py::isinstance<py::dict>(report))
        throw py::type_error("convert: report: expected a dict to fill");
    Options options(given);
    if (py::isinstance<Points>(data))
        return of_points(data.cast<const Points&>(), method, options, progress, report, fields);
    if (py::isinstance<Cells>(data))
        return of_cells(data.cast<const Cells&>(), method, options, progress, report, fields);
    if (!py::isinstance<Volume>(data) && !levels_of(data))
        refuse_data(data, "convert", "a Volume, Levels, a list of Volumes, Points or Cells");
    if (method == "paper") return by_paper(data, options, progress, fields);
    return by_moments(data, options, progress, report, fields);
}

}  // namespace

void bind_convert(py::module_& m) {
    std::string signature = "convert(data, *, method='moments'";
    for (const char* keyword : kKeywords) signature += std::string(", ") + keyword + "=None";
    signature += ", fields=None, progress=None, report=None) -> vog.Gaussians\n\n";
    py::options options;
    options.disable_function_signatures();
    m.def(
        "convert", &convert, py::arg("data"), py::kw_only(), py::arg("method") = "moments",
        py::arg("fields") = py::none(), py::arg("progress") = py::none(),
        py::arg("report") = py::none(),
        (signature +
         R"(Converts voxels or particles to a model of 3D Gaussians, without training. Returns Gaussians.

data      a Volume; Levels or a list of Volumes: levels of one mesh, where finer ones hide coarser; Points
method    'moments': each Gaussian has the mass, mean and covariance of its cell, the voxels or particles
          it replaces; 'paper': the method of Sharma and Schmalstieg

Number of Gaussians, for method 'moments' (at most one of these):
block     one Gaussian per occupied cube of this edge, voxels: a power of two, 1 to 128
budget    the best model with at most this many Gaussians, > 0
error     the smallest model whose measured error, relative L2 of optical depth T in the worst of 12 views,
          is at most this, in (0, 1). Default for volumes: 0.03, but at most one Gaussian to 16 voxels
          (256 of small volumes).
          Default for particles: one Gaussian each
lod       level of detail, 1 (finest) to 5 (coarsest)

Volumes and Levels, method 'moments':
soft_steps      steps of expectation-maximisation from hard cells (a voxel counts for one Gaussian) to soft
                cells (it is divided among several), 0 to 1000. 0: hard cells, fast, but with block and
                lod a grid of dots along the axes. Default of block and lod: cells that overlap by half
                a cell, above 2 voxels with up to 24 steps, fewer for more than 4 million voxels
spread          factor on every standard deviation at constant mass, [0.5, 2]; default 1
mass_threshold  fraction of the total mass that may be dropped with the lightest cells, [0, 1)
refine_seconds  time for splitting and merging Gaussians by the error of pictures; not reproducible
axis_aligned    True: no rotations
measure         True: measure the error with block, budget and lod too

Points:
value       mass of a particle's Gaussian: 'count' (1 each), 'speed' or the name of an attribute
radius      standard deviation, world units; default: by `smoothing`, else half the distance to the nearest neighbour
            number `neighbours`
smoothing   radii at which the particles' kernels end: the name of an attribute, or an array [N]; default: SmoothingLength
            and the like where the particles have it. The Gaussians have the variance of cubic splines
periodic    True: the box that the snapshot states; or its edge, three edges, or [lower, upper]: neighbours are found across
            faces, and what leaves through a face enters through the opposite one. Of volumes by moments, too: True is the
            domain of a mesh. render and projection show the inside of the box
mass_threshold, axis_aligned and measure as above

Method 'paper', volumes: lod, strategy ('smart', 'strict', 'single', 'variance', 'neighbours', 'tree'),
dense_block (edge, voxels: 2, 4, 8), amplitude ('mean', 'mass'), kappa (fraction of the peak where kernels
are truncated), opacity_threshold (density), minimum_radius (voxels), variance_threshold, similarity,
tree_depth (1 to 3). Points: value, radius (world units), kappa.

fields    what the Gaussians know beside their density, of voxels: {"temperature": array, "velocity": array}.
          An array [X, Y, Z] or, of vectors along the world's axes, [X, Y, Z, 3], begins at voxel (0, 0, 0);
          ((i, j, k), array) or a list of such pairs begins elsewhere; a Volume is sampled at the voxels'
          centres; a text is the name of a grid in the data's file; of several levels a list with one of these
          for each. {"value": array, "unit": "K"} states the unit. The data's own values are a field in any case;
          False: no fields at all. Cells of budget, error and the default are small where fields vary.
          Of Points: ["velocity", "temperature"], or {name: column}; none by default
joint_field  of Volume and Levels by moments: one of the fields, or "volume", the data's own values; the Gaussians
          are then fitted to pictures of it, by joint_steps (2) steps of expectation-maximisation in the joint
          space of position and value. T is less exact: report["joint"] has error_before and error_after,
          measured errors of T, and removed, Gaussians without voxels. error and refine_seconds are then of
          volume pictures, of a scalar field: relative L2 of premultiplied RGBA under a ramp, three bands and
          an opaque step, in the worst view; report["joint"]["value_error"] has it, None: not measured
progress  called with the finished fraction, [0, 1]
report    dict to fill: mass_ratio, dropped_mass_share, dropped_cells, measured_error (relative L2 of T in
          the worst view), mean_error (over all views), interpolation_error and
          mean_interpolation_error (those of the voxels interpolated, in place of a model),
          as_near_as_interpolation, view_note (mass that the views leave out, in words),
          stopped_by_count, stage_ms

Raises vog.Error for an option out of range or without effect, and for data without mass. The result is the
same bytes for any number of threads. The interpreter lock is released; Ctrl-C interrupts the call.

>>> volume = vog.sample_cloud(64)
>>> model = vog.convert(volume, block=4)
>>> abs(model.mass / volume.mass - 1) < 1e-3
True
>>> len(vog.convert(volume, budget=500)) <= 500
True)")
            .c_str());
}

}  // namespace vog::python
