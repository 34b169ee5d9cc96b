// conduit_test.cpp: meshes of Conduit as vog's: masses, moments, fields and refusals of examples/conduit.
#include <cmath>
#include <conduit.hpp>
#include <cstdio>
#include <string>
#include <vector>

#include "../../examples/conduit/mesh.h"

namespace {

using conduit::Node;

int failures = 0;
void expect_near(const std::string& what, double found, double right) {
    if (std::abs(found - right) <= 1e-5 * std::abs(right)) return;
    std::printf("%s: %.9g, expected %.9g\n", what.c_str(), found, right);
    ++failures;
}

/// A box of 4 x 3 x 2 elements with edges 0.5, 1, 2 from (1, 2, 3) on.
constexpr int kSize[] = {4, 3, 2};
constexpr double kEdge[] = {0.5, 1, 2}, kOrigin[] = {1, 2, 3};

void add_field(Node& mesh, const std::string& name, const std::vector<double>& values,
               bool at_vertices = false) {
    Node& field = mesh["fields/" + name];
    field["topology"] = "mesh";
    field["association"] = at_vertices ? "vertex" : "element";
    field["values"].set(values);
}

/// The box as a kind of mesh, with the density 1 + x of its elements.
Node box(const std::string& kind) {
    Node mesh;
    const char *ijk[] = {"i", "j", "k"}, *axes[] = {"x", "y", "z"}, *steps[] = {"dx", "dy", "dz"};
    Node &coords = mesh["coordsets/coords"], &topology = mesh["topologies/mesh"];
    topology["coordset"] = "coords";
    topology["type"] = kind == "hex" || kind == "tet" || kind == "mixed" ? "unstructured" : kind;
    std::vector<double> along[3], points[3], density;
    for (int k = 0; k < 3; ++k)
        for (int n = 0; n <= kSize[k]; ++n) along[k].push_back(kOrigin[k] + n * kEdge[k]);
    for (const double z : along[2])
        for (const double y : along[1])
            for (const double x : along[0]) {
                points[0].push_back(x);
                points[1].push_back(y);
                points[2].push_back(z);
            }
    const bool is_explicit = kind != "uniform" && kind != "rectilinear";
    coords["type"] = is_explicit ? "explicit" : kind;
    for (int k = 0; k < 3; ++k) {
        if (kind == "uniform") {
            coords["dims"][ijk[k]] = kSize[k] + 1;
            coords["origin"][axes[k]] = kOrigin[k];
            coords["spacing"][steps[k]] = kEdge[k];
        } else {
            coords["values"][axes[k]].set(is_explicit ? points[k] : along[k]);
        }
        if (kind == "structured") topology["elements/dims"][ijk[k]] = kSize[k];
    }
    std::vector<int> connectivity, shapes, sizes, offsets;
    for (int z = 0; z < 2; ++z)
        for (int y = 0; y < 3; ++y)
            for (int x = 0; x < 4; ++x) {
                const int at = (z * 4 + y) * 5 + x;
                const int hex[] = {at, at + 1, at + 6, at + 5, at + 20, at + 21, at + 26, at + 25};
                // Six tetrahedra about a diagonal.
                const int tets[] = {0, 1, 2, 6, 0, 2, 3, 6, 0, 3, 7, 6,
                                    0, 7, 4, 6, 0, 4, 5, 6, 0, 5, 1, 6};
                const bool as_tets = kind == "tet" || (kind == "mixed" && x % 2 == 1);
                for (int n = 0; n < (as_tets ? 6 : 1); ++n) {
                    shapes.push_back(as_tets ? 10 : 12);
                    sizes.push_back(as_tets ? 4 : 8);
                    offsets.push_back(static_cast<int>(connectivity.size()));
                    for (int k = 0; k < sizes.back(); ++k)
                        connectivity.push_back(hex[as_tets ? tets[4 * n + k] : k]);
                    density.push_back(1 + x);
                }
            }
    if (kind == "hex" || kind == "tet" || kind == "mixed") {
        Node& elements = topology["elements"];
        elements["shape"] = kind;
        elements["connectivity"].set(connectivity);
        if (kind == "mixed") {
            elements["shape_map/hex"] = 12;
            elements["shape_map/tet"] = 10;
            elements["shapes"].set(shapes);
            elements["sizes"].set(sizes);
            elements["offsets"].set(offsets);
        }
    }
    add_field(mesh, "rho", density);
    return mesh;
}

template <class Act>
void expect_refusal(const std::string& text, const Act& act) {
    try {
        act();
    } catch (const vog::Error& error) {
        if (std::string(error.what()).find(text) != std::string::npos) return;
        std::printf("'%s', expected '%s'\n", error.what(), text.c_str());
    }
    std::printf("no refusal, expected '%s'\n", text.c_str());
    ++failures;
}

}  // namespace

int main() {
    const double right = 6 * (1 + 2 + 3 + 4);  // elements of volume 1
    for (const std::string kind : {"uniform", "rectilinear", "structured", "hex", "tet", "mixed"}) {
        Node mesh = box(kind);
        const vog::Gaussians model = conduit_mesh::convert(mesh, "rho", {}, 100);
        expect_near(kind + ": mass", vog::mass(model), right);
        double x = 0;
        for (std::size_t n = 0; n < model.size(); ++n)
            x += vog::mass(model, n) * (model.origin.x + static_cast<double>(model.mean[n].x));
        expect_near(kind + ": centre", x / right,
                    1 + 0.5 * (0.5 * 1 + 1.5 * 2 + 2.5 * 3 + 3.5 * 4) / 10);

        // Ghosts do not count: the first column of elements, of density 1.
        std::vector<double> ghosts;
        const auto values = mesh["fields/rho/values"].as_float64_accessor();
        for (int n = 0; n < values.number_of_elements(); ++n) ghosts.push_back(values[n] == 1);
        add_field(mesh, "ascent_ghosts", ghosts);
        expect_near(kind + ": mass without ghosts",
                    vog::mass(conduit_mesh::convert(mesh, "rho", {}, 100)), right - 6);
    }

    // Further fields: a vector at vertices, 2 x along y.
    Node mesh = box("uniform");
    std::vector<double> twice, zero;
    for (int z = 0; z <= 2; ++z)
        for (int y = 0; y <= 3; ++y)
            for (int x = 0; x <= 4; ++x) {
                twice.push_back(2 * (kOrigin[0] + x * kEdge[0]));
                zero.push_back(0);
            }
    Node& field = mesh["fields/velocity"];
    field["topology"] = "mesh";
    field["association"] = "vertex";
    field["units"] = "m/s";
    field["values/u"].set(zero);
    field["values/v"].set(twice);
    field["values/w"].set(zero);
    const std::string fields[] = {"velocity"};
    const vog::Cells cells = conduit_mesh::cells_of(mesh, "rho", fields);
    expect_near("vector", cells.fields[0].component[1][4], 2 * 3);
    expect_near("mass with a vector", vog::mass(conduit_mesh::convert(mesh, "rho", fields, 100)),
                right);

    // Two domains of one level, and a finer one that hides an eighth of an element.
    Node domains;
    domains["a"] = box("uniform");
    domains["b"] = box("uniform");
    domains["b/coordsets/coords/origin/x"] = 3.0;
    expect_near("two domains", vog::mass(conduit_mesh::convert(domains, "rho", {}, 200)),
                2 * right);
    domains["b/coordsets/coords/origin/x"] = 1.0;
    for (const char* axis : {"dx", "dy", "dz"})
        domains["b/coordsets/coords/spacing"][axis] =
            0.5 * domains["b/coordsets/coords/spacing"][axis].to_float64();
    domains["b/fields/rho/values"].set(std::vector<double>(24, 8.0));
    // The finer box covers x of 1 to 2, half of y's three elements, and one of two layers: 2 x 1.5 x 1 elements of densities 1 and 2.
    expect_near("levels", vog::mass(conduit_mesh::convert(domains, "rho", {}, 400)),
                right - 1.5 * (1 + 2) + 24 * 8.0 / 8);
    expect_refusal("levels of several spacings", [&] {
        (void)conduit_mesh::convert(domains, "rho", std::vector<std::string>{"rho"}, 100);
    });

    expect_refusal("no field 'heat'", [&] { (void)conduit_mesh::convert(mesh, "heat", {}, 100); });
    Node other = box("hex");
    other["topologies/mesh/elements/shape"] = "polyhedral";
    expect_refusal("elements 'polyhedral'",
                   [&] { (void)conduit_mesh::convert(other, "rho", {}, 100); });
    expect_refusal("no domain", [&] { (void)conduit_mesh::convert(Node(), "rho", {}, 100); });
    std::printf("conduit: %d failures\n", failures);
    return failures > 0;
}
