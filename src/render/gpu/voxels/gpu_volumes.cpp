// gpu_volumes.cpp: GpuVolumes: volumes as NanoVDB grids, and pictures from the sums of their rays.
#include "render/gpu/voxels/gpu_volumes.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

#include "core/parallel.h"
#include "render/by_value/lighting.h"
#include "render/by_value/value_pieces.h"
#include "render/gpu/optix/optix_film.h"
#include "render/gpu/voxels/voxel_scene.h"
#include "render/reference/fields/field_grid.h"
#include "render/reference/fields/visible_parts.h"
#include "render/reference/nano_tree.h"
#include "render/shown_field.h"
#include "vog/distributed.h"
#include "vog/error.h"

namespace vog {

using namespace gpu;
using reference::nano_tree;
using reference::NanoTree;

namespace {

/// The volume with the values of a component of its field.
Volume with_values(const Volume& volume, const VoxelValues& values) {
    Volume changed = volume;
    vog::parallel_for(std::size_t{0}, changed.leaves.size(),
                      [&](std::size_t n) { changed.leaves[n].value = values.leaf[n]; });
    for (std::size_t n = 0; n < changed.tiles.size(); ++n) changed.tiles[n].value = values.tile[n];
    return changed;
}

std::span<const std::byte> bytes_of(const NanoTree& tree) {
    return {tree.buffer.data(), tree.buffer.size()};
}

Clipping both(const Clipping& a, const Clipping& b) {
    Clipping all = a;
    all.planes.insert(all.planes.end(), b.planes.begin(), b.planes.end());
    for (int axis = 0; b.box && axis < 3; ++axis) {
        Vec3d normal;
        normal[axis] = 1;
        all.planes.push_back({normal, b.box->lower[axis]});
        all.planes.push_back({-normal, -b.box->upper[axis]});
    }
    return all;
}

}  // namespace

struct GpuVolumes::State {
    VoxelScene scene;
    std::size_t count = 0;  ///< volumes, also empty ones
    bool fields = false;    ///< whether there are any
    bool is_vector = false;

    void load(std::span<const Volume> volumes, std::span<const VoxelField> of);
    /// Sums of a picture, its options checked.
    std::vector<double> draw(const ShownVoxels& shown, const Camera& camera, int width, int height,
                             const ReferenceOptions& options, const Clipping& clip = {});
    /// throws  vog::Error for volumes without fields, and for a part that they have not
    void require(FieldPart part) const;
};

void GpuVolumes::State::load(std::span<const Volume> volumes, std::span<const VoxelField> of) {
    count = volumes.size();
    fields = !of.empty();
    is_vector = fields && of.front().is_vector();
    if (fields)
        reference::check_fields(volumes, of, is_vector ? FieldPart::x : FieldPart::value, "optix");
    for (std::size_t n = 0; n < count; ++n) {
        validate(volumes[n]);
        const NanoTree density = nano_tree(volumes[n], false);
        std::vector<NanoTree> components;
        if (fields && !reference::is_own(of[n]))
            for (const VoxelValues& values : of[n].component)
                components.push_back(nano_tree(with_values(volumes[n], values), false));
        VoxelGridBytes bytes{bytes_of(density), {}, fields ? of[n].background : 0};
        for (const NanoTree& tree : components) bytes.component.push_back(bytes_of(tree));
        scene.add(bytes);
    }
}

GpuVolumes::GpuVolumes(std::span<const Volume> volumes, std::span<const VoxelField> fields)
    : state_(std::make_unique<State>()) {
    state_->load(volumes, fields);
}

GpuVolumes::GpuVolumes(const Levels& levels, std::span<const VoxelField> fields)
    : state_(std::make_unique<State>()) {
    if (fields.empty()) {
        state_->load(composite(levels).parts, {});
        return;
    }
    reference::check_fields(levels.volumes, fields,
                            fields.front().is_vector() ? FieldPart::x : FieldPart::value, "optix");
    std::vector<VoxelField> valued(fields.begin(), fields.end());
    for (std::size_t n = 0; n < valued.size(); ++n)
        if (reference::is_own(valued[n])) valued[n] = own_field(levels.volumes[n], valued[n].name);
    const reference::VisibleParts parts = reference::weighted_parts(levels, valued);
    state_->load(parts.volumes, parts.fields);
}

GpuVolumes::~GpuVolumes() = default;
GpuVolumes::GpuVolumes(GpuVolumes&&) noexcept = default;
GpuVolumes& GpuVolumes::operator=(GpuVolumes&&) noexcept = default;

double GpuVolumes::gpu_ms() const { return state_->scene.gpu_ms(); }

void GpuVolumes::State::require(FieldPart part) const {
    if (!fields) throw Error("optix: volumes without a field, expected one for each");
    if (is_vector != (part != FieldPart::value))
        throw Error(fmt::format("optix: a field of {} components, expected {}", is_vector ? 3 : 1,
                                is_vector ? 1 : 3));
}

std::vector<double> GpuVolumes::State::draw(const ShownVoxels& shown, const Camera& camera,
                                            int width, int height, const ReferenceOptions& options,
                                            const Clipping& clip) {
    check_samples(options.samples);
    validate(options.clip);
    if (options.collective && options.collective->count > 1)
        throw Error("optix: voxels of several processes, expected reference");
    return scene.draw(shown, frame_of(camera, width, height), options.samples,
                      both(options.clip, clip));
}

DepthImage GpuVolumes::depth(const Camera& camera, int width, int height,
                             const ReferenceOptions& options) {
    const std::vector<double> sums = state_->draw({}, camera, width, height, options);
    DepthImage image(width, height);
    for (std::size_t n = 0; n < image.depth.size(); ++n)
        image.depth[n] = static_cast<float>(sums[4 * n] / (options.samples * options.samples));
    return image;
}

FieldMaps GpuVolumes::fields(FieldPart part, const Camera& camera, int width, int height,
                             const ReferenceOptions& options) {
    state_->require(part);
    if (part == FieldPart::magnitude)
        return magnitude_maps({}, [&](FieldPart component, const Progress&) {
            return fields(component, camera, width, height, options);
        });
    ShownVoxels shown;
    shown.field = true;
    shown.component = part == FieldPart::y ? 1 : part == FieldPart::z ? 2 : 0;
    shown.along_rays = part == FieldPart::view;
    const std::vector<double> sums = state_->draw(shown, camera, width, height, options);
    FieldMaps maps = empty_maps(width, height);
    for (std::size_t n = 0; n < maps.column.size(); ++n) {
        const double* of = &sums[4 * n];
        set_pixel(maps, n, {of[0], of[1], of[2]}, of[0] / (options.samples * options.samples),
                  of[3], 1);
    }
    return maps;
}

VolumeImage GpuVolumes::volume(const ValueTransfer& transfer, const Camera& camera, int width,
                               int height, const ReferenceOptions& options,
                               const VolumeLook& look) {
    validate(look);
    const by_value::ValuePieces pieces(transfer);
    state_->require(FieldPart::value);
    if (const std::size_t count = state_->scene.size(); count > device::kMostLitVolumes)
        throw Error(fmt::format("optix: {} volumes by value, expected at most {}", count,
                                device::kMostLitVolumes));
    ShownVoxels shown;
    shown.kind = device::VoxelKind::light;
    shown.field = true;
    shown.transfer = pieces.table();
    shown.pieces = pieces.pieces().size();
    shown.look = by_value::blinn_phong(look);
    const std::vector<double> sums = state_->draw(shown, camera, width, height, options, look.clip);
    VolumeImage image{width, height, std::vector<Rgba>(sums.size() / 4)};
    const double share = 1.0 / (options.samples * options.samples);
    for (std::size_t n = 0; n < image.pixel.size(); ++n) {
        const auto mean = [&](std::size_t channel) {
            return static_cast<float>(share * sums[4 * n + channel]);
        };
        image.pixel[n] = {mean(0), mean(1), mean(2), mean(3)};
    }
    return image;
}

ValueMap GpuVolumes::maximum(const Camera& camera, int width, int height,
                             const ReferenceOptions& options) {
    state_->require(FieldPart::value);
    ShownVoxels shown;
    shown.kind = device::VoxelKind::maximum;
    shown.field = true;
    const std::vector<double> sums = state_->draw(shown, camera, width, height, options);
    ValueMap map{width, height, std::vector<float>(sums.size() / 4)};
    for (std::size_t n = 0; n < map.value.size(); ++n)
        map.value[n] = sums[4 * n + 1] > 0 ? static_cast<float>(sums[4 * n] / sums[4 * n + 1])
                                           : std::numeric_limits<float>::quiet_NaN();
    return map;
}

}  // namespace vog
