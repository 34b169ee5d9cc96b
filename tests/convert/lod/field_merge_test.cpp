// field_merge_test.cpp: fields of nodes and of coarser models against sums over samples of their Gaussians.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>

#include "support/field_models.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/lod.h"

namespace vog::test {

namespace {

/// A sample: weight, place, and value of each component of a field.
struct Sample {
    double weight;
    Vec3d at, value;
};
using Visit = std::function<void(const Sample&)>;

/// Calls visit for 27 places of Gaussian i after truncation, by Gauss-Hermite rules of three nodes: moments up to the
/// fifth are those of a normal distribution. Weights add up to the mass.
void each_place(const Gaussians& model, std::size_t i,
                const std::function<void(double weight, Vec3d offset)>& visit) {
    constexpr std::array<double, 3> kWeight{1.0 / 6, 2.0 / 3, 1.0 / 6};
    const Mat3 r = model.axis_aligned() ? Mat3{} : matrix_from_quat(model.rotation[i]);
    const double node = std::sqrt(3 * variance_within(model.cutoff));
    for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t b = 0; b < 3; ++b)
            for (std::size_t c = 0; c < 3; ++c) {
                const Vec3f s = model.scale[i];
                const Vec3d u{(static_cast<double>(a) - 1) * s.x,
                              (static_cast<double>(b) - 1) * s.y,
                              (static_cast<double>(c) - 1) * s.z};
                visit(mass(model, i) * kWeight[a] * kWeight[b] * kWeight[c], r * (node * u));
            }
}

/// Samples of a scalar field: at each place two values, with the residual's deviation and skewness.
void each_sample(const Gaussians& model, const ScalarField& field, std::size_t i,
                 const Visit& visit) {
    const double q = field.skewness[i], root = std::sqrt(q * q + 4);
    const double high = (q + root) / 2, low = (q - root) / 2;
    each_place(model, i, [&](double weight, Vec3d offset) {
        const Vec3d at = vec_cast<double>(model.mean[i]) + offset;
        const double plane = field.value[i] + dot(vec_cast<double>(field.gradient[i]), offset);
        for (const double z : {high, low}) {
            const double share = (z == high ? -low : high) / (high - low);
            visit({weight * share, at, {plane + field.deviation[i] * z, 0, 0}});
        }
    });
}

/// Samples of a vector field: at each place six values, with the residual's covariance.
void each_sample(const Gaussians& model, const VectorField& field, std::size_t i,
                 const Visit& visit) {
    const std::array<float, 6>& c = field.covariance[i];
    const Eigen3 eigen = symmetric_eigen(
        {{Vec3d{c[0], c[1], c[2]}, Vec3d{c[1], c[3], c[4]}, Vec3d{c[2], c[4], c[5]}}});
    each_place(model, i, [&](double weight, Vec3d offset) {
        const Vec3d at = vec_cast<double>(model.mean[i]) + offset;
        Vec3d plane = vec_cast<double>(field.value[i]);
        for (int a = 0; a < 3; ++a)
            plane[a] +=
                dot(vec_cast<double>(field.gradient[static_cast<std::size_t>(a)][i]), offset);
        for (int k = 0; k < 3; ++k)
            for (const double sign : {-1.0, 1.0}) {
                const double spread = sign * std::sqrt(3 * std::max(eigen.values[k], 0.0));
                visit({weight / 6, at, plane + spread * eigen.axes.column(k)});
            }
    });
}

/// Joint moments of position and value of some Gaussians, by plain sums over all samples.
struct Joint {
    double mass = 0;
    Vec3d mean, value;
    Mat3 covariance{{Vec3d{}, {}, {}}}, gradient{{Vec3d{}, {}, {}}}, residual{{Vec3d{}, {}, {}}};
    double third = 0;  ///< third moment of the residual of component 0

    template <class Field>
    Joint(const Gaussians& model, const Field& field, const std::vector<std::size_t>& gaussians) {
        const auto each = [&](const Visit& visit) {
            for (const std::size_t i : gaussians) each_sample(model, field, i, visit);
        };
        each([&](const Sample& s) {
            mass += s.weight;
            mean = mean + s.weight * s.at;
            value = value + s.weight * s.value;
        });
        mean = (1 / mass) * mean;
        value = (1 / mass) * value;
        Mat3 cross{{Vec3d{}, {}, {}}}, values{{Vec3d{}, {}, {}}};
        each([&](const Sample& s) {
            const Vec3d d = s.at - mean, v = s.value - value;
            for (int a = 0; a < 3; ++a)
                for (int b = 0; b < 3; ++b) {
                    covariance(a, b) += s.weight / mass * d[a] * d[b];
                    cross(a, b) += s.weight / mass * v[a] * d[b];
                    values(a, b) += s.weight / mass * v[a] * v[b];
                }
        });
        gradient = cross * inverse(covariance);
        const Mat3 explained = gradient * transpose(cross);
        for (int a = 0; a < 3; ++a)
            for (int b = 0; b < 3; ++b) residual(a, b) = values(a, b) - explained(a, b);
        each([&](const Sample& s) {
            const double off = s.value.x - value.x - dot(gradient.row[0], s.at - mean);
            third += s.weight / mass * off * off * off;
        });
    }
};

constexpr double kFieldFloat = 2e-5;  // of sums of single-precision numbers

void expect_field(const ScalarField& field, std::size_t i, const Joint& exact, bool skewness) {
    const double sd = std::sqrt(exact.residual(0, 0)), spread = std::sqrt(exact.covariance(0, 0));
    const double size = sd + length(exact.gradient.row[0]) * spread + std::abs(exact.value.x);
    EXPECT_NEAR(field.value[i], exact.value.x, kFieldFloat * size) << i;
    EXPECT_NEAR(length(vec_cast<double>(field.gradient[i]) - exact.gradient.row[0]) * spread, 0,
                kFieldFloat * size)
        << i;
    EXPECT_NEAR(field.deviation[i], sd, kFieldFloat * size) << i;
    if (skewness) {
        EXPECT_NEAR(field.skewness[i], std::clamp(exact.third / (sd * sd * sd), -3.0, 3.0), 1e-3)
            << i;
    }
}

void expect_field(const VectorField& field, std::size_t i, const Joint& exact) {
    const Mat3& r = exact.residual;
    const double sd2 = r(0, 0) + r(1, 1) + r(2, 2), spread = std::sqrt(exact.covariance(0, 0));
    double size = std::sqrt(sd2) + length(exact.value);
    for (const Vec3d& row : exact.gradient.row) size += length(row) * spread;
    EXPECT_NEAR(length(vec_cast<double>(field.value[i]) - exact.value), 0, kFieldFloat * size) << i;
    std::size_t n = 0;
    for (int a = 0; a < 3; ++a) {
        const auto row = static_cast<std::size_t>(a);
        EXPECT_NEAR(
            length(vec_cast<double>(field.gradient[row][i]) - exact.gradient.row[row]) * spread, 0,
            kFieldFloat * size)
            << i;
        for (int b = a; b < 3; ++b)
            EXPECT_NEAR(field.covariance[i][n++], r(a, b), kFieldFloat * size * size) << i;
    }
}

/// The leaves below a node.
void add_leaves(const Hierarchy& tree, std::size_t n, std::vector<std::size_t>& leaves) {
    for (std::size_t k = 0; k < tree.leaf_count[n]; ++k) leaves.push_back(tree.first_leaf[n] + k);
    for (std::size_t k = 0; k < tree.node_count[n]; ++k)
        add_leaves(tree, tree.first_node[n] + k, leaves);
}

Gaussians model_with_fields(int count, std::uint64_t seed, float cutoff = 2.25f) {
    Gaussians model = random_gaussians(count, 0.02, 0.2, seed, cutoff);
    add_random_fields(model, seed);
    for (ScalarField& field : model.fields.scalar)
        field.lower = -1e4, field.upper = 1e4;  // no plane is limited
    return model;
}

}  // namespace

TEST(field_merge, nodes_have_the_joint_moments_of_all_leaves_below) {
    Gaussians plain = model_with_fields(300, 11);
    plain.rotation.clear();
    for (Gaussians model : {model_with_fields(400, 12), plain, model_with_fields(60, 13, 3.03f)}) {
        const Hierarchy tree = build_hierarchy(model);
        validate(tree, model, "tree");
        int skewed = 0;
        for (std::size_t n = 0; n < tree.size(); ++n) {
            std::vector<std::size_t> leaves;
            add_leaves(tree, n, leaves);
            // The third moment of nodes over nodes takes these to be normal, which samples are not.
            const bool exact_third = tree.node_count[n] == 0;
            skewed += exact_third;
            for (std::size_t k = 0; k < 2; ++k)
                expect_field(tree.nodes.fields.scalar[k], n,
                             {model, model.fields.scalar[k], leaves}, exact_third);
            expect_field(tree.nodes.fields.vector[0], n, {model, model.fields.vector[0], leaves});
        }
        EXPECT_GT(skewed, 5);
        EXPECT_EQ(tree.nodes.fields.scalar[0].lower, model.fields.scalar[0].lower);
        EXPECT_EQ(tree.nodes.fields.vector[0].unit, model.fields.vector[0].unit);
    }
}

TEST(field_merge, a_coarse_model_of_one_has_the_joint_moments_of_the_whole) {
    for (const float cutoff : {1.5f, 2.25f}) {
        const Gaussians model = model_with_fields(500, 14, cutoff);
        const Gaussians one = coarsen(model, 1);
        ASSERT_EQ(one.size(), 1u);
        validate(one);
        std::vector<std::size_t> all(model.size());
        for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
        for (std::size_t k = 0; k < 2; ++k)
            expect_field(one.fields.scalar[k], 0, {model, model.fields.scalar[k], all}, true);
        expect_field(one.fields.vector[0], 0, {model, model.fields.vector[0], all});
    }
}

TEST(field_merge, coarser_models_keep_the_sums_of_fields) {
    Gaussians model = model_with_fields(800, 15);
    model.density[3] = 0;  // is in no cell
    for (const std::size_t budget : {40u, 799u, 800u}) {
        const Gaussians coarse = coarsen(model, budget);
        validate(coarse);
        const auto sums = [](const Gaussians& of) {
            std::array<double, 3> sum{};  // of value, its square, and a component's product with x
            for (std::size_t i = 0; i < of.size(); ++i)
                each_sample(of, of.fields.scalar[0], i, [&](const Sample& s) {
                    sum[0] += s.weight * s.value.x;
                    sum[1] += s.weight * s.value.x * s.value.x;
                    sum[2] += s.weight * s.value.x * s.at.x;
                });
            return sum;
        };
        const auto a = sums(coarse), b = sums(model);
        EXPECT_NEAR(a[0], b[0], 1e-5 * b[0]) << budget;
        EXPECT_NEAR(a[1], b[1], 1e-5 * b[1]) << budget;
        EXPECT_NEAR(a[2], b[2], 1e-5 * b[0]) << budget;
    }
}

TEST(field_merge, a_plane_that_all_share_stays_a_plane) {
    Gaussians model = random_gaussians(200, 0.02, 0.2, 16);
    model.fields.scalar.resize(1);
    ScalarField& height = model.fields.scalar[0];
    height.name = "height";
    const Vec3d slope{2, -1, 0.5};
    for (std::size_t i = 0; i < model.size(); ++i) {
        height.value.push_back(static_cast<float>(7 + dot(slope, vec_cast<double>(model.mean[i]))));
        height.gradient.push_back(vec_cast<float>(slope));
        height.deviation.push_back(0);
        height.skewness.push_back(0);
    }
    height.lower = -100, height.upper = 100;  // no plane is limited
    const Hierarchy tree = build_hierarchy(model);
    ASSERT_GT(tree.size(), 20u);
    for (std::size_t n = 0; n < tree.size(); ++n) {
        const ScalarField& nodes = tree.nodes.fields.scalar[0];
        EXPECT_NEAR(length(vec_cast<double>(nodes.gradient[n]) - slope), 0, 1e-3);
        EXPECT_NEAR(nodes.value[n], 7 + dot(slope, vec_cast<double>(tree.nodes.mean[n])), 1e-5);
        EXPECT_LT(nodes.deviation[n], 1e-3);
    }
}

TEST(field_merge, extreme_values_and_flat_groups_stay_finite) {
    for (const double unit : {1e-30, 1.0, 1e30}) {
        Gaussians model;
        for (int n = 0; n < 20; ++n) {
            const auto s = static_cast<float>(unit);
            add(model, {s * static_cast<float>(n), 0, 0}, {s, 1e-6f * s, 1e-6f * s}, n % 3 ? 1 : 0);
        }
        add_random_fields(model, 17);
        for (float& value : model.fields.scalar[0].value) value *= 1e35f;
        for (Vec3f& value : model.fields.vector[0].value) value = 1e37f * value;
        const Hierarchy tree = build_hierarchy(model);
        EXPECT_NO_THROW(validate(tree, model, "tree")) << unit;
        EXPECT_NO_THROW(validate(coarsen(model, 3))) << unit;
    }
}

TEST(field_merge, the_gaussians_of_a_hierarchy_keep_their_own_fields) {
    Gaussians model = model_with_fields(300, 18);
    // A value that tells the Gaussian.
    for (std::size_t i = 0; i < model.size(); ++i)
        model.fields.scalar[0].value[i] = model.mean[i].x;
    static_cast<void>(build_hierarchy(model));
    for (std::size_t i = 0; i < model.size(); ++i)
        EXPECT_EQ(model.fields.scalar[0].value[i], model.mean[i].x);
}

}  // namespace vog::test
