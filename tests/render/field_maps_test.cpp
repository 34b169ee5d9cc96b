// field_maps_test.cpp: Maps of fields by every renderer against the closed form in double precision, and the closed
// form against quadrature.
#include "vog/field_maps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <ostream>
#include <random>

#include "render/gpu/chords/gpu_pictures.h"
#include "render/shown_field.h"
#include "render/splat/fields/field_splat.h"
#include "support/expected_maps.h"
#include "support/gpus.h"
#include "support/scenes.h"
#include "vog/error.h"
#include "vog/picture.h"

namespace vog::test {

namespace {

const FieldChoice kScalar{"temperature", FieldPart::value};

FieldChoice velocity(FieldPart part) { return {"velocity", part}; }

Vec3f vector_in(Random& random, double half) { return vec_cast<float>(random.in_cube(half)); }

/// Appends a scalar and a vector field.
/// level  mean of the scalar field;  range  of its values
void add_fields(Gaussians& model, std::uint64_t seed, double level = 20, double range = 5) {
    Random random(seed);
    ScalarField scalar;
    scalar.name = "temperature";
    scalar.unit = "K";
    VectorField vector;
    vector.name = "velocity";
    vector.unit = "m/s";
    for (std::size_t i = 0; i < model.size(); ++i) {
        const Vec3f s = model.scale[i];
        const double steep = 0.5 * range / double{std::max({s.x, s.y, s.z})};
        scalar.value.push_back(static_cast<float>(level + range * random(-1, 1)));
        scalar.gradient.push_back(vector_in(random, steep));
        scalar.deviation.push_back(static_cast<float>(0.3 * range * random()));
        scalar.skewness.push_back(0);
        vector.value.push_back(vector_in(random, 3));
        for (auto& gradient : vector.gradient)
            gradient.push_back(vector_in(random, 1 / double{std::max({s.x, s.y, s.z})}));
        // A covariance is a product of a matrix with its transpose.
        const Mat3 m{{random.in_cube(1), random.in_cube(1), random.in_cube(1)}};
        const Mat3 r = m * transpose(m);
        vector.covariance.push_back({static_cast<float>(r(0, 0)), static_cast<float>(r(0, 1)),
                                     static_cast<float>(r(0, 2)), static_cast<float>(r(1, 1)),
                                     static_cast<float>(r(1, 2)), static_cast<float>(r(2, 2))});
    }
    model.fields.scalar.push_back(std::move(scalar));
    model.fields.vector.push_back(std::move(vector));
}

Expected closed_form(const Gaussians& model, const FieldChoice& choice, const CameraFrame& frame,
                     int x, int y, const Clipping& clip = {}) {
    if (choice.part == FieldPart::magnitude)
        return magnitude_of(
            [&](FieldPart part) { return closed_form(model, velocity(part), frame, x, y, clip); });
    std::vector<FieldSums> parts;
    for (std::size_t i = 0; i < model.size(); ++i)
        parts.push_back(
            field_sums(model, choice, i, frame.origin(x, y), frame.direction(x, y), clip));
    return expected(parts);
}

using Render = std::function<FieldMaps(const Gaussians&, const FieldChoice&, const Camera&, int,
                                       int, const Clipping&)>;
std::vector<std::pair<std::string, Render>> cpu_renderers() {
    std::vector<std::pair<std::string, Render>> all;
    for (const std::string& target : splat_targets())
        all.emplace_back(
            "splat_" + target,
            [target](const Gaussians& model, const FieldChoice& choice, const Camera& camera,
                     int width, int height, const Clipping& clip) {
                return render_field_splat(model, choice, camera, width, height,
                                          {.simd_target = target}, nullptr, clip);
            });
    all.emplace_back(
        "trace", [](const Gaussians& model, const FieldChoice& choice, const Camera& camera,
                    int width, int height, const Clipping& clip) {
            return render_field_trace(model, choice, camera, width, height, {}, {}, clip);
        });
    return all;
}
std::vector<std::pair<std::string, Render>> map_renderers() {
    std::vector<std::pair<std::string, Render>> all = cpu_renderers();
    for (const Gpu& gpu : gpus())
        all.emplace_back(
            gpu.name, [gpu](const Gaussians& model, const FieldChoice& choice, const Camera& camera,
                            int width, int height, const Clipping& clip) {
                gpu.prepare();
                return GpuPictures(gpu.renderer, model).fields(choice, camera, width, height, clip);
            });
    return all;
}

/// Scene and the part of the field that is shown.
struct View {
    std::string name;
    Gaussians model;
    FieldChoice choice;
    Camera camera;
    double tolerance = 2e-5;  ///< of means and deviations, of the field's range over the picture
    Clipping clip{};
};

Camera pinhole(Vec3d eye, Vec3d look_at, double fov) {
    Camera camera;
    camera.eye = eye;
    camera.look_at = look_at;
    camera.fov_degrees = fov;
    return camera;
}
Camera parallel(Vec3d eye, double width) {
    Camera camera = pinhole(eye, {0, 0, 0}, 40);
    camera.orthographic_width = width;
    return camera;
}

/// Rotated Gaussians up to 5 times as long as wide, wider than two pixels, with fields.
Gaussians model_of(int count, double low, double high, std::uint64_t seed, float cutoff = 2.25f) {
    Gaussians model = random_gaussians(count, low, high, seed, cutoff);
    add_fields(model, seed + 1);
    return model;
}

std::vector<View> make_views() {
    std::vector<View> all;
    const Gaussians some = model_of(40, 0.2, 0.5, 5);
    const std::pair<std::string, Camera> cameras[] = {
        {"perspective", pinhole({2, 1.5, 3}, {0, 0, 0}, 40)},
        {"wide_angle", pinhole({0.2, 0.3, 2.5}, {0, 0.1, 0}, 90)},
        {"eye_inside", pinhole({0.1, 0.05, -0.1}, {1, 0.2, 0.5}, 90)},
        {"telescope", pinhole({2000, 1000, -1500}, {0, 0, 0}, 0.06)},
        {"parallel", parallel({1, 2, 3}, 3)},
        {"parallel_eye_inside", parallel({0.1, 0.2, 0.3}, 3)},
    };
    for (const auto& [name, camera] : cameras)
        for (const FieldChoice& choice : {kScalar, velocity(FieldPart::view),
                                          velocity(FieldPart::y), velocity(FieldPart::magnitude)}) {
            const bool is_scalar = choice.part == FieldPart::value;
            const bool is_view = choice.part == FieldPart::view;
            const bool is_y = choice.part == FieldPart::y;
            all.push_back({name + (is_scalar ? "_scalar"
                                   : is_view ? "_along_view"
                                   : is_y    ? "_y"
                                             : "_magnitude"),
                           some, choice, camera});
        }
    all.push_back(
        {"needles", model_of(20, 0.08, 1.2, 8), kScalar, pinhole({3, 1, 2}, {0, 0, 0}, 40), 1e-4});
    all.push_back(
        {"needles_parallel", model_of(20, 0.08, 1.2, 8), kScalar, parallel({3, 1, 2}, 3), 1e-4});
    all.push_back(
        {"cutoff_1", model_of(40, 0.2, 0.5, 9, 1.0f), kScalar, pinhole({3, 1, 2}, {0, 0, 0}, 40)});
    // The polynomial's error, 2e-6 of a Gaussian's peak, is a share of the columns in its tails.
    all.push_back({"cutoff_5", model_of(40, 0.1, 0.3, 10, 5.0f), velocity(FieldPart::view),
                   pinhole({3, 1, 2}, {0, 0, 0}, 40), 2e-4});
    Gaussians far = some;
    far.origin = {5e6, -3e6, 1e6};
    all.push_back({"far_from_origin", far, velocity(FieldPart::view),
                   pinhole(far.origin + Vec3d{2, 1.5, 3}, far.origin, 40)});
    // Faces inside of the model, and one plane oblique to everything.
    Clipping box;
    box.box = Box{{-0.6, -0.4, -0.7}, {0.5, 0.6, 0.1}};
    Clipping oblique;
    oblique.planes = {{{1, 0.7, -0.4}, 0.05}, {{-0.3, 2, 1}, -0.9}};
    for (const auto& [name, camera] : cameras)
        for (const auto& [clip_name, clip] : {std::pair{"_box", box}, {"_planes", oblique}}) {
            all.push_back({name + clip_name, some, kScalar, camera, 2e-5, clip});
            all.push_back({name + clip_name + "_along_view", some, velocity(FieldPart::view),
                           camera, 2e-5, clip});
        }
    all.push_back({"perspective_box_magnitude", some, velocity(FieldPart::magnitude),
                   cameras[0].second, 2e-5, box});
    Clipping moved;
    moved.box = vog::moved(*box.box, far.origin);
    all.push_back({"far_from_origin_box", far, velocity(FieldPart::view),
                   pinhole(far.origin + Vec3d{2, 1.5, 3}, far.origin, 40), 2e-5, moved});
    for (const double unit : {1e-12, 1e12}) {
        Gaussians scaled = model_of(40, 0.2, 0.5, 5);
        for (std::size_t i = 0; i < scaled.size(); ++i) {
            const auto by = static_cast<float>(unit);
            scaled.density[i] *= by;
            ScalarField& field = scaled.fields.scalar[0];
            field.value[i] *= by, field.deviation[i] *= by;
            field.gradient[i] = by * field.gradient[i];
        }
        all.push_back({unit < 1 ? "tiny_values" : "huge_values", scaled, kScalar,
                       pinhole({2, 1.5, 3}, {0, 0, 0}, 40)});
    }
    return all;
}
/// Made once: every name of a test is one of these.
const std::vector<View>& views() {
    static const std::vector<View> all = make_views();
    return all;
}

/// Pictures of views: Gaussians are wider than two pixels.
constexpr int kWidth = 128, kHeight = 96;

/// The closed form at every third pixel of every third row.
std::vector<std::pair<std::size_t, Expected>> exact_pixels(const View& view) {
    const CameraFrame frame = frame_of(view.camera, kWidth, kHeight);
    std::vector<std::pair<std::size_t, Expected>> exact;
    for (int y = 0; y < kHeight; y += 3)
        for (int x = 0; x < kWidth; x += 3)
            exact.emplace_back(kWidth * y + x,
                               closed_form(view.model, view.choice, frame, x, y, view.clip));
    return exact;
}

void expect_closed_form(const View& view,
                        const std::vector<std::pair<std::size_t, Expected>>& exact,
                        const FieldMaps& maps) {
    double most = 0, low = 1e300, high = -1e300;
    for (const auto& [n, e] : exact) {
        if (e.column == 0) continue;
        most = std::max(most, e.column);
        low = std::min(low, e.mean - e.deviation), high = std::max(high, e.mean + e.deviation);
    }
    ASSERT_GT(most, 0);
    int shown = 0;
    double worst = 0;
    for (const auto& [n, e] : exact) {
        EXPECT_NEAR(maps.column[n], e.column, 1e-5 * most) << "pixel " << n;
        ASSERT_EQ(std::isnan(maps.mean[n]), maps.column[n] == 0) << "pixel " << n;
        ASSERT_EQ(std::isnan(maps.deviation[n]), maps.column[n] == 0) << "pixel " << n;
        // Where only the rim of a support is, its column has no digits in floats.
        if (e.column < 1e-3 * most) continue;
        ++shown;
        worst = std::max({worst, std::abs(maps.mean[n] - e.mean) / (high - low),
                          std::abs(maps.deviation[n] - e.deviation) / (high - low)});
    }
    EXPECT_GT(shown, 40);
    EXPECT_LT(worst, view.tolerance);
}

/// Column, first and second sum by the midpoint rule over the chord.
FieldSums by_quadrature(const Gaussians& model, const FieldChoice& choice, std::size_t i,
                        Vec3d origin, Vec3d direction, const Clipping& clip = {}) {
    const Vec3d along = normalized(direction);
    const Mat3 w = whitening(model, i);
    const Vec3d e = w * (world_mean(model, i) - origin), d = w * along;
    const double c = dot(d, d), b = dot(e, d) / c;
    const double rest = double{model.cutoff} * double{model.cutoff} - dot(e - b * d, e - b * d);
    if (rest <= 0) return {};
    // Walls by the definition of a clip, independent of clipped_ray.
    const auto is_kept = [&](Vec3d x) {
        for (int axis = 0; clip.box && axis < 3; ++axis)
            if (x[axis] < clip.box->lower[axis] || x[axis] > clip.box->upper[axis]) return false;
        return std::ranges::all_of(clip.planes, [&](const ClipPlane& plane) {
            return dot(plane.normal, x) >= plane.offset;
        });
    };
    const double first = std::max(b - std::sqrt(rest / c), 0.0), last = b + std::sqrt(rest / c);
    const auto density = [&](double t) {
        const Vec3d x = e - t * d;
        return double{model.density[i]} * std::exp(-0.5 * dot(x, x));
    };
    const auto field = [&](double t, double& variance) {
        const Vec3d from = origin + t * along - world_mean(model, i);
        if (choice.part == FieldPart::value) {
            const ScalarField& f = model.fields.scalar[0];
            variance = double{f.deviation[i]} * double{f.deviation[i]};
            return double{f.value[i]} + dot(vec_cast<double>(f.gradient[i]), from);
        }
        const VectorField& f = model.fields.vector[0];
        const Vec3d to = choice.part == FieldPart::view ? along
                         : choice.part == FieldPart::x  ? Vec3d{1, 0, 0}
                         : choice.part == FieldPart::y  ? Vec3d{0, 1, 0}
                                                        : Vec3d{0, 0, 1};
        double value = 0;
        for (int a = 0; a < 3; ++a)
            value +=
                to[a] * (double{f.value[i][a]} +
                         dot(vec_cast<double>(f.gradient[static_cast<std::size_t>(a)][i]), from));
        const auto& r = f.covariance[i];
        const Mat3 whole{{Vec3d{double{r[0]}, double{r[1]}, double{r[2]}},
                          Vec3d{double{r[1]}, double{r[3]}, double{r[4]}},
                          Vec3d{double{r[2]}, double{r[4]}, double{r[5]}}}};
        variance = dot(to, whole * to);
        return value;
    };
    FieldSums sums;
    constexpr int kSteps = 20000;
    const double step = (last - first) / kSteps;
    for (int n = 0; first < last && n < kSteps; ++n) {
        const double t = first + (n + 0.5) * step;
        if (!is_kept(origin + t * along)) continue;
        double variance = 0;
        const double weight = density(t) * step, value = field(t, variance);
        sums.column += weight;
        sums.first += weight * value;
        sums.second += weight * (value * value + variance);
    }
    return sums;
}

}  // namespace

class field_maps : public testing::TestWithParam<std::size_t> {};

TEST_P(field_maps, are_the_closed_form) {
    const View& view = views()[GetParam()];
    const auto exact = exact_pixels(view);
    for (const auto& [name, render] : map_renderers()) {
        SCOPED_TRACE(view.name + " " + name);
        expect_closed_form(
            view, exact, render(view.model, view.choice, view.camera, kWidth, kHeight, view.clip));
    }
}
INSTANTIATE_TEST_SUITE_P(views, field_maps, testing::Range<std::size_t>(0, views().size()),
                         [](const auto& param) { return views()[param.param].name; });

TEST(field_sums, are_the_integrals) {
    Gaussians model = model_of(30, 0.05, 0.6, 21);
    model.origin = {10, 20, -30};
    Random random(3);
    int met = 0, cut = 0;
    for (std::size_t i = 0; i < model.size(); ++i)
        for (const double distance : {0.0, 0.3, 2.0, 1000.0}) {
            const Vec3d inside =
                world_mean(model, i) + 0.3 * random.in_cube(double{model.scale[i].x});
            const Vec3d direction = random.in_cube(1);
            const Vec3d origin = inside - distance * normalized(direction);
            for (const FieldChoice& choice : {kScalar, velocity(FieldPart::view),
                                              velocity(FieldPart::x), velocity(FieldPart::z)}) {
                const FieldSums sums = field_sums(model, choice, i, origin, direction);
                const FieldSums right = by_quadrature(model, choice, i, origin, direction);
                const double scale = right.column * (1 + std::sqrt(right.second / right.column));
                EXPECT_NEAR(sums.column, right.column, 2e-7 * right.column);
                EXPECT_NEAR(sums.first, right.first, 2e-7 * scale);
                EXPECT_NEAR(sums.second, right.second, 4e-7 * (scale + right.second));
                ++met;
            }
            const FieldSums all =
                field_sums(model, velocity(FieldPart::magnitude), i, origin, direction);
            double squares = 0;
            for (const FieldPart part : {FieldPart::x, FieldPart::y, FieldPart::z})
                squares += by_quadrature(model, velocity(part), i, origin, direction).second;
            EXPECT_NEAR(all.second, squares, 1e-6 * (squares + all.column));
            EXPECT_EQ(all.first, 0);
            cut += distance == 0;
        }
    EXPECT_EQ(met, 480);
    EXPECT_EQ(cut, 30);
    // Past the Gaussian and behind the eye.
    const Vec3d mean = world_mean(model, 0);
    EXPECT_EQ(field_sums(model, kScalar, 0, mean + Vec3d{10, 0, 0}, {1, 0, 0}).column, 0);
    EXPECT_EQ(field_sums(model, kScalar, 0, mean + Vec3d{10, 0, 0}, {0, 1, 0}).column, 0);
}

TEST(field_sums, under_a_clip_are_the_integrals) {
    Gaussians model = model_of(30, 0.05, 0.6, 22);
    model.origin = {10, 20, -30};
    Random random(4);
    int cut = 0;
    for (std::size_t i = 0; i < model.size(); ++i) {
        const double size = double{model.scale[i].x};
        const Vec3d inside = world_mean(model, i) + 0.3 * random.in_cube(size);
        const Vec3d direction = random.in_cube(1), origin = inside - 2.0 * normalized(direction);
        Clipping clip;
        clip.planes = {{random.in_cube(1), 0}};
        clip.planes[0].offset =
            dot(clip.planes[0].normal, world_mean(model, i) + 0.5 * random.in_cube(size));
        const Vec3d corner = world_mean(model, i) + random.in_cube(size);
        clip.box = Box{corner, corner + Vec3d{2 * size, 3, 3}};
        for (const FieldChoice& choice : {kScalar, velocity(FieldPart::view)}) {
            const FieldSums whole = field_sums(model, choice, i, origin, direction);
            const FieldSums sums = field_sums(model, choice, i, origin, direction, clip);
            const FieldSums right = by_quadrature(model, choice, i, origin, direction, clip);
            // Steps at the ends of the kept part count whole or not: one of 20,000, twice.
            const double tolerance = 5e-4;
            EXPECT_NEAR(sums.column, right.column, tolerance * whole.column);
            EXPECT_NEAR(sums.second, right.second, tolerance * (whole.second + right.second));
            EXPECT_NEAR(sums.first, right.first,
                        tolerance * std::sqrt(whole.column * (whole.second + right.second)));
            cut += sums.column > 0 && sums.column < 0.99 * whole.column;
        }
    }
    EXPECT_GT(cut, 12);
}

// 300 ± 0.1: squares of the values in floats would have no digit of the deviation.
TEST(field_maps, keep_the_digits_of_a_small_dispersion) {
    Gaussians model = random_gaussians(200, 0.1, 0.3, 31);
    add_fields(model, 32, 300, 0.1);
    const Camera camera = pinhole({2, 1.5, 3}, {0, 0, 0}, 40);
    const CameraFrame frame = frame_of(camera, 96, 96);
    for (const auto& [name, render] : map_renderers()) {
        const FieldMaps maps = render(model, kScalar, camera, 96, 96, {});
        for (const auto& [x, y] : {std::pair{48, 48}, {30, 60}, {60, 27}}) {
            const Expected exact = closed_form(model, kScalar, frame, x, y);
            const auto n = static_cast<std::size_t>(96 * y + x);
            EXPECT_NEAR(maps.mean[n], exact.mean, 3e-5) << name;  // a float of 300
            EXPECT_NEAR(maps.deviation[n], exact.deviation, 1e-4 * exact.deviation) << name;
        }
    }
}

TEST(field_maps, of_an_orthographic_camera_sum_to_the_mass_and_to_the_field) {
    // Cutoff 5: a support of 12 pixels and more sums over the lattice as its integral, to 1e-7.
    Gaussians model = model_of(100, 0.12, 0.3, 41, 5.0f);
    const Camera camera = parallel({1, 2, 3}, 7);
    constexpr int kSize = 280;
    const double area = 7.0 / kSize * 7.0 / kSize;
    for (const FieldChoice& choice : {kScalar, velocity(FieldPart::view)}) {
        const Vec3d towards = frame_of(camera, 1, 1).forward;
        double weighted = 0;
        for (std::size_t i = 0; i < model.size(); ++i)
            weighted += mass(model, i) *
                        (choice.part == FieldPart::value
                             ? double{model.fields.scalar[0].value[i]}
                             : dot(towards, vec_cast<double>(model.fields.vector[0].value[i])));
        for (const auto& [name, render] : cpu_renderers()) {
            const FieldMaps maps = render(model, choice, camera, kSize, kSize, {});
            double column = 0, first = 0;
            for (std::size_t n = 0; n < maps.column.size(); ++n) {
                if (!(maps.column[n] > 0)) continue;
                column += double{maps.column[n]} * area;
                first += double{maps.column[n]} * double{maps.mean[n]} * area;
            }
            EXPECT_NEAR(column, mass(model), 1e-6 * mass(model)) << name;
            // Velocities of both signs nearly cancel: relative to their size, 3.
            const double scale = std::max(std::abs(weighted), 3 * mass(model));
            EXPECT_NEAR(first, weighted, 1e-5 * scale) << name;
        }
    }
}

TEST(field_maps, show_points_with_their_mean_and_whole_variance) {
    Gaussians model = model_of(400, 2e-4, 2e-3, 51);
    for (const Camera& camera : {parallel({1, 2, 3}, 3), pinhole({2, 1.5, 3}, {0, 0, 0}, 40)}) {
        for (const FieldChoice& choice : {kScalar, velocity(FieldPart::view)}) {
            const FieldMaps splat = render_field_splat(model, choice, camera, 48, 48);
            const FieldMaps trace = render_field_trace(model, choice, camera, 48, 48);
            int shown = 0;
            for (std::size_t n = 0; n < splat.column.size(); ++n) {
                if (!(splat.column[n] > 1e-9f)) continue;
                ++shown;
                EXPECT_NEAR(splat.column[n], trace.column[n], 1e-4f * trace.column[n] + 1e-11f);
                EXPECT_NEAR(splat.mean[n], trace.mean[n], 2e-3f);
                EXPECT_NEAR(splat.deviation[n], trace.deviation[n], 2e-3f);
            }
            EXPECT_GT(shown, 200);
        }
    }
    // One of them alone: all its pixels have the value, and the variance of residual and plane.
    Gaussians one;
    add(one, {0.01f, 0.02f, 0}, {1e-4f, 2e-4f, 3e-4f}, 1);
    add_fields(one, 7);
    const Vec3f g = one.fields.scalar[0].gradient[0], s = one.scale[0];
    const double plane = variance_within(double{one.cutoff}) *
                         (std::pow(double{g.x * s.x}, 2) + std::pow(double{g.y * s.y}, 2) +
                          std::pow(double{g.z * s.z}, 2));
    const double residual = double{one.fields.scalar[0].deviation[0]};
    for (const auto& [name, render] : map_renderers()) {
        const FieldMaps maps = render(one, kScalar, parallel({1, 2, 3}, 3), 48, 48, {});
        int shown = 0;
        for (std::size_t n = 0; n < maps.column.size(); ++n) {
            if (!(maps.column[n] > 0)) continue;
            ++shown;
            EXPECT_NEAR(maps.mean[n], one.fields.scalar[0].value[0], 1e-5) << name;
            EXPECT_NEAR(maps.deviation[n], std::sqrt(plane + residual * residual), 1e-5) << name;
        }
        EXPECT_GE(shown, 1) << name;
    }
}

TEST(field_maps, are_the_same_bytes_for_any_number_of_threads) {
    const Gaussians model = model_of(3000, 0.005, 0.1, 61);
    Clipping half;
    half.planes = {{{1, 2, 3}, 0.1}};
    const Camera camera = pinhole({0.9, 0.8, 0.7}, {0, 0, 0}, 70);
    for (const auto& [name, render] : cpu_renderers())
        for (const auto& [choice, clip] : {std::pair{kScalar, Clipping{}},
                                           {velocity(FieldPart::view), Clipping{}},
                                           {kScalar, half}}) {
            const FieldMaps many = render(model, choice, camera, 96, 64, clip);
            const ThreadLimit limit(1);
            const FieldMaps one = render(model, choice, camera, 96, 64, clip);
            EXPECT_EQ(one.column, many.column) << name;
            for (std::size_t n = 0; n < one.mean.size(); ++n) {
                if (std::isnan(one.mean[n])) continue;
                ASSERT_EQ(one.mean[n], many.mean[n]) << name;
                ASSERT_EQ(one.deviation[n], many.deviation[n]) << name;
            }
        }
}

TEST(field_maps, of_two_halves_are_those_of_the_whole) {
    // From Gaussians of many pixels to points: their chords, or the share at their means.
    for (const double size : {0.3, 0.004, 0.0005}) {
        const Gaussians model = model_of(500, 0.2 * size, size, 81);
        Clipping front, back;
        front.planes = {{{0.4, -0.2, 1}, 0.02}};
        back.planes = {{{-0.4, 0.2, -1}, -0.02}};
        for (const Camera& camera : {parallel({1, 2, 3}, 3), pinhole({2, 1.5, 3}, {0, 0, 0}, 40)})
            for (const auto& [name, render] : map_renderers()) {
                SCOPED_TRACE(name);
                const FieldMaps whole = render(model, kScalar, camera, 36, 36, {});
                const FieldMaps a = render(model, kScalar, camera, 36, 36, front);
                const FieldMaps b = render(model, kScalar, camera, 36, 36, back);
                const double most = double{*std::ranges::max_element(whole.column)};
                int both = 0;
                for (std::size_t n = 0; n < whole.column.size(); ++n) {
                    EXPECT_NEAR(a.column[n] + b.column[n], whole.column[n], 1e-5 * most);
                    if (!(whole.column[n] > 1e-3 * most)) continue;
                    const auto weighted = [&](const FieldMaps& maps) {
                        return maps.column[n] > 0 ? double{maps.column[n]} * double{maps.mean[n]}
                                                  : 0;
                    };
                    EXPECT_NEAR(weighted(a) + weighted(b), weighted(whole),
                                2e-5 * 25 * double{whole.column[n]} + 20 * 1e-5 * most);
                    both += a.column[n] > 0 && b.column[n] > 0;
                }
                EXPECT_GT(both, size > 0.01 ? 300 : 1);
            }
    }
}

TEST(field_maps, under_a_clip_have_the_column_of_T_and_nothing_outside) {
    const auto model = std::make_shared<Gaussians>(model_of(300, 0.1, 0.4, 91));
    const Camera camera = pinhole({2, 1.5, 3}, {0, 0, 0}, 40);
    Clipping some;
    some.box = Box{{-0.5, -0.5, -0.2}, {0.4, 0.5, 0.5}};
    PictureRenderer renderer(scene_of(model));
    const DepthImage depth = bare_depth(
        renderer, {.camera = camera, .width = 64, .height = 64, .options = {.clip = some}});
    const float most = *std::ranges::max_element(depth.depth);
    Clipping all, none;
    all.box = Box{{-9, -9, -9}, {9, 9, 9}};
    none.box = Box{{5, 5, 5}, {6, 6, 6}};
    for (const auto& [name, render] : map_renderers()) {
        SCOPED_TRACE(name);
        const FieldMaps maps = render(*model, kScalar, camera, 64, 64, some);
        for (std::size_t n = 0; n < depth.depth.size(); ++n)
            EXPECT_NEAR(maps.column[n], depth.depth[n], 2e-5f * most);
        const FieldMaps whole = render(*model, kScalar, camera, 64, 64, {});
        const FieldMaps kept = render(*model, kScalar, camera, 64, 64, all);
        for (std::size_t n = 0; n < whole.column.size(); ++n)
            EXPECT_NEAR(kept.column[n], whole.column[n], 3e-6f * whole.column[n]);
        for (const float column : render(*model, kScalar, camera, 64, 64, none).column)
            EXPECT_EQ(column, 0);
        Clipping inside_out;
        inside_out.box = Box{{1, 0, 0}, {0, 1, 1}};
        EXPECT_THROW(render(*model, kScalar, camera, 8, 8, inside_out), Error);
    }
}

TEST(field_maps, have_the_column_of_T) {
    const Gaussians model = model_of(500, 0.002, 0.2, 71);
    const Camera camera = pinhole({2, 1.5, 3}, {0, 0, 0}, 40);
    const DepthImage depth = render_splat(model, camera, 64, 64);
    const FieldMaps maps = render_field_splat(model, kScalar, camera, 64, 64);
    const float most = *std::ranges::max_element(depth.depth);
    for (std::size_t n = 0; n < maps.column.size(); ++n)
        ASSERT_NEAR(maps.column[n], depth.depth[n], 2e-6f * most);
}

TEST(field_maps, an_earlier_pictures_arrays_leave_no_trace) {
    const Gaussians model = model_of(40, 0.01, 0.05, 72);
    FieldMaps maps;
    render_field_splat(model, kScalar, pinhole({0.5, 0.5, 1}, {0, 0, 0}, 60), 150, 90, {}, maps);
    const Camera camera = pinhole({4, 3, 6}, {0, 0, 0}, 60);
    render_field_splat(model, kScalar, camera, 200, 70, {}, maps);
    const FieldMaps fresh = render_field_splat(model, kScalar, camera, 200, 70);
    EXPECT_EQ(maps.width, 200);
    EXPECT_EQ(maps.column, fresh.column);
    for (std::size_t n = 0; n < fresh.mean.size(); ++n) {
        ASSERT_EQ(std::isnan(maps.mean[n]), std::isnan(fresh.mean[n]));
        ASSERT_TRUE(std::isnan(fresh.mean[n]) || maps.mean[n] == fresh.mean[n]);
        ASSERT_EQ(fresh.column[n] > 0, !std::isnan(maps.deviation[n]));
    }
}

TEST(field_maps, of_an_empty_model_show_nothing) {
    Gaussians model;
    add_fields(model, 1);
    for (const auto& [name, render] : map_renderers()) {
        const FieldMaps maps = render(model, kScalar, pinhole({2, 1, 3}, {0, 0, 0}, 40), 8, 6, {});
        ASSERT_EQ(maps.column, std::vector<float>(48)) << name;
        EXPECT_TRUE(std::ranges::all_of(maps.mean, [](float v) { return std::isnan(v); }));
    }
}

}  // namespace vog::test
