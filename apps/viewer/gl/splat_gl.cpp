// splat_gl.cpp: vertex buffers and one draw call; the integral is in shaders/splat.vert and
// splat.frag.
#include "gl/splat_gl.h"

#include <algorithm>
#include <cmath>

#include "render/pixel_limits.h"
#include "vog/error.h"

namespace vog::viewer {

namespace {

struct Instance {
    float mean[3], density, scale[3], rotation[4];
};
constexpr std::size_t kInstanceFloats = sizeof(Instance) / sizeof(float);
constexpr std::size_t kMostPlanes = 16;  // chord.glsl

/// Planes of a clip, normal and offset along the camera's axes from the eye, in the model's unit.
std::vector<std::array<float, 4>> clip_planes(const GlModel& model, const CameraFrame& frame,
                                              const Clipping& clip) {
    std::vector<ClipPlane> planes = clip.planes;
    for (int axis = 0; clip.box && axis < 3; ++axis) {
        Vec3d along{};
        along[axis] = 1;
        planes.push_back({along, clip.box->lower[axis]});
        planes.push_back({-1.0 * along, -clip.box->upper[axis]});
    }
    if (planes.size() > kMostPlanes) throw Error("OpenGL: expected at most 10 planes beside a box");
    std::vector<std::array<float, 4>> out;
    for (const ClipPlane& plane : planes) {
        const Vec3d n = (1 / length(plane.normal)) * plane.normal;
        const double offset = plane.offset / length(plane.normal) - dot(n, frame.eye);
        const auto f = [](double v) { return static_cast<float>(v); };
        out.push_back({f(dot(n, frame.right)), f(dot(n, frame.up)), f(dot(n, frame.forward)),
                       f(offset / model.unit())});
    }
    return out;
}

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
    set_attributes();
    glBindVertexArray(0);
}

void GlModel::set_attributes() const {
    glBindBuffer(GL_ARRAY_BUFFER, buffer_);
    set_attribute(0, 4, kInstanceFloats, 0);
    set_attribute(1, 3, kInstanceFloats, 4);
    set_attribute(2, 4, kInstanceFloats, 7);
}

void set_attribute(GLuint place, GLint count, std::size_t floats, std::size_t offset) {
    glEnableVertexAttribArray(place);
    glVertexAttribPointer(place, count, GL_FLOAT, GL_FALSE,
                          static_cast<GLsizei>(floats * sizeof(float)),
                          reinterpret_cast<const void*>(offset * sizeof(float)));
    glVertexAttribDivisor(place, 1);
}

Jitter jitter_of(int subframe) {
    // 1/g and 1/g² with g the root of g³ = g + 1.
    constexpr double kX = 0.7548776662466927, kY = 0.5698402909980532;
    const auto centred = [](double v) { return v - std::floor(v + 0.5); };
    return {centred(subframe * kX), centred(subframe * kY)};
}

void set_view(const GlProgram& program, const GlModel& model, const CameraFrame& frame,
              Jitter jitter, const Clipping& clip) {
    program.use();
    // Along the camera's axes, in double precision: large distances cost no precision in the
    // pixels.
    const Vec3d eye = (1 / model.unit()) * (frame.eye - model.center());
    program.set("eye", Vec3d{dot(eye, frame.right), dot(eye, frame.up), dot(eye, frame.forward)});
    program.set("right", frame.right);
    program.set("up", frame.up);
    program.set("forward", frame.forward);
    program.set("size_px", static_cast<float>(frame.width), static_cast<float>(frame.height));
    program.set("jitter_px", static_cast<float>(jitter.x), static_cast<float>(jitter.y));
    const double lengths = frame.orthographic ? model.unit() : 1;  // of the shader's unit
    program.set("pixels_per_unit", static_cast<float>(lengths * frame.pixels_per_unit));
    program.set("parallel", frame.orthographic ? 1.0f : 0.0f);
    program.set("cutoff", model.cutoff());
    const bool alone = jitter.x == 0 && jitter.y == 0;
    const PixelLimits limits =
        alone ? pixel_limits(model.cutoff()) : subframe_limits(model.cutoff());
    const auto f = [](double v) { return static_cast<float>(v); };
    program.set("limits", f(limits.least2), f(limits.sampled2), f(limits.variance), f(limits.mass));
    const auto planes = clip_planes(model, frame, clip);
    program.set("clip_planes", static_cast<int>(planes.size()));
    if (!planes.empty()) program.set("clip_plane[0]", planes);
}

void draw_gaussians(GLuint vertex_array, std::size_t count, GLenum equation) {
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    glEnable(GL_BLEND);
    glBlendEquation(equation);
    glBlendFunc(GL_ONE, GL_ONE);
    glBindVertexArray(vertex_array);
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(count));
    glBindVertexArray(0);
    glDisable(GL_BLEND);
}

GlSplat::GlSplat() : program_("splat.vert", {"splat.frag"}) {}

void GlSplat::add(const GlModel& model, const Camera& camera, Jitter jitter,
                  const GlTarget& target) const {
    if (model.size() == 0) return;
    target.bind();
    set_view(program_, model, frame_of(camera, target.width(), target.height()), jitter);
    draw_gaussians(model.vertex_array(), model.size());
}

DepthImage render_gl(const Gaussians& gaussians, const Camera& camera, int width, int height,
                     int subframes) {
    const GlModel model(gaussians);
    const GlSplat splat;
    const GlTarget target(GL_R32F, width, height);
    target.clear();
    for (int n = 0; n < subframes; ++n) splat.add(model, camera, jitter_of(n), target);
    DepthImage image(width, height);
    image.depth = target.read_floats();
    for (float& t : image.depth) t /= static_cast<float>(subframes);
    return image;
}

}  // namespace vog::viewer
