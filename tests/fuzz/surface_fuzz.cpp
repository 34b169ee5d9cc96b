// surface_fuzz.cpp: Readers of triangles, STL, OBJ and PLY, by the extension that the first byte chooses; what is read is hit by rays,
// written and read again.
#include <array>
#include <cmath>
#include <memory>

#include "fuzz_target.h"
#include "render/layers/surface_rays.h"
#include "vog/surface.h"

namespace vog::fuzz {

const Limits kLimits{};

namespace {

constexpr std::array<const char*, 3> kExtensions{".stl", ".obj", ".ply"};

void expect_whole(const Surface& surface) {
    expect(!surface.triangle.empty(), "a surface that is read has triangles");
    expect(surface.color.empty() || surface.color.size() == surface.point.size(),
           "every point has a colour, or none has");
    for (const auto& triangle : surface.triangle)
        for (const std::uint32_t corner : triangle) {
            expect(corner < surface.point.size(), "a triangle has points that are there");
            const Vec3d p = surface.point[corner];
            expect(std::isfinite(p.x + p.y + p.z), "a triangle has finite points");
        }
}

}  // namespace

void run(Bytes input) {
    if (input.empty()) return;
    const std::filesystem::path file =
        input_file(input.subspan(1), kExtensions[input[0] % kExtensions.size()]);
    accepted([&] { (void)is_surface_file(file); });
    Surface surface;
    std::vector<std::string> notes;
    if (!accepted([&] { surface = read_surface(file, &notes); })) return;
    expect_whole(surface);
    const Vec3d first = surface.point[surface.triangle.front()[0]];
    std::unique_ptr<layers::SurfaceBvh> rays;
    if (accepted([&] {
            rays = std::make_unique<layers::SurfaceBvh>(std::make_shared<const Surface>(surface));
        })) {
        const auto hit = rays->hit(first - Vec3d{0.1, 0.2, 3}, {0.1, 0.2, 3}, {});
        expect(!hit || std::isfinite(hit->t), "a hit is at a finite place");
    }
    for (const char* extension : kExtensions) {
        const std::filesystem::path again = scratch_file(std::string("again") + extension);
        Surface back;
        // Points beyond the range of floats are not written, and triangles of points that floats do not tell apart are left out.
        if (accepted([&] { write_surface(again, surface); }) &&
            accepted([&] { back = read_surface(again); })) {
            expect_whole(back);
            expect(back.triangle.size() <= surface.triangle.size(), "no triangle is added");
        }
    }
}

}  // namespace vog::fuzz
