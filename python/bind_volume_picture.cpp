// bind_volume_picture.cpp: Python's render_volume(), pictures by value.
#include <algorithm>
#include <string_view>
#include <tuple>

#include "arrays.h"
#include "data.h"
#include "sampled_fields.h"
#include "vog/error.h"
#include "vog/gpu_pictures.h"
#include "vog/gpu_volumes.h"
#include "vog/maximum_picture.h"
#include "vog/periodic.h"
#include "vog/picture.h"
#include "vog/renderer.h"
#include "volume_look.h"

namespace vog::python {

namespace {

/// How a picture is drawn.
struct PictureArguments {
    const char* call;  ///< name of the Python function, for errors
    const std::optional<Camera>& camera;
    int width, height;
    int slabs, usual_slabs;
    const std::string& renderer;
    const VolumeLook& look;
    Progress progress;
    VoxelGridOptions voxels{};
};
VoxelGridOptions voxels_by(const std::string& interpolation, double step) {
    if (interpolation != "constant" && interpolation != "linear")
        throw Error("render_volume: interpolation '" + interpolation +
                    "', expected 'constant' or 'linear'");
    return {interpolation == "linear" ? Interpolation::linear : Interpolation::constant, step};
}

/// A model, or voxels, with the scalar field that is shown.
struct Shown {
    const Gaussians* model = nullptr;
    SampledFields voxels;  ///< of no model: one field
    std::string field;
    ValueData data;
    Renderer renderer = Renderer::splat;
    Camera camera{};

    const std::vector<VoxelField>& values() const { return voxels.values.front(); }
};

Shown shown_of_model(const Gaussians& model, const std::string& name,
                     const PictureArguments& picture) {
    const ScalarField* field = scalar_to_show(model.fields, name);
    if (!field)
        throw Error(std::string(picture.call) + ": " +
                    (name.empty() ? "no field named" : "no scalar field '" + name + "'") +
                    ", the model has " + scalar_names(model.fields) +
                    " (convert(volume, fields=...) makes them)");
    return {&model, {}, field->name, value_data(model, *field)};
}

Shown shown_of_voxels(const py::object& data, const std::string& name, const py::object& fields,
                      const PictureArguments& picture) {
    const std::string call = picture.call;
    if (name.empty() && !fields.is_none())
        throw Error(call + ": fields: expected field, the shown one");
    Shown shown;
    shown.voxels =
        sampled_fields(data, name.empty() ? fields : one_field(fields, name, call), picture.call);
    auto& all = shown.voxels.values;
    all.resize(1);  // behind it the data's own values
    if (all.front().front().is_vector()) {
        const std::string& vector = all.front().front().name;
        const std::string part = name.size() > vector.size() ? name.substr(vector.size() + 1) : "";
        if (part != "x" && part != "y" && part != "z" && part != "magnitude")
            throw Error(call + ": no scalar field '" + name + "' in fields, expected '" + vector +
                        ".x', .y, .z or .magnitude");
        for (std::size_t n = 0; n < all.front().size(); ++n)
            all.front()[n] = component_of(std::move(all.front()[n]), part, shown.voxels.volumes[n]);
    } else if (!name.empty() && all.front().front().name != name) {
        throw Error(call + ": no scalar field '" + name + "' in fields");
    }
    shown.field = all.front().front().name;
    shown.data = value_data(shown.voxels.volumes, shown.values(), subject_to_view(data, call).box);
    return shown;
}

/// Data of a picture. throws TypeError for other objects
Shown shown_of(const py::object& data, const std::string& name, const py::object& fields,
               const PictureArguments& picture) {
    const std::string call = picture.call;
    const bool is_model = py::isinstance<Gaussians>(data);
    if (!is_model && !py::isinstance<Volume>(data) && !levels_of(data))
        refuse_data(data, call, "Gaussians, a Volume, Levels or a list of Volumes");
    if (is_model && !fields.is_none())
        throw Error(call + ": fields: of voxels, a model has its own");
    const RenderInput input = is_model ? RenderInput::gaussians : RenderInput::volumes;
    const Renderer renderer = renderer_for(picture.renderer, input);
    RenderOptions options;
    options.voxels = picture.voxels;
    try {
        require_options(renderer, input, changed_options(options), OptionSpelling::arguments);
    } catch (const Error& error) {
        throw Error(call + ": " + error.what());
    }
    if (picture.slabs != picture.usual_slabs && (!is_model || renderer == Renderer::trace))
        throw Error(call + ": slabs is for Gaussians and renderer 'splat', 'cuda' or 'optix'");
    Shown shown = is_model ? shown_of_model(data.cast<const Gaussians&>(), name, picture)
                           : shown_of_voxels(data, name, fields, picture);
    shown.renderer = renderer;
    shown.camera = camera_or_default(picture.camera, data, call, picture.width, picture.height);
    return shown;
}

/// Clipped to the box of a periodic model.
VolumeLook look_at(const py::object& data, VolumeLook look) {
    if (py::isinstance<Gaussians>(data))
        look.clip = inside_period(look.clip, data.cast<const Gaussians&>());
    return look;
}

VolumeImage volume_of(const Shown& shown, const TransferRequest& request,
                      const PictureArguments& picture) {
    const ValueTransfer transfer = choose_transfer(request, shown.data).transfer;
    const Camera& camera = shown.camera;
    const int width = picture.width, height = picture.height;
    if (!shown.model) {
        if (shown.renderer == Renderer::optix)
            return GpuVolumes(shown.voxels.volumes, shown.values())
                .volume(transfer, camera, width, height, {}, picture.look);
        return render_volume_reference(shown.voxels.volumes, shown.values(), transfer, camera,
                                       width, height, {picture.progress, 1, {}}, picture.look,
                                       picture.voxels);
    }
    if (shown.renderer == Renderer::trace) {
        TraceOptions options;
        options.progress = picture.progress;
        return render_volume_trace(*shown.model, shown.field, transfer, camera, width, height,
                                   options, {}, picture.look);
    }
    if (shown.renderer != Renderer::splat)
        return GpuPictures(shown.renderer, *shown.model)
            .volume(shown.field, transfer, camera, width, height, picture.slabs, picture.look);
    SlabOptions options;
    options.slabs = picture.slabs;
    options.look = picture.look;
    return render_volume_splat(*shown.model, shown.field, transfer, camera, width, height, options);
}

ValueMap maximum_of(const Shown& shown, const PictureArguments& picture) {
    const int width = picture.width, height = picture.height;
    const Camera& camera = shown.camera;
    if (!shown.model) {
        const ReferenceOptions options{picture.progress, 1, picture.look.clip};
        if (shown.renderer == Renderer::optix)
            return GpuVolumes(shown.voxels.volumes, shown.values())
                .maximum(camera, width, height, options);
        return render_maximum_reference(shown.voxels.volumes, shown.values(), camera, width, height,
                                        options);
    }
    if (shown.renderer == Renderer::trace) {
        TraceOptions options;
        options.progress = picture.progress;
        return render_maximum_trace(*shown.model, shown.field, camera, width, height, options, {},
                                    picture.look.clip);
    }
    if (shown.renderer != Renderer::splat)
        return GpuPictures(shown.renderer, *shown.model)
            .maximum(shown.field, camera, width, height, picture.slabs, picture.look.clip);
    SlabOptions options;
    options.slabs = picture.slabs;
    options.look = picture.look;
    return render_maximum_splat(*shown.model, shown.field, camera, width, height, options);
}

void bind_maximum_picture(py::module_& m) {
    m.def(
        "render_maximum",
        [](const py::object& data, const std::optional<Camera>& camera, const py::object& size,
           const std::string& field, const py::object& clip, const py::object& clip_planes,
           const std::string& renderer, int slabs, const py::object& fields,
           const py::object& progress) {
            const auto [width, height] = size_of(size);
            const VolumeLook look =
                look_at(data, look_of("render_maximum", py::none(), clip, clip_planes));
            const PictureArguments picture{"render_maximum", camera, width,
                                           height,           slabs,  kMaximumSlabs,
                                           renderer,         look,   progress_of(progress)};
            const Shown shown = shown_of(data, field, fields, picture);
            const ValueMap map = unlocked([&] { return maximum_of(shown, picture); });
            return py::array_t<float>({map.height, map.width}, map.value.data());
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
            const auto [width, height] = size_of(size);
            const VolumeLook look =
                look_at(data, look_of("render_volume", light, clip, clip_planes));
            const PictureArguments picture{"render_volume",
                                           camera,
                                           width,
                                           height,
                                           slabs,
                                           SlabOptions{}.slabs,
                                           renderer,
                                           look,
                                           progress_of(progress),
                                           voxels_by(interpolation, step)};
            const Rgba behind = background_of(background);
            const TransferRequest request =
                transfer_request({"render_volume", "value_range", tf, value_range, unit_distance,
                                  window, bands, log_of(scale)});
            const Shown shown = shown_of(data, field, fields, picture);
            return unlocked(
                [&] { return Picture{over(volume_of(shown, request, picture), behind)}; });
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
