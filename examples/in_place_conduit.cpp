// in_place_conduit.cpp: a solver that publishes a mesh of Conduit, as for Ascent and Catalyst 2, to an adaptor that leaves a page of its steps:
// in_place_conduit [STEPS] [FOLDER]
#include <conduit.hpp>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "conduit/mesh.h"
#include "dye_solver.h"

namespace {

/// What Ascent's open, publish and close do with meshes, or Catalyst's initialize, execute and finalize.
class Adaptor {
  public:
    /// density  field that becomes Gaussians
    Adaptor(std::filesystem::path folder, std::string density, std::size_t budget)
        : folder_(std::move(folder)),
          density_(std::move(density)),
          budget_(budget),
          site_(folder_, vog::kPagePrecision) {}

    void execute(const conduit::Node& mesh) {
        vog::Gaussians model = conduit_mesh::convert(mesh, density_, {}, budget_);
        const conduit::Node* state = mesh.has_child("state") ? &mesh["state"] : nullptr;
        const std::string name = "cycle " + std::to_string(state ? (*state)["cycle"].to_int()
                                                                 : static_cast<int>(pages_.size()));
        vog::Hierarchy hierarchy;
        pages_.push_back(vog::prepare_for_site(name, model, hierarchy));
        site_.add(name, model, hierarchy);
    }

    void finalize() {
        site_.finish(true);
        vog::write_site_page(folder_, pages_, {.title = density_, .steps = true});
    }

  private:
    std::filesystem::path folder_;
    std::string density_;
    std::size_t budget_;
    vog::SiteWriter site_;
    std::vector<vog::HtmlModel> pages_;
};

}  // namespace

int main(int argc, char** argv) try {
    const int steps = argc > 1 ? std::atoi(argv[1]) : 4;
    const std::string folder = argc > 2 ? argv[2] : "dye";
    DyeSolver solver;
    Adaptor adaptor(folder, "dye", 2000);
    for (int step = 0; step < steps; ++step) {
        for (int part = 0; part < 5; ++part) solver.advance();
        conduit::Node mesh;
        mesh["state/cycle"] = step;
        mesh["coordsets/coords/type"] = "uniform";
        for (const char* axis : {"i", "j", "k"})
            mesh["coordsets/coords/dims"][axis] = DyeSolver::kEdge + 1;  // vertices
        for (const char* axis : {"dx", "dy", "dz"})
            mesh["coordsets/coords/spacing"][axis] = 1.0 / DyeSolver::kEdge;
        mesh["topologies/mesh/type"] = "uniform";
        mesh["topologies/mesh/coordset"] = "coords";
        mesh["fields/dye/association"] = "element";
        mesh["fields/dye/topology"] = "mesh";
        // The solver's own array: nothing is copied.
        mesh["fields/dye/values"].set_external(
            const_cast<float*>(solver.density()),
            conduit::index_t{DyeSolver::kEdge} * DyeSolver::kEdge * DyeSolver::kEdge);
        adaptor.execute(mesh);
    }
    adaptor.finalize();
    std::printf("%s: %d steps\n", folder.c_str(), steps);
} catch (const std::exception& error) {
    std::fprintf(stderr, "in_place_conduit: %s\n", error.what());
    return 1;
}
