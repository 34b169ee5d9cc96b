// web_fields_test.cpp: errors of a page's fields, with a decoder of the format of web_fields.h.
#include "web/web_fields.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/scenes.h"

namespace vog::test {

using namespace vog::web;

namespace {

int byte_at(const WebField& field, std::size_t column, std::size_t count, std::size_t n) {
    return static_cast<unsigned char>(field.bytes.at(column * count + n));
}

/// Numbers of one component, as page/picture/fields.js decodes them.
struct Decoded {
    double value, deviation;
    Vec3d change;
};
Decoded decoded_part(const WebField& field, std::size_t parts, std::size_t part, std::size_t count,
                     std::size_t n) {
    // Values, changes, deviations, the rest; then the lower bits of the numbers of 10 bits.
    const std::size_t rest = parts * 6, low = rest + (parts == 1 ? 1 : 3);
    const auto tens = [&](std::size_t index) {
        const int upper = byte_at(field, 2 * parts + index, count, n);
        return upper << 2 | (byte_at(field, low + index / 4, count, n) >> 2 * (index % 4) & 3);
    };
    const auto square = [](double share) { return share * std::abs(share); };
    const int word = byte_at(field, 2 * part, count, n) | byte_at(field, 2 * part + 1, count, n)
                                                              << 8;
    Decoded out;
    out.value = field.value[part].low + field.value[part].step * word;
    for (int axis = 0; axis < 3; ++axis)
        out.change[axis] =
            field.change * square((tens(3 * part + static_cast<std::size_t>(axis)) - 512) / 511.0);
    out.deviation = field.deviation * square(tens(3 * parts + part) / 1023.0);
    return out;
}

/// Step of a number whose square root is linear in `words`.
double square_step(double value, double most, double words) {
    return 2 * std::sqrt(value * most) / words + most / (words * words);
}

}  // namespace

TEST(web_fields, every_number_is_within_its_bound) {
    for (const bool aligned : {false, true}) {
        Gaussians model = random_gaussians(300, 0.01, 0.3, 7);
        if (aligned) model.rotation.clear();
        const std::size_t size = model.size();
        ScalarField field;
        field.lower = 270, field.upper = 330;
        VectorField flow;
        flow.upper = 90;
        for (std::size_t i = 0; i < size; ++i) {
            const auto x = static_cast<float>(i);
            field.value.push_back(300 + 30 * std::sin(x));
            field.gradient.push_back(
                {100 * std::cos(x), 40 * std::sin(3 * x), -70 * std::cos(2 * x)});
            field.deviation.push_back(4 + 4 * std::sin(5 * x));
            field.skewness.push_back(3 * std::sin(7 * x));
            flow.value.push_back({50 * std::sin(x), -20, 30 * std::cos(x)});
            for (auto& gradient : flow.gradient) gradient.push_back({20 * std::sin(x), 5, -9});
            flow.covariance.push_back({9, 2, -1, 16, 3, 4});
        }
        const WebFrame frame = web_frame(model);
        const WebShapes shapes = web_shapes(model, frame);
        const WebField scalar = web_field(shapes, frame, field);
        const WebField vector = web_field(shapes, frame, flow);
        ASSERT_EQ(scalar.bytes.size(), 8 * size);
        ASSERT_EQ(vector.bytes.size(), 24 * size);
        const WebUnit unit = web_unit(field);
        EXPECT_EQ(unit.reference, 300);
        EXPECT_EQ(unit.unit, 30);
        for (std::size_t n = 0; n < size; ++n) {
            const std::size_t i = shapes.index[n];
            const Decoded back = decoded_part(scalar, 1, 0, size, n);
            EXPECT_NEAR(back.value, (double{field.value[i]} - 300) / 30,
                        0.51 * scalar.value[0].step);
            EXPECT_NEAR(back.deviation, double{field.deviation[i]} / 30,
                        square_step(double{field.deviation[i]} / 30, scalar.deviation, 1023));
            EXPECT_NEAR((byte_at(scalar, 6, size, n) - 127) / 127.0, double{field.skewness[i]} / 3,
                        0.004);
            // Length over the ellipsoid: the same in any order of its axes.
            const Vec3d g = vec_cast<double>(field.gradient[i]),
                        s = vec_cast<double>(model.scale[i]);
            const Vec3d own = aligned ? g : transpose(matrix_from_quat(model.rotation[i])) * g;
            const double spread = length(Vec3d{own.x * s.x, own.y * s.y, own.z * s.z}) / 30;
            EXPECT_NEAR(length(back.change), spread,
                        2 * square_step(spread, scalar.change, 511) + 0.002 * spread);
            for (std::size_t part = 0; part < 3; ++part) {
                const Decoded of = decoded_part(vector, 3, part, size, n);
                EXPECT_NEAR(of.value, double{flow.value[i][static_cast<int>(part)]} / 90,
                            0.51 * vector.value[part].step);
                EXPECT_NEAR(of.deviation,
                            (part == 0   ? 3
                             : part == 1 ? 4
                                         : 2) /
                                90.0,
                            square_step(of.deviation, vector.deviation, 1023));
            }
            EXPECT_NEAR((byte_at(vector, 18, size, n) - 127) / 127.0, 2 / 12.0, 0.005);
            EXPECT_NEAR((byte_at(vector, 19, size, n) - 127) / 127.0, -1 / 6.0, 0.005);
            EXPECT_NEAR((byte_at(vector, 20, size, n) - 127) / 127.0, 3 / 8.0, 0.005);
        }
    }
}

TEST(web_fields, fields_of_one_value) {
    Gaussians model = random_gaussians(5, 0.01, 0.3, 3);
    ScalarField field;
    field.lower = field.upper = 5;
    field.value.assign(5, 5);
    field.gradient.assign(5, Vec3f{0, 0, 0});
    field.deviation.assign(5, 0);
    field.skewness.assign(5, 0);
    const WebFrame frame = web_frame(model);
    const WebField back = web_field(web_shapes(model, frame), frame, field);
    const WebUnit unit = web_unit(field);
    for (std::size_t n = 0; n < 5; ++n)
        EXPECT_EQ(unit.reference + unit.unit * decoded_part(back, 1, 0, 5, n).value, 5);
}

}  // namespace vog::test
