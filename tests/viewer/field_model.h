// field_model.h: A model with a scalar and a vector field, for the window's tests.
#pragma once

#include <memory>

#include "support/scenes.h"

namespace vog::test {

/// Gaussians wider than pixels, with a field that rises along x and one that turns about z.
inline std::shared_ptr<Gaussians> warm_gaussians() {
    auto model = std::make_shared<Gaussians>(random_gaussians(60, 0.2, 0.4, 44));
    ScalarField& field = model->fields.scalar.emplace_back();
    field.name = "heat", field.upper = 10;
    VectorField& wind = model->fields.vector.emplace_back();
    wind.name = "wind", wind.upper = 2;
    for (std::size_t i = 0; i < model->size(); ++i) {
        field.value.push_back(5 + 4 * model->mean[i].x);
        field.gradient.push_back({4, 0, 0});
        field.deviation.push_back(0.3f);
        field.skewness.push_back(0);
        const Vec3f mean = model->mean[i];
        wind.value.push_back({-mean.y, mean.x, 0.5f});
        wind.gradient[0].push_back({0, -1, 0});
        wind.gradient[1].push_back({1, 0, 0});
        wind.gradient[2].push_back({0, 0, 0});
        wind.covariance.push_back({0.04f, 0.01f, 0, 0.09f, 0, 0.01f});
    }
    return model;
}

}  // namespace vog::test
