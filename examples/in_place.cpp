// in_place.cpp: a solver that hands its arrays to vog as it runs, and leaves a page that plays its steps: in_place [STEPS] [FOLDER]
//
// The solver owns one dense array. A block is a view of it: voxels go from there into a sparse volume, without a dense copy between.
#include <vog/vog.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

#include "dye_solver.h"

namespace {

double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace

int main(int argc, char** argv) try {
    const int steps = argc > 1 ? std::atoi(argv[1]) : 4;
    const std::string folder = argc > 2 ? argv[2] : "dye";
    DyeSolver solver;
    // The array, and the strides to the next voxel along x, y and z.
    const vog::DenseBlock block{
        .value = solver.density(),
        .size = {DyeSolver::kEdge, DyeSolver::kEdge, DyeSolver::kEdge},
        .stride = {1, DyeSolver::kEdge, DyeSolver::kEdge * DyeSolver::kEdge}};
    const vog::Affine world_from_index =
        vog::affine_from_voxels((1.0 / DyeSolver::kEdge) * vog::Vec3d{1, 1, 1});

    vog::SiteWriter site(folder, vog::kPagePrecision);
    std::vector<vog::HtmlModel> pages;
    for (int step = 0; step < steps; ++step) {
        const double start = now_s();
        for (int part = 0; part < 5; ++part) solver.advance();
        vog::DenseBlock here = block;
        here.value = solver.density();
        const double solved = now_s();

        const vog::Volume volume = vog::volume_from_dense({&here, 1}, world_from_index, "dye");
        vog::Gaussians model = vog::convert_moments(volume, {.budget = 2000, .own_field = "dye"});
        const std::string name = "step " + std::to_string(step);
        vog::Hierarchy hierarchy;
        pages.push_back(vog::prepare_for_site(name, model, hierarchy));
        site.add(name, model, hierarchy);
        std::printf("%s: solver %.0f ms, vog %.0f ms, %zu Gaussians of %d cells\n", name.c_str(),
                    1e3 * (solved - start), 1e3 * (now_s() - solved), model.size(),
                    DyeSolver::kEdge * DyeSolver::kEdge * DyeSolver::kEdge);
    }
    const vog::SiteReport report = site.finish(true);
    vog::write_site_page(folder, pages, {.title = "A drop of dye", .steps = true});
    std::printf("%s: %d steps in %llu bytes, %.1f kB a step\n", folder.c_str(), steps,
                static_cast<unsigned long long>(report.bytes),
                1e-3 * static_cast<double>(report.bytes) / steps);
} catch (const std::exception& error) {
    std::fprintf(stderr, "in_place: %s\n", error.what());
    return 1;
}
