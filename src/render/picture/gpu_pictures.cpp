// gpu_pictures.cpp: pictures of a model and of voxels on a GPU.
#include <fmt/core.h>

#include <optional>

#include "render/gpu/chords/gpu_pictures.h"
#include "render/gpu/gpu.h"
#include "render/gpu/voxels/gpu_volumes.h"
#include "render/picture/source_renderer.h"
#include "render/pixel_limits.h"
#include "vog/error.h"

namespace vog::pictures {

namespace {

class GpuModelPictures : public SourceRenderer {
  public:
    GpuModelPictures(Renderer renderer, const ModelSource& source, const RenderOptions& options)
        : renderer_(renderer), source_(source), options_(options) {
        if (source_.hierarchy && !source_.hierarchy->empty())
            cut_.emplace(*source_.model, *source_.hierarchy,
                         cutoff_of_kappa(options.kappa, source_.model->cutoff));
    }

    void prepare(const ResolvedPicture& picture) override {
        if (cuts(picture)) return;
        if (is_depth(picture.request.show) && picture.request.options.clip.empty())
            prepare_depth(*source_.model);
        else
            (void)prepared(picture);
    }
    FieldMaps fields(const ResolvedPicture& picture, const FieldChoice& choice,
                     const Progress&) override {
        GpuPictures& pictures = prepared(picture);
        const PictureRequest& request = picture.request;
        FieldMaps maps = pictures.fields(choice, picture.camera(), request.width, request.height,
                                         request.options.clip);
        report.gpu_ms = pictures.gpu_ms();
        return maps;
    }

    void draw_sums(const ResolvedPicture& picture, const SumsUnit& unit, int rays,
                   GpuSums& sums) override {
        const PictureRequest& request = picture.request;
        const SumsSize size{request.width, request.height, rays};
        const Clipping& clip = request.options.clip;
        const Camera& camera = picture.camera();
        const std::string& field = picture.field.field;
        if (is_depth(request.show) && clip.empty()) {
            prepare_depth(*source_.model);
            return cuda_ ? cuda_->render(camera, size, sums) : optix_->render(camera, size, sums);
        }
        GpuPictures& pictures = prepared(picture);
        if (is_depth(request.show))
            pictures.depth(camera, size, sums, clip);
        else if (is_field_map(request.show))
            pictures.fields(picture.field, unit, camera, size, sums, clip);
        else if (request.show == Show::volume)
            pictures.volume(field, picture.chosen.transfer, camera, size, sums,
                            depth_slabs(request), look_of(picture));
        else
            pictures.maximum(field, unit, camera, size, sums, depth_slabs(request), clip);
    }

  protected:
    void depth(const ResolvedPicture& picture, DepthImage& image, const Progress&) override {
        const PictureRequest& request = picture.request;
        if (!request.options.clip.empty()) {
            GpuPictures& pictures = prepared(picture);
            image = pictures.depth(picture.camera(), request.width, request.height,
                                   request.options.clip);
            report.gpu_ms = pictures.gpu_ms();
        } else if (renderer_ == Renderer::cuda) {
            prepare_depth(drawn(picture));
            image = cuda_->render(picture.camera(), request.width, request.height);
            report.gpu_ms = cuda_->gpu_ms();
        } else {
            prepare_depth(drawn(picture));
            image = optix_->render(picture.camera(), request.width, request.height,
                                   request.options.trace, &report.traced.emplace(),
                                   request.options.samples);
            report.gpu_ms = optix_->gpu_ms();
        }
        if (cuts(picture)) depth_of_ = nullptr;  // the next cut lies in the same place
    }

    ValueMap maximum(const ResolvedPicture& picture, const Progress& progress) override {
        GpuPictures& pictures = prepared(picture);
        const PictureRequest& request = picture.request;
        ValueMap map = pictures.maximum(picture.field.field, picture.camera(), request.width,
                                        request.height, depth_slabs(request), request.options.clip);
        report.gpu_ms = pictures.gpu_ms();
        if (progress) progress(1);
        return map;
    }

    void volume(const ResolvedPicture& picture, VolumeImage& image,
                const Progress& progress) override {
        GpuPictures& pictures = prepared(picture);
        const PictureRequest& request = picture.request;
        image = pictures.volume(picture.field.field, picture.chosen.transfer, picture.camera(),
                                request.width, request.height, depth_slabs(request),
                                look_of(picture), std::move(image.pixel));
        report.gpu_ms = pictures.gpu_ms();
        if (progress) progress(1);
    }

  private:
    /// Whether a picture is a cut through the hierarchy, which is sent to the GPU for it.
    bool cuts(const ResolvedPicture& picture) const {
        const bool has_nodes = !is_by_value(picture.request.show);
        return cut_ && picture.request.options.pixel_error && has_nodes;
    }
    const Gaussians& drawn(const ResolvedPicture& picture) {
        if (!cuts(picture)) return *source_.model;
        const PictureRequest& request = picture.request;
        const Gaussians& chosen =
            cut_->choose(frame_of(picture.camera(), request.width, request.height),
                         {*request.options.pixel_error, true});
        report.cut = cut_->report();
        return chosen;
    }
    /// Sends a model for T without a clip.
    void prepare_depth(const Gaussians& model) {
        if (&model == depth_of_) return;
        if (renderer_ == Renderer::cuda)
            cuda_.emplace(model, options_.kappa);
        else
            optix_.emplace(model, TraceSceneOptions{options_.aabb_sigma, options_.kappa});
        depth_of_ = &model;
    }
    GpuPictures& prepared(const ResolvedPicture& picture) {
        const RenderOptions& options = picture.request.options;
        const auto refuse = [&](const char* member, const char* value) {
            throw RequestError(member, fmt::format(" {}is for T without a clip with renderer '{}'",
                                                   value, info_of(renderer_).name));
        };
        // On the device boxes are met by whole rays, elsewhere by the part that the clip leaves.
        if (options.aabb_sigma != 0 && !options.clip.empty())
            throw RequestError("aabb_sigma",
                               fmt::format(" is for pictures without a clip with renderer '{}'",
                                           info_of(renderer_).name));
        if (options.samples != 1) refuse("samples", "");
        if (options.trace.anyhit != AnyHit::accumulate) refuse("anyhit", "collect ");
        if (options.trace.stop_transmittance > 0) refuse("stop_transmittance", "");
        if (cuts(picture)) {
            pictures_.emplace(renderer_, drawn(picture), TraceSceneOptions{0, options_.kappa});
            whole_ = false;
        } else if (!pictures_ || !whole_) {
            pictures_.emplace(renderer_, *source_.model,
                              TraceSceneOptions{options_.aabb_sigma, options_.kappa});
            whole_ = true;
        }
        return *pictures_;
    }

    Renderer renderer_;
    ModelSource source_;
    RenderOptions options_;
    std::optional<ViewCut> cut_;
    std::optional<CudaSplat> cuda_;  ///< T without a clip, of `depth_of_`
    std::optional<OptixModel> optix_;
    const Gaussians* depth_of_ = nullptr;
    std::optional<GpuPictures> pictures_;  ///< all else
    bool whole_ = false;                   ///< whether they are of the model, not of a cut
};

class GpuVoxelPictures : public SourceRenderer {
  public:
    explicit GpuVoxelPictures(const VoxelSource& source) : source_(source) {}

    void prepare(const ResolvedPicture& picture) override {
        (void)prepared(is_depth(picture.request.show) ? "" : picture.field.field);
    }
    FieldMaps fields(const ResolvedPicture& picture, const FieldChoice& choice,
                     const Progress&) override {
        const PictureRequest& request = picture.request;
        FieldMaps maps = prepared(choice.field)
                             .fields(choice.part, picture.camera(), request.width, request.height,
                                     reference_options(request));
        report.gpu_ms = volumes_->gpu_ms();
        return maps;
    }

  protected:
    void depth(const ResolvedPicture& picture, DepthImage& image, const Progress&) override {
        const PictureRequest& request = picture.request;
        image = prepared({}).depth(picture.camera(), request.width, request.height,
                                   reference_options(request));
        report.gpu_ms = volumes_->gpu_ms();
    }
    ValueMap maximum(const ResolvedPicture& picture, const Progress& progress) override {
        const PictureRequest& request = picture.request;
        ValueMap map = prepared(picture.field.field)
                           .maximum(picture.camera(), request.width, request.height,
                                    reference_options(request));
        report.gpu_ms = volumes_->gpu_ms();
        if (progress) progress(1);
        return map;
    }
    void volume(const ResolvedPicture& picture, VolumeImage& image,
                const Progress& progress) override {
        const PictureRequest& request = picture.request;
        if (request.look.shadows || request.look.occlusion)
            throw RequestError(request.look.shadows ? "shadows" : "ambient_occlusion",
                               " of voxels needs `renderer` reference");
        image = prepared(picture.field.field)
                    .volume(picture.chosen.transfer, picture.camera(), request.width,
                            request.height, reference_options(request), look_of(picture));
        report.gpu_ms = volumes_->gpu_ms();
        if (progress) progress(1);
    }

  private:
    static ReferenceOptions reference_options(const PictureRequest& request) {
        return {{}, request.options.samples, request.options.clip};
    }
    GpuVolumes& prepared(const std::string& field) {
        if (volumes_ && of_ == field) return *volumes_;
        const auto found = std::ranges::find(source_.fields, field, &SampledField::name);
        const std::span<const VoxelField> values =
            field.empty() ? std::span<const VoxelField>() : std::span(found->values);
        const VolumeSet& set = *source_.volumes;
        if (set.is_mesh())
            volumes_.emplace(static_cast<const Levels&>(set), values);
        else
            volumes_.emplace(set.volumes, values);
        of_ = field;
        return *volumes_;
    }

    VoxelSource source_;
    std::optional<GpuVolumes> volumes_;
    std::string of_;
};

}  // namespace

std::unique_ptr<SourceRenderer> gpu_pictures(Renderer renderer, const ModelSource& source,
                                             const RenderOptions& options) {
    return std::make_unique<GpuModelPictures>(renderer, source, options);
}

std::unique_ptr<SourceRenderer> gpu_voxel_pictures(const VoxelSource& source) {
    return std::make_unique<GpuVoxelPictures>(source);
}

}  // namespace vog::pictures
