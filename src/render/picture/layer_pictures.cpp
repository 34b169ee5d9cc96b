// layer_pictures.cpp: volume pictures of several layers: of voxels and surfaces alone exactly, else by depth slabs.
#include <algorithm>

#include "render/layers/slab_layers.h"
#include "render/picture/source_renderer.h"
#include "render/reference/cells/lit_cells.h"
#include "render/reference/fields/ray_light.h"
#include "vog/distributed.h"

namespace vog::pictures {

namespace {

/// Surfaces that this process hides with, and another one draws.
class HidingRays : public reference::LitRays {
  public:
    explicit HidingRays(std::unique_ptr<reference::LitRays> surface)
        : surface_(std::move(surface)) {}
    void add(Vec3d origin, Vec3d direction, reference::Segment& within,
             std::vector<reference::LitPiece>& pieces) const override {
        const auto before = static_cast<std::ptrdiff_t>(pieces.size());
        surface_->add(origin, direction, within, pieces);
        pieces.erase(pieces.begin() + before, pieces.end());
    }

  private:
    std::unique_ptr<reference::LitRays> surface_;
};

/// Light that reaches the layers, which shadow each other. Planes do not.
void update(LayersLight& light, const ResolvedPicture& picture,
            std::span<const PreparedLayer> prepared,
            std::span<const ResolvedPicture* const> of_layers, const Box& bounds,
            const Collective* processes) {
    const VolumeLook look = look_of(picture);
    const Vec3d forward =
        frame_of(picture.camera(), picture.request.width, picture.request.height).forward;
    std::vector<Vec3d> towards = lights::directions_of(look, forward);
    std::vector<ValueTransfer> transfers;
    std::vector<const void*> data;
    std::vector<double> opacities;
    bool of_voxels = true;
    for (std::size_t n = 0; n < prepared.size(); ++n) {
        const PreparedLayer& layer = prepared[n];
        transfers.push_back(of_layers[n]->chosen.transfer);
        data.push_back(layer.model     ? static_cast<const void*>(layer.model)
                       : layer.surface ? static_cast<const void*>(layer.surface)
                       : layer.cells   ? static_cast<const void*>(layer.cells)
                                       : layer.volumes.data());
        opacities.push_back(layer.asked->opacity.value_or(1));
        of_voxels = of_voxels && !layer.model;
    }
    // Voxels first: models know what is opaque beside what is clear.
    const auto add_extinction = [&](lights::ExtinctionLattice& lattice) {
        for (std::size_t n = 0; n < prepared.size(); ++n)
            for (std::size_t v = 0; v < prepared[n].volumes.size(); ++v)
                lights::add_extinction(prepared[n].volumes[v], prepared[n].field[v], transfers[n],
                                       lattice);
        for (std::size_t n = 0; n < prepared.size(); ++n)
            if (prepared[n].cells)
                lights::add_extinction(prepared[n].cells->cells(), prepared[n].cells->kept(),
                                       *prepared[n].values, transfers[n], lattice);
        if (processes && of_voxels) processes->sum(lattice.sum);
        for (const PreparedLayer& layer : prepared)
            if (layer.model) layer.model->add_extinction(lattice);
        for (std::size_t n = 0; n < prepared.size(); ++n)
            if (prepared[n].surface)
                prepared[n].surface->add_extinction(
                    -std::log1p(-std::min(opacities[n], kMostOpacity)), lattice);
    };
    if (light.data == data && light.transfers == transfers && light.opacities == opacities &&
        light.look == look && light.towards == towards)
        return;
    light.reached =
        lights::illumination(bounds, of_voxels, add_extinction, look, forward, processes);
    light.data = std::move(data), light.transfers = std::move(transfers);
    light.opacities = std::move(opacities);
    light.look = look, light.towards = std::move(towards);
}

}  // namespace

VolumeImage layered_picture(const ResolvedPicture& picture, std::span<PreparedLayer> prepared,
                            std::span<const ResolvedPicture* const> of_layers, const Box& bounds,
                            LayersLight& light, const Collective* processes,
                            const Progress& progress) {
    const PictureRequest& request = picture.request;
    const VolumeLook look = look_of(picture);
    update(light, picture, prepared, of_layers, bounds, processes);
    const CameraFrame frame = frame_of(picture.camera(), request.width, request.height);
    std::vector<SlabRenderer*> models;
    std::vector<std::unique_ptr<reference::LitRays>> rays;
    Box box;
    for (std::size_t n = 0; n < prepared.size(); ++n) {
        PreparedLayer& layer = prepared[n];
        const double opacity = layer.asked->opacity.value_or(1);
        const ValueTransfer& transfer = of_layers[n]->chosen.transfer;
        if (layer.model) {
            models.push_back(layer.model);
        } else if (layer.surface) {
            rays.insert(rays.begin(),
                        std::make_unique<layers::SurfaceRays>(*layer.surface, layer.asked->color,
                                                              opacity, look, light.reached));
        } else if (const auto& plane = layer.asked->plane) {
            rays.insert(rays.begin(), std::make_unique<layers::PlaneRays>(
                                          ClipPlane{plane->normal, *plane->offset},
                                          std::move(layer.plane), transfer, frame));
        } else if (layer.cells) {
            box.include(vog::bounds(layer.cells->cells()));
            rays.push_back(std::make_unique<reference::LitCells>(*layer.cells, *layer.values,
                                                                 transfer, look, light.reached));
        } else {
            for (const Volume& volume : layer.volumes) box.include(world_box(volume));
            rays.push_back(std::make_unique<reference::VoxelRays>(layer.volumes, layer.field,
                                                                  transfer, look, light.reached,
                                                                  layer.voxels, layer.others));
        }
    }
    if (models.empty()) {
        const auto surfaces = static_cast<std::size_t>(
            std::ranges::count_if(prepared, [](const PreparedLayer& l) { return l.surface; }));
        for (std::size_t n = 0; n < surfaces && processes && !processes->is_root(); ++n)
            rays[n] = std::make_unique<HidingRays>(std::move(rays[n]));
        return reference::render_layers_reference(
            rays, picture.camera(), request.width, request.height,
            {progress, request.options.samples, {}, processes}, look);
    }
    VolumeImage image{request.width, request.height, {}};
    layers::draw_slabs(models, rays, box, picture.camera(), depth_slabs(request), look.clip,
                       light.reached, processes, image);
    if (progress) progress(1);
    return image;
}

}  // namespace vog::pictures
