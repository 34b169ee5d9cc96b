// splat_pictures.cpp: pictures of a model by splatting on the CPU.
#include <optional>

#include "render/picture/source_renderer.h"
#include "render/splat/fields/field_splat.h"
#include "render/splat/splat.h"
#include "render/splat/volume/volume_splat.h"

namespace vog::pictures {

namespace {

class SplatPictures : public SourceRenderer {
  public:
    SplatPictures(const ModelSource& source, const RenderOptions& options,
                  const Collective* processes)
        : source_(source), options_(options), processes_(processes) {
        if (source_.hierarchy && source_.hierarchy->empty()) source_.hierarchy.reset();
    }

    void prepare(const ResolvedPicture& picture) override {
        const PictureRequest& request = picture.request;
        if (is_depth(request.show) && !splat_) splat_.emplace(model(), splat_options(request));
    }
    FieldMaps fields(const ResolvedPicture& picture, const FieldChoice& choice,
                     const Progress& progress) override {
        const PictureRequest& request = picture.request;
        SplatOptions options = splat_options(request);
        options.progress = progress;
        FieldMaps maps = std::exchange(before, {});
        render_field_splat(model(), choice, picture.camera(), request.width, request.height,
                           options, maps, source_.hierarchy ? &report.cut.emplace() : nullptr,
                           request.options.clip);
        return maps;
    }

    PreparedLayer layer(const ResolvedPicture& picture) override {
        return {.model = &slabs(picture)};
    }

  protected:
    FieldMaps section(const ResolvedPicture& picture, const FieldChoice& choice,
                      const Progress& progress) override {
        const PictureRequest& request = picture.request;
        return slice_model(model(), choice, picture.camera(), request.width, request.height,
                           slice_options(picture, progress));
    }
    void depth(const ResolvedPicture& picture, DepthImage& image,
               const Progress& progress) override {
        const PictureRequest& request = picture.request;
        prepare(picture);
        const SplatOptions options = splat_options(request);
        splat_->set_cut(options.cut);
        splat_->set_clip(request.options.clip);
        splat_->render(picture.camera(), request.width, request.height, image, progress);
        if (options.hierarchy) report.cut = splat_->cut_report();
    }

    ValueMap maximum(const ResolvedPicture& picture, const Progress& progress) override {
        const PictureRequest& request = picture.request;
        SlabOptions options = slab_options(picture);
        options.slabs = depth_slabs(request);
        ValueMap map = render_maximum_splat(model(), picture.field.field, picture.camera(),
                                            request.width, request.height, options);
        if (progress) progress(1);
        return map;
    }

    void volume(const ResolvedPicture& picture, VolumeImage& image,
                const Progress& progress) override {
        const PictureRequest& request = picture.request;
        slabs(picture).render(picture.camera(), request.width, request.height, image);
        if (progress) progress(1);
    }

  private:
    /// What slabs depend on beside transfer function and light.
    struct Kept {
        std::string field;
        int slabs = 0;
        double precision = 0;
        bool lit = false, by_gradient = false;
        Clipping clip{};
        friend bool operator==(const Kept&, const Kept&) = default;
    };

    /// Made with the first transfer function, then kept for pictures under others.
    SlabRenderer& slabs(const ResolvedPicture& picture) {
        SlabOptions options = slab_options(picture);
        options.slabs = depth_slabs(picture.request);
        options.precision = picture.request.precision;
        const ValueTransfer& transfer = picture.chosen.transfer;
        Kept wanted{picture.field.field,        options.slabs,
                    options.precision,          options.look.light,
                    !transfer.gradient.empty(), options.look.clip};
        if (slabs_ && kept_ == wanted) {
            slabs_->set_transfer(transfer);
            slabs_->set_light(options.look);
        } else {
            slabs_.emplace(model(), wanted.field, transfer, options);
            kept_ = std::move(wanted);
        }
        return *slabs_;
    }

    const Gaussians& model() const { return *source_.model; }
    SplatOptions splat_options(const PictureRequest& request) const {
        SplatOptions options;
        options.aabb_sigma = options_.aabb_sigma;
        options.kappa = options_.kappa;
        if (options.aabb_sigma == 0) options.hierarchy = source_.hierarchy.get();
        options.cut = {request.options.pixel_error.value_or(options.cut.pixel_error), true};
        return options;
    }
    SlabOptions slab_options(const ResolvedPicture& picture) const {
        SlabOptions options;
        options.kappa = options_.kappa;
        options.look = look_of(picture);
        options.collective = processes_;
        return options;
    }

    ModelSource source_;
    RenderOptions options_;
    const Collective* processes_;
    std::optional<SplatRenderer> splat_;
    std::optional<SlabRenderer> slabs_;
    Kept kept_;
};

}  // namespace

std::unique_ptr<SourceRenderer> splat_pictures(const ModelSource& source,
                                               const RenderOptions& options,
                                               const Collective* processes) {
    return std::make_unique<SplatPictures>(source, options, processes);
}

}  // namespace vog::pictures
