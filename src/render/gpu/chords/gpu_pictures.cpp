// gpu_pictures.cpp: GpuPictures: a model in GPU memory, and the arguments of pictures of chords.
#include "render/gpu/chords/gpu_pictures.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/parallel.h"
#include "render/by_value/lighting.h"
#include "render/by_value/slab_moments.h"
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

std::vector<device::SplatValue> values_in_range(const ScalarField& field, const TraceModel& model) {
    const ValueRange range = value_range(field);
    const double per_scene_unit = model.unit / (range.upper - range.lower);
    std::vector<device::SplatValue> all(field.value.size());
    vog::parallel_for(std::size_t{0}, all.size(), [&](std::size_t i) {
        const Vec3d g = per_scene_unit * vec_cast<double>(field.gradient[i]);
        const Residual residual = residual_of(field, range, i);
        all[i] = {{within_floats(range.share(double{field.value[i]})),
                   {within_floats(g.x), within_floats(g.y), within_floats(g.z)},
                   within_floats(residual.variance)},
                  within_floats(residual.third)};
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

void GpuPictures::State::draw(device::ChordPicture picture) {
    const bool all = renderer == Renderer::cuda;
    timer.start();
    // With boxes rays leave out no Gaussian, and sums need no projection.
    const bool by_slabs = picture.slabs.values;
    if (!model.boxed || by_slabs) {
        if (by_slabs) {
            range.reserve(2, "the range of depths");
            check_cuda(cudaMemset(range.data(), 0, 2 * sizeof(std::uint32_t)),
                       "clearing the range of depths");
            picture.slabs.range = range.data();
        }
        ChordProjection projection{};
        projection.picture = picture;
        projection.kernel = model.kernel;
        projection.all = all ? 1 : 0;
        projection.boxed = model.boxed ? 1 : 0;
        projection.shares = shares.data();
        projection.depths = depths.data();
        projection.range = by_slabs ? range.data() : nullptr;
        passes.list(projection);
        picture = projection.picture;
        picture.shares = shares.data();
        picture.depths = depths.data();
    }
    if (all) {
        const std::int64_t rows =
            (picture.camera.height + device::kSplatTile - 1) / device::kSplatTile;
        const std::int64_t tiles = picture.tile_columns * rows;
        by_slabs ? launch_slabs(picture, tiles) : launch_chord_sums(picture, tiles);
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

ShownField GpuPictures::State::load_field(const FieldChoice& choice, const CameraFrame& frame) {
    // The component along the view differs from view to view.
    if (shown && choice == shown->first && choice.part != FieldPart::view) return shown->second;
    shown.reset();  // in case of an error
    const ShownField made = shown_field(gaussians, choice, frame, std::sqrt(double{model.cutoff2}));
    const TraceField field = trace_field(made, gaussians.size(), model.unit);
    scalar = GpuArray(field.scalar, "planes of the field");
    vector = GpuArray(field.vector, "planes of the field");
    return shown.emplace(choice, made).second;
}

void GpuPictures::State::draw_fields(const CameraFrame& frame, const Clipping& clip) {
    const std::size_t pixels =
        static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
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
    const ShownField shown = s.load_field(choice, frame);
    FieldMaps maps = empty_maps(width, height);
    validate(clip);
    if (s.count == 0) return maps;
    const std::size_t pixels = maps.column.size();
    s.draw_fields(frame, clip);
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

void GpuPictures::State::load_values(const ScalarField& field) {
    if (values_field == field.name) return;
    values_field.reset();  // in case of an error
    splat_values = GpuArray(values_in_range(field, model), "values of Gaussians");
    values_field = field.name;
}

void GpuPictures::State::load_light(const ScalarField& field, const ValueTransfer& transfer) {
    if (light_of && light_of->first == field.name && light_of->second == transfer) return;
    light_of.reset();  // in case of an error
    made_light = LightOfMoments(transfer, value_range(field), field.is_measure, model.depth_unit);
    ++lights_made;
    light = made_light.mean_light(0, model.unit);
    pieces = GpuArray(made_light.pieces(), "the transfer function");
    table = GpuArray(made_light.table(), "means of the transfer function");
    light.pieces.piece = pieces.data();
    if (light.table) light.table = table.data();
    light_of.emplace(field.name, transfer);
}

device::LightLattice GpuPictures::State::load_reached(const ScalarField& field,
                                                      const VolumeLook& look, Vec3d forward) {
    if (reached.update(lights_made, {gaussians, field, made_light, model.depth_unit}, look,
                       forward)) {
        direct = GpuArray((*reached).direct(), "shadows");
        ambient = GpuArray((*reached).ambient(), "ambient occlusion");
        opaque = GpuArray((*reached).opaque(), "opaque cells");
    }
    device::LightLattice lattice = (*reached).lattice(model.origin, model.unit);
    lattice.direct = direct.data(), lattice.ambient = ambient.data();
    lattice.opaque = opaque.data();
    return lattice;
}

void GpuPictures::State::draw_slabs(const ScalarField& field, const ValueTransfer* by,
                                    const CameraFrame& frame, int slabs, const VolumeLook& look) {
    load_values(field);
    if (by) load_light(field, *by);
    const std::size_t pixels =
        static_cast<std::size_t>(frame.width) * static_cast<std::size_t>(frame.height);
    result.reserve(4 * pixels, "the picture");
    device::ChordPicture picture = begin(frame, look.clip);
    picture.slabs.count = slabs;
    picture.slabs.values = splat_values.data();
    picture.slabs.channels = !by                                   ? device::kMaximumChannels
                             : look.light || !by->gradient.empty() ? device::kLitChannels
                                                                   : device::kUnlitChannels;
    if (by) {
        picture.slabs.light = light;
        picture.slabs.lattice = load_reached(field, look, frame.forward);
    }
    picture.slabs.light.parts_per_cell = static_cast<float>(slabs) / device::kDepthCells;
    picture.slabs.look = blinn_phong(look);
    picture.slabs.most_share =
        static_cast<float>(most_share_per_density(field) * model.depth_unit / model.unit);
    picture.slabs.least_share = static_cast<float>(kLeastDensityShare);
    picture.slabs.colors = result.data();
    draw(picture);
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
                                const VolumeLook& look, std::vector<Rgba> memory) {
    State& s = *state_;
    const ScalarField& values = s.slab_field(field, slabs);
    validate(look);
    validate(transfer);
    const CameraFrame frame = s.frame_for(camera, width, height);
    VolumeImage image{width, height, std::move(memory)};
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (s.count == 0) {
        image.pixel.assign(pixels, Rgba{0, 0, 0, 0});
        return image;
    }
    image.pixel.resize(pixels);
    s.draw_slabs(values, &transfer, frame, slabs, look);
    static_assert(sizeof(Rgba) == 4 * sizeof(float) && offsetof(Rgba, a) == 3 * sizeof(float));
    s.fetch(&image.pixel.data()->r, 4 * pixels);
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
    s.draw_slabs(values, nullptr, frame, slabs, look);
    const std::vector<float> shares = s.fetch(4 * pixels);
    vog::parallel_for(std::size_t{0}, pixels, [&](std::size_t n) {
        if (shares[4 * n] >= 0) map.value[n] = value_of_share(values, double{shares[4 * n]});
    });
    return map;
}

}  // namespace vog
