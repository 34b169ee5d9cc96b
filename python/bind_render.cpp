// bind_render.cpp: Python's Scene, data prepared for one renderer, and render(), one picture.
#include <limits>
#include <memory>
#include <mutex>
#include <tuple>

#include "arrays.h"
#include "data.h"
#include "sampled_fields.h"
#include "shown_maps.h"
#include "vog/camera.h"
#include "vog/convert_points.h"
#include "vog/error.h"
#include "vog/periodic.h"
#include "vog/picture.h"
#include "vog/renderer.h"
#include "vog/splat.h"
#include "volume_look.h"
#include "voxel_fields.h"

namespace vog::python {

namespace {

/// Keyword arguments of render() and Scene(), those of other renderers at their defaults.
struct RenderArguments {
    std::string renderer;  ///< empty: splat, or reference for voxels
    RenderOptions options{};
    std::optional<double> extinction{};  ///< factor on density of the pictures; nothing: auto
};

/// Data prepared for one renderer.
struct Scene {
    std::string renderer;
    std::optional<double> extinction;
    py::object data;  ///< of the default view
    std::unique_ptr<DepthRenderer> prepared{};
    std::mutex drawing{};  ///< the renderer's buffers are for one picture at a time
};

/// The renderer, with its options checked.
/// throws vog::Error: "render: kappa is not for renderer 'reference', expected 'splat', ..."
Renderer checked_renderer(const RenderArguments& a, RenderInput input) try {
    const Renderer renderer =
        a.renderer.empty() ? renderer_for({}, input) : renderer_named(a.renderer);
    require_options(renderer, input, changed_options(a.options), OptionSpelling::arguments);
    return renderer_for(a.renderer, input);
} catch (const Error& error) {
    throw Error(std::string("render: ") + error.what());
}

std::shared_ptr<Scene> make_scene(const py::object& data, const RenderArguments& a) {
    const bool points = py::isinstance<Points>(data), model = py::isinstance<Gaussians>(data);
    const auto* volume = py::isinstance<Volume>(data) ? &data.cast<const Volume&>() : nullptr;
    const auto levels = points || model || volume ? nullptr : levels_of(data);
    if (!points && !model && !volume && !levels)
        refuse_data(data, "render", "Gaussians, a Volume, Levels, a list of Volumes or Points");
    const RenderInput input = volume   ? RenderInput::volumes
                              : levels ? RenderInput::levels
                                       : RenderInput::gaussians;
    const Renderer renderer = checked_renderer(a, input);

    auto scene = std::make_shared<Scene>();
    scene->renderer = info_of(renderer).name;
    scene->extinction = a.extinction;
    std::shared_ptr<Gaussians> gaussians;
    if (model) gaussians = data.cast<std::shared_ptr<Gaussians>>();
    const auto* particles = points ? &data.cast<const Points&>() : nullptr;
    unlocked([&] {
        if (particles) gaussians = std::make_shared<Gaussians>(convert_points(*particles));
        RenderOptions options = a.options;
        if (gaussians) options.clip = inside_period(options.clip, *gaussians);
        if (gaussians)
            scene->prepared = std::make_unique<DepthRenderer>(renderer, gaussians, options);
        else if (volume)
            scene->prepared =
                std::make_unique<DepthRenderer>(renderer, std::span(volume, 1), a.options);
        else
            scene->prepared = std::make_unique<DepthRenderer>(renderer, *levels, a.options);
    });
    scene->data = particles ? py::cast(gaussians) : data;
    return scene;
}

DepthImage draw(Scene& scene, const std::optional<Camera>& camera, const py::object& size,
                const py::object& progress) {
    const auto [width, height] = size_of(size);
    const Progress report = progress_of(progress);
    const Camera view = camera_or_default(camera, scene.data, "render", width, height);
    return unlocked([&, width = width, height = height] {
        const std::lock_guard lock(scene.drawing);
        DepthImage depth;
        scene.prepared->render(view, width, height, depth, report);
        set_extinction(depth, scene.extinction ? *scene.extinction : auto_extinction(depth));
        return depth;
    });
}

/// Arguments of a map.
struct MapArguments {
    std::string show, field;
    const py::object& fields;
    const std::optional<Camera>& camera;
    const py::object& size;
    const py::object& progress;
};

/// Voxels with the field of a map.
VoxelSource voxels_of_map(const py::object& data, const MapArguments& map) {
    auto set = std::make_shared<VolumeSet>();
    if (py::isinstance<Volume>(data)) {
        set->volumes.push_back(data.cast<const Volume&>());
    } else if (const auto given = levels_of(data)) {
        static_cast<Levels&>(*set) = *given;
        set->overlap = Overlap::hide;
    } else {
        refuse_data(data, "render", "Gaussians, a Volume, Levels or a list of Volumes for a field");
    }
    auto values = voxel_fields_of(one_field(map.fields, map.field, "render"), set->volumes,
                                  lattices_of(set->volumes), set->volumes.size(), "render");
    const VoxelField& first = values.front().front();
    VoxelSource source;
    source.fields.push_back({first.name, first.unit, first.is_vector(), {}});
    source.fields.front().values = std::move(values.front());
    source.volumes = std::move(set);
    return source;
}

ShownMaps maps_of(const py::object& data, const MapArguments& map, const RenderArguments& a) {
    vog::Scene scene;
    const bool is_model = py::isinstance<Gaussians>(data);
    if (is_model && !map.fields.is_none())
        throw Error("render: fields: of voxels, a model has its own");
    if (is_model)
        scene.sources.push_back(ModelSource{data.cast<std::shared_ptr<Gaussians>>(), nullptr});
    else
        scene.sources.push_back(voxels_of_map(data, map));
    PictureRequest request;
    request.show = Show::mean;  // maps have all three
    request.field = map.field;
    request.options = a.options;
    request.renderer =
        checked_renderer(a, is_model                            ? RenderInput::gaussians
                            : scene.voxels().volumes->is_mesh() ? RenderInput::levels
                                                                : RenderInput::volumes);
    std::tie(request.width, request.height) = size_of(map.size);
    request.camera = camera_or_default(map.camera, data, "render", request.width, request.height);
    const Progress report = progress_of(map.progress);
    const ResolvedPicture picture = resolve(request, scene);
    Sums sums;
    unlocked([&] { PictureRenderer(scene).draw(picture, sums, report); });
    return {{request.width, request.height, std::move(sums.column), std::move(sums.mean),
             std::move(sums.deviation)},
            map.show,
            field_label(picture.field),
            picture.unit};
}

/// Maps with the column alone, without a field.
ShownMaps column_of(const py::object& data, const MapArguments& map, RenderArguments a) {
    a.extinction = 1;
    const auto scene = make_scene(data, a);
    const DepthImage depth = draw(*scene, map.camera, map.size, map.progress);
    const std::vector<float> none(depth.depth.size(), std::numeric_limits<float>::quiet_NaN());
    return {{depth.width, depth.height, depth.depth, none, none}, "column", "", ""};
}

/// DepthImage or FieldMaps, by `show`.
py::object rendered(const py::object& data, const MapArguments& map, const RenderArguments& a) {
    if (map.show == "T") {
        if (!map.field.empty() || !map.fields.is_none())
            throw Error("render: field and fields are of show 'column', 'mean' and 'deviation'");
        const auto scene = make_scene(data, a);
        return py::cast(draw(*scene, map.camera, map.size, map.progress));
    }
    if (map.show != "column" && map.show != "mean" && map.show != "deviation")
        throw Error("render: show '" + map.show +
                    "', expected 'T', 'column', 'mean' or 'deviation'");
    if (a.extinction)
        throw Error("render: extinction is of show 'T': column density and fields have none");
    if (map.field.empty()) {
        if (map.show != "column" || !map.fields.is_none())
            throw Error("render: show '" + map.show + "': expected field, the name of one");
        return py::cast(column_of(data, map, a));
    }
    if (py::isinstance<Points>(data))
        throw Error("render: a field of particles, expected a model or voxels: convert() them");
    return py::cast(maps_of(data, map, a));
}

RenderArguments arguments_of(const std::string& renderer, const py::object& extinction,
                             double aabb_sigma, double kappa, const std::string& anyhit,
                             int hits_per_slab, double stop_transmittance,
                             const std::string& interpolation, double step, int samples,
                             const py::object& clip, const py::object& clip_planes) {
    if (anyhit != "accumulate" && anyhit != "collect")
        throw Error("render: anyhit '" + anyhit + "', expected 'accumulate' or 'collect'");
    if (interpolation != "constant" && interpolation != "linear")
        throw Error("render: interpolation '" + interpolation +
                    "', expected 'constant' or 'linear'");
    RenderArguments a{renderer, {}, extinction_of(extinction)};
    if (stop_transmittance > 0 && !a.extinction)
        throw Error(
            "render: stop_transmittance needs a number as extinction: 'auto' is known "
            "only after");
    a.options.aabb_sigma = aabb_sigma;
    a.options.kappa = kappa;
    a.options.trace.anyhit = anyhit == "collect" ? AnyHit::collect : AnyHit::accumulate;
    a.options.trace.hits_per_slab = hits_per_slab;
    a.options.trace.stop_transmittance = stop_transmittance;
    if (a.extinction) a.options.trace.extinction = *a.extinction;
    a.options.voxels.interpolation =
        interpolation == "linear" ? Interpolation::linear : Interpolation::constant;
    a.options.voxels.step_voxels = step;
    a.options.samples = samples;
    a.options.clip = look_of("render", py::none(), clip, clip_planes).clip;
    return a;
}

constexpr const char* kOptionsText = R"(
renderer       'splat' (of models and particles: exact, object order), 'trace' (the same ray by ray),
               'cuda', 'optix' (on an NVIDIA GPU), 'reference' (of voxels: exact). '': splat or reference
extinction     factor on density; 'auto': the 99th percentile of the non-zero T becomes 4
aabb_sigma     splat, trace, optix: the paper's boxes, in its radii; 0: none
kappa          cuts kernels at this share of their peak, in place of the model's own cutoff; 0: does not
anyhit         trace, optix: 'accumulate' or, as the paper, 'collect', with hits_per_slab hits at once
               until transmittance falls below stop_transmittance
interpolation  reference: 'constant' (exact) or 'linear' between voxel centres, by `step` voxels
samples        reference, optix: N for the mean of N x N rays in each pixel; 1: the ray through its centre
clip           box of the world that is shown, [2, 3]; None: all. Exact on every ray
clip_planes    rows (nx, ny, nz, d): the side where n.x >= d stays)";

}  // namespace

void bind_render(py::module_& m) {
    const RenderOptions unset;
    const std::string scene_text =
        std::string(R"(Data made ready to be drawn from any number of views.

data           Gaussians, a Volume, Levels, a list of Volumes, or Points (one Gaussian each). Its arrays
               are not copied: leave them as they are while the scene is used)") +
        kOptionsText;
    py::class_<Scene, std::shared_ptr<Scene>>(m, "Scene", scene_text.c_str())
        .def(py::init([](const py::object& data, const std::string& renderer,
                         const py::object& extinction, double aabb_sigma, double kappa,
                         const std::string& anyhit, int hits_per_slab, double stop_transmittance,
                         const std::string& interpolation, double step, int samples,
                         const py::object& clip, const py::object& clip_planes) {
                 return make_scene(
                     data, arguments_of(renderer, extinction, aabb_sigma, kappa, anyhit,
                                        hits_per_slab, stop_transmittance, interpolation, step,
                                        samples, clip, clip_planes));
             }),
             py::arg("data"), py::kw_only(), py::arg("renderer") = "",
             py::arg("extinction") = "auto", py::arg("aabb_sigma") = 0.0, py::arg("kappa") = 0.0,
             py::arg("anyhit") = "accumulate", py::arg("hits_per_slab") = unset.trace.hits_per_slab,
             py::arg("stop_transmittance") = 0.0, py::arg("interpolation") = "constant",
             py::arg("step") = unset.voxels.step_voxels, py::arg("samples") = unset.samples,
             py::arg("clip") = py::none(), py::arg("clip_planes") = py::none())
        .def("render", &draw, py::arg("camera") = py::none(), py::arg("size") = 512, py::kw_only(),
             py::arg("progress") = py::none(),
             R"(One picture: a DepthImage.

camera    None: Camera.orbit of the data, fitted to the picture
size      pixels, 512 or (width, height)
progress  is called with the finished fraction)")
        .def_readonly("renderer", &Scene::renderer, "The renderer's name.")
        .def_property_readonly(
            "box",
            [](const Scene& self) { return box_array(subject_to_view(self.data, "Scene").box); },
            "[2, 3] lower and upper corner of what views look at.")
        .def("__repr__", [](const Scene& self) { return "<vog.Scene: " + self.renderer + ">"; });

    const std::string render_text =
        std::string(
            R"(One picture: optical depth T per pixel, a vog.DepthImage; or maps of a field, vog.FieldMaps.

data           Gaussians, a Volume, Levels, a list of Volumes, or Points (one Gaussian each)
camera         None: Camera.orbit(data), fitted to the picture
size           pixels, 512 or (width, height))") +
        kOptionsText + R"(
show           'T'; 'column', the integral of the density along the ray; of a field 'mean', weighted by
               density along the ray, or 'deviation', its standard deviation. FieldMaps have all three
field          'temperature'; of vectors 'velocity' (along the view, away from the eye positive), 'velocity.x',
               '.y', '.z' or 'velocity.magnitude' (root mean square)
fields         of voxels: the field at them, {'temperature': array}, as convert() takes it
progress       is called with the finished fraction

For many views of one thing make a Scene. The interpreter's lock is released; Ctrl-C ends it.

>>> volume = vog.sample_cloud(64)
>>> depth = vog.render(vog.convert(volume, block=4), size=(64, 48))
>>> depth.shape
(48, 64)
>>> vog.compare(vog.render(volume, size=(64, 48)), depth).psnr_db > 30
True)";
    m.def(
        "render",
        [](const py::object& data, const std::optional<Camera>& camera, const py::object& size,
           const std::string& renderer, const py::object& extinction, double aabb_sigma,
           double kappa, const std::string& anyhit, int hits_per_slab, double stop_transmittance,
           const std::string& interpolation, double step, int samples, const py::object& clip,
           const py::object& clip_planes, const std::string& show, const std::string& field,
           const py::object& fields, const py::object& progress) {
            return rendered(
                data, {show, field, fields, camera, size, progress},
                arguments_of(renderer, extinction, aabb_sigma, kappa, anyhit, hits_per_slab,
                             stop_transmittance, interpolation, step, samples, clip, clip_planes));
        },
        py::arg("data"), py::arg("camera") = py::none(), py::arg("size") = 512, py::kw_only(),
        py::arg("renderer") = "", py::arg("extinction") = "auto", py::arg("aabb_sigma") = 0.0,
        py::arg("kappa") = 0.0, py::arg("anyhit") = "accumulate",
        py::arg("hits_per_slab") = unset.trace.hits_per_slab, py::arg("stop_transmittance") = 0.0,
        py::arg("interpolation") = "constant", py::arg("step") = unset.voxels.step_voxels,
        py::arg("samples") = unset.samples, py::arg("clip") = py::none(),
        py::arg("clip_planes") = py::none(), py::arg("show") = "T", py::arg("field") = "",
        py::arg("fields") = py::none(), py::arg("progress") = py::none(), render_text.c_str());
    m.def("splat_targets", &splat_targets,
          "SIMD targets of the splat renderer that this machine can run, best first.");
}

}  // namespace vog::python
