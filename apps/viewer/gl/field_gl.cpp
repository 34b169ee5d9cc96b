// field_gl.cpp: vertex buffers of fields, and their sums by shaders/field.frag.
#include "gl/field_gl.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vog::viewer {

namespace {

constexpr std::size_t kScalarFloats = 6, kVectorFloats = 18;

/// Plane of one component: its value at the mean, and its change over a standard deviation along each own axis.
class Planes {
  public:
    Planes(const Gaussians& gaussians, FieldUnit unit) : gaussians_(gaussians), unit_(unit) {}
    void put(std::size_t i, double value, Vec3f gradient, float* out) const {
        const Vec3d g = vec_cast<double>(gradient), s = vec_cast<double>(gaussians_.scale[i]);
        const Vec3d own =
            gaussians_.axis_aligned() ? g : transpose(matrix_from_quat(gaussians_.rotation[i])) * g;
        out[0] = static_cast<float>((value - unit_.reference) / unit_.unit);
        for (int axis = 0; axis < 3; ++axis)
            out[1 + axis] = static_cast<float>(own[axis] * s[axis] / unit_.unit);
    }

  private:
    const Gaussians& gaussians_;
    FieldUnit unit_;
};

std::vector<float> scalar_numbers(const Gaussians& gaussians, const FieldChoice& choice,
                                  FieldUnit unit) {
    std::vector<float> out(gaussians.size() * kScalarFloats);
    const Planes planes(gaussians, unit);
    const auto rest = [&](double number) { return static_cast<float>(number / unit.unit); };
    if (const ScalarField* field = gaussians.fields.find_scalar(choice.field)) {
        for (std::size_t i = 0; i < gaussians.size(); ++i) {
            float* at = out.data() + i * kScalarFloats;
            planes.put(i, double{field->value[i]}, field->gradient[i], at);
            at[4] = rest(double{field->deviation[i]});
            at[5] = field->skewness[i];
        }
        return out;
    }
    const VectorField& field = *gaussians.fields.find_vector(choice.field);
    const int axis = static_cast<int>(choice.part) - static_cast<int>(FieldPart::x);
    const std::size_t diagonal = axis == 0 ? 0 : axis == 1 ? 3 : 5;  // of xx xy xz yy yz zz
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
        float* at = out.data() + i * kScalarFloats;
        planes.put(i, double{field.value[i][axis]},
                   field.gradient[static_cast<std::size_t>(axis)][i], at);
        at[4] = rest(std::sqrt(std::max(0.0, double{field.covariance[i][diagonal]})));
    }
    return out;
}

std::vector<float> vector_numbers(const Gaussians& gaussians, const VectorField& field,
                                  FieldUnit unit) {
    std::vector<float> out(gaussians.size() * kVectorFloats);
    const Planes planes(gaussians, unit);
    for (std::size_t i = 0; i < gaussians.size(); ++i) {
        float* at = out.data() + i * kVectorFloats;
        for (int axis = 0; axis < 3; ++axis)
            planes.put(i, double{field.value[i][axis]},
                       field.gradient[static_cast<std::size_t>(axis)][i], at + 4 * axis);
        for (std::size_t n = 0; n < 6; ++n)
            at[12 + n] =
                static_cast<float>(double{field.covariance[i][n]} / (unit.unit * unit.unit));
    }
    return out;
}

}  // namespace

GlField::GlField(const GlModel& model, const Gaussians& gaussians, const FieldChoice& choice)
    : of_vector_(choice.part == FieldPart::view || choice.part == FieldPart::magnitude),
      magnitude_(choice.part == FieldPart::magnitude),
      array_(make_vertex_array()),
      buffer_(make_buffer()) {
    static std::uint64_t uploaded = 0;  // OpenGL is of one thread
    id_ = ++uploaded;
    const FieldUnit unit = unit_of(gaussians.fields, choice.field);
    const std::vector<float> numbers =
        of_vector_ ? vector_numbers(gaussians, *gaussians.fields.find_vector(choice.field), unit)
                   : scalar_numbers(gaussians, choice, unit);
    glBindVertexArray(array_);
    model.set_attributes();
    glBindBuffer(GL_ARRAY_BUFFER, buffer_);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(numbers.size() * sizeof(float)),
                 numbers.data(), GL_STATIC_DRAW);
    if (of_vector_) {
        for (GLuint n = 0; n < 4; ++n) set_attribute(3 + n, 4, kVectorFloats, std::size_t{4} * n);
        set_attribute(7, 2, kVectorFloats, 16);
    } else {
        set_attribute(3, 4, kScalarFloats, 0);
        set_attribute(4, 2, kScalarFloats, 4);
    }
    glBindVertexArray(0);
}

void GlFieldSums::add(const GlModel& model, const GlField* field, const Camera& camera,
                      Jitter jitter, const Clipping& clip, const GlTarget& target) {
    if (model.size() == 0) return;
    const bool of_vector = field && field->of_vector();
    std::optional<GlProgram>& program = of_vector ? vector_ : scalar_;
    if (!program)
        program.emplace("splat.vert",
                        std::vector<std::string>{"erf.glsl", "chord.glsl", "field.frag"},
                        of_vector ? "VECTOR" : "SCALAR");
    target.bind();
    set_view(*program, model, frame_of(camera, target.width(), target.height()), jitter, clip);
    if (of_vector) program->set("magnitude", int{field->magnitude()});
    for (const GLuint place : {3u, 4u}) glVertexAttrib4f(place, 0, 0, 0, 0);  // without a field
    draw_gaussians(field ? field->vertex_array() : model.vertex_array(), model.size());
}

}  // namespace vog::viewer
