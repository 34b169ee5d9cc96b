// bind_evaluate.cpp: evaluate(): the paper's tables.
#include <map>
#include <memory>
#include <tuple>

#include "data.h"
#include "picture_data.h"
#include "sampled_fields.h"
#include "vog/error.h"
#include "vog/evaluate.h"

namespace vog::python {

namespace {

/// cells  number of cells; 0: voxels
std::vector<Conversion> conversions_of(const std::string& name, std::size_t cells) {
    if (cells && (name == "all" || name == "moments")) return cell_conversions(cells);
    if (cells) throw Error("conversions: '" + name + "', expected 'all' or 'moments' of Cells");
    if (name == "all") return all_conversions();
    if (name == "paper") return paper_conversions();
    if (name == "moments") return moment_conversions();
    throw Error("conversions: '" + name + "', expected 'all', 'paper' or 'moments'");
}

/// Contents of a file of results, so that both have the same form.
py::object results_in(const std::filesystem::path& file) {
    const py::object text = py::module_::import("pathlib").attr("Path")(file).attr("read_text")();
    return py::module_::import("json").attr("loads")(text);
}

py::object evaluate_data(const py::object& data, const std::filesystem::path& folder,
                         const py::object& size, int repeats, const py::object& extinction,
                         const py::object& tf, const std::string& conversions,
                         const std::map<std::string, Gaussians>& models, const std::string& show,
                         const py::object& fields, bool voxels, bool resume,
                         const py::object& progress) {
    EvaluateOptions options;
    std::tie(options.width, options.height) = size_of(size);
    options.repeats = repeats;
    options.extinction = extinction_of(extinction).value_or(0);
    Scene cells;
    if (py::isinstance<Cells>(data)) cells = scene_of_cells(data);
    options.conversions =
        conversions_of(conversions, cells.sources.empty() ? 0 : cells.model().cells->kept.size());
    if (!models.empty()) options.conversions.clear();
    for (const auto& [name, model] : models) options.conversions.push_back(model_row(name, model));
    if (show != "T" && show != "volume")
        throw Error("show: '" + show + "', expected 'T' or 'volume'");
    options.by_value = show == "volume";
    const auto texts = py::isinstance<py::str>(tf) ? std::vector{tf.cast<std::string>()}
                       : tf.is_none()              ? std::vector<std::string>{}
                                                   : cast_to<std::vector<std::string>>(
                                            tf, "evaluate: tf", "a name or a list of names");
    if (options.by_value)
        options.value_functions = texts;
    else if (texts.size() > 1)
        throw Error("tf: several transfer functions need show='volume'");
    else if (!texts.empty())
        options.tf = texts.front();
    options.voxels = voxels;
    options.resume = resume;
    options.progress = progress_of(progress);
    if (!cells.sources.empty()) {
        if (!fields.is_none())
            options.cell_fields = cast_to<std::vector<std::string>>(
                fields, "evaluate: fields", "names of the cells' own: ['heat']");
        unlocked([&] { return evaluate(cells, folder, options); });
        return results_in(folder / "results.json");
    }
    VolumeSet set;
    if (py::isinstance<Volume>(data)) {
        set.volumes.push_back(data.cast<const Volume&>());
    } else if (const auto levels = levels_of(data)) {
        static_cast<Levels&>(set) = *levels;
        set.overlap = Overlap::hide;
    } else {
        refuse_data(data, "evaluate", "a Volume, Levels, a list of Volumes or Cells");
    }
    SampledFields sampled;
    if (!fields.is_none()) {
        sampled = sampled_fields(data, fields, "evaluate");
        options.read_fields = [&](std::vector<Volume>& volumes) {
            volumes = sampled.volumes;
            return sampled.values;
        };
    }
    unlocked([&] { return evaluate(set, folder, options); });
    return results_in(folder / "results.json");
}

}  // namespace

void bind_evaluate(py::module_& m) {
    m.def(
        "evaluate", &evaluate_data, py::arg("data"), py::arg("folder"), py::kw_only(),
        py::arg("size") = 512, py::arg("repeats") = 5, py::arg("extinction") = "auto",
        py::arg("tf") = py::none(), py::arg("conversions") = "all", py::arg("models") = py::dict(),
        py::arg("show") = "T", py::arg("fields") = py::none(), py::arg("voxels") = false,
        py::arg("resume") = false, py::arg("progress") = py::none(),
        R"(Converts a volume in many ways, renders seven views of each model, and measures them against the voxels, or exact chords of cells.

data         a Volume, Levels, a list of Volumes, or Cells
folder       output folder, created if absent: results.json, results.csv, pictures/;
             `python -m vog.report FOLDER` makes plots and a page of it
size         size of the pictures in pixels, 512 or (width, height)
repeats      timed renders per view, after one warm-up
extinction   factor on density, or 'auto': by the reference of each view
tf           transfer function of the pictures and the RGB figures: a name or a JSON file, default 'inferno'; with
             show='volume' those of values, one or a list, beside a ramp, three narrow bands and an opaque step
conversions  'all', 'paper' or 'moments'; of Cells one Gaussian to 4, 16, 64 and 256 cells, and the default
models       {name: Gaussians}, evaluated in place of conversions
show         'T', or 'volume': volume pictures are compared too, from seven views
fields       {name: array, Volume or grid}, as convert takes them: maps of their mean and deviation, and of the data's
             own values, are compared too; of Cells names of their own, ['heat']; None: no maps
voxels       True: the field error too, each model turned back into voxels against the volume; for one Volume or Levels
resume       True: continues an interrupted evaluation with its finished conversions
progress     called with the finished fraction, [0, 1]

Returns the contents of results.json as a dict (docs/evaluation.md).)");
}

}  // namespace vog::python
