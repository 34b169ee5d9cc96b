// gpu_pictures.cpp: GpuPictures: a model in GPU memory, and the arguments of pictures of chords.
#include "render/gpu/chords/gpu_pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/parallel.h"
#include "render/by_value/value_light.h"
#include "render/by_value/volume_field.h"
#include "render/gpu/chords/gpu_pictures_state.h"
#include "render/gpu/half_spaces.h"
#include "render/shown_field.h"
#include "render/trace/trace_field.h"
#include "render/trace/trace_model.h"
#include "vog/error.h"

namespace vog {

using namespace by_value;
using namespace gpu;
using namespace trace;

namespace {

constexpr int kMostGpuSlabs = 1024;

float within_floats(double number) {
    constexpr double kMost = std::numeric_limits<float>::max();
    return static_cast<float>(std::clamp(number, -kMost, kMost));
}

std::vector<device::SplatLight> splat_light(const ScalarField& field,
                                            const std::vector<LightQuadratic>& quadratics,
                                            const TraceModel& model) {
    std::vector<device::SplatLight> all(quadratics.size());
    vog::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
        const LightQuadratic& from = quadratics[i];
        device::SplatLight& to = all[i];
        for (std::size_t c = 0; c < 4; ++c)
            for (std::size_t power = 0; power < 3; ++power)
                to.c[c][power] = within_floats(model.depth_unit * double{from.c[c][power]});
        const double spread = double{from.spread}, per_z = spread > 0 ? model.unit / spread : 0;
        to.gradient = device::to_float(plain(per_z * vec_cast<double>(field.gradient[i])));
        to.explained = static_cast<float>(
            explained_share(from, double{field.deviation[i]}, model.kernel.variance));
    });
    return all;
}

}  // namespace

GpuPictures::GpuPictures(Renderer renderer, const Gaussians& gaussians,
                         const TraceSceneOptions& options) {
    if (renderer != Renderer::cuda && renderer != Renderer::optix)
        throw Error(fmt::format("{}: no renderer on a GPU, expected cuda or optix",
                                info_of(renderer).name));
    if (renderer == Renderer::cuda && options.aabb_sigma != 0)
        throw Error("cuda: bounding boxes (aabb_sigma), expected optix");
    TraceModel model = trace_model(gaussians, options.aabb_sigma, options.kappa);
    if (gaussians.size() >= std::numeric_limits<std::int32_t>::max())
        throw Error(fmt::format("{}: {} Gaussians, expected fewer than 2^31",
                                info_of(renderer).name, gaussians.size()));
    require_cuda();
    state_ = std::make_unique<State>(renderer, gaussians, std::move(model));
    State& s = *state_;
    const std::size_t size = gaussians.size();
    s.count = static_cast<std::int32_t>(size);
    if (renderer == Renderer::optix && size > 0)
        s.tracer = std::make_unique<ChordTracer>(s.model.boxes);
    s.packed = GpuArray(s.model.gaussians, "Gaussians");
    s.passes = SplatPasses(s.count);
    s.shares = GpuArray<float>(size, "shares of Gaussians");
    s.depths = GpuArray<device::SplatDepth>(size, "depths of Gaussians");
    s.model.gaussians = {};
    s.model.boxes = {};
}

GpuPictures::~GpuPictures() = default;
GpuPictures::GpuPictures(GpuPictures&&) noexcept = default;
GpuPictures& GpuPictures::operator=(GpuPictures&&) noexcept = default;

double GpuPictures::gpu_ms() const { return state_->timer.ms(); }

device::ChordPicture GpuPictures::State::begin(const CameraFrame& frame, const Clipping& clip) {
    validate(clip);
    const auto cut = half_spaces(relative_to(clip, model.origin), model.unit);
    planes.reserve(cut.size(), "planes of the clip");
    if (!cut.empty()) planes.copy_from(cut, "planes of the clip");
    device::ChordPicture picture{};
    // Depths relative to that of a Gaussian in the middle of the model keep their digits.
    const Vec3d middle = vec_cast<double>(gaussians.mean[gaussians.size() / 2]);
    picture.view = {plain(frame.forward), dot(middle - frame.eye, frame.forward) / model.unit,
                    planes.data(), static_cast<std::int32_t>(cut.size())};
    picture.bounds = model.bounds;
    picture.camera = scene_camera(frame, model.unit);
    picture.kernel = model.kernel.kernel;
    picture.within = static_cast<float>(model.kernel.variance);
    picture.depth_unit = model.depth_unit;
    picture.gaussians = packed.data();
    return picture;
}

void GpuPictures::State::draw(device::ChordPicture picture, const device::BlinnPhong& look) {
    const bool all = renderer == Renderer::cuda;
    timer.start();
    // With boxes rays leave out no Gaussian, and sums need no projection.
    if (!model.boxed || picture.slabs.light) {
        device::SlabPicture& slabs = picture.slabs;
        if (slabs.light) {
            const std::size_t words = 2 * static_cast<std::size_t>(slabs.tiles + 1);
            ranges.reserve(words, "depths of tiles");
            check_cuda(cudaMemset(ranges.data(), 0, words * sizeof(std::uint32_t)),
                       "clearing depths of tiles");
            slabs.ranges = ranges.data();
            if (look.on) lit.reserve(static_cast<std::size_t>(count), "shaded light");
        }
        ChordProjection projection{};
        projection.picture = picture;
        projection.kernel = model.kernel;
        projection.all = all ? 1 : 0;
        projection.boxed = model.boxed ? 1 : 0;
        projection.look = look;
        projection.light = slabs.light;
        projection.lit = slabs.light && look.on ? lit.data() : nullptr;
        projection.shares = shares.data();
        projection.depths = depths.data();
        projection.ranges = slabs.light ? ranges.data() : nullptr;
        passes.list(projection);
        picture = projection.picture;
        picture.shares = shares.data();
        picture.depths = depths.data();
        if (projection.lit) picture.slabs.light = projection.lit;
    }
    if (all) {
        const std::int64_t rows =
            (picture.camera.height + device::kSplatTile - 1) / device::kSplatTile;
        const std::int64_t tiles = picture.tile_columns * rows;
        picture.slabs.light ? launch_slabs(picture, tiles) : launch_chord_sums(picture, tiles);
    } else {
        device::Launch launch{};
        launch.camera = picture.camera;
        launch.bounds = model.bounds;
        launch.gaussians = packed.data();
        launch.shares = picture.shares;
        launch.center = model.center;
        launch.scene = model.scene;
        launch.rounding = model.rounding;
        launch.cutoff2 = model.cutoff2;
        launch.boxed = model.boxed ? 1 : 0;
        launch.chords = picture;
        tracer->run(launch);
    }
    timer.stop();
}

void GpuPictures::State::draw_depth(const CameraFrame& frame, const Clipping& clip) {
    result.reserve(static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height),
                   "the picture");
    device::ChordPicture picture = begin(frame, clip);
    picture.column = result.data();
    draw(picture);
}

DepthImage GpuPictures::depth(const Camera& camera, int width, int height, const Clipping& clip) {
    State& s = *state_;
    const CameraFrame frame = s.frame_for(camera, width, height);
    DepthImage image(width, height);
    validate(clip);
    if (s.count == 0) return image;
    s.draw_depth(frame, clip);
    image.depth = s.fetch(image.depth.size());
    return image;
}

void GpuPictures::State::draw_fields(const ShownField& shown, const CameraFrame& frame,
                                     const Clipping& clip) {
    const std::size_t pixels =
        static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
    const TraceField field = trace_field(shown, gaussians.size(), model.unit);
    scalar = GpuArray(field.scalar, "planes of the field");
    vector = GpuArray(field.vector, "planes of the field");
    result.reserve(3 * pixels, "the picture");
    device::ChordPicture picture = begin(frame, clip);
    picture.scalar = scalar.data();
    picture.vector = vector.data();
    picture.column = result.data();
    picture.mean = picture.column + pixels;
    picture.deviation = picture.mean + pixels;
    draw(picture);
}

FieldMaps GpuPictures::fields(const FieldChoice& choice, const Camera& camera, int width,
                              int height, const Clipping& clip) {
    if (choice.part == FieldPart::magnitude) {
        double ms = 0;
        FieldMaps maps = magnitude_maps({}, [&](FieldPart part, const Progress&) {
            FieldMaps one = fields({choice.field, part}, camera, width, height, clip);
            ms += gpu_ms();
            return one;
        });
        state_->timer.set_ms(ms);
        return maps;
    }
    State& s = *state_;
    const CameraFrame frame = s.frame_for(camera, width, height);
    const ShownField shown = s.shown(choice, frame);
    FieldMaps maps = empty_maps(width, height);
    validate(clip);
    if (s.count == 0) return maps;
    const std::size_t pixels = maps.column.size();
    s.draw_fields(shown, frame, clip);
    const std::vector<float> sums = s.fetch(3 * pixels);
    vog::parallel_for(0, height, [&](int row) {
        for (int column = 0; column < width; ++column) {
            const auto n = static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                           static_cast<std::size_t>(column);
            maps.column[n] = sums[n];
            if (!(sums[n] > 0)) continue;
            const double reference =
                shown.reference_along(normalized(frame.direction(column, row)));
            maps.mean[n] = static_cast<float>(reference + shown.unit * double{sums[pixels + n]});
            maps.deviation[n] = static_cast<float>(shown.unit * double{sums[2 * pixels + n]});
        }
    });
    return maps;
}

void GpuPictures::State::load_light(const ScalarField& field,
                                    const std::optional<ValueTransfer>& by) {
    if (light_field == field.name && transfer == by) return;
    light_field.reset();  // in case of an error
    const std::vector<LightQuadratic> quadratics =
        by ? fit_light(gaussians, field, *by) : value_planes(gaussians, field);
    light = GpuArray(splat_light(field, quadratics, model), "light of Gaussians");
    light_field = field.name;
    transfer = by;
}

void GpuPictures::State::draw_slabs(const ScalarField& field, device::SlabKind kind,
                                    const std::optional<ValueTransfer>& by,
                                    const CameraFrame& frame, int slabs, const VolumeLook& look) {
    load_light(field, by);
    const std::size_t pixels =
        static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
    result.reserve(4 * pixels, "the picture");
    device::ChordPicture picture = begin(frame, look.clip);
    const std::int32_t columns =
        (frame.width + device::kSlabTileWidth - 1) / device::kSlabTileWidth;
    const std::int32_t rows =
        (frame.height + device::kSlabTileHeight - 1) / device::kSlabTileHeight;
    picture.slabs.kind = kind;
    picture.slabs.count = slabs;
    picture.slabs.light = light.data();
    picture.slabs.tile_columns = columns;
    picture.slabs.tiles = columns * rows;
    picture.slabs.most_share = static_cast<float>(most_share_per_density(field) / model.unit);
    picture.slabs.least_share = static_cast<float>(kLeastDensityShare);
    picture.slabs.colors = result.data();
    draw(picture, blinn_phong(look));
}

const ScalarField& GpuPictures::State::slab_field(const std::string& field, int slabs) const {
    const char* name = info_of(renderer).name;
    if (slabs < 1 || slabs > kMostGpuSlabs)
        throw Error(
            fmt::format("{}: {} depth slabs, expected 1 to {}", name, slabs, kMostGpuSlabs));
    return volume_field(gaussians, field);
}

VolumeImage GpuPictures::volume(const std::string& field, const ValueTransfer& transfer,
                                const Camera& camera, int width, int height, int slabs,
                                const VolumeLook& look) {
    State& s = *state_;
    const ScalarField& values = s.slab_field(field, slabs);
    validate(look);
    validate(transfer);
    const CameraFrame frame = s.frame_for(camera, width, height);
    VolumeImage image{width, height, {}};
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    image.pixel.assign(pixels, Rgba{0, 0, 0, 0});
    if (s.count == 0) return image;
    s.draw_slabs(values, device::SlabKind::light, transfer, frame, slabs, look);
    const std::vector<float> colors = s.fetch(4 * pixels);
    for (std::size_t n = 0; n < pixels; ++n)
        image.pixel[n] = {colors[4 * n], colors[4 * n + 1], colors[4 * n + 2], colors[4 * n + 3]};
    return image;
}

ValueMap GpuPictures::maximum(const std::string& field, const Camera& camera, int width, int height,
                              int slabs, const Clipping& clip) {
    State& s = *state_;
    const ScalarField& values = s.slab_field(field, slabs);
    VolumeLook look;
    look.clip = clip;
    validate(clip);
    const CameraFrame frame = s.frame_for(camera, width, height);
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    ValueMap map{width, height,
                 std::vector<float>(pixels, std::numeric_limits<float>::quiet_NaN())};
    if (s.count == 0) return map;
    s.draw_slabs(values, device::SlabKind::maximum, std::nullopt, frame, slabs, look);
    const std::vector<float> shares = s.fetch(4 * pixels);
    for (std::size_t n = 0; n < pixels; ++n)
        if (shares[4 * n] >= 0) map.value[n] = value_of_share(values, double{shares[4 * n]});
    return map;
}

}  // namespace vog
