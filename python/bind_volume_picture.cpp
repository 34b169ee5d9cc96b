// bind_volume_picture.cpp: Python's render_volume(), pictures by value.
#include <algorithm>

#include "arrays.h"
#include "data.h"
#include "vog/error.h"
#include "vog/gpu_pictures.h"
#include "vog/gpu_volumes.h"
#include "vog/levels.h"
#include "vog/maximum_picture.h"
#include "vog/renderer.h"
#include "vog/volume_picture.h"
#include "volume_look.h"
#include "voxel_fields.h"

namespace vog::python {

namespace {

/// Keyword arguments that choose a transfer function.
struct ValueArguments {
    const py::object &tf, &value_range, &window, &bands, &unit_distance;
};

std::vector<ValueBand> bands_in(const py::object& list) {
    std::vector<ValueBand> bands;
    for (const py::handle band : list) {
        const auto row = py::reinterpret_borrow<py::object>(band);
        if (py::len(row) != 4)
            throw Error("render_volume: bands: expected rows (lower, upper, (r, g, b), opacity)");
        const std::vector<double> color =
            numbers_in(py::reinterpret_borrow<py::object>(row[py::int_(2)]), 3,
                       "render_volume: bands: colour");
        bands.push_back({row[py::int_(0)].cast<double>(), row[py::int_(1)].cast<double>(),
                         static_cast<float>(color[0]), static_cast<float>(color[1]),
                         static_cast<float>(color[2]), row[py::int_(3)].cast<double>()});
    }
    return bands;
}

/// lower, upper  of the data
ValueTransfer transfer_of(const ValueArguments& a, double lower, double upper, const Box& box) {
    if (!a.window.is_none() && !a.bands.is_none())
        throw Error("render_volume: window and bands, expected one of them");
    const double unit =
        a.unit_distance.is_none() ? 0.02 * box.radius() : a.unit_distance.cast<double>();
    if (!a.value_range.is_none()) {
        const std::vector<double> range =
            numbers_in(a.value_range, 2, "render_volume: value_range");
        lower = range[0], upper = range[1];
    }
    if (!a.window.is_none()) {
        const std::vector<double> window = numbers_in(a.window, 2, "render_volume: window");
        return window_transfer(window[0], window[1], unit);
    }
    if (!a.bands.is_none()) return band_transfer(bands_in(a.bands), unit);
    if (py::isinstance<TransferFunction>(a.tf))
        return over_range(a.tf.cast<const TransferFunction&>(), lower, upper, unit);
    ValueTransfer transfer =
        read_value_transfer(py::str(a.tf).cast<std::string>(), lower, upper, unit);
    if (!a.unit_distance.is_none()) transfer.unit_distance = unit;
    return transfer;
}

/// Where a picture is drawn.
struct PictureArguments {
    const std::optional<Camera>& camera;
    int width, height;
    int slabs;
    const std::string& renderer;
    const VolumeLook& look;
    VoxelGridOptions voxels{};
};
VoxelGridOptions voxels_by(const std::string& interpolation, double step) {
    if (interpolation != "constant" && interpolation != "linear")
        throw Error("render_volume: interpolation '" + interpolation +
                    "', expected 'constant' or 'linear'");
    return {interpolation == "linear" ? Interpolation::linear : Interpolation::constant, step};
}
Camera camera_for(const PictureArguments& picture, const Box& box) {
    const double aspect = double(picture.width) / std::max(picture.height, 1);
    return picture.camera ? *picture.camera : orbit_view(box, {}, aspect);
}

/// The field of this name, else the model's own values, else its only field.
const ScalarField& field_of(const Gaussians& model, std::string name, const std::string& call) {
    const auto& fields = model.fields.scalar;
    const auto measure = std::ranges::find(fields, true, &ScalarField::is_measure);
    if (name.empty() && measure != fields.end()) name = measure->name;
    if (name.empty() && fields.size() == 1) name = fields.front().name;
    if (const ScalarField* found = model.fields.find_scalar(name)) return *found;
    throw Error(call + ": " +
                (name.empty() ? std::string("no field named") : "no scalar field '" + name + "'") +
                ", the model has " + std::to_string(fields.size()) +
                " scalar fields (convert(volume, fields=...) makes them)");
}

VolumeImage of_model(const Gaussians& model, const std::string& name, const ValueArguments& values,
                     const PictureArguments& picture, const Progress& progress) {
    const ScalarField& found = field_of(model, name, "render_volume");
    const std::string& field = found.name;
    const Box box = view_box(model);
    const ValueTransfer transfer = transfer_of(values, found.lower, found.upper, box);
    const Renderer renderer = renderer_for(picture.renderer, RenderInput::gaussians);
    return unlocked([&] {
        const Camera camera = camera_for(picture, box);
        if (renderer == Renderer::trace) {
            TraceOptions options;
            options.progress = progress;
            return render_volume_trace(model, field, transfer, camera, picture.width,
                                       picture.height, options, {}, picture.look);
        }
        if (renderer != Renderer::splat)
            return GpuPictures(renderer, model)
                .volume(field, transfer, camera, picture.width, picture.height, picture.slabs,
                        picture.look);
        SlabOptions options;
        options.slabs = picture.slabs;
        options.look = picture.look;
        return render_volume_splat(model, field, transfer, camera, picture.width, picture.height,
                                   options);
    });
}

/// A scalar field at the voxels of a volume, whose tiles it may divide; '': its own values.
std::vector<VoxelField> voxels_of(std::vector<Volume>& volumes, const std::string& field,
                                  const py::object& fields, const std::string& renderer,
                                  const char* call) {
    std::vector<VoxelField> shown;
    if (field.empty()) {
        if (!fields.is_none())
            throw Error(std::string(call) + ": fields: expected field, the shown one");
        shown.push_back(measure_field(volumes.front(), volumes.front().name));
    } else {
        for (auto& sampled : voxel_fields_of(fields, volumes, lattices_of(volumes), 1, call))
            if (sampled.front().name == field) shown.push_back(std::move(sampled.front()));
        if (shown.empty() || shown.front().is_vector())
            throw Error(std::string(call) + ": no scalar field '" + field + "' in fields");
    }
    (void)renderer_for(renderer, RenderInput::volumes);
    return shown;
}

VolumeImage of_volume(const Volume& given, const std::string& field, const py::object& fields,
                      const ValueArguments& values, const PictureArguments& picture,
                      const Progress& progress) {
    std::vector<Volume> volumes{given};
    const std::vector<VoxelField> shown =
        voxels_of(volumes, field, fields, picture.renderer, "render_volume");
    const Box box = world_box(given);
    const ValueTransfer transfer =
        transfer_of(values, shown.front().lower, shown.front().upper, box);
    const bool on_gpu = renderer_for(picture.renderer, RenderInput::volumes) == Renderer::optix;
    if (on_gpu && picture.voxels.interpolation != Interpolation::constant)
        throw Error(
            "render_volume: interpolation is not for renderer 'optix', expected 'reference'");
    return unlocked([&] {
        if (on_gpu)
            return GpuVolumes(volumes, shown)
                .volume(transfer, camera_for(picture, box), picture.width, picture.height, {},
                        picture.look);
        return render_volume_reference(volumes, shown, transfer, camera_for(picture, box),
                                       picture.width, picture.height, {progress, 1, {}},
                                       picture.look, picture.voxels);
    });
}

ValueMap maximum_of_model(const Gaussians& model, const std::string& name,
                          const PictureArguments& picture, const Progress& progress) {
    const std::string& field = field_of(model, name, "render_maximum").name;
    const Renderer renderer = renderer_for(picture.renderer, RenderInput::gaussians);
    return unlocked([&] {
        const Camera camera = camera_for(picture, view_box(model));
        if (renderer == Renderer::trace) {
            TraceOptions options;
            options.progress = progress;
            return render_maximum_trace(model, field, camera, picture.width, picture.height,
                                        options, {}, picture.look.clip);
        }
        if (renderer != Renderer::splat)
            return GpuPictures(renderer, model)
                .maximum(field, camera, picture.width, picture.height, picture.slabs,
                         picture.look.clip);
        SlabOptions options;
        options.slabs = picture.slabs;
        options.look = picture.look;
        return render_maximum_splat(model, field, camera, picture.width, picture.height, options);
    });
}

ValueMap maximum_of_volume(const Volume& given, const std::string& field, const py::object& fields,
                           const PictureArguments& picture, const Progress& progress) {
    std::vector<Volume> volumes{given};
    const std::vector<VoxelField> shown =
        voxels_of(volumes, field, fields, picture.renderer, "render_maximum");
    const Renderer renderer = renderer_for(picture.renderer, RenderInput::volumes);
    return unlocked([&] {
        const Camera camera = camera_for(picture, world_box(given));
        const ReferenceOptions options{progress, 1, picture.look.clip};
        if (renderer == Renderer::optix)
            return GpuVolumes(volumes, shown)
                .maximum(camera, picture.width, picture.height, options);
        return render_maximum_reference(volumes, shown, camera, picture.width, picture.height,
                                        options);
    });
}

void bind_maximum_picture(py::module_& m) {
    m.def(
        "render_maximum",
        [](const py::object& data, const std::optional<Camera>& camera, const py::object& size,
           const std::string& field, const py::object& clip, const py::object& clip_planes,
           const std::string& renderer, int slabs, const py::object& fields,
           const py::object& progress) {
            const auto [width, height] = size_of(size);
            const VolumeLook look = look_of("render_volume", py::none(), clip, clip_planes);
            const PictureArguments picture{camera, width, height, slabs, renderer, look};
            const Progress report = progress_of(progress);
            ValueMap map;
            if (py::isinstance<Gaussians>(data)) {
                if (!fields.is_none())
                    throw Error("render_maximum: fields: of voxels, a model has its own");
                map = maximum_of_model(data.cast<const Gaussians&>(), field, picture, report);
            } else if (py::isinstance<Volume>(data)) {
                map = maximum_of_volume(data.cast<const Volume&>(), field, fields, picture, report);
            } else {
                refuse_data(data, "render_maximum", "Gaussians or a Volume");
            }
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

void bind_volume_picture(py::module_& m) {
    bind_maximum_picture(m);
    m.def(
        "render_volume",
        [](const py::object& data, const std::optional<Camera>& camera, const py::object& size,
           const std::string& field, const py::object& tf, const py::object& value_range,
           const py::object& window, const py::object& bands, const py::object& unit_distance,
           const py::object& light, const py::object& clip, const py::object& clip_planes,
           const py::object& background, const std::string& renderer, int slabs,
           const py::object& fields, const std::string& interpolation, double step,
           const py::object& progress) {
            const auto [width, height] = size_of(size);
            const VolumeLook look = look_of("render_volume", light, clip, clip_planes);
            const PictureArguments picture{
                camera, width, height, slabs, renderer, look, voxels_by(interpolation, step)};
            if (py::isinstance<Gaussians>(data) && interpolation != "constant")
                throw Error("render_volume: interpolation: of voxels, a model has none");
            const ValueArguments values{tf, value_range, window, bands, unit_distance};
            const Progress report = progress_of(progress);
            VolumeImage image;
            if (py::isinstance<Gaussians>(data)) {
                if (!fields.is_none())
                    throw Error("render_volume: fields: of voxels, a model has its own");
                image = of_model(data.cast<const Gaussians&>(), field, values, picture, report);
            } else if (py::isinstance<Volume>(data)) {
                image =
                    of_volume(data.cast<const Volume&>(), field, fields, values, picture, report);
            } else {
                refuse_data(data, "render_volume", "Gaussians or a Volume");
            }
            return Picture{over(image, background_of(background))};
        },
        py::arg("data"), py::arg("camera") = py::none(), py::arg("size") = 512, py::kw_only(),
        py::arg("field") = "", py::arg("tf") = "inferno", py::arg("value_range") = py::none(),
        py::arg("window") = py::none(), py::arg("bands") = py::none(),
        py::arg("unit_distance") = py::none(), py::arg("light") = py::none(),
        py::arg("clip") = py::none(), py::arg("clip_planes") = py::none(),
        py::arg("background") = "black", py::arg("renderer") = "",
        py::arg("slabs") = SlabOptions{}.slabs, py::arg("fields") = py::none(),
        py::arg("interpolation") = "constant", py::arg("step") = VoxelGridOptions{}.step_voxels,
        py::arg("progress") = py::none(),
        R"(One picture by value, a vog.Image: emission and absorption under a transfer function of a field's values.

data           Gaussians with a scalar field, or a Volume
camera         None: Camera.orbit(data), fitted to the picture
size           pixels, 512 or (width, height)
field          the scalar field; '': the data's own values
tf             name of a colour map, or a TransferFunction, over value_range; or a JSON file, whose points may be at values
value_range    (lower, upper); None: of the data
window         (centre, width) of medical pictures, in place of tf
bands          rows (lower, upper, (r, g, b), opacity), in place of tf
unit_distance  world length that opacities refer to; None: the file's, else a hundredth of the box's diagonal
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
