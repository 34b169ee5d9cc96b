// bind_sample.cpp: procedural volumes and particles.
#include <memory>
#include <utility>
#include <vector>

#include "bindings.h"
#include "vog/levels.h"
#include "vog/sample.h"

namespace vog::python {

namespace {

template <class Make>
void define(py::module_& m, const char* name, const Make& make, const char* text) {
    m.def(
        name,
        [make](int size, std::uint32_t seed) {
            using Data = decltype(make(SampleOptions{}));
            return std::make_shared<Data>(
                unlocked([&] { return make({.size = size, .seed = seed}); }));
        },
        py::arg("size") = SampleOptions{}.size, py::arg("seed") = SampleOptions{}.seed, text);
}

}  // namespace

void bind_sample(py::module_& m) {
    define(
        m, "sample_cloud", [](const SampleOptions& o) { return sample_cloud(o); },
        "Procedural cumulus cloud as a Volume. size: voxels along its longest axis, 64 to 1024.");
    define(
        m, "sample_explosion", [](const SampleOptions& o) { return sample_explosion(o); },
        "Procedural fireball with a turbulent shell as a Volume. size: voxels across, 64 to 1024.");
    define(
        m, "sample_head", [](const SampleOptions& o) { return sample_head(o); },
        "Procedural CT of a head as a Volume, Hounsfield units + 1000, world units mm. size: "
        "voxels along an edge, 64 to 1024.");
    m.def(
        "sample_fire",
        [](int size, std::uint32_t seed) {
            std::vector<Volume> volumes =
                unlocked([&] { return sample_fire({.size = size, .seed = seed}); });
            return std::pair(std::make_shared<Volume>(std::move(volumes[0])),
                             std::make_shared<Volume>(std::move(volumes[1])));
        },
        py::arg("size") = SampleOptions{}.size, py::arg("seed") = SampleOptions{}.seed,
        "Procedural fireball as two Volumes of the same voxels, density and temperature in K. "
        "size: voxels across, 64 to 1024.");
    define(
        m, "sample_levels",
        [](const SampleOptions& o) {
            return Levels{sample_levels(o), {}};
        },
        "Procedural halos and filaments on three nested Levels. size: voxels along an edge of the "
        "finest level, 64 to 1024.");
    m.def(
        "sample_particles",
        [](int size, std::uint32_t seed) {
            return std::make_shared<Points>(
                unlocked([&] { return sample_particles({.size = size, .seed = seed}); }));
        },
        py::arg("size") = ParticleSampleOptions{}.size,
        py::arg("seed") = ParticleSampleOptions{}.seed,
        "Procedural box of a cosmological simulation as Points, size^3 particles with velocities. "
        "size: 8 to 512.");
}

}  // namespace vog::python
