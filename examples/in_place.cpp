// in_place.cpp: a solver that hands its arrays to vog as it runs, and leaves a page that plays its steps: in_place [STEPS] [FOLDER]
//
// The solver owns one dense array. A block is a view of it: voxels go from there into a sparse volume, without a dense copy between.
#include <vog/vog.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <vector>

namespace {

/// A drop of dye in a vortex: advection and a little diffusion on a lattice of N^3 cells, x fastest, as Fortran's arrays.
class Solver {
  public:
    static constexpr int kEdge = 64;

    Solver() : density_(std::size_t{kEdge} * kEdge * kEdge) {
        each([&](int x, int y, int z, std::size_t n) {
            const double dx = x - 20.0, dy = y - 32.0, dz = z - 32.0;
            density_[n] = static_cast<float>(std::exp(-(dx * dx + dy * dy + dz * dz) / 60));
        });
    }
    const float* density() const { return density_.data(); }

    void advance() {
        std::vector<float> next(density_.size());
        each([&](int x, int y, int z, std::size_t n) {
            // Backwards along a vortex about the middle, which is faster inside.
            const double rx = x - 31.5, ry = y - 31.5, r = std::hypot(rx, ry);
            const double angle = 0.12 / (1 + 0.05 * r);
            const double from_x = 31.5 + std::cos(angle) * rx + std::sin(angle) * ry;
            const double from_y = 31.5 - std::sin(angle) * rx + std::cos(angle) * ry;
            const float moved = at(from_x, from_y, z);
            const float around = (value(x, y, z - 1) + value(x, y, z + 1)) / 2;
            next[n] = 0.98f * moved + 0.02f * around;
            if (next[n] < 1e-4f) next[n] = 0;  // empty space costs nothing
        });
        density_ = std::move(next);
    }

  private:
    template <class Visit>
    void each(const Visit& visit) const {
        std::size_t n = 0;
        for (int z = 0; z < kEdge; ++z)
            for (int y = 0; y < kEdge; ++y)
                for (int x = 0; x < kEdge; ++x) visit(x, y, z, n++);
    }
    float value(int x, int y, int z) const {
        const bool inside = std::min({x, y, z}) >= 0 && std::max({x, y, z}) < kEdge;
        return inside ? density_[static_cast<std::size_t>((z * kEdge + y) * kEdge + x)] : 0;
    }
    float at(double x, double y, int z) const {
        const int i = static_cast<int>(std::floor(x)), j = static_cast<int>(std::floor(y));
        const auto u = static_cast<float>(x - i), v = static_cast<float>(y - j);
        return (1 - v) * ((1 - u) * value(i, j, z) + u * value(i + 1, j, z)) +
               v * ((1 - u) * value(i, j + 1, z) + u * value(i + 1, j + 1, z));
    }

    std::vector<float> density_;
};

double now_s() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

}  // namespace

int main(int argc, char** argv) try {
    const int steps = argc > 1 ? std::atoi(argv[1]) : 4;
    const std::string folder = argc > 2 ? argv[2] : "dye";
    Solver solver;
    // The array, and the strides to the next voxel along x, y and z.
    const vog::DenseBlock block{.value = solver.density(),
                                .size = {Solver::kEdge, Solver::kEdge, Solver::kEdge},
                                .stride = {1, Solver::kEdge, Solver::kEdge * Solver::kEdge}};
    const vog::Affine world_from_index =
        vog::affine_from_voxels((1.0 / Solver::kEdge) * vog::Vec3d{1, 1, 1});

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
                    Solver::kEdge * Solver::kEdge * Solver::kEdge);
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
