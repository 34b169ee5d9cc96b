// volume_splat.cpp: Volume rendering of a model by splatting to depth slabs: no sorting, sums alone.
#include <fmt/core.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <optional>

#include "render/by_value/lighting.h"
#include "render/by_value/slab_moments.h"
#include "render/by_value/volume_field.h"
#include "render/light/illumination.h"
#include "render/pixel_limits.h"
#include "render/splat/volume/slab_exchange.h"
#include "render/splat/volume/slab_picture.h"
#include "render/splat/volume/volume_splat.h"
#include "vog/error.h"
#include "vog/volume_picture.h"

namespace vog {

using namespace by_value;
using namespace splat;

namespace {

/// Blinn and Phong's lights along right, down and forward of a picture.
device::BlinnPhong along_view(const VolumeLook& look, const CameraFrame& frame) {
    device::BlinnPhong out = blinn_phong(look);
    for (auto& [towards, strength] : out.light) {
        const Vec3d to{towards.x, towards.y, towards.z};
        towards = {dot(to, frame.right), -dot(to, frame.up), dot(to, frame.forward)};
    }
    return out;
}

/// View of a picture.
struct View {
    Camera camera;
    int width, height;

    friend bool operator==(const View&, const View&) = default;
    /// Whether it has more pixels under the same camera.
    bool is_finer(const View& other) const { return camera == other.camera && width > other.width; }
};

/// A picture of one resolution in progress, and buffers that are kept from picture to picture.
struct SlabLevel {
    CameraFrame frame;
    std::deque<SlabBatch> batches;
    std::optional<SlabView> view;
    std::optional<SlabPicture> drawn;
    std::optional<SlabLight> finish;
    VolumeImage image;  ///< of half the resolution, and less
};

/// Model and buffers, kept from picture to picture.
struct SlabModel {
    const Gaussians* gaussians;
    const ScalarField* field;
    SplatModel model;
    KernelPolynomial kernel;
    const SplatKernels* kernels;
    int slabs;
    SlabPolynomials polynomials;
    VolumeLook look;
    ValueRange range;
    const Collective* processes;  ///< that hold parts of the model; null: this one alone
    double precision;
    tbb::enumerable_thread_specific<SlabBuffers> buffers;
    int drawn_pictures = 0;
    int edits = 0;      ///< counts changes of transfer function and light
    int transfers = 0;  ///< counts those of the transfer function
    /// The latest views, and the edit that each was last drawn after: of a picture and two finer ones with more rays a pixel.
    std::deque<std::pair<View, int>> views;
    KeptSums kept;
    std::optional<View> kept_view;  ///< that `kept` holds whole
    int kept_level = 0;             ///< whose sums these are
    lights::KeptIllumination reached;
    const lights::Illumination* joint = nullptr;  ///< of all layers of a picture, in its place
    // Of the picture in progress.
    Clipping clip;
    std::array<SlabLevel, 1 + kMostHalves> levels;  ///< by halves of the resolution
    SlabLevel& whole = levels.front();

    SlabModel(const Gaussians& of, const ScalarField& of_model, const SlabOptions& options,
              int channels);
    SlabModel(const SlabModel&) = delete;
    SlabModel& operator=(const SlabModel&) = delete;

    /// Places the model in a picture.
    /// light    null: draws the maximum
    /// returns  whether there are any Gaussians
    bool begin(const LightOfMoments* light, const Camera& camera, int width, int height);
    /// Places it in a picture of half the resolution of the level before.
    void begin_half(std::size_t level);
    /// Projects and bins them.
    SplatExtent project(std::size_t level);
    /// Draws a level of a picture, from that at half its resolution where there is one.
    /// coarsest  level without one
    /// sums      of the coarsest level: receives them, or draws from them where they are kept; null: neither
    void draw_level(std::size_t level, std::size_t coarsest, KeptSums* sums, VolumeImage& picture);
    void draw(const LightOfMoments* light, const Camera& camera, int width, int height,
              VolumeImage& picture);
    /// Light that reaches the slabs of a picture.
    void set_reached(const LightOfMoments& of, SlabLight& light);
    /// Sums to draw a picture from, or to keep them in, once edits follow one another under one view.
    KeptSums* sums_for(const View& view);
    double length() const { return std::max(view_box(*gaussians).radius(), 1e-300); }
};

SlabModel::SlabModel(const Gaussians& of, const ScalarField& of_model, const SlabOptions& options,
                     int channels)
    : gaussians(&of),
      field(&of_model),
      look(options.look),
      range(value_range(of_model, options.collective)),
      processes(options.collective && options.collective->count > 1 ? options.collective : nullptr),
      precision(options.precision) {
    if (options.slabs < 1 || options.slabs > kMostSlabs)
        throw Error(
            fmt::format("splat: {} depth slabs, expected 1 to {}", options.slabs, kMostSlabs));
    slabs = options.slabs;
    vog::validate(of);
    vog::validate(options.look);
    const double cutoff = cutoff_of_kappa(options.kappa, of.cutoff);
    model = {&of, unit_of(of), static_cast<float>(cutoff), pixel_limits(cutoff), &kernel};
    kernel = fit_kernel(double{model.cutoff});
    polynomials = fit_slab_polynomials(double{model.cutoff});
    kernels =
        options.simd_target.empty() ? &best_splat_kernels() : &splat_kernels(options.simd_target);
    buffers = tbb::enumerable_thread_specific<SlabBuffers>([count = options.slabs, channels] {
        SlabBuffers made;
        made.cell.resize(count, channels);
        return made;
    });
}

KeptSums* SlabModel::sums_for(const View& view) {
    const auto before = std::ranges::find(views, view, &std::pair<View, int>::first);
    const bool edited = before != views.end() && before->second != edits;
    if (before != views.end()) views.erase(before);
    views.emplace_front(view, edits);
    if (views.size() > 3) views.pop_back();
    if (!edited || (kept_view && view.is_finer(*kept_view))) return nullptr;
    if (kept_view != view) {
        kept_view.reset();
        return &kept;
    }
    return kept.complete() ? &kept : nullptr;
}

void SlabModel::set_reached(const LightOfMoments& of, SlabLight& light) {
    const CameraFrame& frame = whole.frame;
    if (!joint)
        reached.update(transfers, {*gaussians, *field, of, model.unit, processes}, look,
                       frame.forward);
    light.lattice = (joint ? *joint : *reached).lattice(gaussians->origin);
    const auto cells = [&](Vec3d v) {
        const Vec3f c = vec_cast<float>(light.lattice.per_edge * v);
        return device::Float3{c.x, c.y, c.z};
    };
    const device::Double3& first = light.lattice.first;
    light.middle =
        cells(frame.eye + whole.view->depth * frame.forward - Vec3d{first.x, first.y, first.z});
    light.right = cells(frame.right), light.down = cells(-frame.up);
    light.forward = cells(frame.forward);
    light.depth = static_cast<float>(whole.view->depth);
}

bool SlabModel::begin(const LightOfMoments* light, const Camera& camera, int width, int height) {
    const CameraFrame& frame = whole.frame =
        relative_to(frame_of(camera, width, height), gaussians->origin);
    if (width > kMaxSide || height > kMaxSide)
        throw Error(fmt::format("image size {}x{}: expected at most {} pixels a side", width,
                                height, kMaxSide));
    std::size_t size = gaussians->size();  // of all parts
    const double depth =
        processes  ? middle_depth(*gaussians, frame, *processes, size)
        : size > 0 ? dot(vec_cast<double>(gaussians->mean[size / 2]) - frame.eye, frame.forward)
                   : 0;
    if (size == 0) return false;
    clip = relative_to(look.clip, gaussians->origin);
    double radius[1] = {length()};
    if (processes) processes->max(radius);
    whole.view.emplace(SlabView{*gaussians, *field, range, frame, clip, double{model.cutoff},
                                model.limits.variance, radius[0], depth});
    const std::size_t most = TileBins::most_splats(width, height);
    whole.batches.resize(std::max<std::size_t>((gaussians->size() + most - 1) / most, 1));
    whole.drawn.emplace(SlabPicture{*whole.view, *kernels, polynomials, whole.batches});
    whole.drawn->unit = model.unit;
    whole.finish.reset();
    if (!light) return true;
    whole.drawn->light = &whole.finish.emplace(
        SlabLight{frame, light->mean_light(slabs, whole.view->length), along_view(look, frame)});
    // What lies behind so little light is less than the error of a pixel.
    whole.finish->dark = std::max(kDarkTransmittance, static_cast<float>(precision / 8));
    set_reached(*light, *whole.finish);
    return true;
}

void SlabModel::begin_half(std::size_t level) {
    SlabLevel &half = levels[level], &before = levels[level - 1];
    half.frame = half_frame(before.frame);
    half.batches.resize(before.batches.size());
    const SlabView& view = *before.view;
    half.view.emplace(SlabView{view.gaussians, view.field, view.range, half.frame, view.clip,
                               view.cutoff, view.share, view.length, view.depth});
    half.drawn.emplace(SlabPicture{*half.view, *kernels, polynomials, half.batches});
    half.drawn->depths = before.drawn->depths;
    half.drawn->unit = model.unit;
    half.drawn->most_share = before.drawn->most_share;
    half.finish.reset();
    if (!before.finish) return;
    const SlabLight& light = *before.finish;
    half.drawn->light = &half.finish.emplace(
        SlabLight{half.frame, light.light, light.look, light.lattice, light.middle, light.right,
                  light.down, light.forward, light.depth, light.dark});
}

SplatExtent SlabModel::project(std::size_t level) {
    SlabLevel& of = levels[level];
    const std::size_t own = gaussians->size();
    const std::size_t most = TileBins::most_splats(whole.frame.width, whole.frame.height);
    SplatModel shown = model;
    shown.limits.least2 = std::ldexp(model.limits.least2, -2 * static_cast<int>(level));
    shown.limits.sampled2 = std::ldexp(model.limits.sampled2, -2 * static_cast<int>(level));
    SplatExtent extent;
    for (std::size_t n = 0; n < of.batches.size(); ++n)
        extent.include(
            of.drawn->project(shown, of.batches[n], n * most, std::min((n + 1) * most, own)));
    return extent;
}

void SlabModel::draw_level(std::size_t level, std::size_t coarsest, KeptSums* sums,
                           VolumeImage& picture) {
    SlabLevel& of = levels[level];
    picture.width = of.frame.width, picture.height = of.frame.height;
    picture.pixel.resize(static_cast<std::size_t>(picture.width) *
                         static_cast<std::size_t>(picture.height));
    std::optional<CellRows> rows;
    if (level < coarsest) {
        SlabLevel& half = levels[level + 1];
        begin_half(level + 1);
        draw_level(level + 1, coarsest, sums, half.image);
        // Errors of a coarser level spread over more pixels.
        const double allowed = std::ldexp(precision, -static_cast<int>(level));
        of.drawn->rows = &rows.emplace(fill_from_half(half.image, allowed, picture));
    } else if (of.drawn->kept = sums; sums && kept_view) {
        return of.drawn->draw_kept(buffers, picture.pixel.data());
    }
    if (level > 0) (void)project(level);
    const TileBins& bins = of.batches.front().splats.bins;
    if (of.drawn->kept) kept.begin(bins.tiles(), of.drawn->depths);
    struct Nothing {};
    draw_tiles<Nothing>(bins, [&](int t, Nothing) {
        of.drawn->draw_tile(t, buffers.local(), picture.pixel.data());
    });
}

void SlabModel::draw(const LightOfMoments* light, const Camera& camera, int width, int height,
                     VolumeImage& picture) {
    picture.width = width, picture.height = height;
    picture.pixel.resize(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    if (!begin(light, camera, width, height)) {
        std::ranges::fill(picture.pixel, Rgba{0, 0, 0, 0});
        return;
    }
    KeptSums* const sums = light && !processes ? sums_for({camera, width, height}) : nullptr;
    if (sums && kept_view && kept_level == 0) {
        whole.drawn->depths = kept.depths();
        return draw_level(0, 0, sums, picture);
    }
    ++drawn_pictures;
    SplatExtent extent = project(0);
    if (processes) extent.depths = joint_depths(extent.depths, *processes);
    if (!extent.depths.empty()) whole.drawn->depths = slab_depths(extent.depths, slabs);
    whole.drawn->most_share = static_cast<float>(most_share_per_density(*field) * model.unit /
                                                 double{whole.drawn->depths.thickness});
    if (processes) {
        const SlabPart part{&*whole.drawn, &buffers};
        const auto finish = [&](int, int) {
            whole.drawn->finish_cell(buffers.local().cell, picture.pixel.data());
        };
        return draw_parts({&part, 1}, *processes, finish, false, picture.pixel.data());
    }
    const int halves = precision > 0 ? extent.halves() : 0;
    draw_level(0, static_cast<std::size_t>(halves), sums, picture);
    if (!sums) return;
    if (!kept.complete()) kept.begin(0, {});
    kept_view = {camera, width, height};
    kept_level = halves;
}

}  // namespace

/// A model and a transfer function.
struct SlabRenderer::State {
    SlabModel slabs;
    std::optional<ValueTransfer> transfer{};
    LightOfMoments light{};
};

SlabRenderer::SlabRenderer(const Gaussians& gaussians, const std::string& field,
                           const ValueTransfer& transfer, const SlabOptions& options)
    : state_(new State{SlabModel(
          gaussians, volume_field(gaussians, field), options,
          options.look.light || !transfer.gradient.empty() ? kLitChannels : kUnlitChannels)}) {
    set_transfer(transfer);
}
SlabRenderer::~SlabRenderer() = default;
SlabRenderer::SlabRenderer(SlabRenderer&&) noexcept = default;
SlabRenderer& SlabRenderer::operator=(SlabRenderer&&) noexcept = default;

void SlabRenderer::set_transfer(const ValueTransfer& transfer) {
    State& s = *state_;
    if (s.transfer == transfer) return;
    if (s.transfer && transfer.gradient.empty() != s.transfer->gradient.empty())
        throw Error("splat: gradient opacity where there was none takes another renderer");
    s.light =
        LightOfMoments(transfer, s.slabs.range, s.slabs.field->is_measure, s.slabs.model.unit);
    s.transfer = transfer;
    ++s.slabs.edits, ++s.slabs.transfers;
}

void SlabRenderer::set_light(const VolumeLook& look) {
    vog::validate(look);
    VolumeLook& own = state_->slabs.look;
    if (look.light != own.light || !(look.clip == own.clip))
        throw Error("splat: another clip, or light where there was none, takes another renderer");
    if (own == look) return;
    own = look;
    ++state_->slabs.edits;
}

void SlabRenderer::render(const Camera& camera, int width, int height, VolumeImage& picture) {
    state_->slabs.draw(&state_->light, camera, width, height, picture);
}
bool SlabRenderer::begin(const Camera& camera, int width, int height,
                         const lights::Illumination& reached, splat::DepthRange& depths) {
    SlabModel& slabs = state_->slabs;
    slabs.joint = &reached;
    if (!slabs.begin(&state_->light, camera, width, height)) return false;
    ++slabs.drawn_pictures;
    DepthRange own = slabs.project(0).depths;
    if (slabs.processes) own = joint_depths(own, *slabs.processes);
    if (own.empty()) return false;
    const auto from_eye = static_cast<float>(slabs.whole.view->depth);
    depths.include({own.near + from_eye, own.far + from_eye});
    return true;
}
void SlabRenderer::set_depths(const splat::SlabDepths& depths) {
    SlabModel& slabs = state_->slabs;
    slabs.whole.drawn->depths = {static_cast<float>(double{depths.first} - slabs.whole.view->depth),
                                 depths.thickness};
}
bool SlabRenderer::begin_tile(int t) {
    SlabModel& slabs = state_->slabs;
    SlabBuffers& own = slabs.buffers.local();
    const bool any = slabs.whole.drawn->find(t, own);
    if (any) slabs.whole.drawn->divide(t, own);
    return any;
}
splat::LayerCell SlabRenderer::sum_cell(int t, int n) {
    SlabModel& slabs = state_->slabs;
    SlabBuffers& own = slabs.buffers.local();
    if (!slabs.whole.drawn->begin_cell(t, n, own)) return {};
    slabs.whole.drawn->sum_cell(own);
    return {&own.cell, slabs.whole.drawn->light};
}
void SlabRenderer::add_extinction(lights::ExtinctionLattice& lattice) const {
    const SlabModel& slabs = state_->slabs;
    lights::add_extinction(*slabs.gaussians, *slabs.field, state_->light, slabs.model.unit,
                           slabs.processes, lattice);
}
splat::SlabPart SlabRenderer::part() {
    return {&*state_->slabs.whole.drawn, &state_->slabs.buffers};
}
splat::LayerCell SlabRenderer::received() {
    SlabModel& slabs = state_->slabs;
    return {&slabs.buffers.local().cell, slabs.whole.drawn->light};
}
const splat::SlabKernels& SlabRenderer::kernels() const {
    return slab_kernels(*state_->slabs.kernels);
}

int SlabRenderer::drawn() const { return state_->slabs.drawn_pictures; }

VolumeImage SlabRenderer::render(const Camera& camera, int width, int height) {
    VolumeImage picture;
    render(camera, width, height, picture);
    return picture;
}

VolumeImage render_volume_splat(const Gaussians& gaussians, const std::string& field,
                                const ValueTransfer& transfer, const Camera& camera, int width,
                                int height, const SlabOptions& options) {
    return SlabRenderer(gaussians, field, transfer, options).render(camera, width, height);
}

ValueMap render_maximum_splat(const Gaussians& gaussians, const std::string& field,
                              const Camera& camera, int width, int height,
                              const SlabOptions& options) {
    SlabModel slabs(gaussians, volume_field(gaussians, field), options, kMaximumChannels);
    VolumeImage shares;
    slabs.draw(nullptr, camera, width, height, shares);
    ValueMap map{width, height, std::vector<float>(shares.pixel.size())};
    std::ranges::transform(shares.pixel, map.value.begin(), [&](const Rgba& pixel) {
        return pixel.a > 0 ? static_cast<float>(slabs.range.value(double{pixel.r}))
                           : std::numeric_limits<float>::quiet_NaN();
    });
    return map;
}

}  // namespace vog
