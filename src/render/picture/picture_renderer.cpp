// picture_renderer.cpp: PictureRenderer: the renderer of a request, prepared for its scene.
#include <algorithm>
#include <deque>
#include <map>
#include <optional>

#include "render/picture/source_renderer.h"
#include "shade/values/label_table.h"
#include "vog/clip.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/periodic.h"
#include "vog/renderer.h"

namespace vog {

using namespace pictures;

namespace {

/// Options that a renderer's preparation depends on.
struct Prepared {
    double aabb_sigma, kappa, step_voxels;
    Interpolation interpolation;
    friend auto operator<=>(const Prepared&, const Prepared&) = default;
};

Prepared prepared_for(const RenderOptions& options) {
    return {options.aabb_sigma, options.kappa, options.voxels.step_voxels,
            options.voxels.interpolation};
}

/// A picture whose clip counts in every period of a model.
ResolvedPicture of_period(ResolvedPicture picture, const Scene& scene) {
    Clipping& clip = picture.request.options.clip;
    if (!scene.has_voxels()) clip = inside_period(clip, *scene.model().model);
    return picture;
}

/// Values of a layer on its plane, NaN outside of the data: those of a slice of the same data and field.
/// field_name  of the layer; empty: the default
std::vector<float> on_plane(SourceRenderer& renderer, ResolvedPicture picture, const Scene& scene,
                            const std::string& field_name) {
    if (!scene.has_voxels() && !scene.subject.content.by_value && field_name.empty())
        if (const ScalarField* field = scene.model().model->fields.find_scalar(picture.field.field);
            field && field->is_measure)
            picture.background = field->background, picture.field = {};
    if (shading::is_label_table(picture.request.transfer.points))
        picture.request.options.samples = 1;  // means of labels are other labels
    Sums sums;
    SourceRenderer::take(renderer.slice(picture, picture.field, {}), sums);
    set_slice(picture, sums);
    return std::move(sums.slice);
}

}  // namespace

struct PictureRenderer::State {
    Scene scene;
    std::map<std::pair<Renderer, Prepared>, std::unique_ptr<SourceRenderer>> by{};
    std::vector<std::unique_ptr<SourceRenderer>> of_layers{};  ///< [Scene::layers]
    std::map<const Surface*, layers::SurfaceBvh> surfaces{};   ///< of layers
    std::optional<Prepared> layers_prepared{};                 ///< options of theirs
    LayersLight light{};
    DrawReport report{};

    bool is_empty() const {
        return !scene.has_voxels() && !scene.has_surface() && scene.model().model->size() == 0;
    }
    bool several() const { return scene.collective && scene.collective->several(); }

    std::unique_ptr<SourceRenderer> made(const Scene& of, Renderer renderer,
                                         const RenderOptions& options) const {
        const Collective* processes = several() ? scene.collective : nullptr;
        if (of.has_voxels()) {
            if (renderer == Renderer::optix) return gpu_voxel_pictures(of.voxels());
            std::vector<VoxelSource> sources;
            for (const Source& source : of.sources)
                sources.push_back(std::get<VoxelSource>(source));
            return reference_pictures(std::move(sources), options, processes);
        }
        if (of.has_cells()) return cell_pictures(of.model());
        switch (renderer) {
            case Renderer::splat:
                return splat_pictures(of.model(), options, processes);
            case Renderer::trace:
                return trace_pictures(of.model(), options);
            default:
                return gpu_pictures(renderer, of.model(), options);
        }
    }

    /// The renderer of a request. Another one for other options replaces it.
    SourceRenderer& prepared(const PictureRequest& request) {
        const RenderOptions& options = request.options;
        const std::pair key{*request.renderer, prepared_for(options)};
        auto found = by.find(key);
        if (found == by.end()) {
            std::erase_if(by, [&](const auto& one) { return one.first.first == key.first; });
            found = by.emplace(key, made(scene, key.first, options)).first;
        }
        return *found->second;
    }

    void draw_layers(const ResolvedPicture& picture, Sums& sums, const Progress& progress) {
        const RenderOptions& options = picture.request.options;
        if (layers_prepared != prepared_for(options)) {
            of_layers.clear();
            of_layers.resize(scene.layers.size());
            light = {};
            layers_prepared = prepared_for(options);
        }
        std::vector<PreparedLayer> prepared;
        std::deque<ResolvedPicture> inside;
        std::vector<const ResolvedPicture*> resolved;
        Box bounds;
        for (std::size_t n = 0; n < scene.layers.size(); ++n) {
            const Scene& layer = scene.layers[n];
            const Layer& asked = picture.request.layers[n];
            if (layer.sources.empty() || !asked.visible) continue;
            if (layer.has_surface()) {
                const auto& surface = std::get<SurfaceSource>(layer.sources.front()).surface;
                resolved.push_back(&picture.layers[n]);
                prepared.push_back(
                    {.surface = &surfaces.try_emplace(surface.get(), surface).first->second,
                     .asked = &asked});
                bounds.include(layer.subject.box);
                continue;
            }
            if (!of_layers[n]) {
                RenderOptions own = options;
                own.voxels = picture.layers[n].request.options.voxels;
                of_layers[n] =
                    made(layer, layer.has_voxels() ? Renderer::reference : Renderer::splat, own);
            }
            resolved.push_back(&inside.emplace_back(of_period(picture.layers[n], layer)));
            PictureRequest& own = inside.back().request;
            own.camera = picture.request.camera;
            own.width = picture.request.width, own.height = picture.request.height;
            prepared.push_back(asked.plane
                                   ? PreparedLayer{.plane = on_plane(*of_layers[n], inside.back(),
                                                                     layer, asked.field)}
                                   : of_layers[n]->layer(inside.back()));
            prepared.back().asked = &asked;
            bounds.include(layer.has_voxels() ? layer.subject.box : view_box(*layer.model().model));
        }
        sums.width = picture.request.width, sums.height = picture.request.height;
        sums.light = layered_picture(picture, prepared, resolved, bounds, light,
                                     several() ? scene.collective : nullptr, progress)
                         .pixel;
    }

    void draw_joint(const ResolvedPicture& picture, Sums& sums, const Progress& progress) {
        SourceRenderer& renderer = prepared(picture.request);
        const Show show = picture.request.show;
        const bool depth = is_depth(show);
        const bool slice = show == Show::slice;
        // The reference joins maps of fields itself.
        const bool joined = scene.has_voxels() &&
                            (!slice || (picture.request.thickness && !picture.field.field.empty()));
        if ((is_field_map(show) || slice) && several() && !joined) {
            sums.width = picture.request.width, sums.height = picture.request.height;
            SourceRenderer::take(
                joint_maps(picture.field, *scene.collective,
                           [&](const FieldChoice& choice) {
                               return slice ? renderer.slice(picture, choice, progress)
                                            : renderer.fields(picture, choice, progress);
                           }),
                sums);
            return;
        }
        if (depth && is_empty()) {
            sums.width = picture.request.width, sums.height = picture.request.height;
            sums.column.assign(DepthImage(sums.width, sums.height).depth.size(), 0);
        } else {
            renderer.draw(picture, sums, progress);
        }
        if (depth && several()) sum_over(sums.column, *scene.collective);
    }
};

PictureRenderer::PictureRenderer(Scene scene)
    : state_(std::make_unique<State>(State{.scene = std::move(scene)})) {}
PictureRenderer::~PictureRenderer() = default;
PictureRenderer::PictureRenderer(PictureRenderer&&) noexcept = default;
PictureRenderer& PictureRenderer::operator=(PictureRenderer&&) noexcept = default;

const Scene& PictureRenderer::scene() const { return state_->scene; }
const DrawReport& PictureRenderer::report() const { return state_->report; }

void PictureRenderer::prepare(const ResolvedPicture& picture) {
    if (!state_->is_empty() && picture.layers.empty())
        state_->prepared(picture.request).prepare(picture);
}

void PictureRenderer::draw(const ResolvedPicture& picture, Sums& sums, const Progress& progress) {
    validate(picture.request.options.clip);
    state_->report = {};
    if (!picture.layers.empty()) return state_->draw_layers(picture, sums, progress);
    state_->draw_joint(of_period(picture, state_->scene), sums, progress);
    if (picture.request.show == Show::slice) set_slice(picture, sums);
    state_->report = state_->prepared(picture.request).report;
}

Picture render(const Scene& scene, const PictureRequest& request) {
    const ResolvedPicture picture = resolve(request, scene);
    Sums sums;
    PictureRenderer(scene).draw(picture, sums);
    return finish(std::move(sums), picture, scene);
}

DepthImage bare_depth(PictureRenderer& renderer, const PictureRequest& request,
                      const Progress& progress) {
    Sums sums;
    renderer.draw(resolve(request, renderer.scene()), sums, progress);
    DepthImage image;
    image.width = sums.width, image.height = sums.height;
    image.depth = std::move(sums.column);
    return image;
}

}  // namespace vog
