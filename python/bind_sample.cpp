// bind_sample.cpp: volumes and particles from nothing.
#include <memory>

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
        "A cumulus, `size` voxels (64 to 1024) along its longest axis: a Volume.");
    define(
        m, "sample_explosion", [](const SampleOptions& o) { return sample_explosion(o); },
        "A fireball with a turbulent shell, `size` voxels (64 to 1024) across: a Volume.");
    define(
        m, "sample_levels",
        [](const SampleOptions& o) {
            return Levels{sample_levels(o), {}};
        },
        "A small universe on three nested levels; `size` counts the finest's cells: Levels.");
    m.def(
        "sample_particles",
        [](int size, std::uint32_t seed) {
            return std::make_shared<Points>(
                unlocked([&] { return sample_particles({.size = size, .seed = seed}); }));
        },
        py::arg("size") = ParticleSampleOptions{}.size,
        py::arg("seed") = ParticleSampleOptions{}.seed,
        "size^3 particles (size 8 to 512) of a box of a universe, with velocities: Points.");
}

}  // namespace vog::python
