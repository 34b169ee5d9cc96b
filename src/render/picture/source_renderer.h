// source_renderer.h: renderer of one source of a scene in all quantities: a class for each method and kind of data.
#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "render/by_value/volume_image.h"
#include "render/gpu/sums/gpu_sums.h"
#include "render/layers/surface_rays.h"
#include "render/reference/cells/cell_rays.h"
#include "render/reference/reference.h"
#include "render/slice/slice.h"
#include "render/splat/volume/volume_splat.h"
#include "vog/picture.h"

namespace vog::pictures {

/// A layer of a volume picture, prepared.
struct PreparedLayer {
    SlabRenderer* model = nullptr;  ///< null: of voxels, cells, a plane or a surface
    const layers::SurfaceBvh* surface = nullptr;
    std::vector<float> plane{};  ///< [height * width] values on the layer's plane
    const Layer* asked = nullptr;
    std::span<const Volume> volumes{};
    std::span<const VoxelField> field{};  ///< [volumes]
    VoxelGridOptions voxels{};
    OtherVoxels others{};
    const reference::CellRays* cells = nullptr;
    const CellValues* values = nullptr;  ///< of the cells
};

/// Draws pictures of data that it prepares for the first one and keeps.
class SourceRenderer {
  public:
    virtual ~SourceRenderer() = default;

    /// T or column, maps of a field, the maximum, or light, by the request's quantity.
    void draw(const ResolvedPicture& picture, Sums& sums, const Progress& progress) {
        report = {};
        const int width = picture.request.width, height = picture.request.height;
        sums.width = width, sums.height = height;
        switch (picture.request.show) {
            case Show::depth:
            case Show::column: {
                DepthImage image;
                image.width = width, image.height = height;
                image.depth = std::move(sums.column);
                depth(picture, image, progress);
                sums.column = std::move(image.depth);
                return;
            }
            case Show::mean:
            case Show::deviation:
                before = {0, 0, std::move(sums.column), std::move(sums.mean),
                          std::move(sums.deviation)};
                return take(fields(picture, picture.field, progress), sums);
            case Show::slice:
                return take(slice(picture, picture.field, progress), sums);
            case Show::maximum:
                sums.maximum = maximum(picture, progress).value;
                return;
            case Show::volume: {
                VolumeImage image{width, height, std::move(sums.light)};
                volume(picture, image, progress);
                sums.light = std::move(image.pixel);
                return;
            }
        }
    }
    /// The picture left in GPU memory, without levels of detail.
    /// unit  of the field in the sums
    /// rays  rays^2 rays a pixel
    /// throws  vog::Error by a renderer that does not draw on a GPU
    virtual void draw_sums(const ResolvedPicture&, const SumsUnit&, int /*rays*/, GpuSums&) {
        throw Error("no sums in GPU memory by this renderer, expected cuda or optix");
    }
    /// What pictures like this one share, which is made with the first one otherwise.
    virtual void prepare(const ResolvedPicture&) {}
    /// Maps of a field, for joint ones of several processes.
    virtual FieldMaps fields(const ResolvedPicture& picture, const FieldChoice& choice,
                             const Progress& progress) = 0;

    /// The data of a volume picture, as a layer of another one.
    /// throws  vog::Error by a renderer that draws no layers
    virtual PreparedLayer layer(const ResolvedPicture&) {
        throw Error("layers are drawn by splat and reference");
    }
    /// Density on the request's plane, or its mean across it, and of a field its mean there; without a field means are 0.
    FieldMaps slice(const ResolvedPicture& picture, const FieldChoice& choice,
                    const Progress& progress);

    static void take(FieldMaps maps, Sums& sums) {
        sums.column = std::move(maps.column);
        sums.mean = std::move(maps.mean);
        sums.deviation = std::move(maps.deviation);
    }

    DrawReport report;  ///< on the last picture

  protected:
    FieldMaps before;  ///< maps of the picture before, whose memory fields() may use

    /// The slice on the plane itself.
    virtual FieldMaps section(const ResolvedPicture&, const FieldChoice&, const Progress&) {
        throw Error("no slices by this renderer, expected splat or reference");
    }
    virtual void depth(const ResolvedPicture& picture, DepthImage& image,
                       const Progress& progress) = 0;
    virtual ValueMap maximum(const ResolvedPicture& picture, const Progress& progress) = 0;
    virtual void volume(const ResolvedPicture& picture, VolumeImage& image,
                        const Progress& progress) = 0;
};

/// Light of a picture in its view, with its clip.
inline VolumeLook look_of(const ResolvedPicture& picture) {
    VolumeLook look = lights_in_view(picture.request.look, frame_of(picture.camera(), 1, 1));
    look.clip = picture.request.options.clip;
    return look;
}

// Renderers of models. `options` are those that their preparation depends on: boxes and kernels.
std::unique_ptr<SourceRenderer> splat_pictures(const ModelSource& source,
                                               const RenderOptions& options,
                                               const Collective* processes);
std::unique_ptr<SourceRenderer> trace_pictures(const ModelSource& source,
                                               const RenderOptions& options);
std::unique_ptr<SourceRenderer> gpu_pictures(Renderer renderer, const ModelSource& source,
                                             const RenderOptions& options);
// Renderers of voxels: sources that add up.
std::unique_ptr<SourceRenderer> reference_pictures(std::vector<VoxelSource> sources,
                                                   const RenderOptions& options,
                                                   const Collective* processes);
std::unique_ptr<SourceRenderer> gpu_voxel_pictures(const VoxelSource& source);
/// Of cells, by the reference.
std::unique_ptr<SourceRenderer> cell_pictures(const ModelSource& source);

/// Light that reaches layers, kept while neither these nor the light change.
struct LayersLight {
    std::vector<const void*> data{};  ///< models, volumes, or surfaces
    std::vector<ValueTransfer> transfers{};
    std::vector<double> opacities{};
    VolumeLook look{};
    std::vector<Vec3d> towards{};
    lights::Illumination reached{};
};

/// The volume picture of several layers.
/// picture    its request, clip included
/// of_layers  resolved, each of its data
/// bounds     box of all, world units
/// processes  that hold parts of models, or of volumes, and whole surfaces; null: this one alone
VolumeImage layered_picture(const ResolvedPicture& picture, std::span<PreparedLayer> prepared,
                            std::span<const ResolvedPicture* const> of_layers, const Box& bounds,
                            LayersLight& light, const Collective* processes,
                            const Progress& progress);
/// Options of a slice, which are those of the request.
SliceOptions slice_options(const ResolvedPicture& picture, const Progress& progress);
/// Moves the shown numbers of a slice to Sums::slice.
void set_slice(const ResolvedPicture& picture, Sums& sums);

/// Maps of the parts of several processes, on the root: columns add, means and deviations by the columns.
/// draw  maps of this process's part
FieldMaps joint_maps(const FieldChoice& choice, const Collective& processes,
                     const std::function<FieldMaps(const FieldChoice&)>& draw);
/// Replaces values by their sums over all processes.
void sum_over(std::span<float> values, const Collective& processes);

}  // namespace vog::pictures
