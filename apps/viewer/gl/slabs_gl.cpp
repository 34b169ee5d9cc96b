// slabs_gl.cpp: passes of the slabs; the page's src/web/page/picture/slabs.js has the same.
#include "gl/slabs_gl.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/by_value/value_light.h"
#include "render/by_value/volume_image.h"
#include "vog/volume_picture.h"

namespace vog::viewer {

namespace {

constexpr int kTileWidth = 64, kTileHeight = 32;  // pixels
constexpr int kLightWidth = 1024;                 // Gaussians a row: light.vert
constexpr int kLayers = 4, kMeanLayers = 8;       // slabs a pass: slab.frag
constexpr int kMostPixels = 1 << 20;  // in the images of slabs; larger pictures are drawn in strips

int drawn_slabs(const GlVolume& volume) {
    return volume.transfer() ? (volume.slabs() + kLayers - 1) / kLayers * kLayers : volume.slabs();
}
int tiles(int pixels, int tile) { return (pixels + tile - 1) / tile; }

}  // namespace

GlSlabs::GlSlabs()
    : light_program_("light.vert", {"light.frag"}),
      range_program_("splat.vert", {"ranges.frag"}, "RANGES"),
      slab_program_("splat.vert", {"chord.glsl", "slab.frag"}, "SLABS"),
      layer_program_("screen.vert", {"layers.frag"}),
      copy_program_("screen.vert", {"copy.frag"}),
      mean_program_("splat.vert", {"chord.glsl", "slab.frag"}, "MEANS"),
      largest_program_("screen.vert", {"largest.frag"}),
      copy_means_program_("screen.vert", {"copy.frag"}, "MEANS"),
      no_vertices_(make_vertex_array()),
      table_(make_texture()) {}

void GlSlabs::require_targets(int width, int height, std::size_t gaussians, bool means) {
    const auto require = [](std::optional<GlTarget>& target, GLenum format, int w, int h,
                            std::size_t images) {
        if (!target || target->width() != w || target->height() != h)
            target.emplace(format, w, h, images);
    };
    const int rows = std::clamp(kMostPixels / width, 1, height);
    require(layers_, GL_RGBA32F, width, rows, kLayers);  // images of four numbers
    require(strip_, GL_RGBA32F, width, rows, 1);
    if (means) require(densest_, GL_R32F, width, rows, 1);
    require(ranges_, GL_RG32F, tiles(width, kTileWidth), tiles(height, kTileHeight), 1);
    const int light_rows = tiles(static_cast<int>(gaussians), kLightWidth);
    if (!light_ || light_->height() != light_rows) lit_field_ = 0;
    require(light_, GL_RGBA32F, kLightWidth, light_rows, 3);
}

void GlSlabs::fit(const GlVolume& volume) {
    const ValueTransfer* transfer = volume.transfer();
    if (volume.field->id() == lit_field_ &&
        (transfer ? lit_transfer_ == *transfer : !lit_transfer_))
        return;
    light_->bind();
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
    light_program_.use();
    light_program_.set("planes", volume.transfer() ? 0 : 1);
    light_program_.set("image_px", static_cast<float>(light_->width()),
                       static_cast<float>(light_->height()));
    if (volume.transfer()) fit_light(volume);
    glBindVertexArray(volume.field->points());
    glDrawArrays(GL_POINTS, 0, static_cast<GLsizei>(volume.model->size()));
    glBindVertexArray(0);
    lit_field_ = volume.field->id();
    lit_transfer_ = transfer ? std::optional(*transfer) : std::nullopt;
}

void GlSlabs::fit_light(const GlVolume& volume) {
    const ScalarField& values = *volume.values;
    const by_value::ExpectedLight expected(*volume.transfer(), values.lower, values.upper,
                                           values.is_measure);
    const by_value::LightTable table = expected.table();
    glBindTexture(GL_TEXTURE_2D, table_);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, table.columns, table.rows, 0, GL_RGBA, GL_FLOAT,
                 table.light.data());
    light_program_.sample({{"table", table_}});
    // Values are -1 to 1 over the range of the data.
    const double middle = 0.5 * (table.lower + table.upper),
                 half = 0.5 * (table.upper - table.lower);
    const double low = (table.low - middle) / half, high = (table.high - middle) / half;
    const auto f = [](double v) { return static_cast<float>(v); };
    light_program_.set("part", f(low), f(high), 0.25f, f(0.5 / (high - low)));
}

void GlSlabs::draw_screen() const {
    glBindVertexArray(no_vertices_);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
}

void GlSlabs::draw_ranges(const GlVolume& volume, const CameraFrame& frame, Jitter jitter) {
    ranges_->bind();
    glDisable(GL_SCISSOR_TEST);
    constexpr std::array<float, 4> kNothing{-60000, -60000, 0, 0};
    glClearBufferfv(GL_COLOR, 0, kNothing.data());
    set_view(range_program_, *volume.model, frame, jitter);
    range_program_.sample({{"light_0", light_->texture(0)},
                           {"light_1", light_->texture(1)},
                           {"light_2", light_->texture(2)}});
    range_program_.set("tile_px", float{kTileWidth}, float{kTileHeight});
    draw_gaussians(volume.model->vertex_array(), volume.model->size(), GL_MAX);
}

void GlSlabs::draw_layers(const GlVolume& volume, const CameraFrame& frame, Jitter jitter,
                          int first, int slab) {
    const GlProgram& program = volume.transfer() ? slab_program_ : mean_program_;
    const VolumeLook& look = volume.picture.request.look;
    const auto f = [](double v) { return static_cast<float>(v); };
    layers_->clear();
    glViewport(0, -first, frame.width, frame.height);
    set_view(program, *volume.model, frame, jitter, volume.picture.request.options.clip);
    program.sample({{"ranges", ranges_->texture()},
                    {"light_0", light_->texture(0)},
                    {"light_1", light_->texture(1)},
                    {"light_2", light_->texture(2)}});
    program.set("tile_px", float{kTileWidth}, float{kTileHeight});
    program.set("slabs", f(drawn_slabs(volume)));
    program.set("first_slab", static_cast<float>(slab));
    program.set("layers", f(volume.transfer() ? kLayers : kMeanLayers));
    program.set("first_row", static_cast<float>(first));
    program.set("per_extinction", 1.0f);
    if (look.light && volume.transfer())
        program.set("lighting", f(look.ambient), f(look.diffuse), f(look.specular), f(look.power));
    else
        program.set("lighting", 0, 0, 0, 0);
    const double steep = length(look.towards_light);
    const Vec3d light = steep > 0 ? (1 / steep) * look.towards_light : Vec3d{};
    program.set("towards_light",
                Vec3d{dot(light, frame.right), dot(light, frame.up), dot(light, frame.forward)});
    draw_gaussians(volume.field->vertex_array(), volume.model->size());
}

void GlSlabs::draw_largest(const GlVolume& volume, const CameraFrame& frame, Jitter jitter,
                           int first) {
    constexpr std::array<float, 4> kNoMean{0, -60000, 0, 0};
    const auto f = [](double v) { return static_cast<float>(v); };
    const GlProgram& program = largest_program_;
    densest_->clear();
    strip_->bind();
    glClearBufferfv(GL_COLOR, 0, kNoMean.data());
    // The largest density of each pixel's slabs, then the largest of the means that count.
    for (const bool means : {false, true})
        for (int slab = 0; slab < volume.slabs(); slab += kMeanLayers) {
            draw_layers(volume, frame, jitter, first, slab);
            (means ? strip_ : densest_)->bind();
            program.use();
            program.sample({{"layer_0", layers_->texture(0)},
                            {"layer_1", layers_->texture(1)},
                            {"layer_2", layers_->texture(2)},
                            {"layer_3", layers_->texture(3)},
                            {"densest", means ? densest_->texture() : layers_->texture(0)},
                            {"ranges", ranges_->texture()}});
            program.set("of_means", means ? 1 : 0);
            program.set("least_share", f(kLeastDensityShare));
            // Of a range of -1 to 1, by densities times the model's unit.
            const double most = by_value::most_share_per_density(*volume.values);
            program.set("most", std::isfinite(most) ? f(2 * most / volume.model->unit()) : 0.0f);
            program.set("tile_px", float{kTileWidth}, float{kTileHeight});
            program.set("slabs", f(volume.slabs()));
            program.set("first_row", static_cast<float>(first));
            glEnable(GL_BLEND);
            glBlendEquation(GL_MAX);
            draw_screen();
            glDisable(GL_BLEND);
        }
}

void GlSlabs::draw_strip(const GlVolume& volume, const CameraFrame& frame, Jitter jitter,
                         int first) {
    const auto f = [](double v) { return static_cast<float>(v); };
    strip_->clear();
    for (int slab = 0; slab < drawn_slabs(volume); slab += kLayers) {
        draw_layers(volume, frame, jitter, first, slab);
        // Under what is in front.
        strip_->bind();
        layer_program_.use();
        layer_program_.sample({{"layer_0", layers_->texture(0)},
                               {"layer_1", layers_->texture(1)},
                               {"layer_2", layers_->texture(2)},
                               {"layer_3", layers_->texture(3)}});
        layer_program_.set("size_px", f(frame.width), f(frame.height));
        layer_program_.set("jitter_px", f(jitter.x), f(jitter.y));
        layer_program_.set("first_row", static_cast<float>(first));
        const double lengths = frame.orthographic ? volume.model->unit() : 1;
        layer_program_.set("pixels_per_unit", f(lengths * frame.pixels_per_unit));
        layer_program_.set("parallel", frame.orthographic ? 1.0f : 0.0f);
        glEnable(GL_BLEND);
        glBlendEquation(GL_FUNC_ADD);
        glBlendFunc(GL_ONE_MINUS_DST_ALPHA, GL_ONE);
        draw_screen();
        glDisable(GL_BLEND);
    }
}

void GlSlabs::add(const GlVolume& volume, const Camera& camera, Jitter jitter,
                  const GlTarget& target) {
    if (volume.model->size() == 0) return;
    const CameraFrame frame = frame_of(camera, target.width(), target.height());
    require_targets(frame.width, frame.height, volume.model->size(), !volume.transfer());
    fit(volume);
    draw_ranges(volume, frame, jitter);
    for (int first = 0; first < frame.height; first += strip_->height()) {
        if (volume.transfer())
            draw_strip(volume, frame, jitter, first);
        else
            draw_largest(volume, frame, jitter, first);
        target.bind();
        glViewport(0, first, frame.width, std::min(strip_->height(), frame.height - first));
        const GlProgram& copy = volume.transfer() ? copy_program_ : copy_means_program_;
        copy.use();
        copy.sample({{"image", strip_->texture()}});
        copy.set("first_row", static_cast<float>(first));
        glEnable(GL_BLEND);
        glBlendEquation(GL_FUNC_ADD);
        glBlendFunc(GL_ONE, GL_ONE);
        draw_screen();
        glDisable(GL_BLEND);
    }
}

}  // namespace vog::viewer
