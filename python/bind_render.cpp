// bind_render.cpp: Scene, data made ready to be drawn, and render(), one picture of it.
#include <functional>
#include <memory>
#include <mutex>

#include "arrays.h"
#include "data.h"
#include "vog/camera.h"
#include "vog/convert_points.h"
#include "vog/error.h"
#include "vog/gpu.h"
#include "vog/reference.h"
#include "vog/splat.h"
#include "vog/trace.h"

namespace vog::python {

namespace {

/// How to draw: the renderer's name and its options, those of others left at their defaults.
struct RenderArguments {
    std::string renderer;  ///< empty: splat, or reference for voxels
    double aabb_sigma = 0, kappa = 0;
    std::string anyhit = "accumulate";
    int hits_per_slab = TraceOptions{}.hits_per_slab;
    double stop_transmittance = 0;
    std::string interpolation = "constant";
    double step_voxels = VoxelGridOptions{}.step_voxels;
    std::optional<double> extinction{};  ///< of pictures; nothing: auto

    bool traces() const { return renderer == "trace" || renderer == "optix"; }
};

/// An option of one renderer, given with another, would be ignored in silence.
void check(const RenderArguments& a, bool voxels) {
    const RenderArguments unset;
    const auto only = [&](bool given, const char* option, const char* renderers, bool fits) {
        if (given && !fits)
            throw Error(std::string("render: ") + option + " is not for renderer '" + a.renderer +
                        "', expected " + renderers);
    };
    only(a.anyhit != unset.anyhit, "anyhit", "'trace' or 'optix'", a.traces() && !voxels);
    only(a.hits_per_slab != unset.hits_per_slab, "hits_per_slab", "'trace' or 'optix'",
         a.traces() && !voxels);
    only(a.stop_transmittance != 0, "stop_transmittance", "'trace' or 'optix'",
         a.traces() && !voxels);
    only(a.aabb_sigma != 0, "aabb_sigma", "'splat', 'trace' or 'optix'",
         (a.traces() || a.renderer == "splat") && !voxels);
    only(a.kappa != 0, "kappa", "'splat', 'trace', 'optix' or 'cuda'",
         a.renderer != "reference" && !voxels);
    only(a.interpolation != unset.interpolation, "interpolation", "'reference'",
         a.renderer == "reference");
    only(a.step_voxels != unset.step_voxels, "step", "'reference'", a.renderer == "reference");
    if (a.anyhit != "accumulate" && a.anyhit != "collect")
        throw Error("render: anyhit '" + a.anyhit + "', expected 'accumulate' or 'collect'");
    if (a.interpolation != "constant" && a.interpolation != "linear")
        throw Error("render: interpolation '" + a.interpolation +
                    "', expected 'constant' or 'linear'");
    if (a.stop_transmittance > 0 && !a.extinction)
        throw Error(
            "render: stop_transmittance needs a number as extinction: 'auto' is known "
            "only after");
}

/// Data made ready for one renderer.
struct Scene {
    using Draw = std::function<DepthImage(const Camera&, int width, int height, const Progress&)>;

    std::string renderer;
    std::optional<double> extinction;
    Box box;
    Draw draw;
    std::mutex drawing{};  ///< renderers' buffers are for one picture at a time
};

TraceOptions trace_options(const RenderArguments& a) {
    TraceOptions options;
    options.anyhit = a.anyhit == "collect" ? AnyHit::collect : AnyHit::accumulate;
    options.hits_per_slab = a.hits_per_slab;
    options.stop_transmittance = a.stop_transmittance;
    if (a.extinction) options.extinction = *a.extinction;
    return options;
}

Scene::Draw draw_gaussians(std::shared_ptr<Gaussians> model, const RenderArguments& a) {
    validate(*model);
    const TraceSceneOptions scene_options{a.aabb_sigma, a.kappa};
    if (a.renderer == "trace")
        return [scene = trace_scene(*model, scene_options), options = trace_options(a)](
                   const Camera& camera, int width, int height, const Progress& progress) {
            TraceOptions now = options;
            now.progress = progress;
            return render_trace(scene, camera, width, height, now);
        };
    if (a.renderer == "optix")
        return [scene = std::make_shared<OptixModel>(*model, scene_options),
                options = trace_options(a)](const Camera& camera, int width, int height,
                                            const Progress&) {
            return scene->render(camera, width, height, options);
        };
    if (a.renderer == "cuda")
        return [splat = std::make_shared<CudaSplat>(*model, a.kappa)](
                   const Camera& camera, int width, int height, const Progress&) {
            return splat->render(camera, width, height);
        };
    if (a.renderer != "splat")
        throw Error("render: renderer '" + a.renderer +
                    "', expected 'splat', 'trace', 'cuda' or 'optix' for Gaussians");
    if (a.kappa != 0) {
        model = std::make_shared<Gaussians>(*model);
        model->cutoff = static_cast<float>(cutoff_of_kappa(a.kappa, model->cutoff));
    }
    SplatOptions options;
    options.aabb_sigma = a.aabb_sigma;
    return [model, splat = std::make_shared<SplatRenderer>(*model, options)](
               const Camera& camera, int width, int height, const Progress& progress) {
        DepthImage depth;
        splat->render(camera, width, height, depth, progress);
        return depth;
    };
}

Scene::Draw draw_voxels(const Levels* levels, const Volume* volume, const RenderArguments& a) {
    if (a.renderer == "optix" && volume)
        return [grid = std::make_shared<OptixVolume>(voxel_grid(*volume).bytes())](
                   const Camera& camera, int width, int height, const Progress&) {
            return grid->render(camera, width, height);
        };
    if (a.renderer != "reference")
        throw Error("render: renderer '" + a.renderer + "', expected 'reference' for " +
                    (volume ? "a Volume, or 'optix'; or convert it first" : "levels"));
    const VoxelGridOptions options{
        a.interpolation == "linear" ? Interpolation::linear : Interpolation::constant,
        a.step_voxels};
    const auto draw_with = [](const auto& grids) -> Scene::Draw {
        return [grids](const Camera& camera, int width, int height, const Progress& progress) {
            return render_reference(grids, camera, width, height, {progress});
        };
    };
    if (volume) return draw_with(std::vector<VoxelGrid>{voxel_grid(*volume, options)});
    return draw_with(level_grids(*levels, options));
}

std::shared_ptr<Scene> make_scene(const py::object& data, RenderArguments a) {
    const bool points = py::isinstance<Points>(data), model = py::isinstance<Gaussians>(data);
    const auto* volume = py::isinstance<Volume>(data) ? &data.cast<const Volume&>() : nullptr;
    const auto levels = points || model || volume ? nullptr : levels_of(data);
    if (!points && !model && !volume && !levels)
        refuse_data(data, "render", "Gaussians, a Volume, Levels, a list of Volumes or Points");
    const bool voxels = volume || levels;
    if (a.renderer.empty()) a.renderer = voxels ? "reference" : "splat";
    check(a, voxels);

    auto scene = std::make_shared<Scene>();
    scene->renderer = a.renderer;
    scene->extinction = a.extinction;
    std::shared_ptr<Gaussians> gaussians;
    if (model) gaussians = data.cast<std::shared_ptr<Gaussians>>();
    const auto* particles = points ? &data.cast<const Points&>() : nullptr;
    unlocked([&] {
        if (particles) gaussians = std::make_shared<Gaussians>(convert_points(*particles));
        scene->draw =
            gaussians ? draw_gaussians(gaussians, a) : draw_voxels(levels.get(), volume, a);
    });
    scene->box = gaussians ? view_box(*gaussians) : box_to_view(data, "render");
    return scene;
}

DepthImage draw(Scene& scene, const std::optional<Camera>& camera, const py::object& size,
                const py::object& progress) {
    const auto [width, height] = size_of(size);
    const Progress report = progress_of(progress);
    return unlocked([&, width = width, height = height] {
        const std::lock_guard lock(scene.drawing);
        DepthImage depth =
            scene.draw(camera ? *camera : paper_view(scene.box), width, height, report);
        set_extinction(depth, scene.extinction ? *scene.extinction : auto_extinction(depth));
        return depth;
    });
}

RenderArguments arguments_of(const std::string& renderer, const py::object& extinction,
                             double aabb_sigma, double kappa, const std::string& anyhit,
                             int hits_per_slab, double stop_transmittance,
                             const std::string& interpolation, double step) {
    return {renderer,      aabb_sigma,    kappa,
            anyhit,        hits_per_slab, stop_transmittance,
            interpolation, step,          extinction_of(extinction)};
}

constexpr const char* kOptionsText = R"(
renderer       'splat' (of models and particles: exact, object order), 'trace' (the same ray by ray),
               'cuda', 'optix' (on an NVIDIA GPU), 'reference' (of voxels: exact). '': splat or reference
extinction     factor on density; 'auto': the 99th percentile of the non-zero T becomes 4
aabb_sigma     splat, trace, optix: the paper's boxes, in its radii; 0: none
kappa          cuts kernels at this share of their peak, in place of the model's own cutoff; 0: does not
anyhit         trace, optix: 'accumulate' or, as the paper, 'collect', with hits_per_slab hits at once
               until transmittance falls below stop_transmittance
interpolation  reference: 'constant' (exact) or 'linear' between voxel centres, by `step` voxels)";

}  // namespace

void bind_render(py::module_& m) {
    const RenderArguments unset;
    const std::string scene_text =
        std::string(R"(Data made ready to be drawn from any number of views.

data           Gaussians, a Volume, Levels, a list of Volumes, or Points (one Gaussian each). Its arrays
               are not copied: leave them as they are while the scene is used)") +
        kOptionsText;
    py::class_<Scene, std::shared_ptr<Scene>>(m, "Scene", scene_text.c_str())
        .def(py::init([](const py::object& data, const std::string& renderer,
                         const py::object& extinction, double aabb_sigma, double kappa,
                         const std::string& anyhit, int hits_per_slab, double stop_transmittance,
                         const std::string& interpolation, double step) {
                 return make_scene(
                     data, arguments_of(renderer, extinction, aabb_sigma, kappa, anyhit,
                                        hits_per_slab, stop_transmittance, interpolation, step));
             }),
             py::arg("data"), py::kw_only(), py::arg("renderer") = "",
             py::arg("extinction") = "auto", py::arg("aabb_sigma") = 0.0, py::arg("kappa") = 0.0,
             py::arg("anyhit") = unset.anyhit, py::arg("hits_per_slab") = unset.hits_per_slab,
             py::arg("stop_transmittance") = 0.0, py::arg("interpolation") = unset.interpolation,
             py::arg("step") = unset.step_voxels)
        .def("render", &draw, py::arg("camera") = py::none(), py::arg("size") = 512, py::kw_only(),
             py::arg("progress") = py::none(),
             R"(One picture: a DepthImage.

camera    None: Camera.paper_view of the data
size      pixels, 512 or (width, height)
progress  is called with the finished fraction)")
        .def_readonly("renderer", &Scene::renderer, "The renderer's name.")
        .def_property_readonly(
            "box", [](const Scene& self) { return box_array(self.box); },
            "[2, 3] lower and upper corner of what views look at.")
        .def("__repr__", [](const Scene& self) { return "<vog.Scene: " + self.renderer + ">"; });

    const std::string render_text =
        std::string(R"(One picture: optical depth T per pixel, a DepthImage.

data           Gaussians, a Volume, Levels, a list of Volumes, or Points (one Gaussian each)
camera         None: Camera.paper_view(data)
size           pixels, 512 or (width, height))") +
        kOptionsText + R"(
progress       is called with the finished fraction

For many views of one thing make a Scene. The interpreter's lock is released; Ctrl-C ends it.)";
    m.def(
        "render",
        [](const py::object& data, const std::optional<Camera>& camera, const py::object& size,
           const std::string& renderer, const py::object& extinction, double aabb_sigma,
           double kappa, const std::string& anyhit, int hits_per_slab, double stop_transmittance,
           const std::string& interpolation, double step, const py::object& progress) {
            const auto scene = make_scene(
                data, arguments_of(renderer, extinction, aabb_sigma, kappa, anyhit, hits_per_slab,
                                   stop_transmittance, interpolation, step));
            return draw(*scene, camera, size, progress);
        },
        py::arg("data"), py::arg("camera") = py::none(), py::arg("size") = 512, py::kw_only(),
        py::arg("renderer") = "", py::arg("extinction") = "auto", py::arg("aabb_sigma") = 0.0,
        py::arg("kappa") = 0.0, py::arg("anyhit") = unset.anyhit,
        py::arg("hits_per_slab") = unset.hits_per_slab, py::arg("stop_transmittance") = 0.0,
        py::arg("interpolation") = unset.interpolation, py::arg("step") = unset.step_voxels,
        py::arg("progress") = py::none(), render_text.c_str());
    m.def("splat_targets", &splat_targets,
          "SIMD targets of the splat renderer that this machine can run, best first.");
}

}  // namespace vog::python
