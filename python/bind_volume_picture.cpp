// bind_volume_picture.cpp: Python's render_volume(), pictures by value.
#include <algorithm>
#include <string_view>
#include <tuple>

#include "arrays.h"
#include "data.h"
#include "sampled_fields.h"
#include "vog/error.h"
#include "vog/maximum_picture.h"
#include "vog/picture.h"
#include "volume_look.h"

namespace vog::python {

namespace {

/// How a picture is drawn.
struct PictureArguments {
    const char* call;  ///< name of the Python function, for errors
    const std::optional<Camera>& camera;
    int usual_slabs;
    Progress progress;
};
VoxelGridOptions voxels_by(const std::string& interpolation, double step) {
    if (interpolation != "constant" && interpolation != "linear")
        throw Error("render_volume: interpolation '" + interpolation +
                    "', expected 'constant' or 'linear'");
    return {interpolation == "linear" ? Interpolation::linear : Interpolation::constant, step};
}

/// Request of the arguments that volumes and maxima share.
PictureRequest request_of(Show show, const py::object& size, const std::string& field,
                          const VolumeLook& look, int slabs) {
    PictureRequest request;
    request.show = show;
    std::tie(request.width, request.height) = size_of(size);
    request.field = field;
    request.look = look;
    request.options.clip = look.clip;
    request.slabs = slabs;
    return request;
}

/// Voxels with the scalar field that is shown.
VoxelSource shown_voxels(const py::object& data, const std::string& name, const py::object& fields,
                         const std::string& call) {
    if (name.empty() && !fields.is_none())
        throw Error(call + ": fields: expected field, the shown one");
    SampledFields sampled =
        sampled_fields(data, name.empty() ? fields : one_field(fields, name, call), call.c_str());
    std::vector<VoxelField>& values = sampled.values.front();  // behind it the data's own values
    if (values.front().is_vector()) {
        const std::string& vector = values.front().name;
        const std::string part = name.size() > vector.size() ? name.substr(vector.size() + 1) : "";
        if (part != "x" && part != "y" && part != "z" && part != "magnitude")
            throw Error(call + ": no scalar field '" + name + "' in fields, expected '" + vector +
                        ".x', .y, .z or .magnitude");
        for (std::size_t n = 0; n < values.size(); ++n)
            values[n] = component_of(std::move(values[n]), part, sampled.volumes[n]);
    } else if (!name.empty() && values.front().name != name) {
        throw Error(call + ": no scalar field '" + name + "' in fields");
    }
    VoxelSource source;
    auto set = std::make_shared<VolumeSet>();
    set->volumes = std::move(sampled.volumes);
    source.volumes = std::move(set);
    source.fields.push_back({values.front().name, values.front().unit, false, std::move(values)});
    return source;
}

/// Data of a picture, and the request's field, renderer and camera.
/// throws  TypeError for other objects
vog::Scene scene_of(const py::object& data, const std::string& renderer, const py::object& fields,
                    const PictureArguments& a, PictureRequest& request) {
    const std::string call = a.call;
    const bool is_model = py::isinstance<Gaussians>(data);
    if (!is_model && !py::isinstance<Volume>(data) && !levels_of(data))
        refuse_data(data, call, "Gaussians, a Volume, Levels or a list of Volumes");
    if (is_model && !fields.is_none())
        throw Error(call + ": fields: of voxels, a model has its own");
    const RenderInput input = is_model ? RenderInput::gaussians : RenderInput::volumes;
    request.renderer = renderer_for(renderer, input);
    try {
        require_options(*request.renderer, input, changed_options(request.options),
                        OptionSpelling::arguments);
    } catch (const Error& error) {
        throw Error(call + ": " + error.what());
    }
    if (*request.slabs != a.usual_slabs && (!is_model || *request.renderer == Renderer::trace))
        throw Error(call + ": slabs is for Gaussians and renderer 'splat', 'cuda' or 'optix'");
    vog::Scene scene;
    if (is_model) {
        const auto model = data.cast<std::shared_ptr<Gaussians>>();
        const ScalarField* field = scalar_to_show(model->fields, request.field);
        if (!field)
            throw Error(call + ": " +
                        (request.field.empty() ? "no field named"
                                               : "no scalar field '" + request.field + "'") +
                        ", the model has " + scalar_names(model->fields) +
                        " (convert(volume, fields=...) makes them)");
        request.field = field->name;
        scene.subject.box = view_box(*model);
        scene.sources.push_back(ModelSource{model, nullptr});
    } else {
        VoxelSource source = shown_voxels(data, request.field, fields, call);
        request.field = source.fields.front().name;
        scene.subject.box = subject_to_view(data, call).box;
        scene.sources.push_back(std::move(source));
    }
    request.camera = camera_or_default(a.camera, data, call, request.width, request.height);
    return scene;
}

/// The finished picture.
vog::Picture drawn(const vog::Scene& scene, const PictureRequest& request,
                   const Progress& progress) {
    const ResolvedPicture picture = resolve(request, scene);
    Sums sums;
    PictureRenderer(scene).draw(picture, sums, progress);
    return finish(std::move(sums), picture, scene);
}

void bind_maximum_picture(py::module_& m) {
    m.def(
        "render_maximum",
        [](const py::object& data, const std::optional<Camera>& camera, const py::object& size,
           const std::string& field, const py::object& clip, const py::object& clip_planes,
           const std::string& renderer, int slabs, const py::object& fields,
           const py::object& progress) {
            PictureRequest request =
                request_of(Show::maximum, size, field,
                           look_of("render_maximum", py::none(), clip, clip_planes), slabs);
            const PictureArguments given{"render_maximum", camera, kMaximumSlabs,
                                         progress_of(progress)};
            const vog::Scene scene = scene_of(data, renderer, fields, given, request);
            const vog::Picture picture =
                unlocked([&] { return drawn(scene, request, given.progress); });
            return py::array_t<float>({request.height, request.width}, picture.sums.maximum.data());
        },
        py::arg("data"), py::arg("camera") = py::none(), py::arg("size") = 512, py::kw_only(),
        py::arg("field") = "", py::arg("clip") = py::none(), py::arg("clip_planes") = py::none(),
        py::arg("renderer") = "", py::arg("slabs") = kMaximumSlabs, py::arg("fields") = py::none(),
        py::arg("progress") = py::none(),
        R"(Maximum intensity projection, float32 [height, width]: the largest value of a field along each ray, NaN where
there is none. Of voxels the largest value, of models the largest mean of the field.

data, camera, size, field, clip, clip_planes, fields, progress   as of render_volume
renderer  of models 'splat', 'cuda' or 'optix' (depth slabs), 'trace' (exact order), of voxels 'reference' or 'optix'; '': the first of them
slabs     depth slabs a tile, not of trace, 1 to 1024)

>>> volume = vog.sample_cloud(64)
>>> bool(np.nanmax(vog.render_maximum(volume, size=64)) <= volume.to_numpy().max())
True)");
}

}  // namespace

/// Whether a scale is logarithmic; nothing: automatic.
std::optional<bool> log_of(const std::string& scale) {
    if (scale == "auto") return std::nullopt;
    if (scale == "linear" || scale == "log") return scale == "log";
    throw Error("render_volume: scale '" + scale + "', expected 'auto', 'linear' or 'log'");
}

void bind_volume_picture(py::module_& m) {
    bind_maximum_picture(m);
    m.def(
        "render_volume",
        [](const py::object& data, const std::optional<Camera>& camera, const py::object& size,
           const std::string& field, const py::object& tf, const py::object& value_range,
           const std::string& scale, const py::object& window, const py::object& bands,
           const py::object& unit_distance, const py::object& light, const py::object& clip,
           const py::object& clip_planes, const py::object& background, const std::string& renderer,
           int slabs, const py::object& fields, const std::string& interpolation, double step,
           const py::object& progress) {
            PictureRequest request =
                request_of(Show::volume, size, field,
                           look_of("render_volume", light, clip, clip_planes), slabs);
            request.options.voxels = voxels_by(interpolation, step);
            request.shading.background = background_of(background);
            request.transfer = transfer_request({"render_volume", "value_range", tf, value_range,
                                                 unit_distance, window, bands, log_of(scale)});
            const PictureArguments given{"render_volume", camera, SlabOptions{}.slabs,
                                         progress_of(progress)};
            const vog::Scene scene = scene_of(data, renderer, fields, given, request);
            return unlocked([&] { return Picture{drawn(scene, request, given.progress).image}; });
        },
        py::arg("data"), py::arg("camera") = py::none(), py::arg("size") = 512, py::kw_only(),
        py::arg("field") = "", py::arg("tf") = kDefaultMap, py::arg("value_range") = py::none(),
        py::arg("scale") = "auto", py::arg("window") = py::none(), py::arg("bands") = py::none(),
        py::arg("unit_distance") = py::none(), py::arg("light") = py::none(),
        py::arg("clip") = py::none(), py::arg("clip_planes") = py::none(),
        py::arg("background") = "black", py::arg("renderer") = "",
        py::arg("slabs") = SlabOptions{}.slabs, py::arg("fields") = py::none(),
        py::arg("interpolation") = "constant", py::arg("step") = VoxelGridOptions{}.step_voxels,
        py::arg("progress") = py::none(),
        R"(One picture by value, a vog.Image: emission and absorption under a transfer function of a field's values.

data           Gaussians with a scalar field, a Volume, Levels or a list of Volumes
camera         None: Camera.orbit(data), fitted to the picture
size           pixels, 512 or (width, height)
field          the scalar field; '': the data's own values
tf             transfer function over value_range, as in DepthImage.shade(); a JSON file may have its points at values
value_range    (lower, upper); None: the 1st to 99th percentile of the data, weighted by mass; of a density from 0 on
scale          'linear', 'log', or 'auto': log where most of the mass has values over a decade and more, without value_range
window         (centre, width) of medical pictures, in place of tf
bands          rows (lower, upper, (r, g, b), opacity), in place of tf
unit_distance  world length that opacities refer to; None: the file's; of window, bands and a tf with opacities a hundredth of
               the box's diagonal; of a colour map the one at which the data, spread evenly over the silhouette of their
               box, have an optical depth of 1
light          'head', or a direction towards the light; None: emission and absorption alone
clip           box of the world that is shown, [2, 3]; None: all
clip_planes    rows (nx, ny, nz, d): the side where n.x >= d stays
background     'black', 'white', 'transparent', or (r, g, b) in [0, 1]
renderer       of models 'splat', 'cuda' or 'optix' (depth slabs), 'trace' (exact order), of voxels 'reference' or 'optix'; '': the first of them
slabs          depth slabs a tile, not of trace, 1 to 1024
fields         of voxels: the field at them, {'temperature': array}, as convert() takes it
interpolation  of voxels: 'constant', or 'linear' between their centres
step           linear: spacing of the samples, voxels, > 0
progress       is called with the finished fraction)

>>> picture = vog.render_volume(vog.sample_head(64), size=64, window=(1040, 400), background="white")
>>> np.asarray(picture).shape
(64, 64, 3))");
}

}  // namespace vog::python
