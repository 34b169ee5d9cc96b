// field_models.cpp: random fields.
#include "support/field_models.h"

#include <gtest/gtest.h>

#include "support/scenes.h"

namespace vog::test {

namespace {

ScalarField random_scalar(std::size_t count, Random& random) {
    ScalarField field;
    for (std::size_t i = 0; i < count; ++i) {
        field.value.push_back(static_cast<float>(random(350, 1150)));
        field.gradient.push_back(vec_cast<float>(random.in_cube(400)));
        field.deviation.push_back(static_cast<float>(random(0, 200)));
        field.skewness.push_back(static_cast<float>(random(-3, 3)));
    }
    return field;
}

VectorField random_vector(std::size_t count, Random& random) {
    VectorField field;
    for (std::size_t i = 0; i < count; ++i) {
        field.value.push_back(vec_cast<float>(random.in_cube(10)));
        for (BigVector<Vec3f>& component : field.gradient)
            component.push_back(vec_cast<float>(random.in_cube(30)));
        // L L^T of a random L.
        const Vec3d a = random.in_cube(2), b = random.in_cube(2), c = random.in_cube(2);
        const auto element = [](double value) { return static_cast<float>(value); };
        field.covariance.push_back({element(dot(a, a)), element(dot(a, b)), element(dot(a, c)),
                                    element(dot(b, b)), element(dot(b, c)), element(dot(c, c))});
    }
    return field;
}

}  // namespace

void add_random_fields(Gaussians& model, std::uint64_t seed) {
    Random random(seed);
    model.fields.scalar = {random_scalar(model.size(), random),
                           random_scalar(model.size(), random)};
    model.fields.vector = {random_vector(model.size(), random)};
    ScalarField &temperature = model.fields.scalar[0], &density = model.fields.scalar[1];
    temperature.name = "temperature";
    temperature.unit = "K";
    temperature.lower = -1.0 / 3;
    temperature.upper = 1500.1;
    density.name = "density";
    density.upper = 1e300;
    VectorField& velocity = model.fields.vector[0];
    velocity.name = "gas velocity";
    velocity.unit = "10% of \xc2\xb5m s-1";
    velocity.upper = 0.1;
}

Gaussians cloud_of_values() {
    Gaussians model = random_gaussians(150, 0.08, 0.2, 3);
    add_random_fields(model, 3);
    return model;
}
ValueTransfer rainbow(const ScalarField& field) {
    const double low = field.lower, range = field.upper - field.lower;
    return {"rainbow",
            {{low, 0, 0, 1}, {low + 0.4 * range, 0, 1, 0}, {low + range, 1, 0, 0}},
            {{low, 0.1}, {low + 0.3 * range, 0.4}, {low + 0.5 * range, 0}, {low + range, 0.5}},
            0.2};
}

void expect_same_fields(const Fields& a, const Fields& b) {
    ASSERT_EQ(a.names(), b.names());
    const auto expect_described = [](const auto& one, const auto& other) {
        EXPECT_EQ(one.unit, other.unit) << one.name;
        EXPECT_EQ(one.lower, other.lower) << one.name;
        EXPECT_EQ(one.upper, other.upper) << one.name;
    };
    for (std::size_t k = 0; k < a.scalar.size(); ++k) {
        const ScalarField &one = a.scalar[k], &other = b.scalar[k];
        expect_described(one, other);
        EXPECT_EQ(one.is_measure, other.is_measure);
        EXPECT_EQ(one.background, other.background);
        EXPECT_EQ(one.value, other.value);
        EXPECT_EQ(one.gradient, other.gradient);
        EXPECT_EQ(one.deviation, other.deviation);
        EXPECT_EQ(one.skewness, other.skewness);
    }
    for (std::size_t k = 0; k < a.vector.size(); ++k) {
        const VectorField &one = a.vector[k], &other = b.vector[k];
        expect_described(one, other);
        EXPECT_EQ(one.value, other.value);
        EXPECT_EQ(one.gradient, other.gradient);
        EXPECT_EQ(one.covariance, other.covariance);
    }
}

}  // namespace vog::test
