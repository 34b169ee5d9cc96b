// slabs_gl.cpp: passes of the slabs; the page's src/web/page/picture/slabs.js has the same.
#include "gl/slabs_gl.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/by_value/lighting.h"
#include "render/by_value/slab_moments.h"
#include "render/by_value/volume_image.h"
#include "vog/error.h"
#include "vog/volume_picture.h"

namespace vog::viewer {

namespace {

constexpr int kLayers = 4, kLitLayers = 2, kMeanLayers = 8;  // slabs a pass: slab.frag
constexpr int kMostPixels = 1 << 20;  // in the images of slabs; larger pictures are drawn in strips
constexpr std::size_t kMostKept = std::size_t{3} << 28;     // bytes of sums
constexpr std::size_t kPixelBytes = 4 * 4 * sizeof(float);  // of a pass
constexpr int kPieceColumns = 1024;                         // expected.glsl
constexpr float kRounding = 4e-7f;                          // device::moments_of
constexpr int kReachedUnit = 15;                            // of textures

/// Whether sums have gradients.
bool is_lit(const GlVolume& volume) {
    return volume.picture.request.look.light ||
           (volume.transfer() && !volume.transfer()->gradient.empty());
}
int slabs_a_pass(const GlVolume& volume) { return is_lit(volume) ? kLitLayers : kLayers; }
int passes_of(const GlVolume& volume) {
    const int in_pass = slabs_a_pass(volume);
    return (volume.slabs() + in_pass - 1) / in_pass;
}

float as_float(double v) { return static_cast<float>(v); }

const std::vector<std::string> kSlabShaders{"erf.glsl", "chord.glsl", "slab.frag"};
const std::vector<std::string> kFinishShaders{"erf.glsl", "expected.glsl", "tiles.glsl",
                                              "finish.frag"};
constexpr int kTile = 16;  // pixels a side, of tiles.glsl

}  // namespace

bool KeptSlabs::has(const GlVolume& volume) const {
    return of_ && of_->first == volume.field->id() && same_moments(of_->second, volume.picture);
}

bool KeptSlabs::require(int targets, int width, int rows) {
    const auto count = static_cast<std::size_t>(targets);
    const bool fit = count * static_cast<std::size_t>(width * rows) <= kMostKept / kPixelBytes;
    if (fit && targets_.size() == count && targets_.front().width() == width &&
        targets_.front().height() == rows)
        return true;
    targets_.clear();
    of_.reset();
    try {
        while (fit && targets_.size() < count) targets_.emplace_back(GL_RGBA32F, width, rows, 4);
    } catch (const Error&) {
        targets_.clear();
    }
    return targets_.size() == count;
}

GlSlabs::GlSlabs()
    : range_programs_{{"splat.vert", {"ranges.frag"}, "RANGES"},
                      {"splat.vert", {"ranges.frag"}, "TILES"}},
      copy_program_("screen.vert", {"copy.frag"}),
      mean_program_("splat.vert", kSlabShaders, "MEANS"),
      largest_program_("screen.vert", {"tiles.glsl", "largest.frag"}),
      copy_means_program_("screen.vert", {"copy.frag"}, "MEANS"),
      slab_programs_{{"splat.vert", kSlabShaders, "SLABS"}, {"splat.vert", kSlabShaders, "LIT"}},
      finish_programs_{{"screen.vert", kFinishShaders}, {"screen.vert", kFinishShaders, "LIT"}},
      no_vertices_(make_vertex_array()),
      pieces_(make_texture()),
      table_(make_texture()),
      reached_texture_(make_texture(GL_TEXTURE_3D, GL_LINEAR)) {}

void GlSlabs::require_targets(const GlVolume& volume, int width, int height) {
    const auto require = [](std::optional<GlTarget>& target, GLenum format, int w, int h,
                            std::size_t images) {
        if (!target || target->width() != w || target->height() != h)
            target.emplace(format, w, h, images);
    };
    const int strips = std::min((width * height + kMostPixels - 1) / kMostPixels, height);
    const int rows = (height + strips - 1) / strips;
    require(layers_, GL_RGBA32F, width, rows, 4);  // images of four numbers
    require(strip_, GL_RGBA32F, width, rows, 1);
    if (volume.transfer())
        require(before_, GL_RGBA32F, width, rows, 4);
    else
        require(densest_, GL_R32F, width, rows, 1);
    require(ranges_[0], GL_RG32F, 1, 1, 1);
    require(ranges_[1], GL_RG32F, (width + kTile - 1) / kTile, (height + kTile - 1) / kTile, 1);
}

void GlSlabs::set_light(const GlVolume& volume) {
    if (volume.field->id() == lit_field_ && lit_transfer_ == *volume.transfer()) return;
    const ScalarField& values = *volume.values;
    by_value::ValueRange range = by_value::value_range(values);
    range.order.clear();  // planes of values are linear in the shaders
    const by_value::LightOfMoments& made = light_ =
        by_value::LightOfMoments(*volume.transfer(), range, values.is_measure);
    ++lights_;
    const auto upload = [](GLuint texture, int width, int height, const float* texels) {
        glBindTexture(GL_TEXTURE_2D, texture);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, width, height, 0, GL_RGBA, GL_FLOAT, texels);
    };
    upload(table_, device::MeanLight::kColumns, device::MeanLight::kRows, made.table().data());
    const std::size_t rows = (made.pieces().size() + kPieceColumns - 1) / kPieceColumns;
    std::vector<std::array<float, 4>> texels(3 * rows * kPieceColumns);
    for (std::size_t n = 0; n < made.pieces().size(); ++n) {
        const device::LightPiece& piece = made.pieces()[n];
        auto* at = &texels[3 * (n / kPieceColumns) * kPieceColumns + n % kPieceColumns];
        at[0] = {piece.start, piece.end, 0, 0};
        std::copy_n(piece.first, 4, at[kPieceColumns].data());
        std::copy_n(piece.last, 4, at[2 * kPieceColumns].data());
    }
    upload(pieces_, kPieceColumns, static_cast<int>(3 * rows), texels.front().data());
    lit_field_ = volume.field->id();
    lit_transfer_ = *volume.transfer();
}

void GlSlabs::set_reached(const GlVolume& volume, const CameraFrame& frame) {
    if (!reached_.update(lights_, {*volume.gaussians, *volume.values, light_},
                         lights_in_view(volume.picture.request.look, frame), frame.forward))
        return;
    const device::LightLattice lattice = (*reached_).lattice();
    if (!lattice.any()) return;
    const auto count = static_cast<std::size_t>(lattice.size[0]) *
                       static_cast<std::size_t>(lattice.size[1]) *
                       static_cast<std::size_t>(lattice.size[2]);
    const auto lights = std::max<std::size_t>((*reached_).direct().size() / count, 1);
    std::vector<std::array<float, 3>> texels(lights * count);
    for (std::size_t n = 0; n < texels.size(); ++n)
        texels[n] = {lattice.direct ? lattice.direct[n] : 1,
                     lattice.ambient ? lattice.ambient[n % count] : 1,
                     lattice.opaque ? lattice.opaque[n % count] : 0};
    glActiveTexture(GL_TEXTURE0 + kReachedUnit);
    glBindTexture(GL_TEXTURE_3D, reached_texture_);
    glTexImage3D(GL_TEXTURE_3D, 0, GL_RGB16F, lattice.size[0], lattice.size[1],
                 static_cast<int>(lights) * lattice.size[2], 0, GL_RGB, GL_FLOAT,
                 texels.front().data());
    for (const GLenum side : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
        glTexParameteri(GL_TEXTURE_3D, side, GL_CLAMP_TO_EDGE);
    glActiveTexture(GL_TEXTURE0);
}

void GlSlabs::draw_screen() const {
    glBindVertexArray(no_vertices_);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
}

void GlSlabs::draw_ranges(const GlVolume& volume, const CameraFrame& frame, Jitter jitter) {
    glDisable(GL_SCISSOR_TEST);
    for (int n = 0; n < 2; ++n) {
        ranges_[n]->bind();
        constexpr std::array<float, 4> kNothing{-60000, -60000, 0, 0};
        glClearBufferfv(GL_COLOR, 0, kNothing.data());
        set_view(range_programs_[n], *volume.model, frame, jitter);
        draw_gaussians(volume.model->vertex_array(), volume.model->size(), GL_MAX);
    }
}

void GlSlabs::gather(const GlProgram& program, const GlVolume& volume, int first, int slab,
                     const GlTarget& layers,
                     std::vector<std::pair<const char*, GLuint>> images) const {
    program.use();
    program.set("slabs", as_float(volume.slabs()));
    program.set("first_slab", as_float(slab));
    program.set("first_row", as_float(first));
    program.set("central", 0.0f);
    constexpr const char* kNames[] = {"layer_0", "layer_1", "layer_2", "layer_3"};
    for (std::size_t n = 0; n < 4; ++n) images.emplace_back(kNames[n], layers.texture(n));
    images.emplace_back("ranges", ranges_[0]->texture());
    images.emplace_back("tiles", ranges_[1]->texture());
    program.sample(images);
    glEnable(GL_BLEND);
    draw_screen();
    glDisable(GL_BLEND);
}

void GlSlabs::draw_layers(const GlVolume& volume, const GlProgram& program, int in_pass,
                          const CameraFrame& frame, Jitter jitter, int first, int slab,
                          const GlTarget& layers) const {
    layers.clear();
    if (slab >= volume.slabs()) return;
    glViewport(0, -first, frame.width, frame.height);
    set_view(program, *volume.model, frame, jitter, volume.picture.request.options.clip);
    program.sample({{"ranges", ranges_[0]->texture()}});
    program.set("slabs", as_float(volume.slabs()));
    program.set("first_slab", as_float(slab));
    program.set("layers", as_float(in_pass));
    program.set("central", 0.0f);
    program.set("first_row", as_float(first));
    draw_gaussians(volume.field->vertex_array(), volume.model->size());
}

void GlSlabs::draw_largest(const GlVolume& volume, const CameraFrame& frame, Jitter jitter,
                           int first) {
    const GlProgram& program = largest_program_;
    densest_->clear();
    strip_->clear();
    // The largest density of each pixel's slabs, then the largest of the means that count.
    for (const bool means : {false, true})
        for (int slab = 0; slab < volume.slabs(); slab += kMeanLayers) {
            draw_layers(volume, mean_program_, kMeanLayers, frame, jitter, first, slab, *layers_);
            (means ? strip_ : densest_)->bind();
            program.use();
            program.set("of_means", means ? 1 : 0);
            program.set("least_share", as_float(kLeastDensityShare));
            // By densities times the model's unit.
            const double most = by_value::most_share_per_density(*volume.values);
            program.set("most", std::isfinite(most) ? as_float(most / volume.model->unit()) : 0.0f);
            glBlendEquation(GL_MAX);
            gather(program, volume, first, slab, *layers_,
                   {{"densest", means ? densest_->texture() : layers_->texture(0)}});
        }
}

void GlSlabs::set_finish(const GlProgram& program, const GlVolume& volume, const CameraFrame& frame,
                         Jitter jitter) const {
    const auto f = as_float;
    program.use();
    const device::MeanLight light = light_.mean_light(0, volume.model->unit());
    program.set("piece_count", light.pieces.count);
    const device::GradientFactor& factor = light.gradient;
    program.set("gradient", f(factor.parts), factor.first, light.per_gradient, 0);
    std::array<std::array<float, 4>, device::GradientFactor::kMostParts> parts{};
    for (std::size_t n = 0; n < parts.size(); ++n)
        parts[n] = {factor.start[n], factor.width[n], factor.slope[n], 0};
    program.set("gradient_part", parts);
    program.set("exact", light_.resolved() ? 0 : 1);
    program.set("columns", light.low, light.high, light.per_range, light.per_part);
    program.set("unit", 1.0f);
    program.set("parts_per_cell", as_float(volume.slabs()) / device::kDepthCells);
    program.set("rounding", kRounding);
    program.set("size_px", f(frame.width), f(frame.height));
    program.set("jitter_px", f(jitter.x), f(jitter.y));
    const double lengths = frame.orthographic ? volume.model->unit() : 1;
    program.set("pixels_per_unit", f(lengths * frame.pixels_per_unit));
    program.set("parallel", frame.orthographic ? 1.0f : 0.0f);
    const device::BlinnPhong look =
        by_value::blinn_phong(lights_in_view(volume.picture.request.look, frame));
    program.set("lighting", f(look.ambient), f(look.diffuse), f(look.specular),
                look.on ? f(look.power) : 0);
    program.set("asymmetry", f(look.asymmetry));
    program.set("light_count", look.lights);
    std::array<std::array<float, 4>, device::kMostLights> lights{}, reaches{};
    for (std::size_t n = 0; n < lights.size(); ++n) {
        const auto& [towards, strength] = look.light[n];
        const Vec3d to{towards.x, towards.y, towards.z};
        lights[n] = {f(dot(to, frame.right)), f(dot(to, frame.up)), f(dot(to, frame.forward)),
                     f(strength)};
    }
    program.set("lights", lights);
    const device::LightLattice lattice = (*reached_).lattice();
    program.set("reached", kReachedUnit);
    program.set("reaches", lattice.any() ? 1.0f : 0.0f);
    if (!lattice.any()) return;
    const auto place = [&](Vec3d v) {
        for (int axis = 0; axis < 3; ++axis) v[axis] *= lattice.per_edge / lattice.size[axis];
        return v;
    };
    // Centres of texels lie half a cell from the faces.
    const double half = 0.5 / lattice.per_edge;
    program.set("reach_eye", place(frame.eye - Vec3d{lattice.first.x - half, lattice.first.y - half,
                                                     lattice.first.z - half}));
    const double unit = volume.model->unit();
    program.set("reach_edge", f(1 / (lattice.per_edge * unit)));
    program.set("inside", f(lattice.direct ? lattice.inside : 0),
                f(lattice.ambient ? lattice.inside : 0));
    const auto towards = [&](const device::Double3& direction) {
        const double cells = double{device::LightLattice::kTowardsLight} / lattice.per_edge;
        return place(cells * Vec3d{direction.x, direction.y, direction.z});
    };
    for (std::size_t n = 0; n < reaches.size(); ++n) {
        const Vec3f to = vec_cast<float>(towards(lattice.towards[n]));
        reaches[n] = {to.x, to.y, to.z, 0};
    }
    program.set("reach_light", reaches);
    program.set("reach_middle", towards(lattice.middle));
    program.set("reach_layers", f(std::max(lattice.direct ? look.lights : 1, 1)),
                f(0.5 / lattice.size[2]));
    program.set("reach_right", place(unit * frame.right));
    program.set("reach_up", place(unit * frame.up));
    program.set("reach_forward", place(unit * frame.forward));
}

void GlSlabs::draw_strip(const GlVolume& volume, const CameraFrame& frame, Jitter jitter, int first,
                         const GlTarget* kept, bool draws) {
    const int lit = is_lit(volume) ? 1 : 0, in_pass = slabs_a_pass(volume);
    const GlProgram& finish = finish_programs_[lit];
    strip_->clear();
    before_->clear();
    const GlTarget* before = &*before_;
    // The last slab is composited with what is behind it, nothing.
    for (int slab = 0, pass = 0; slab <= volume.slabs(); slab += in_pass, ++pass) {
        const bool any = slab < volume.slabs();
        const GlTarget& layers = kept && any ? kept[pass] : pass % 2 == 0 ? *layers_ : *before_;
        if (draws || !any)
            draw_layers(volume, slab_programs_[lit], in_pass, frame, jitter, first, slab, layers);
        // Under what is in front.
        strip_->bind();
        set_finish(finish, volume, frame, jitter);
        glBlendEquation(GL_FUNC_ADD);
        glBlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE);
        gather(finish, volume, first, (pass - 1) * in_pass, layers,
               {{"before_0", before->texture(0)},
                {"before_1", before->texture(1)},
                {"before_2", before->texture(2)},
                {"before_3", before->texture(3)},
                {"table", table_},
                {"pieces", pieces_}});
        before = &layers;
    }
}

void GlSlabs::add(const GlVolume& volume, const Camera& camera, Jitter jitter,
                  const GlTarget& target, KeptSlabs* kept) {
    if (volume.model->size() == 0) return;
    const CameraFrame frame = frame_of(camera, target.width(), target.height());
    require_targets(volume, frame.width, frame.height);
    if (volume.transfer()) {
        set_light(volume);
        set_reached(volume, frame);
    }
    const int rows = strip_->height(), strips = (frame.height + rows - 1) / rows;
    // Further sub-frames are drawn once the picture stands still: editing shows the first.
    if (!volume.transfer() || jitter.x != 0 || jitter.y != 0 ||
        (kept && !kept->require(strips * passes_of(volume), frame.width, rows)))
        kept = nullptr;
    const bool draws = !(kept && kept->has(volume));
    draw_ranges(volume, frame, jitter);
    if (kept && draws) {
        ++kept->drawn_;
        kept->of_.emplace(volume.field->id(), volume.picture);
    }
    const GlTarget* sums = kept ? kept->targets_.data() : nullptr;
    for (int first = 0; first < frame.height; first += rows) {
        if (volume.transfer()) {
            draw_strip(volume, frame, jitter, first, sums, draws);
            if (sums) sums += passes_of(volume);
        } else {
            draw_largest(volume, frame, jitter, first);
        }
        target.bind();
        glViewport(0, first, frame.width, std::min(rows, frame.height - first));
        const GlProgram& copy = volume.transfer() ? copy_program_ : copy_means_program_;
        copy.use();
        copy.sample({{"image", strip_->texture()}});
        copy.set("first_row", as_float(first));
        glEnable(GL_BLEND);
        glBlendEquation(GL_FUNC_ADD);
        glBlendFunc(GL_ONE, GL_ONE);
        draw_screen();
        glDisable(GL_BLEND);
    }
}

}  // namespace vog::viewer
