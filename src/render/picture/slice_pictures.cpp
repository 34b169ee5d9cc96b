// slice_pictures.cpp: slices of a source on a plane, or averaged across it by clipped columns.
#include <cmath>
#include <limits>

#include "render/picture/source_renderer.h"
#include "shade/values/label_table.h"

namespace vog::pictures {

namespace {

/// Divides columns by the length of their rays within the slab.
void average(const PictureRequest& request, const Vec3d& normal, std::vector<float>& column) {
    const CameraFrame frame = frame_of(*request.camera, request.width, request.height);
    const double across = *request.thickness * length(normal);
    std::size_t n = 0;
    for (int row = 0; row < request.height; ++row)
        for (int at = 0; at < request.width; ++at, ++n) {
            const Vec3d direction = normalized(frame.direction(at, row));
            column[n] =
                static_cast<float>(double{column[n]} * (std::abs(dot(normal, direction)) / across));
        }
}

}  // namespace

FieldMaps SourceRenderer::slice(const ResolvedPicture& picture, const FieldChoice& choice,
                                const Progress& progress) {
    const PictureRequest& request = picture.request;
    if (!request.thickness) return section(picture, choice, progress);
    const Vec3d normal = request.plane->normal;
    const double offset = *request.plane->offset, half = 0.5 * *request.thickness * length(normal);
    ResolvedPicture slab = picture;
    slab.request.options.clip.planes.push_back({normal, offset - half});
    slab.request.options.clip.planes.push_back({-normal, -(offset + half)});
    slab.request.options.pixel_error = 0;  // the model itself, as on a plane
    FieldMaps maps;
    if (choice.field.empty()) {
        slab.request.show = Show::column;
        DepthImage image(request.width, request.height);
        depth(slab, image, progress);
        maps = {request.width, request.height, std::move(image.depth), {}, {}};
        maps.mean.resize(maps.column.size()), maps.deviation.resize(maps.column.size());
    } else {
        slab.request.show = Show::mean;
        maps = fields(slab, choice, progress);
    }
    average(request, normal, maps.column);
    return maps;
}

SliceOptions slice_options(const ResolvedPicture& picture, const Progress& progress) {
    const PictureRequest& request = picture.request;
    return {{request.plane->normal, *request.plane->offset},
            request.options.clip,
            request.options.samples,
            request.options.kappa,
            progress,
            shading::is_label_table(request.transfer.points)};
}

void set_slice(const ResolvedPicture& picture, Sums& sums) {
    if (!picture.field.field.empty()) {
        sums.slice = std::move(sums.mean);
        sums.mean.clear(), sums.deviation.clear();
        return;
    }
    sums.slice.resize(sums.column.size());
    for (std::size_t n = 0; n < sums.column.size(); ++n) {
        const float density = sums.column[n];
        sums.slice[n] = density > 0
                            ? static_cast<float>((density > kLeastDensity ? double{density} : 0) +
                                                 picture.background)
                            : std::numeric_limits<float>::quiet_NaN();
    }
    sums.mean.clear(), sums.deviation.clear();
}

}  // namespace vog::pictures
