// universe.cpp: synthetic cosmological particles: a lattice displaced along the gradient of a
// random field, with halos at its densest points.
// Source: Zel'dovich, "Gravitational instability" (1970): x = q + psi(q), v along psi; Hernquist,
// "An analytical model for spherical galaxies and bulges" (1990): M(r) = r^2 / (r + a)^2.
// Arithmetic and sqrt only: the same bits on every machine.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "core/parallel.h"
#include "sample/noise.h"
#include "vog/error.h"
#include "vog/points.h"
#include "vog/sample.h"

namespace vog {

using namespace sampling;

namespace {

constexpr double kBoxEdge = 100;         ///< world units, as Mpc/h
constexpr double kSpeed = 300;           ///< root mean square of the flow, as km/s
constexpr int kModes = 240;              ///< plane waves
constexpr int kShortestWave = 9;         ///< waves across the box
constexpr double kLinearContrast = 1.4;  ///< rms of the linear density; some paths have crossed
constexpr std::size_t kHalos = 120;

struct Complex {
    double re = 1, im = 0;
};
Complex operator*(Complex a, Complex b) {
    return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}

/// exp(2 pi i m / count) for m = 0 ... count - 1: m = 1 by its series, others by multiplication.
std::vector<Complex> roots_of_unity(int count) {
    const double angle = 2 * std::numbers::pi / count;
    Complex step{0, 0};
    double term = 1;
    for (int n = 0; n < 40; ++n) {
        (n & 1 ? step.im : step.re) += n & 2 ? -term : term;
        term *= angle / (n + 1);
    }
    std::vector<Complex> roots(static_cast<std::size_t>(count));
    for (std::size_t m = 1; m < roots.size(); ++m) roots[m] = roots[m - 1] * step;
    return roots;
}

/// Random point in the unit ball, or disk if flat.
Vec3d in_ball(Uniform& uniform, bool flat = false) {
    for (;;) {
        const double x = uniform(-1, 1), y = uniform(-1, 1);
        const Vec3d p{x, y, flat ? 0.0 : double{uniform(-1, 1)}};
        if (const double r2 = dot(p, p); r2 <= 1 && r2 > 1e-6) return p;
    }
}

/// Plane wave of the random field.
struct Mode {
    std::array<int, 3> wave{};  ///< number of waves along each axis of the box
    Complex phase;
    double contrast = 0;  ///< amplitude of the density
    Vec3d flow;           ///< amplitude of psi, lattice edges of 1
};

std::vector<Mode> random_modes(std::uint32_t seed) {
    Uniform uniform(seed);
    std::vector<Mode> modes;
    double variance = 0;
    while (modes.size() < kModes) {
        // Uniform numbers of waves; contrast grows with the fourth root of the wave number.
        const Vec3d direction = normalized(in_ball(uniform));
        const double u = uniform(), count = 1 + (kShortestWave - 1) * u;
        Mode mode;
        for (int axis = 0; axis < 3; ++axis)
            mode.wave[std::size_t(axis)] =
                static_cast<int>(std::floor(direction[axis] * count + 0.5));
        const Vec3d k = 2 * std::numbers::pi *
                        Vec3d{double(mode.wave[0]), double(mode.wave[1]), double(mode.wave[2])};
        if (dot(k, k) == 0) continue;
        const Vec3d phase = normalized(in_ball(uniform, true));
        mode.phase = {phase.x, phase.y};
        mode.contrast = std::sqrt(std::sqrt(length(k)));
        mode.flow = (mode.contrast / dot(k, k)) * k;
        variance += 0.5 * mode.contrast * mode.contrast;
        modes.push_back(mode);
    }
    const double scale = kLinearContrast / std::sqrt(variance);
    for (Mode& mode : modes) {
        mode.contrast *= scale;
        mode.flow = scale * mode.flow;
    }
    return modes;
}

/// Random field at a lattice point.
struct Flow {
    Vec3d psi;            ///< displacement, box edges of 1
    double contrast = 0;  ///< linear density
};
/// Random field: sum of the modes.
class FlowField {
  public:
    FlowField(int size, std::uint32_t seed)
        : size_(size), roots_(roots_of_unity(size)), modes_(random_modes(seed)) {}
    Flow at(int i, int j, int k) const {
        Flow flow;
        for (const Mode& mode : modes_) {
            const int turn = (mode.wave[0] * i + mode.wave[1] * j + mode.wave[2] * k) % size_;
            const Complex wave =
                mode.phase * roots_[static_cast<std::size_t>(turn < 0 ? turn + size_ : turn)];
            flow.psi = flow.psi + wave.im * mode.flow;
            flow.contrast -= wave.re * mode.contrast;
        }
        return flow;
    }

  private:
    int size_;
    std::vector<Complex> roots_;
    std::vector<Mode> modes_;
};

/// Ball of lattice points that has collapsed to a halo.
struct Halo {
    Vec3d from, to, velocity;  ///< centre before and after, box edges of 1
    double contrast = 0;
    double radius = 0;  ///< on the lattice, box edges of 1
};

double nearest_image(double d) { return d - std::floor(d + 0.5); }

/// Densest lattice point of each of 12^3 blocks, in order of falling density; at most kHalos.
std::vector<Halo> find_halos(const FlowField& field, int size) {
    const int blocks = std::min(size, 12);
    std::vector<Halo> halos(static_cast<std::size_t>(blocks * blocks * blocks));
    vog::parallel_for(std::size_t{0}, halos.size(), [&](std::size_t n) {
        const auto block = static_cast<int>(n);
        const std::array<int, 3> place{block / blocks / blocks, block / blocks % blocks,
                                       block % blocks};
        // 5^3 points per block suffice for any lattice.
        constexpr int kTries = 5;
        Halo& halo = halos[n];
        halo.contrast = -1e9;
        for (int t = 0; t < kTries * kTries * kTries; ++t) {
            const std::array<int, 3> part{t / kTries / kTries, t / kTries % kTries, t % kTries};
            std::array<int, 3> at{};
            for (std::size_t axis = 0; axis < 3; ++axis)
                at[axis] = (place[axis] * kTries + part[axis]) * size / (blocks * kTries);
            const Flow flow = field.at(at[0], at[1], at[2]);
            if (flow.contrast <= halo.contrast) continue;
            halo.contrast = flow.contrast;
            halo.from = (1.0 / size) * Vec3d{double(at[0]), double(at[1]), double(at[2])};
            halo.to = halo.from + flow.psi;
            halo.velocity = flow.psi;
        }
    });
    std::ranges::stable_sort(halos, std::ranges::greater(), &Halo::contrast);
    halos.resize(std::min(halos.size(), kHalos));
    for (std::size_t n = 0; n < halos.size(); ++n)
        halos[n].radius = 0.075 / std::sqrt(std::sqrt(1.0 + static_cast<double>(n)));
    return halos;
}

/// Particle before scaling to world units.
struct Placed {
    Vec3d position, velocity;  ///< box edges of 1; velocity as psi
};

/// Random particle of a halo by Hernquist's profile.
Placed in_halo(const Halo& halo, Uniform& uniform) {
    constexpr double kScaleShare = 0.06;  // scale length / radius on the lattice
    constexpr double kLargest = 0.8;      // sampled share of the mass: up to 8.5 scale lengths
    const double a = kScaleShare * halo.radius, root = std::sqrt(kLargest * uniform());
    const double r = a * root / (1 - root);
    // Isotropic velocity, bounded by that of a circular orbit.
    const double speed = 0.5 * halo.radius * std::sqrt(r * halo.radius) / (r + a);
    return {halo.to + r * normalized(in_ball(uniform)), halo.velocity + speed * in_ball(uniform)};
}

}  // namespace

Points sample_particles(const ParticleSampleOptions& options) {
    const int size = options.size;
    if (size < 8 || size > 512)
        throw Error(fmt::format("{} particles along an edge, expected 8 to 512", size));
    const FlowField field(size, options.seed);
    const std::vector<Halo> halos = find_halos(field, size);

    const auto rows = static_cast<std::size_t>(size) * static_cast<std::size_t>(size);
    std::vector<Placed> placed(rows * static_cast<std::size_t>(size));
    vog::parallel_for(std::size_t{0}, rows, [&](std::size_t row) {
        const int i = static_cast<int>(row) / size, j = static_cast<int>(row) % size;
        for (int k = 0; k < size; ++k) {
            const std::size_t n =
                row * static_cast<std::size_t>(size) + static_cast<std::size_t>(k);
            const Vec3d q = (1.0 / size) * Vec3d{double(i), double(j), double(k)};
            const auto around = [&](const Halo& halo) {
                const Vec3d d{nearest_image(q.x - halo.from.x), nearest_image(q.y - halo.from.y),
                              nearest_image(q.z - halo.from.z)};
                return dot(d, d) < halo.radius * halo.radius;
            };
            const auto halo = std::ranges::find_if(halos, around);
            if (halo != halos.end()) {
                Uniform uniform(mixed(static_cast<std::uint32_t>(n)) ^ options.seed);
                placed[n] = in_halo(*halo, uniform);
            } else {
                const Flow flow = field.at(i, j, k);
                placed[n] = {q + flow.psi, flow.psi};
            }
        }
    });
    if (options.progress) options.progress(1);

    double speed2 = 0;
    for (const Placed& p : placed) {
        check_interrupt();
        speed2 += dot(p.velocity, p.velocity);
    }
    const double to_speed = kSpeed / std::sqrt(speed2 / static_cast<double>(placed.size()));
    Points points;
    for (const Placed& p : placed) {
        check_interrupt();
        // Rounded to float, the precision of simulations' text files.
        Vec3f position;
        for (int axis = 0; axis < 3; ++axis)
            position[axis] =
                static_cast<float>(kBoxEdge * (p.position[axis] - std::floor(p.position[axis])));
        points.position.push_back(vec_cast<double>(position));
        points.velocity.push_back(vec_cast<float>(to_speed * p.velocity));
    }
    points.source = "particles";
    return points;
}

}  // namespace vog
