// bind_gaussians.cpp: Gaussians: array views, selection, concatenation, files.
#include <algorithm>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <span>

#include "arrays.h"
#include "data.h"
#include "fields.h"
#include "vog/error.h"
#include "vog/gaussians.h"
#include "vog/lod.h"
#include "vog/model_io.h"
#include "vog/picture.h"
#include "vog/vogz_fit.h"

namespace vog::python {

namespace {

using Model = std::shared_ptr<Gaussians>;

py::array_t<double> array_of(Vec3d v) {
    py::array_t<double> array(3);
    for (int axis = 0; axis < 3; ++axis) array.mutable_at(axis) = v[axis];
    return array;
}

/// throws vog::Error where a mean given in double precision moves by more than an eighth of its
///        Gaussian's largest scale, as a float
void require_precise(const py::object& mean, const Gaussians& model) {
    if (py::isinstance<py::array_t<float>>(mean) || model.scale.size() != model.size()) return;
    const BigVector<Vec3d> exact = vector_of<Vec3d, double>(mean, "mean");
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const Vec3f s = model.scale[i];
        const double moved = length(vec_cast<double>(model.mean[i]) - exact[i]);
        if (moved > 0.125 * double{std::max({s.x, s.y, s.z})})
            throw Error("mean: row " + std::to_string(i) + " would move by " +
                        std::to_string(moved) +
                        " as float32, expected means relative to a near point, with origin=point");
    }
}

Model from_arrays(const py::object& mean, const py::object& scale, const py::object& density,
                  const py::object& rotation, float cutoff, const py::object& box,
                  const py::object& origin, const py::object& fields) {
    auto model = std::make_shared<Gaussians>();
    model->mean = vector_of<Vec3f, float>(mean, "mean");
    if (!origin.is_none()) {
        const auto o = row_of<double>(origin, "origin");
        if (o.size() != 3)
            throw Error("origin: " + std::to_string(o.size()) + " numbers, expected 3");
        model->origin = {o.at(0), o.at(1), o.at(2)};
    }
    const py::array_t<float> peak = row_of<float>(density, "density");
    model->density = {peak.data(), peak.data() + peak.size()};
    model->scale = vector_of<Vec3f, float>(scale, "scale");
    if (!rotation.is_none()) model->rotation = vector_of<Quat, float>(rotation, "rotation");
    require_precise(mean, *model);
    model->fields = fields_from(fields, model->size());
    model->cutoff = cutoff;
    model->box = box_of(box);
    validate(*model);
    return model;
}

/// Rotations as a view; for an axis-aligned model, a read-only broadcast of (1, 0, 0, 0).
py::array rotation_of(const py::object& self) {
    auto& model = self.cast<Gaussians&>();
    if (!model.axis_aligned()) return view_of<float>(model.rotation, self);
    py::array_t<float> one(4);
    std::fill(one.mutable_data(), one.mutable_data() + 4, 0.0f);
    one.mutable_at(0) = 1;
    return py::module_::import("numpy").attr("broadcast_to")(one, py::make_tuple(model.size(), 4));
}

void set_rotation(Gaussians& model, const py::object& data) {
    BigVector<Quat> rotation = vector_of<Quat, float>(data, "rotation");
    if (rotation.size() != model.size())
        throw Error("rotation: " + std::to_string(rotation.size()) + " rows, expected " +
                    std::to_string(model.size()));
    if (model.axis_aligned())
        model.rotation = std::move(rotation);  // no view of it exists
    else
        std::copy(rotation.begin(), rotation.end(), model.rotation.begin());
}

/// The Gaussians of an index as NumPy's: a slice, a mask, numbers, one number.
Model part_of(const Gaussians& model, const py::object& index) {
    py::object every = py::module_::import("numpy").attr("arange")(model.size());
    py::object chosen = every[index];
    if (py::isinstance<py::tuple>(index))
        throw py::type_error(
            "Gaussians: got a tuple, expected one index: a number, slice, mask or numbers");
    chosen = py::module_::import("numpy").attr("atleast_1d")(chosen);
    const auto numbers =
        py::array_t<std::size_t, py::array::c_style | py::array::forcecast>(chosen);
    if (numbers.ndim() != 1)
        throw Error("Gaussians: index of " + std::to_string(numbers.ndim()) +
                    " axes, expected one");
    return std::make_shared<Gaussians>(select(
        model,
        std::span<const std::size_t>(numbers.data(), static_cast<std::size_t>(numbers.size()))));
}

Model join(const Gaussians& a, const Gaussians& b) {
    auto both = std::make_shared<Gaussians>(a);
    append(*both, b);
    return both;
}

py::tuple state_of_model(const py::object& self) {
    const auto& model = self.cast<const Gaussians&>();
    return py::make_tuple(
        self.attr("mean"), self.attr("scale"), self.attr("density"),
        model.axis_aligned() ? py::none() : py::object(self.attr("rotation")), model.cutoff,
        box_array(model.box), model.source_voxels, model.source, model.method, model.options,
        model.summary, array_of(model.origin), plain_fields(self), box_array(model.content.voxels),
        model.content.hull, model.content.standing.up, model.content.standing.front,
        model.content.units.length, model.content.units.density, model.content.by_value);
}
Model model_of_state(const py::tuple& state) {
    Model model = from_arrays(state[0], state[1], state[2], state[3], state[4].cast<float>(),
                              state[5], state[11], state[12]);
    model->source_voxels = state[6].cast<std::uint64_t>();
    model->source = state[7].cast<std::string>();
    model->method = state[8].cast<std::string>();
    model->options = state[9].cast<std::string>();
    model->summary = state[10].cast<std::string>();
    if (state.size() > 13)  // older states have none
        model->content = {box_of(state[13]),
                          state[14].cast<std::vector<Vec3d>>(),
                          {state[15].cast<Vec3d>(), state[16].cast<Vec3d>()}};
    if (state.size() > 17)
        model->content.units = {state[17].cast<std::string>(), state[18].cast<std::string>()};
    if (state.size() > 19) model->content.by_value = state[19].cast<bool>();
    return model;
}

void bind_arrays(py::class_<Gaussians, Model>& c) {
    c.def_property(
        "_units",
        [](const Gaussians& model) {
            const Units& units = model.content.units;
            return py::make_tuple(units.length, units.density);
        },
        [](Gaussians& model, const std::pair<std::string, std::string>& units) {
            model.content.units = {units.first, units.second};
        });
    c.def_property(
         "mean",
         [](const py::object& self) { return view_of<float>(self.cast<Gaussians&>().mean, self); },
         [](Gaussians& self, const py::object& data) { assign<float>(self.mean, data, "mean"); },
         "[N, 3] float32 view: centres, relative to origin.")
        .def_property_readonly(
            "origin", [](const Gaussians& self) { return array_of(self.origin); },
            "[3] float64: point of the world that means are relative to; 0 for data near 0.")
        .def_property_readonly(
            "world_mean",
            [](const Gaussians& self) {
                py::array_t<double> means({static_cast<py::ssize_t>(self.size()), py::ssize_t{3}});
                auto rows = means.mutable_unchecked<2>();
                for (std::size_t i = 0; i < self.size(); ++i)
                    for (int axis = 0; axis < 3; ++axis)
                        rows(static_cast<py::ssize_t>(i), axis) = world_mean(self, i)[axis];
                return means;
            },
            "[N, 3] float64 copy: centres in world space, origin + mean.")
        .def_property(
            "scale",
            [](const py::object& self) {
                return view_of<float>(self.cast<Gaussians&>().scale, self);
            },
            [](Gaussians& self, const py::object& data) {
                assign<float>(self.scale, data, "scale");
            },
            "[N, 3] float32 view: standard deviations along the principal axes, > 0, world units.")
        .def_property(
            "rotation", &rotation_of, &set_rotation,
            R"([N, 4] float32: unit quaternions (w, x, y, z) that rotate principal axes to world axes.

A view; of an axis-aligned model a read-only array of (1, 0, 0, 0).)")
        .def_property(
            "density",
            [](const py::object& self) {
                return view_of<float>(self.cast<Gaussians&>().density, self);
            },
            [](Gaussians& self, const py::object& data) {
                assign<float>(self.density, data, "density");
            },
            "[N] float32 view: peak densities, >= 0, per world unit of length.")
        .def_property_readonly(
            "fields", &fields_of,
            "Mapping of names to vog.Field: what the Gaussians know beside their density.")
        .def_property_readonly(
            "axis_aligned", &Gaussians::axis_aligned,
            "Whether all principal axes are world axes: no rotations are stored.")
        .def_property_readonly(
            "box", [](const Gaussians& self) { return box_array(view_box(self)); },
            "[2, 3] float64: lower and upper corner of the source data in world space.")
        .def_property_readonly(
            "voxel_box", [](const Gaussians& self) { return box_array(self.content.voxels); },
            "[2, 3] float64: lower and upper corner of the source's active voxels in world space; "
            "None where they are not known.")
        .def_property_readonly(
            "mass", [](const Gaussians& self) { return mass(self); },
            "Sum of the masses of the truncated Gaussians; compare with Volume.mass.");
}

/// throws vog::Error where an option of compact files goes with another file
void require_compact(const std::filesystem::path& file, bool options) {
    if (options && file.extension() != ".vogz")
        throw Error(file.string() + ": options of compact models, expected a .vogz");
}

Model load(const std::filesystem::path& file, const std::optional<std::size_t>& level,
           const py::object& box, const std::optional<std::vector<std::string>>& fields,
           bool skip_nonfinite) {
    const bool part = level || !box.is_none() || fields;
    require_compact(file, part);
    VogzPart chosen{level, {}, fields};
    if (!box.is_none()) chosen.box = box_of(box);
    ValueNotes notes;
    Model model = std::make_shared<Gaussians>(unlocked([&] {
        return part ? read_vogz(file, chosen)
                    : read_model(file, nullptr, {.skip_nonfinite = skip_nonfinite}, &notes);
    }));
    if (const std::string text = values_text(notes, file.string()); !text.empty()) warn({text});
    return model;
}

/// Pictures of the voxels of a Volume or Levels.
std::function<DepthImage(const Camera&, int)> pictures_of(const py::object& data) {
    auto set = std::make_shared<VolumeSet>();
    if (py::isinstance<Volume>(data)) {
        set->volumes.push_back(data.cast<const Volume&>());
    } else if (const auto levels = levels_of(data)) {
        static_cast<Levels&>(*set) = *levels;
        set->overlap = Overlap::hide;
    } else {
        refuse_data(data, "save", "a Volume or Levels as reference");
    }
    auto renderer = std::make_shared<PictureRenderer>(scene_of(std::move(set)));
    return [renderer](const Camera& camera, int size) {
        return bare_depth(*renderer, {.camera = camera, .width = size, .height = size});
    };
}

void save(const Gaussians& self, const std::filesystem::path& file,
          const std::optional<double>& step, const std::optional<double>& field_step,
          const std::optional<double>& max_loss, const py::object& reference, bool hierarchy) {
    const bool compact = step || field_step || max_loss || !reference.is_none() || hierarchy;
    require_compact(file, compact);
    if (step && max_loss) throw Error("step and max_loss exclude each other");
    if (!reference.is_none() && !max_loss) throw Error("reference: expected max_loss beside it");
    VogzBound bound;
    if (!reference.is_none()) bound.data = pictures_of(reference);
    unlocked([&] {
        if (!compact) return write_model(file, self);
        VogzOptions options;
        if (max_loss) {
            bound.max_loss_db = *max_loss;
            options.precision = fit_vogz(self, bound).precision;
        }
        if (step) options.precision.step = *step;
        if (field_step) options.precision.field_step = *field_step;
        if (!hierarchy) {
            write_vogz(file, self, {}, options);
            return;
        }
        Gaussians sorted = self;
        const Hierarchy levels = build_hierarchy(sorted);
        write_vogz(file, sorted, levels, options);
    });
}

}  // namespace

void bind_gaussians(py::module_& m) {
    py::class_<Gaussians, Model> c(
        m, "Gaussians",
        R"(Model: a density that is the sum of N truncated 3D Gaussians in world space.

sigma(x) = sum_i density[i] exp(-|W_i d_i|^2 / 2)   for |W_i d_i| <= cutoff
d_i = x - (origin + mean[i])
W_i = diag(1 / scale[i]) R(rotation[i])^T           R: rotation matrix of the quaternion

mean, scale, rotation and density are NumPy views of the model's memory: writing to them changes the
model. model[index] selects Gaussians (a slice, a mask, numbers); a + b concatenates two models.

>>> model = vog.Gaussians(mean=[[0, 0, 0], [3, 0, 0]], scale=[[1, 1, 1], [1, 2, 1]], density=[0.5, 1])
>>> len(model), len(model[model.density > 0.7]), len(model + model)
(2, 1, 4)
>>> model.density *= 2
>>> model.density
array([1., 2.], dtype=float32))");
    c.def(py::init(&from_arrays), py::arg("mean"), py::arg("scale"), py::arg("density"),
          py::arg("rotation") = py::none(), py::kw_only(), py::arg("cutoff") = 2.25f,
          py::arg("box") = py::none(), py::arg("origin") = py::none(),
          py::arg("fields") = py::none(),
          R"(Creates a model from arrays, which are copied.

mean      [N, 3] centres minus origin, world units, stored as float32
scale     [N, 3] standard deviations, > 0, world units
density   [N] peak densities, >= 0, per world unit
rotation  [N, 4] quaternions (w, x, y, z); None: all axis-aligned
cutoff    truncation radius of the kernels, standard deviations, (0, 8]
box       [2, 3] corners that views frame, world units; None: bounding box of the Gaussians
origin    [3] float64 point of the world that means are relative to, for data far from 0; None: 0
fields    mapping of names to vog.Field objects, or to dicts: value [N], gradient [N, 3], deviation
          [N], skewness [N], of a vector field value [N, 3], gradient and covariance [N, 3, 3]; 0 where
          not given; unit and range

Raises vog.Error for other shapes and values out of range.)")
        .def_static("load", &load, py::arg("file"), py::kw_only(), py::arg("level") = py::none(),
                    py::arg("box") = py::none(), py::arg("fields") = py::none(),
                    py::arg("skip_nonfinite") = false, R"(
Reads a model: .ply in the layout of vog, 3DGS or volprim, compact (.vogz), or splats (.spz, .glb, .usda),
whose opacities become densities.

skip_nonfinite  leaves splats of other programs out that have a NaN or infinite number, which is an error otherwise

Of a compact file parts alone may be read:
level   depth of the hierarchy, 0 the roots: its nodes, and the Gaussians above them, as a coarse model
box     [2, 3] corners, world units: chunks that reach into it
fields  names of fields; None: all

Raises vog.Error for a file that is missing, corrupt or of another format, for a level or field that it lacks,
and for parts of a .ply.)")
        .def("save", &save, py::arg("file"), py::kw_only(), py::arg("step") = py::none(),
             py::arg("field_step") = py::none(), py::arg("max_loss") = py::none(),
             py::arg("reference") = py::none(), py::arg("hierarchy") = false, R"(
Writes a model: .ply, which load() reads back bit for bit, or compact, .vogz, rounded.

step        step of masses, shapes and (in standard deviations) means relative to themselves; None: 0.025
field_step  step of field values relative to the range of the data; None: 1/256
max_loss    largest loss of PSNR of V against the data in seven views, dB, in place of step
reference   with max_loss: the data, a Volume or Levels; None: data that the model is 50 dB from
hierarchy   write the level-of-detail hierarchy, for readers of parts

Raises vog.Error where the file cannot be written, a bound cannot be met, or options of .vogz are given for a
.ply.)")
        .def_readwrite("cutoff", &Gaussians::cutoff,
                       "Truncation radius of the kernels, standard deviations, (0, 8].")
        .def_readwrite("source", &Gaussians::source, "Source of the model: 'smoke.vdb density'.")
        .def_readonly("source_voxels", &Gaussians::source_voxels,
                      "Number of active voxels or particles that the model replaces; 0: unknown.")
        .def_readonly("method", &Gaussians::method,
                      "Conversion method: 'moments', 'paper', 'particles', ...")
        .def_readonly("options", &Gaussians::options,
                      "Options of the conversion, as flags of vog convert.")
        .def_readonly("summary", &Gaussians::summary,
                      "Result of the conversion in one line: count, mass ratio, measured error.")
        .def(
            "coarsen",
            [](const Gaussians& self, std::size_t budget) {
                return std::make_shared<Gaussians>(unlocked([&] { return coarsen(self, budget); }));
            },
            py::arg("budget"),
            "A coarser model with at most `budget` Gaussians: neighbours are joined, which "
            "conserves mass, mean and covariance.")
        .def("__len__", &Gaussians::size)
        .def("__getitem__", &part_of, py::arg("index"))
        .def("__add__", &join, py::arg("other"), py::is_operator())
        .def("__repr__",
             [](const Gaussians& self) {
                 return "<vog.Gaussians: " + std::to_string(self.size()) + " of " +
                        (self.source.empty() ? "unknown source" : self.source) +
                        (self.axis_aligned() ? ", axis-aligned>" : ">");
             })
        .def(py::pickle(&state_of_model, &model_of_state));
    bind_arrays(c);
}

}  // namespace vog::python
