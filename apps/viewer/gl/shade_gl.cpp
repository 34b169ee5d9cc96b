// shade_gl.cpp: transfer function as a texture, and one triangle over the viewport.
#include "gl/shade_gl.h"

#include <cmath>

namespace vog::viewer {

namespace {

constexpr std::size_t kTransferSize = 4096;

/// Cursor over the points of a piecewise linear function; v must not decrease from call to call.
template <class Point>
class Walk {
  public:
    explicit Walk(const std::vector<Point>& points) : points_(points) {}
    /// The points around v and the position of v between them, as in vog::color_at.
    float to(float v, const Point*& from, const Point*& next) {
        while (n_ < points_.size() && v >= points_[n_].v) ++n_;
        from = &points_[n_ == 0 ? 0 : n_ - 1];
        next = &points_[n_ == points_.size() ? n_ - 1 : n_];
        return next->v > from->v ? (v - from->v) / (next->v - from->v) : 0;
    }

  private:
    const std::vector<Point>& points_;
    std::size_t n_ = 0;
};

}  // namespace

std::vector<Rgba> sampled(const TransferFunction& tf, std::size_t count) {
    const std::vector<OpacityPoint> opaque{{0, 1}};
    Walk colors(tf.color);
    Walk opacities(tf.opacity.empty() ? opaque : tf.opacity);
    std::vector<Rgba> values(count);
    for (std::size_t i = 0; i < count; ++i) {
        const float root = static_cast<float>(i) / static_cast<float>(count - 1);
        const float v = root * root;
        const ColorPoint *c0, *c1;
        const OpacityPoint *o0, *o1;
        const float c = colors.to(v, c0, c1), o = opacities.to(v, o0, o1);
        values[i] = {std::lerp(c0->r, c1->r, c), std::lerp(c0->g, c1->g, c),
                     std::lerp(c0->b, c1->b, c), std::lerp(o0->opacity, o1->opacity, o)};
    }
    return values;
}

GlShade::GlShade()
    : program_("screen.vert", {"shade.frag"}),
      no_vertices_(make_vertex_array()),
      transfer_(make_texture()),
      map_(make_texture()) {
    set_look({});
}

void GlShade::set_look(const Look& look) {
    look_ = look;
    const auto upload = [](const GlTexture& texture, const TransferFunction& tf) {
        const std::vector<Rgba> values = sampled(tf, kTransferSize);
        glBindTexture(GL_TEXTURE_2D, texture);
        glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA32F, static_cast<GLsizei>(values.size()), 1, 0,
                     GL_RGBA, GL_FLOAT, values.data());
    };
    const TransferFunction visible = transfer_function(look);
    upload(transfer_, look.shading.blend ? fading(visible) : visible);
    upload(map_, map_function(look));
}

void GlShade::draw(const GlDepth& a, const GlDepth& b, const ShadeView& view,
                   const Viewport& to) const {
    glViewport(to.x, to.y, to.width, to.height);
    glDisable(GL_BLEND);
    glDisable(GL_SCISSOR_TEST);
    program_.use();
    const auto image = [&](int unit, const GlDepth& depth, const char* sampler, const char* size,
                           const char* factor) {
        glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
        glBindTexture(GL_TEXTURE_2D, depth.target->texture());
        program_.set(sampler, unit);
        program_.set(size, static_cast<float>(depth.target->width()),
                     static_cast<float>(depth.target->height()));
        const double extinction = view.show == Show::depth ? look_.extinction : 1;
        program_.set(factor, static_cast<float>(extinction / depth.subframes));
    };
    image(0, a, "depth_a", "size_a", "factor_a");
    image(1, b, "depth_b", "size_b", "factor_b");
    glActiveTexture(GL_TEXTURE2);
    glBindTexture(GL_TEXTURE_2D, view.show == Show::depth ? transfer_ : map_);
    glActiveTexture(GL_TEXTURE0);
    program_.set("quantity", static_cast<int>(view.show));
    program_.set("scale_ends", static_cast<float>(view.scale.low),
                 static_cast<float>(view.scale.high));
    program_.set("log_scale", int{view.scale.kind == ColorScale::Kind::log});
    program_.set("field_unit", static_cast<float>(view.unit.reference),
                 static_cast<float>(view.unit.unit));
    program_.set("least_column", view.least_column);
    program_.set("transfer", 2);
    program_.set("transfer_size", static_cast<float>(kTransferSize));
    program_.set("background", look_.shading.background);
    program_.set("blend", int{look_.shading.blend});
    program_.set("checker", int{view.checker});
    program_.set("split", view.split);
    program_.set("difference", int{view.difference});
    program_.set("difference_limit", view.difference_limit);
    program_.set("viewport_px", static_cast<float>(to.width), static_cast<float>(to.height));
    program_.set("viewport_origin_px", static_cast<float>(to.x), static_cast<float>(to.y));
    glBindVertexArray(no_vertices_);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glBindVertexArray(0);
}

}  // namespace vog::viewer
