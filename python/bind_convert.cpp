// bind_convert.cpp: convert(), for volumes, levels and particles.
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>

#include "arrays.h"
#include "data.h"
#include "sampled_fields.h"
#include "vog/cells.h"
#include "vog/conversion_schema.h"
#include "vog/convert_cells.h"
#include "vog/error.h"
#include "vog/periodic.h"

namespace vog::python {

namespace {

using Model = std::shared_ptr<Gaussians>;

/// Names of conversions in messages.
const std::map<std::string, const char*> kConversions = {
    {"moments", "moments of volumes"},
    {"paper", "the paper's conversion of volumes"},
    {"particles", "particles"},
    {"paper-particles", "the paper's particles"},
    {"cells", "cells"}};

/// Keyword arguments of convert(); None and False: not given.
struct Options : ConversionOptions {
    py::dict given;
    /// The option itself; None: not given.
    py::object own(const char* name) const {
        return given.contains(name) ? py::object(given[name]) : py::none();
    }
};

/// Options of a conversion by the table.
/// throws  TypeError for another type, vog::Error for values out of range and for options without effect
Options options_of(const py::kwargs& given, const std::string& conversion) {
    Options options{{}, given};
    std::vector<std::string> stated, known;
    for (const ConversionOption& one : conversion_schema()) {
        const py::object value = options.own(one.key.c_str());
        const bool is_known =
            (" " + one.of + " ").find(" " + conversion + " ") != std::string::npos;
        if (is_known) known.push_back(one.key);
        if (value.is_none()) continue;
        if (!is_known) {
            stated = {one.key};
            break;
        }
        const auto take = [&](const auto& place) {
            using Place = std::remove_cvref_t<decltype(place)>;
            if constexpr (std::is_pointer_v<Place>) {
                using T = std::remove_pointer_t<Place>;
                constexpr const char* kExpected = std::is_same_v<T, std::string> ? "a text"
                                                  : std::is_same_v<T, bool>      ? "True or False"
                                                  : std::is_integral_v<T>        ? "a whole number"
                                                                                 : "a number";
                *place = cast_to<T>(value, "convert: " + one.key, kExpected);
            }
        };
        std::visit(take, one.value(options));
        if (!value.is(py::bool_(false))) stated.push_back(one.key);
    }
    if (stated.size() == 1 && !std::ranges::count(known, stated.front())) {
        std::string list;
        for (const std::string& key : known) list += (list.empty() ? "" : ", ") + key;
        throw Error("convert: " + stated.front() + " does not go with " +
                    kConversions.at(conversion) + " (there are: " + list + ")");
    }
    check_values(options, stated);
    require_effects(options, conversion, stated);
    return options;
}

/// Box of `periodic`; an empty one: that of the data. None: not given, or False.
std::optional<Box> take_period(const Options& options) {
    const py::object given = options.own("periodic");
    if (given.is_none() || given.is(py::bool_(false))) return {};
    if (given.is(py::bool_(true))) return Box{};
    const auto row = cast_to<py::array_t<double, py::array::c_style | py::array::forcecast>>(
        given, "convert: periodic", "True, an edge, three edges or two corners");
    return box_of_numbers(std::span(row.data(), static_cast<std::size_t>(row.size())));
}

/// Box of `periodic` for voxels.
std::optional<Box> period_of(const py::object& data, const Options& options) {
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
void take_smoothing(const Options& options, PointOptions& chosen, Points& copy,
                    const Points& points) {
    const py::object given = options.own("smoothing");
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
    dict["field_errors"] =
        std::map<std::string, double>(report.field_errors.begin(), report.field_errors.end());
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

/// The model of voxels by convert(volume) or convert(mesh), without the interpreter's lock.
/// parts  of levels, in place of their own; none: theirs
template <class Convert>
Model of_mesh(const py::object& data, const Convert& convert, std::span<const Volume> parts = {}) {
    const auto levels = py::isinstance<Volume>(data) ? nullptr : levels_of(data);
    const Volume* volume = levels          ? nullptr
                           : parts.empty() ? &data.cast<const Volume&>()
                                           : &parts.front();
    return unlocked([&] {
        if (volume) return std::make_shared<Gaussians>(convert(*volume));
        Composite mesh = composite(*levels);
        if (!parts.empty()) mesh.parts.assign(parts.begin(), parts.end());
        return std::make_shared<Gaussians>(convert(mesh));
    });
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
    const auto convert = [&](const auto& mesh) {
        return convert_for_field(mesh, sampled.values, moments, options, &report);
    };
    Model model = of_mesh(data, convert, sampled.volumes);
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

Model by_moments(const py::object& data, const Options& options, const py::object& progress,
                 const py::object& report_dict, const py::object& fields) {
    FieldOptions field_options;
    field_options.periodic = period_of(data, options);
    const auto* image = py::isinstance<Volume>(data) ? &data.cast<const Volume&>() : nullptr;
    if (!options.joint_field.empty() || (fields.is_none() && options.moments.spread == 1))
        field_options.joint_field =
            resolved_joint_field(options.joint_field, {image, image ? 1u : 0u});
    field_options.joint_steps = options.joint_steps;
    MomentOptions moments = moment_options(options);
    moments.periodic = field_options.periodic;
    const bool fits = !field_options.joint_field.empty();
    if (fits && no_fields(fields))
        throw Error("convert: joint_field and fields=False exclude each other");
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
    Model model =
        of_mesh(data, [&](const auto& mesh) { return convert_moments(mesh, moments, &report); });
    fill(report_dict, report, moments.block_voxels || moments.budget ? 0 : moments.error);
    field_options.cells = report.cells;
    field_options.progress = between(whole, converted(fields), 1);
    add(sampled, field_options, *model);
    return with_images(model);
}

Model by_paper(const py::object& data, const Options& options, const py::object& progress,
               const py::object& fields) {
    PaperOptions paper = paper_options(options);
    const Progress whole = progress_of(progress);
    const SampledFields sampled = sampled_fields(data, fields, "convert");
    paper.progress = between(whole, 0, converted(fields));
    Model model = of_mesh(data, [&](const auto& mesh) { return convert_paper(mesh, paper); });
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

Model of_points(const Points& points, const std::string& method, const Options& options,
                const py::object& progress, const py::object& report_dict,
                const py::object& fields) {
    const std::vector<PointField> carried = point_fields(fields);
    if (method == "paper") {
        const std::string value =
            options.own("value").is_none() ? "speed" : options.particles.value;
        return unlocked([&] {
            return std::make_shared<Gaussians>(convert_points_paper(
                points, value, options.particles.radius, options.paper.kappa, carried));
        });
    }
    Points copy;  // where an array sets the radii of the kernels
    PointOptions point = point_options(options);
    if (!options.own("neighbours").is_none()) point.smoothing.clear();
    take_smoothing(options, point, copy, points);
    point.periodic = take_period(options);
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

Model of_cells(const Cells& given, const Options& options, const py::object& progress,
               const py::object& report_dict, const py::object& fields) {
    if (!no_fields(fields) && !fields.is_none())
        throw Error("convert: fields of Cells are their own, expected None, or False for none");
    CellOptions chosen;
    chosen.budget = options.moments.budget, chosen.error = options.moments.error;
    chosen.measure = options.moments.measure;
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
              const py::object& labels, const py::object& progress, const py::object& report,
              const py::kwargs& given);

/// The models of the parts that labels divide a volume into, as one.
Model of_parts(const py::object& data, const std::string& method, const py::object& fields,
               const py::object& labels, const py::object& progress, const py::kwargs& given) {
    py::dict named;
    if (py::isinstance<py::dict>(fields)) named = fields.attr("copy")();
    if (no_fields(fields) || named.contains("label"))
        throw Error("convert: labels are a field 'label', expected other fields");
    Model all;
    double done = 0;
    for (const LabelledPart& part : labelled_parts(data, labels, "convert")) {
        py::kwargs own = given.attr("copy")();
        if (given.contains("budget") && py::isinstance<py::int_>(given["budget"]))
            own["budget"] =
                static_cast<std::int64_t>(std::ceil(given["budget"].cast<double>() * part.share));
        named["label"] = part.label;
        py::object counted = py::none();
        if (!progress.is_none())
            counted = py::cpp_function(
                [&progress, done, share = part.share](double f) { progress(done + share * f); });
        Model one = convert(part.volume, method, named, py::none(), counted, py::none(), own);
        done += part.share;
        if (all)
            append(*all, *one);
        else
            all = std::move(one);
    }
    return all;
}

Model convert(const py::object& data, const std::string& method, const py::object& fields,
              const py::object& labels, const py::object& progress, const py::object& report,
              const py::kwargs& given) {
    std::vector<std::string> known;
    for (const ConversionOption& one : conversion_schema()) known.push_back(one.key);
    py::module_::import("vog._messages").attr("refuse_unknown")("convert", given, known);
    if (method != "moments" && method != "paper")
        throw Error("convert: method '" + method + "', expected 'moments' or 'paper'");
    if (!report.is_none() && !py::isinstance<py::dict>(report))
        throw py::type_error("convert: report: expected a dict to fill");
    if (!labels.is_none() && !py::isinstance<Volume>(data))
        throw Error("convert: labels divide a single Volume");
    if (py::isinstance<Points>(data))
        return of_points(data.cast<const Points&>(), method,
                         options_of(given, method == "paper" ? "paper-particles" : "particles"),
                         progress, report, fields);
    if (py::isinstance<Cells>(data)) {
        if (method != "moments") throw Error("convert: cells go with method 'moments'");
        return of_cells(data.cast<const Cells&>(), options_of(given, "cells"), progress, report,
                        fields);
    }
    if (!py::isinstance<Volume>(data) && !levels_of(data))
        refuse_data(data, "convert", "a Volume, Levels, a list of Volumes, Points or Cells");
    const Options options = options_of(given, method);
    if (!labels.is_none()) {
        if (!report.is_none() || take_period(options))
            throw Error("convert: labels and " +
                        std::string(report.is_none() ? "periodic" : "report") +
                        " exclude each other");
        return of_parts(data, method, fields, labels, progress, given);
    }
    if (method == "paper") return by_paper(data, options, progress, fields);
    return by_moments(data, options, progress, report, fields);
}

/// Types of an option's values, by the place of its variant.
constexpr const char* kTypes[] = {"ArrayLike", "bool",  "int", "int",
                                  "float",     "float", "str", "float"};
std::string type_of(const ConversionOption& option) {
    ConversionOptions unset;
    return kTypes[option.value(unset).index()];
}

/// Lines of the help for each option: "spread  float [0.5, 2]: Factor on .... Default: 1. Of moments".
std::string option_texts() {
    const py::object fill = py::module_::import("textwrap").attr("fill");
    std::string all;
    for (const ConversionOption& one : conversion_schema()) {
        const OptionValues values = values_of(one);
        const std::string range = values.words().empty() ? values.text : values.expected();
        std::string text = type_of(one) + (range.empty() ? "" : " " + range) + ": " + one.text;
        if (!default_text(one).empty()) text += ". Default: " + default_text(one);
        text += ". Of " + one.of.substr(0, one.of.find(" models"));
        std::erase(text, '`');
        std::string name = "    " + one.key;
        name.resize(24, ' ');
        all += fill(text, 120, py::arg("initial_indent") = name,
                    py::arg("subsequent_indent") = std::string(24, ' '))
                   .cast<std::string>() +
               "\n";
    }
    return all;
}

}  // namespace

void bind_convert(py::module_& m) {
    std::string signature =
        "convert(data, *, method='moments', fields=None, labels=None, progress=None, report=None";
    py::dict types;
    for (const ConversionOption& one : conversion_schema()) {
        signature += ", " + one.key + "=None";
        types[py::str(one.key)] = type_of(one);
    }
    m.def("_conversion_schema", [types] { return types; });
    signature += ") -> vog.Gaussians\n\n";
    py::options options;
    options.disable_function_signatures();
    m.def(
        "convert", &convert, py::arg("data"), py::kw_only(), py::arg("method") = "moments",
        py::arg("fields") = py::none(), py::arg("labels") = py::none(),
        py::arg("progress") = py::none(), py::arg("report") = py::none(),
        (signature +
         R"(Converts voxels or particles to a model of 3D Gaussians, without training. Returns Gaussians.

data      a Volume; Levels or a list of Volumes: levels of one mesh, where finer ones hide coarser; Points; Cells
method    'moments': each Gaussian has the mass, mean and covariance of its cell, the voxels or particles
          it replaces; 'paper': the method of Sharma and Schmalstieg

Options, at most one of error, budget, block and lod. Each names its conversions: moments and paper are those of volumes and levels,
particles and paper-particles those of Points, cells those of Cells. periodic=True is the box that the data state; else an edge, three
edges, or [lower, upper].

)" + option_texts() +
         R"(
fields    what the Gaussians know beside their density, of voxels: {"temperature": array, "velocity": array}.
          An array [X, Y, Z] or, of vectors along the world's axes, [X, Y, Z, 3], begins at voxel (0, 0, 0);
          ((i, j, k), array) or a list of such pairs begins elsewhere; a Volume is sampled at the voxels'
          centres; a text is the name of a grid in the data's file; of several levels a list with one of these
          for each. {"value": array, "unit": "K"} states the unit. The data's own values are a field in any case;
          False: no fields at all. Cells of budget, error and the default are small where fields vary.
          Of Points: ["velocity", "temperature"], or {name: column}; none by default
          With joint_field, report["joint"] has error_before and error_after, measured errors of T, removed, Gaussians
          without voxels, and value_error: relative L2 of premultiplied RGBA under a ramp, three bands and an opaque
          step, in the worst view; None: not measured
labels    whole numbers at the voxels of a Volume, such as a segmentation has, as a field of `fields`; 0 beyond them. No
          Gaussian straddles two, and each has its own as the field label
progress  called with the finished fraction, [0, 1]
report    dict to fill: mass_ratio, dropped_mass_share, dropped_cells, measured_error (relative L2 of T in
          the worst view), mean_error (over all views), interpolation_error and
          mean_interpolation_error (those of the voxels interpolated, in place of a model),
          as_near_as_interpolation, field_errors (of other fields than the data's values: relative L2 of their
          means in the worst view), view_note (mass that the views leave out, in words),
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
