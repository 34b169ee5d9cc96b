// field_choice_test.cpp: Fields and their parts by name, and what renderers refuse of them.
#include <gtest/gtest.h>

#include "render/splat/fields/field_splat.h"
#include "render/trace/trace.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/field_maps.h"

namespace vog::test {

namespace {

/// Three Gaussians with a scalar and a vector field.
Gaussians model_with_fields() {
    Gaussians model = random_gaussians(3, 0.1, 0.2, 81);
    ScalarField scalar;
    scalar.name = "temperature";
    VectorField vector;
    vector.name = "velocity";
    const std::size_t count = model.size();
    scalar.value.resize(count);
    scalar.gradient.resize(count);
    scalar.deviation.resize(count);
    scalar.skewness.resize(count);
    vector.value.resize(count);
    for (auto& gradient : vector.gradient) gradient.resize(count);
    vector.covariance.resize(count);
    model.fields.scalar.push_back(std::move(scalar));
    model.fields.vector.push_back(std::move(vector));
    return model;
}

}  // namespace

TEST(field_choice, chooses_a_field_by_its_name) {
    const Gaussians model = model_with_fields();
    EXPECT_EQ(field_choice("temperature", model.fields).part, FieldPart::value);
    EXPECT_EQ(field_choice("velocity", model.fields).part, FieldPart::view);
    EXPECT_EQ(field_choice("velocity.y", model.fields).part, FieldPart::y);
    EXPECT_EQ(field_choice("velocity.magnitude", model.fields).part, FieldPart::magnitude);
    EXPECT_EQ(field_label(field_choice("velocity", model.fields)), "velocity along the view");
    EXPECT_EQ(field_label(field_choice("velocity.y", model.fields)), "velocity.y");
    EXPECT_EQ(field_label({"velocity", FieldPart::magnitude}), "rms of velocity");
    const auto message = [](const std::string& text, const Fields& fields) {
        try {
            (void)field_choice(text, fields);
        } catch (const Error& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    for (const char* wrong : {"pressure", "temperature.x", "temperature.magnitude", "velocity.w",
                              "velocity.", ".x", ""})
        EXPECT_NE(message(wrong, model.fields).find("expected one of temperature, velocity"),
                  std::string::npos)
            << wrong;
    EXPECT_NE(message("pressure", {}).find("vog convert VOLUME -o model.ply --field pressure"),
              std::string::npos);
    Camera camera;
    camera.eye = {2, 1, 3};
    camera.fov_degrees = 40;
    const FieldChoice scalar{"temperature", FieldPart::value};
    EXPECT_THROW((void)render_field_splat(model, {"pressure"}, camera, 8, 8), Error);
    EXPECT_THROW((void)render_field_trace(model, {"velocity"}, camera, 8, 8), Error);
    EXPECT_THROW((void)render_field_splat(model, scalar, camera, 8, 8, {.aabb_sigma = 1}), Error);
    EXPECT_THROW((void)render_field_trace(model, scalar, camera, 8, 8, {.anyhit = AnyHit::collect}),
                 Error);
}

}  // namespace vog::test
