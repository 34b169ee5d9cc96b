// cell_pictures.cpp: pictures of cells of any shape by the reference.
#include <algorithm>

#include "render/light/illumination.h"
#include "render/picture/source_renderer.h"
#include "render/reference/cells/cell_maps.h"
#include "render/reference/cells/lit_cells.h"

namespace vog::pictures {

namespace {

using namespace reference;

class CellPictures : public SourceRenderer {
  public:
    explicit CellPictures(const ModelSource& source)
        : source_(source.cells), rays_(*source.cells->cells, source.cells->kept) {}

    FieldMaps fields(const ResolvedPicture& picture, const FieldChoice& choice,
                     const Progress& progress) override {
        const PictureRequest& request = picture.request;
        return render_cells_fields(rays_, values(choice.field), choice.part, picture.camera(),
                                   request.width, request.height, options(request, progress));
    }
    PreparedLayer layer(const ResolvedPicture& picture) override {
        PreparedLayer layer;
        layer.cells = &rays_, layer.values = &values(picture.field.field);
        return layer;
    }

  protected:
    FieldMaps section(const ResolvedPicture& picture, const FieldChoice& choice,
                      const Progress& progress) override {
        const PictureRequest& request = picture.request;
        return slice_cells(rays_, choice.field.empty() ? nullptr : &values(choice.field),
                           choice.part, picture.camera(), request.width, request.height,
                           slice_options(picture, progress));
    }
    void depth(const ResolvedPicture& picture, DepthImage& image,
               const Progress& progress) override {
        const PictureRequest& request = picture.request;
        image = render_cells_reference(rays_, picture.camera(), request.width, request.height,
                                       options(request, progress));
    }
    ValueMap maximum(const ResolvedPicture& picture, const Progress& progress) override {
        const PictureRequest& request = picture.request;
        return render_cells_maximum(rays_, values(picture.field.field), picture.camera(),
                                    request.width, request.height, options(request, progress));
    }
    void volume(const ResolvedPicture& picture, VolumeImage& image,
                const Progress& progress) override {
        const PictureRequest& request = picture.request;
        const VolumeLook look = look_of(picture);
        const ValueTransfer& transfer = picture.chosen.transfer;
        const lights::Illumination reached = lights::illumination(
            bounds(rays_.cells()), true,
            [&](lights::ExtinctionLattice& lattice) {
                lights::add_extinction(rays_.cells(), rays_.kept(), values(picture.field.field),
                                       transfer, lattice);
            },
            look, frame_of(picture.camera(), request.width, request.height).forward);
        std::vector<std::unique_ptr<LitRays>> all;
        all.push_back(std::make_unique<LitCells>(rays_, values(picture.field.field), transfer, look,
                                                 reached));
        image = render_layers_reference(all, picture.camera(), request.width, request.height,
                                        options(request, progress), look);
    }

  private:
    /// Values of a field, or the density.
    const CellValues& values(const std::string& name) const {
        const Cells& cells = rays_.cells();
        const auto found = std::ranges::find(cells.fields, name, &CellValues::name);
        return found == cells.fields.end() ? cells.density : *found;
    }
    static ReferenceOptions options(const PictureRequest& request, const Progress& progress) {
        return {progress, request.options.samples, request.options.clip};
    }

    std::shared_ptr<const CellSource> source_;
    CellRays rays_;
};

}  // namespace

std::unique_ptr<SourceRenderer> cell_pictures(const ModelSource& source) {
    return std::make_unique<CellPictures>(source);
}

}  // namespace vog::pictures
