// dye_solver.h: a small solver, for the examples that call vog as it runs.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

/// A drop of dye in a vortex: advection and a little diffusion on a lattice of N^3 cells, x fastest, as Fortran's arrays.
class DyeSolver {
  public:
    static constexpr int kEdge = 64;

    DyeSolver() : density_(std::size_t{kEdge} * kEdge * kEdge) {
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
