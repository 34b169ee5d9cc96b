// fields_test.cpp: selection, joining and refusal of fields.
#include "vog/fields.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/field_models.h"
#include "support/refusal.h"
#include "support/scenes.h"
#include "vog/error.h"

namespace vog::test {

namespace {

Gaussians model_with_fields(int count, std::uint64_t seed) {
    Gaussians model = random_gaussians(count, 0.1, 0.2, seed);
    model.source = "gas.vdb";
    add_random_fields(model, seed);
    return model;
}

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

}  // namespace

TEST(fields, are_found_by_name_and_kind) {
    const Fields fields = model_with_fields(3, 1).fields;
    EXPECT_EQ(fields.names(), (std::vector<std::string>{"temperature", "density", "gas velocity"}));
    EXPECT_EQ(fields.find_scalar("density"), &fields.scalar[1]);
    EXPECT_EQ(fields.find_vector("gas velocity"), &fields.vector[0]);
    EXPECT_EQ(fields.find_vector("density"), nullptr);
    EXPECT_EQ(fields.find_scalar("heat"), nullptr);
    EXPECT_FALSE(fields.empty());
    EXPECT_TRUE(Fields{}.empty());
}

TEST(fields, selections_take_them_along) {
    const Gaussians model = model_with_fields(20, 2);
    const std::vector<std::size_t> index{7, 0, 7, 19};
    const Gaussians some = select(model, index);
    validate(some);
    EXPECT_EQ(some.fields.scalar[0].lower, model.fields.scalar[0].lower);
    EXPECT_EQ(some.fields.vector[0].unit, model.fields.vector[0].unit);
    for (std::size_t n = 0; n < index.size(); ++n) {
        EXPECT_EQ(some.fields.scalar[1].value[n], model.fields.scalar[1].value[index[n]]);
        EXPECT_EQ(some.fields.scalar[0].skewness[n], model.fields.scalar[0].skewness[index[n]]);
        EXPECT_EQ(some.fields.vector[0].gradient[2][n],
                  model.fields.vector[0].gradient[2][index[n]]);
        EXPECT_EQ(some.fields.vector[0].covariance[n], model.fields.vector[0].covariance[index[n]]);
    }
}

TEST(fields, joined_models_match_them_by_name) {
    const Gaussians first = model_with_fields(5, 3), second = model_with_fields(4, 4);
    Gaussians other = second, both = first;
    std::swap(other.fields.scalar[0], other.fields.scalar[1]);
    other.fields.scalar[1].lower = -7;
    append(both, other);
    validate(both);
    EXPECT_EQ(both.fields.names(), first.fields.names());
    EXPECT_EQ(both.fields.scalar[0].lower, -7);
    EXPECT_EQ(both.fields.scalar[0].upper, 1500.1);
    const std::vector<std::size_t> front{0, 1, 2, 3, 4}, back{5, 6, 7, 8};
    expect_same_fields(select(both, back).fields, [&] {
        Fields expected = second.fields;
        expected.scalar[0].lower = -7;
        return expected;
    }());
    EXPECT_EQ(select(both, front).fields.vector[0].covariance, first.fields.vector[0].covariance);
}

TEST(fields, a_model_without_gaussians_takes_those_of_the_other_or_leaves_them) {
    const Gaussians model = model_with_fields(5, 5);
    Gaussians none;
    none.source = "void.vdb";
    Gaussians joined = none;
    append(joined, model);
    validate(joined);
    expect_same_fields(joined.fields, model.fields);
    joined = model;
    append(joined, none);
    validate(joined);
    expect_same_fields(joined.fields, model.fields);
}

TEST(fields, models_of_different_fields_are_not_joined) {
    const Gaussians model = model_with_fields(5, 6);
    const auto joined_with = [&](const std::function<void(Fields&)>& change) {
        Gaussians other = model, both = model;
        other.source = "air.vdb";
        change(other.fields);
        const std::string error = refusal([&] { append(both, other); });
        EXPECT_EQ(both.size(), model.size());
        EXPECT_NO_THROW(validate(both));
        return error;
    };
    EXPECT_EQ(
        joined_with([](Fields& fields) { fields.scalar.pop_back(); }),
        "air.vdb: field 'density': one model has it and one has not, expected the same fields "
        "in models that are joined");
    EXPECT_EQ(joined_with([](Fields& fields) { fields.vector[0].name = "wind"; }),
              "air.vdb: field 'gas velocity': one model has it and one has not, expected the same "
              "fields in models that are joined");
    EXPECT_EQ(joined_with([](Fields& fields) { fields.scalar[0].unit = "C"; }),
              "air.vdb: field 'temperature': in 'K' and in 'C', expected one unit");
    Gaussians plain = random_gaussians(3, 0.1, 0.2, 7);
    EXPECT_NE(refusal([&] { append(plain, model); }).find("field 'temperature': one model"),
              std::string::npos);
}

TEST(fields, invalid_ones_are_refused_by_name) {
    const Gaussians model = model_with_fields(3, 8);
    ASSERT_NO_THROW(validate(model));
    struct Case {
        std::string message;
        std::function<void(Fields&)> change;
    };
    const std::vector<Case> cases{
        {"a field without a name", [](Fields& f) { f.scalar[0].name = ""; }},
        {"field '\\x1b', unit 'K': expected UTF-8 without control characters",
         [](Fields& f) { f.scalar[0].name = "\x1b"; }},
        {"field 'temperature', unit '\\x0a': expected", [](Fields& f) { f.scalar[0].unit = "\n"; }},
        {"field 'temperature': range 2 to 1, expected finite and in this order",
         [](Fields& f) { f.scalar[0].lower = 2, f.scalar[0].upper = 1; }},
        {"field 'temperature': range -inf to",
         [](Fields& f) { f.scalar[0].lower = -std::numeric_limits<double>::infinity(); }},
        {"two fields 'density', expected one of each name",
         [](Fields& f) { f.scalar[0].name = "density"; }},
        {"two fields 'density', expected one of each name",
         [](Fields& f) { f.vector[0].name = "density"; }},
        {"fields 'density' and 'density_value' both have a property 'density_value' in files",
         [](Fields& f) { f.scalar.push_back(f.scalar[0]), f.scalar[2].name = "density_value"; }},
        {"fields 'wind_y' and 'wind' both have a property 'wind_y' in files",
         [](Fields& f) { f.scalar[0].name = "wind_y", f.vector[0].name = "wind"; }},
        {"field 'density': an array of 2 values, expected 3, one a Gaussian",
         [](Fields& f) { f.scalar[1].skewness.pop_back(); }},
        {"field 'gas velocity': an array of 4 values, expected 3, one a Gaussian",
         [](Fields& f) { f.vector[0].gradient[2].emplace_back(); }},
        {"Gaussian 1: field 'temperature': value nan, expected finite",
         [](Fields& f) { f.scalar[0].value[1] = kNan; }},
        {"Gaussian 2: field 'density': gradient 0 nan 0, expected finite",
         [](Fields& f) {
             f.scalar[1].gradient[2] = {0, kNan, 0};
         }},
        {"Gaussian 0: field 'density': deviation -1, expected finite and >= 0",
         [](Fields& f) { f.scalar[1].deviation[0] = -1; }},
        {"Gaussian 0: field 'density': skewness 3.5, expected in [-3, 3]",
         [](Fields& f) { f.scalar[1].skewness[0] = 3.5f; }},
        {"Gaussian 1: field 'gas velocity': value nan 0 0, expected finite",
         [](Fields& f) {
             f.vector[0].value[1] = {kNan, 0, 0};
         }},
        {"Gaussian 1: field 'gas velocity': gradient nan 0 0 of z, expected finite",
         [](Fields& f) {
             f.vector[0].gradient[2][1] = {kNan, 0, 0};
         }},
        {"Gaussian 1: field 'gas velocity': covariance 1 0 0 -1 0 1 (xx xy xz yy yz zz), expected",
         [](Fields& f) { f.vector[0].covariance[1] = {1, 0, 0, -1, 0, 1}; }},
        {"Gaussian 1: field 'gas velocity': covariance 1 nan 0 1 0 1 (xx xy xz yy yz zz), expected",
         [](Fields& f) { f.vector[0].covariance[1] = {1, kNan, 0, 1, 0, 1}; }},
    };
    for (const Case& one : cases) {
        Gaussians changed = model;
        one.change(changed.fields);
        EXPECT_EQ(refusal([&] { validate(changed); }).find("gas.vdb: " + one.message), 0u)
            << one.message << " / " << refusal([&] { validate(changed); });
    }
}

}  // namespace vog::test
