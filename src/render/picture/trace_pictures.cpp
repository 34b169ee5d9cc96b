// trace_pictures.cpp: pictures of a model by rays on the CPU.
#include <optional>

#include "render/picture/source_renderer.h"
#include "render/trace/trace.h"

namespace vog::pictures {

namespace {

class TracePictures : public SourceRenderer {
  public:
    TracePictures(const ModelSource& source, const RenderOptions& options)
        : model_(source.model), scene_options_{options.aabb_sigma, options.kappa} {}

    void prepare(const ResolvedPicture& picture) override {
        const PictureRequest& request = picture.request;
        if (is_depth(request.show) && !scene_) scene_.emplace(trace_scene(*model_, scene_options_));
    }
    FieldMaps fields(const ResolvedPicture& picture, const FieldChoice& choice,
                     const Progress& progress) override {
        const PictureRequest& request = picture.request;
        return render_field_trace(*model_, choice, picture.camera(), request.width, request.height,
                                  trace_options(request, progress), scene_options_,
                                  request.options.clip);
    }

  protected:
    void depth(const ResolvedPicture& picture, DepthImage& image,
               const Progress& progress) override {
        const PictureRequest& request = picture.request;
        prepare(picture);
        image = render_trace(*scene_, picture.camera(), request.width, request.height,
                             trace_options(request, progress), &report.traced.emplace(),
                             request.options.clip);
    }

    ValueMap maximum(const ResolvedPicture& picture, const Progress& progress) override {
        const PictureRequest& request = picture.request;
        TraceOptions options;
        options.progress = progress;
        return render_maximum_trace(*model_, picture.field.field, picture.camera(), request.width,
                                    request.height, options, scene_options_, request.options.clip);
    }

    void volume(const ResolvedPicture& picture, VolumeImage& image,
                const Progress& progress) override {
        const PictureRequest& request = picture.request;
        TraceOptions options;
        options.progress = progress;
        image = render_volume_trace(*model_, picture.field.field, picture.chosen.transfer,
                                    picture.camera(), request.width, request.height, options,
                                    scene_options_, look_of(picture));
    }

  private:
    static TraceOptions trace_options(const PictureRequest& request, const Progress& progress) {
        TraceOptions options = request.options.trace;
        options.progress = progress;
        return options;
    }

    std::shared_ptr<const Gaussians> model_;
    TraceSceneOptions scene_options_;
    std::optional<TraceScene> scene_;
};

}  // namespace

std::unique_ptr<SourceRenderer> trace_pictures(const ModelSource& source,
                                               const RenderOptions& options) {
    return std::make_unique<TracePictures>(source, options);
}

}  // namespace vog::pictures
