// Cells of any shape have the mass, mean, covariance and joint moments of their integrals, whatever they are cut into.
#include "vog/convert_cells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "convert/moments/gaussian_moments.h"
#include "render/splat/splat.h"
#include "support/refusal.h"
#include "vog/camera.h"
#include "vog/gaussians.h"

namespace vog {
using test::refusal;

namespace {

/// A lattice of edge^3 cubes in the unit cube, whose inner points are moved; each cube is one cell or several.
/// cut  types and corners (of a hexahedron in VTK's order) of the cells of a cube
struct Piece {
    int type;
    std::vector<int> corner;
};
Cells lattice(int edge, const std::vector<Piece>& cut, double shift = 0) {
    Cells cells;
    std::mt19937 random(1);
    std::uniform_real_distribution<double> move(-shift / edge, shift / edge);
    for (int z = 0; z <= edge; ++z)
        for (int y = 0; y <= edge; ++y)
            for (int x = 0; x <= edge; ++x) {
                Vec3d p{double(x) / edge, double(y) / edge, double(z) / edge};
                // Points of the sides stay in their planes.
                if (x % edge) p.x += move(random);
                if (y % edge) p.y += move(random);
                if (z % edge) p.z += move(random);
                cells.points.push_back(p);
            }
    const auto at = [&](int x, int y, int z) {
        return static_cast<std::uint32_t>(x + (edge + 1) * (y + (edge + 1) * z));
    };
    for (int z = 0; z < edge; ++z)
        for (int y = 0; y < edge; ++y)
            for (int x = 0; x < edge; ++x) {
                const std::uint32_t cube[8] = {at(x, y, z),
                                               at(x + 1, y, z),
                                               at(x + 1, y + 1, z),
                                               at(x, y + 1, z),
                                               at(x, y, z + 1),
                                               at(x + 1, y, z + 1),
                                               at(x + 1, y + 1, z + 1),
                                               at(x, y + 1, z + 1)};
                for (const Piece& piece : cut) {
                    for (const int corner : piece.corner) cells.corner.push_back(cube[corner]);
                    cells.end.push_back(cells.corner.size());
                    cells.type.push_back(static_cast<std::uint8_t>(piece.type));
                }
            }
    cells.density.name = "density";
    return cells;
}

const std::vector<Piece> kHexahedra{{12, {0, 1, 2, 3, 4, 5, 6, 7}}};
const std::vector<Piece> kVoxels{{11, {0, 1, 3, 2, 4, 5, 7, 6}}};
const std::vector<Piece> kWedges{{13, {0, 1, 2, 4, 5, 6}}, {13, {0, 2, 3, 4, 6, 7}}};
/// Kuhn's six tetrahedra about a diagonal: faces of neighbours have the same diagonals.
const std::vector<Piece> kTetrahedra{{10, {0, 1, 2, 6}}, {10, {0, 2, 3, 6}}, {10, {0, 3, 7, 6}},
                                     {10, {0, 7, 4, 6}}, {10, {0, 4, 5, 6}}, {10, {0, 5, 1, 6}}};
/// A pyramid on each of three faces, with the corner opposite to them as tip.
const std::vector<Piece> kPyramids{
    {14, {0, 1, 2, 3, 6}}, {14, {0, 4, 5, 1, 6}}, {14, {0, 3, 7, 4, 6}}};
const std::vector<Piece> kAllCuts[] = {kHexahedra, kVoxels, kWedges, kTetrahedra, kPyramids};

double plane(Vec3d p) { return 2 + p.x - 0.5 * p.y + 0.25 * p.z; }
double slope(Vec3d p) { return -3 + 2 * p.x + 4 * p.y - p.z; }

void set_at_points(const Cells& cells, CellValues& values, double (*function)(Vec3d)) {
    values.at_points = true;
    values.component.resize(1);
    for (const Vec3d& p : cells.points)
        values.component[0].push_back(static_cast<float>(function(p)));
}

/// Mass, mean and covariance of a model of one Gaussian, and what the closed form of `plane` on the unit cube has.
struct Expected {
    double mass = 2.375;  // plane at the centre
    // int plane (x - 1/2) = slope / 12
    Vec3d mean{0.5 + 1.0 / 12 / 2.375, 0.5 - 0.5 / 12 / 2.375, 0.5 + 0.25 / 12 / 2.375};
    std::array<double, 6> covariance() const {
        const Vec3d d = mean - Vec3d{0.5, 0.5, 0.5};
        return {1.0 / 12 - d.x * d.x, -d.x * d.y, -d.x * d.z,
                1.0 / 12 - d.y * d.y, -d.y * d.z, 1.0 / 12 - d.z * d.z};
    }
};

TEST(convert_cells, linear_data_on_curvilinear_cells_equal_the_closed_form) {
    for (const std::vector<Piece>& cut : kAllCuts) {
        SCOPED_TRACE(cut.front().type);
        // Voxels are boxes, and these pyramids have triangles where their neighbours have quads.
        const bool warped = cut.front().type != 11 && cut.front().type != 14;
        Cells cells = lattice(4, cut, warped ? 0.3 : 0);
        set_at_points(cells, cells.density, plane);
        set_at_points(cells, cells.fields.emplace_back(), slope);
        cells.fields[0].name = "slope";
        MomentReport report;
        CellNotes notes;
        const Gaussians model = convert_cells(cells, {.budget = 1}, &notes, &report);
        ASSERT_EQ(model.size(), 1u);
        EXPECT_TRUE(notes_text(notes, cells).empty()) << notes_text(notes, cells);
        const Expected expected;
        EXPECT_NEAR(mass(model), expected.mass, 1e-6 * expected.mass);
        EXPECT_NEAR(report.mass_ratio, 1, 1e-6);
        EXPECT_LT(length(world_mean(model, 0) - expected.mean), 1e-6);
        const std::array<double, 6> covariance = moments::kernel_covariance(model, 0);
        for (std::size_t k = 0; k < 6; ++k)
            EXPECT_NEAR(covariance[k] * variance_within(model.cutoff), expected.covariance()[k],
                        1e-6);
        const ScalarField& field = *model.fields.find_scalar("slope");
        EXPECT_NEAR(field.value[0], slope(expected.mean), 1e-5);
        // The plane is limited to the range of the data, by 1.1 %, and the residual takes what it gives up.
        const auto variance = [&](Vec3d g) {
            const std::array<double, 6> c = expected.covariance();
            return dot(
                g, Vec3d{c[0] * g.x + c[1] * g.y + c[2] * g.z, c[1] * g.x + c[3] * g.y + c[4] * g.z,
                         c[2] * g.x + c[4] * g.y + c[5] * g.z});
        };
        const Vec3d gradient = vec_cast<double>(field.gradient[0]);
        EXPECT_NEAR(variance(gradient) + field.deviation[0] * field.deviation[0],
                    variance({2, 4, -1}), 1e-5);
        EXPECT_LT(length(gradient - gradient.x / 2 * Vec3d{2, 4, -1}), 1e-4);
        EXPECT_NEAR(gradient.x, 2, 0.03);
        EXPECT_TRUE(model.fields.find_scalar("density")->is_measure);
    }
}

TEST(convert_cells, gaussians_of_cells_overlap_and_follow_linear_fields) {
    Cells cells = lattice(2, kHexahedra);
    set_at_points(cells, cells.density, [](Vec3d) { return 3.0; });
    set_at_points(cells, cells.fields.emplace_back(), slope);
    cells.fields[0].name = "slope";
    const Gaussians model = convert_cells(cells, {.budget = 8});
    ASSERT_EQ(model.size(), 8u);
    Vec3d mean;
    double second = 0;
    for (std::size_t i = 0; i < 8; ++i) {
        EXPECT_NEAR(mass(model, i), 3.0 / 8, 1e-6);
        const Vec3d at = world_mean(model, i);
        const double variance =
            moments::kernel_covariance(model, i)[0] * variance_within(model.cutoff);
        EXPECT_GT(variance, 0.25 / 12);
        mean = mean + 1.0 / 8 * at;
        second += 1.0 / 8 * (variance + (at.x - 0.5) * (at.x - 0.5));
        EXPECT_NEAR(model.fields.find_scalar("slope")->value[i], slope(at), 1e-5);
    }
    EXPECT_LT(length(mean - Vec3d{0.5, 0.5, 0.5}), 1e-6);
    EXPECT_NEAR(second, 1.0 / 12, 1e-6);
}

TEST(convert_cells, pictures_of_few_gaussians_are_as_near_as_those_of_voxels) {
    constexpr int kEdge = 24;
    Cells cells = lattice(kEdge, kTetrahedra);
    set_at_points(cells, cells.density, [](Vec3d) { return 1.0; });
    Orbit orbit;
    orbit.orthographic = true;
    orbit.azimuth_degrees = 30, orbit.elevation_degrees = 20;
    const Camera camera = orbit_view(bounds(cells), orbit);
    for (const std::size_t budget : {cells.size() / 50, cells.size()}) {
        const Gaussians model = convert_cells(cells, {.budget = budget, .own_field = false});
        EXPECT_NEAR(mass(model), 1, 1e-6);
        const DepthImage image = render_splat(model, camera, 128, 128);
        // The part within the cube's faces, where T is the length of the ray: beyond, Gaussians end softly.
        const CameraFrame frame = frame_of(camera, 128, 128);
        double error2 = 0, norm2 = 0;
        for (int y = 0; y < 128; ++y)
            for (int x = 0; x < 128; ++x) {
                const Vec3d from = frame.origin(x, y), along = normalized(frame.direction(x, y));
                double first = -1e300, last = 1e300;
                for (int axis = 0; axis < 3; ++axis) {
                    const double a = -from[axis] / along[axis], b = (1 - from[axis]) / along[axis];
                    first = std::max(first, std::min(a, b)), last = std::min(last, std::max(a, b));
                }
                if (last - first < 0.6) continue;
                const double d = image.at(x, y) - (last - first);
                error2 += d * d, norm2 += (last - first) * (last - first);
            }
        // Without windows and steps: 0.05 at 2 %, 0.04 of one Gaussian a cell.
        EXPECT_LT(std::sqrt(error2 / norm2), 0.02) << budget;
    }
}

TEST(convert_cells, vectors_of_cells_are_constant_in_each) {
    Cells cells = lattice(2, kTetrahedra);
    cells.density.component.resize(1);
    cells.density.component[0].assign(cells.size(), 1.0f);
    CellValues& wind = cells.fields.emplace_back();
    wind.name = "wind";
    for (int axis = 0; axis < 3; ++axis)
        wind.component.emplace_back().assign(cells.size(), static_cast<float>(axis + 1));
    const Gaussians model = convert_cells(cells, {.budget = 1, .own_field = false});
    EXPECT_EQ(model.fields.scalar.size(), 0u);
    const VectorField& field = *model.fields.find_vector("wind");
    EXPECT_NEAR(length(vec_cast<double>(field.value[0]) - Vec3d{1, 2, 3}), 0, 1e-6);
    EXPECT_NEAR(field.upper, std::sqrt(14.0), 1e-6);
    EXPECT_NEAR(mass(model), 1, 1e-6);
}

TEST(convert_cells, shells_have_their_thickness) {
    for (const int type : {5, 8, 9}) {
        Cells cells;
        cells.points = {{0, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}};
        if (type == 5) cells.corner = {0, 1, 2, 0, 2, 3}, cells.end = {3, 6}, cells.type = {5, 5};
        if (type == 8) cells.corner = {0, 1, 3, 2}, cells.end = {4}, cells.type = {8};
        if (type == 9) cells.corner = {0, 1, 2, 3}, cells.end = {4}, cells.type = {9};
        cells.density.name = "density";
        cells.density.component.resize(1);
        cells.density.component[0].assign(cells.size(), 5.0f);
        cells.thickness = 0.1;
        const Gaussians model = convert_cells(cells, {.budget = 1});
        EXPECT_NEAR(mass(model), 5 * 4 * 0.1, 1e-5);
        const std::array<double, 6> covariance = moments::kernel_covariance(model, 0);
        EXPECT_NEAR(covariance[5] * variance_within(model.cutoff), 0.01 / 12, 1e-6);
        EXPECT_NEAR(covariance[0] * variance_within(model.cutoff), 4.0 / 12, 1e-5);
        cells.thickness = 0;
        EXPECT_NE(refusal([&] { (void)convert_cells(cells); }).find("no cell with mass"),
                  std::string::npos);
    }
}

TEST(convert_cells, bad_cells_are_counted_and_the_others_count) {
    Cells cells = lattice(3, kTetrahedra);
    set_at_points(cells, cells.density, [](Vec3d) { return 1.0; });
    std::swap(cells.corner[0], cells.corner[1]);  // inverted
    cells.corner[5] = cells.corner[4];            // flat
    cells.points.push_back({std::numeric_limits<double>::quiet_NaN(), 0, 0});
    cells.density.component[0].push_back(1);
    cells.corner[8] = static_cast<std::uint32_t>(cells.points.size() - 1);
    cells.corner.push_back(0), cells.end.push_back(cells.corner.size()), cells.type.push_back(1);
    CellNotes notes;
    const Gaussians model = convert_cells(cells, {.budget = 1000}, &notes);
    EXPECT_EQ(notes_text(notes, cells),
              "cells: of 163 cells 1 flat, 1 not finite, 1 of other types or without a thickness "
              "left out, 1 inverted, which count as the others");
    EXPECT_EQ(model.size(), 160u);
    EXPECT_NEAR(mass(model), 160.0 / 162, 1e-6);
    for (float d : model.density) EXPECT_TRUE(std::isfinite(d) && d > 0);
}

TEST(convert_cells, tangled_cells_stay_finite) {
    std::mt19937 random(3);
    std::normal_distribution<double> any;
    for (const std::vector<Piece>& cut : kAllCuts) {
        Cells cells = lattice(3, cut);
        for (Vec3d& p : cells.points) p = {any(random), any(random), any(random)};
        set_at_points(cells, cells.density, [](Vec3d p) { return p.x * p.x; });
        const Gaussians model = convert_cells(cells, {.budget = 1000});
        validate(model);
        for (std::size_t i = 0; i < model.size(); ++i) EXPECT_TRUE(std::isfinite(mass(model, i)));
    }
}

TEST(convert_cells, errors_are_met) {
    Cells cells = lattice(7, kTetrahedra);
    set_at_points(cells, cells.density, [](Vec3d p) {
        const Vec3d d = p - Vec3d{0.5, 0.4, 0.6};
        return std::exp(-20 * dot(d, d));
    });
    MomentReport report;
    const Gaussians model = convert_cells(cells, {.error = 0.05}, nullptr, &report);
    EXPECT_LE(report.measured_error, 0.05);
    EXPECT_LT(model.size(), cells.size() / 2);
    MomentReport whole;
    EXPECT_GT(convert_cells(cells, {}, nullptr, &whole).size(), model.size());
    // Small meshes have up to one Gaussian a cell, which is as near as it gets.
    EXPECT_LT(whole.measured_error, 0.8 * report.measured_error);
}

TEST(convert_cells, refuses_what_is_no_mesh) {
    Cells cells = lattice(1, kHexahedra);
    set_at_points(cells, cells.density, [](Vec3d p) { return p.x - 0.5; });
    const auto text = [&](const CellOptions& options = {}) {
        return refusal([&] { (void)convert_cells(cells, options); });
    };
    EXPECT_EQ(text(),
              "cells: 'density' has 4 negative values, the first -0.5 at point 0, expected 0 or "
              "more (negative ones can be clipped to 0)");
    EXPECT_NO_THROW((void)convert_cells(cells, {.clip_negative = true}));
    EXPECT_NE(text({.budget = 1, .error = 0.1}).find("exclude each other"), std::string::npos);
    EXPECT_NE(text({.error = 2}).find("expected in (0, 1)"), std::string::npos);
    cells.corner[3] = 99;
    EXPECT_EQ(text(), "cells: a corner at point 99, expected less than 8");
    cells.end[0] = 7;
    EXPECT_NE(text().find("cell 0 of type 12"), std::string::npos);
    cells.density.component.clear();
    cells.end[0] = 8, cells.corner[3] = 3;
    EXPECT_NE(text().find("of 0 components"), std::string::npos);
    EXPECT_NE(refusal([] { (void)convert_cells({}); }).find("no cells"), std::string::npos);
}

}  // namespace
}  // namespace vog
