// layer_pictures.cpp: volume pictures of several layers: of voxels alone exactly, else by depth slabs.
#include <algorithm>

#include "render/layers/slab_layers.h"
#include "render/picture/source_renderer.h"
#include "render/reference/fields/ray_light.h"

namespace vog::pictures {

VolumeImage layered_picture(const ResolvedPicture& picture, std::span<const PreparedLayer> prepared,
                            std::span<const ResolvedPicture* const> of_layers, const Box& bounds,
                            LayersLight& light, const Progress& progress) {
    const PictureRequest& request = picture.request;
    const VolumeLook look = look_of(picture);
    std::vector<SlabRenderer*> models;
    for (const PreparedLayer& layer : prepared)
        if (layer.model) models.push_back(layer.model);
    // Layers shadow each other. Voxels first: models know what is opaque beside what is clear.
    const auto add_extinction = [&](lights::ExtinctionLattice& lattice) {
        for (std::size_t n = 0; n < prepared.size(); ++n)
            for (std::size_t v = 0; v < prepared[n].volumes.size(); ++v)
                lights::add_extinction(prepared[n].volumes[v], prepared[n].field[v],
                                       of_layers[n]->chosen.transfer, lattice);
        for (const SlabRenderer* model : models) model->add_extinction(lattice);
    };
    const Vec3d forward = frame_of(picture.camera(), request.width, request.height).forward;
    const Vec3d towards = look.towards_light == Vec3d{} ? -forward : look.towards_light;
    std::vector<ValueTransfer> transfers;
    std::vector<const void*> data;
    for (std::size_t n = 0; n < prepared.size(); ++n) {
        const PreparedLayer& layer = prepared[n];
        transfers.push_back(of_layers[n]->chosen.transfer);
        data.push_back(layer.model ? static_cast<const void*>(layer.model) : layer.volumes.data());
    }
    if (light.data != data || light.transfers != transfers || light.look != look ||
        light.towards != towards)
        light = {std::move(data), std::move(transfers), look, towards,
                 lights::illumination(bounds, models.empty(), add_extinction, look, forward)};
    const lights::Illumination& reached = light.reached;
    std::vector<layers::VoxelLayer> voxels;
    for (std::size_t n = 0; n < prepared.size(); ++n) {
        const PreparedLayer& layer = prepared[n];
        if (layer.model) continue;
        Box box;
        for (const Volume& volume : layer.volumes) box.include(world_box(volume));
        voxels.push_back({{layer.volumes, layer.field, of_layers[n]->chosen.transfer, look, reached,
                           layer.voxels},
                          box});
    }
    VolumeImage image{request.width, request.height, {}};
    if (models.empty()) {
        std::vector<reference::VoxelRays> rays;
        for (layers::VoxelLayer& layer : voxels) rays.push_back(std::move(layer.rays));
        return reference::render_layers_reference(rays, picture.camera(), request.width,
                                                  request.height,
                                                  {progress, request.options.samples}, look);
    }
    layers::draw_slabs(models, voxels, picture.camera(), depth_slabs(request), look.clip, reached,
                       image);
    if (progress) progress(1);
    return image;
}

}  // namespace vog::pictures
