// reference_pictures.cpp: pictures of voxels by the reference.
#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <optional>

#include "render/picture/source_renderer.h"
#include "render/reference/reference.h"
#include "vog/error.h"

namespace vog::pictures {

namespace {

class ReferencePictures : public SourceRenderer {
  public:
    ReferencePictures(std::vector<VoxelSource> sources, const RenderOptions& options,
                      const Collective* processes)
        : sources_(std::move(sources)), voxels_(options.voxels), processes_(processes) {}

    /// Grids for T. The visible voxels of a mesh's levels are grids that add up, unless a finer level hides part of a voxel.
    void prepare(const ResolvedPicture& picture) override {
        if (!is_depth(picture.request.show) || !grids_.empty() || !levels_.empty()) return;
        for (const VoxelSource& source : sources_) {
            const VolumeSet& levels = *source.volumes;
            if (levels.volumes.empty()) continue;
            std::optional<Composite> mesh;
            if (levels.is_mesh() && voxels_.interpolation == Interpolation::constant)
                mesh = composite(levels);
            if (levels.is_mesh() && !(mesh && mesh->partly_hidden == 0)) {
                levels_.push_back(level_grids(levels, voxels_));
                continue;
            }
            for (const Volume& volume : mesh ? mesh->parts : levels.volumes)
                grids_.push_back(voxel_grid(volume, voxels_));
        }
    }
    FieldMaps fields(const ResolvedPicture& picture, const FieldChoice& choice,
                     const Progress& progress) override {
        const PictureRequest& request = picture.request;
        const ReferenceOptions options = reference_options(request, progress);
        if (!sources_.front().volumes->is_mesh())
            return render_field_reference(volumes(), values(sources_.front(), choice.field),
                                          choice.part, picture.camera(), request.width,
                                          request.height, options, voxels_);
        const std::vector<const Levels*> levels = sets<const Levels>();
        return render_field_reference(levels, values(choice.field), choice.part, picture.camera(),
                                      request.width, request.height, options, voxels_);
    }

    PreparedLayer layer(const ResolvedPicture& picture) override {
        const VoxelSource& source = sources_.front();
        return {.volumes = volumes(),
                .field = values(source, picture.field.field),
                .voxels = interpolation_of_values(),
                .others = {source.overlap, source.beside, source.beside_field}};
    }

  protected:
    FieldMaps section(const ResolvedPicture& picture, const FieldChoice& choice,
                      const Progress& progress) override {
        const PictureRequest& request = picture.request;
        return slice_voxels(sets<const VolumeSet>(), values(choice.field), choice.part,
                            picture.camera(), request.width, request.height,
                            slice_options(picture, progress));
    }
    void depth(const ResolvedPicture& picture, DepthImage& image,
               const Progress& progress) override {
        prepare(picture);
        const PictureRequest& request = picture.request;
        ReferenceOptions options = reference_options(request, progress);
        options.collective = nullptr;
        const auto draw = [&](const auto& grids) {
            return render_reference(grids, picture.camera(), request.width, request.height,
                                    options);
        };
        image = grids_.empty() ? DepthImage(request.width, request.height) : draw(grids_);
        for (const LevelGrids& levels : levels_) {
            const DepthImage one = draw(levels);
            std::ranges::transform(image.depth, one.depth, image.depth.begin(), std::plus());
        }
    }

    ValueMap maximum(const ResolvedPicture& picture, const Progress& progress) override {
        const PictureRequest& request = picture.request;
        return render_maximum_reference(volumes(), values(sources_.front(), picture.field.field),
                                        picture.camera(), request.width, request.height,
                                        reference_options(request, progress));
    }

    void volume(const ResolvedPicture& picture, VolumeImage& image,
                const Progress& progress) override {
        const PictureRequest& request = picture.request;
        const VoxelSource& source = sources_.front();
        image = render_volume_reference(volumes(), values(source, picture.field.field),
                                        picture.chosen.transfer, picture.camera(), request.width,
                                        request.height, reference_options(request, progress),
                                        look_of(picture), interpolation_of_values(),
                                        {source.overlap, source.beside, source.beside_field});
    }

  private:
    /// throws  vog::Error for several volumes, and a step of 0, with interpolation
    VoxelGridOptions interpolation_of_values() const {
        if (voxels_.interpolation == Interpolation::constant) return {};
        if (volumes().size() > 1)
            throw Error(
                fmt::format("{} volumes or parts of a mesh: linear interpolation in volume "
                            "rendering works with one volume",
                            volumes().size()));
        if (voxels_.step_voxels == 0)
            throw RequestError("step", " 0: volume rendering takes samples, expected a step > 0");
        return voxels_;
    }
    std::span<const Volume> volumes() const { return sources_.front().volumes->volumes; }
    static std::span<const VoxelField> values(const VoxelSource& source, const std::string& field) {
        return std::ranges::find(source.fields, field, &SampledField::name)->values;
    }
    template <class Set>
    std::vector<Set*> sets() const {
        std::vector<Set*> all;
        for (const VoxelSource& source : sources_) all.push_back(source.volumes.get());
        return all;
    }
    /// [sources] a field; none without a name.
    std::vector<std::span<const VoxelField>> values(const std::string& field) const {
        std::vector<std::span<const VoxelField>> all;
        if (!field.empty())
            for (const VoxelSource& source : sources_) all.push_back(values(source, field));
        return all;
    }
    ReferenceOptions reference_options(const PictureRequest& request,
                                       const Progress& progress) const {
        return {progress, request.options.samples, request.options.clip, processes_};
    }

    std::vector<VoxelSource> sources_;
    VoxelGridOptions voxels_;
    const Collective* processes_;
    std::vector<VoxelGrid> grids_;
    std::vector<LevelGrids> levels_;
};

}  // namespace

std::unique_ptr<SourceRenderer> reference_pictures(std::vector<VoxelSource> sources,
                                                   const RenderOptions& options,
                                                   const Collective* processes) {
    return std::make_unique<ReferencePictures>(std::move(sources), options, processes);
}

}  // namespace vog::pictures
