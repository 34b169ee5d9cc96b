// splat_gl.cpp: vertex buffers and one draw call; the integral is in shaders/splat.vert and
// splat.frag.
#include "gl/splat_gl.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "render/pixel_limits.h"

namespace vog::viewer {

namespace {

struct Instance {
    float mean[3], density, scale[3], rotation[4];
};

}  // namespace

GlModel::GlModel(const Gaussians& gaussians)
    : size_(gaussians.size()),
      cutoff_(gaussians.cutoff),
      array_(make_vertex_array()),
      buffer_(make_buffer()) {
    Box means;
    for (const Vec3f& mean : gaussians.mean) means.include(vec_cast<double>(mean));
    if (!means.empty()) {
        center_ = gaussians.origin + means.center();
        unit_ = means.radius();
        for (const Vec3f& scale : gaussians.scale)
            unit_ = std::max({unit_, double{scale.x}, double{scale.y}, double{scale.z}});
    }
    const Vec3d center = center_ - gaussians.origin;
    std::vector<Instance> instances(size_);
    for (std::size_t i = 0; i < size_; ++i) {
        const Vec3d mean = (1 / unit_) * (vec_cast<double>(gaussians.mean[i]) - center);
        const Vec3d scale = (1 / unit_) * vec_cast<double>(gaussians.scale[i]);
        const Quat q = gaussians.axis_aligned() ? Quat{} : gaussians.rotation[i];
        const double norm = 1 / std::hypot(std::hypot(q.w, q.x), std::hypot(q.y, q.z));
        const auto f = [](double v) { return static_cast<float>(v); };
        instances[i] = {{f(mean.x), f(mean.y), f(mean.z)},
                        f(gaussians.density[i] * unit_),
                        {f(scale.x), f(scale.y), f(scale.z)},
                        {f(q.w * norm), f(q.x * norm), f(q.y * norm), f(q.z * norm)}};
    }

    glBindVertexArray(array_);
    glBindBuffer(GL_ARRAY_BUFFER, buffer_);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(size_ * sizeof(Instance)),
                 instances.data(), GL_STATIC_DRAW);
    const auto attribute = [](GLuint place, GLint count, std::size_t offset) {
        glEnableVertexAttribArray(place);
        glVertexAttribPointer(place, count, GL_FLOAT, GL_FALSE, sizeof(Instance),
                              reinterpret_cast<const void*>(offset));
        glVertexAttribDivisor(place, 1);
    };
    attribute(0, 4, offsetof(Instance, mean));
    attribute(1, 3, offsetof(Instance, scale));
    attribute(2, 4, offsetof(Instance, rotation));
    glBindVertexArray(0);
}

Jitter jitter_of(int subframe) {
    // 1/g and 1/g² with g the root of g³ = g + 1.
    constexpr double kX = 0.7548776662466927, kY = 0.5698402909980532;
    const auto centred = [](double v) { return v - std::floor(v + 0.5); };
    return {centred(subframe * kX), centred(subframe * kY)};
}

GlSplat::GlSplat() : program_("splat.vert", "splat.frag") {}

void GlSplat::add(const GlModel& model, const Camera& camera, Jitter jitter,
                  const GlTarget& target) const {
    if (model.size() == 0) return;
    const CameraFrame frame = frame_of(camera, target.width(), target.height());
    target.bind();
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    glEnable(GL_BLEND);
    glBlendEquation(GL_FUNC_ADD);
    glBlendFunc(GL_ONE, GL_ONE);

    program_.use();
    // Along the camera's axes, in double precision: large distances cost no precision in the
    // pixels.
    const Vec3d eye = (1 / model.unit()) * (frame.eye - model.center());
    program_.set("eye", Vec3d{dot(eye, frame.right), dot(eye, frame.up), dot(eye, frame.forward)});
    program_.set("right", frame.right);
    program_.set("up", frame.up);
    program_.set("forward", frame.forward);
    program_.set("size_px", static_cast<float>(frame.width), static_cast<float>(frame.height));
    program_.set("jitter_px", static_cast<float>(jitter.x), static_cast<float>(jitter.y));
    const double lengths = frame.orthographic ? model.unit() : 1;  // of the shader's unit
    program_.set("pixels_per_unit", static_cast<float>(lengths * frame.pixels_per_unit));
    program_.set("parallel", frame.orthographic ? 1.0f : 0.0f);
    program_.set("cutoff", model.cutoff());
    const bool alone = jitter.x == 0 && jitter.y == 0;
    const PixelLimits limits =
        alone ? pixel_limits(model.cutoff()) : subframe_limits(model.cutoff());
    const auto f = [](double v) { return static_cast<float>(v); };
    program_.set("limits", f(limits.least2), f(limits.sampled2), f(limits.variance),
                 f(limits.mass));
    glBindVertexArray(model.vertex_array());
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(model.size()));
    glBindVertexArray(0);
    glDisable(GL_BLEND);
}

DepthImage render_gl(const Gaussians& gaussians, const Camera& camera, int width, int height,
                     int subframes) {
    const GlModel model(gaussians);
    const GlSplat splat;
    const GlTarget target(GL_R32F, width, height);
    target.bind();
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT);
    for (int n = 0; n < subframes; ++n) splat.add(model, camera, jitter_of(n), target);
    DepthImage image(width, height);
    image.depth = target.read_floats();
    for (float& t : image.depth) t /= static_cast<float>(subframes);
    return image;
}

}  // namespace vog::viewer
