// usda_write.cpp: OpenUSD as text, schema ParticleField3DGaussianSplat of 26.x.
#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "io/exchange/splat_density.h"
#include "io/exchange/splat_files.h"
#include "io/exchange/usd/usd_prims.h"

namespace vog::exchange {

namespace {

/// `TYPE NAME = [a, b, ...]`, an element a line of text from one(i).
template <class One>
void put_array(std::ofstream& out, const char* name, std::size_t count, const One& one) {
    std::string text = fmt::format("    {} = [", name);
    for (std::size_t i = 0; i < count; ++i) {
        if (i > 0) text += ", ";
        one(std::back_inserter(text), i);
    }
    out << text << "]\n";
}

/// Box of balls of 3 of the largest standard deviation around splats.
Box splat_extent(const Splats& splats) {
    Box box;
    for (std::size_t i = 0; i < splats.size(); ++i) {
        const Vec3f s = splats.scale[i];
        const double reach = double{kSplatCutoff} * std::max({s.x, s.y, s.z});
        const Vec3d m = vec_cast<double>(splats.mean[i]);
        box.include(m - Vec3d{reach, reach, reach});
        box.include(m + Vec3d{reach, reach, reach});
    }
    return box;
}

}  // namespace

void write_usda(std::ofstream& out, const Splats& splats, const std::string& frame) {
    const std::size_t count = splats.size();
    const Box box = splat_extent(splats);
    out << "#usda 1.0\n(\n    defaultPrim = \"Splats\"\n    metersPerUnit = 1\n    upAxis = "
           "\"Y\"\n)\n\n"
        << "def ParticleField3DGaussianSplat \"Splats\"\n{\n";
    out << fmt::format("    float3[] extent = [({}, {}, {}), ({}, {}, {})]\n", box.lower.x,
                       box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z);
    const auto vectors = [](const std::vector<Vec3f>& values) {
        return [&values](auto to, std::size_t i) {
            fmt::format_to(to, "({}, {}, {})", values[i].x, values[i].y, values[i].z);
        };
    };
    put_array(out, "point3f[] positions", count, vectors(splats.mean));
    put_array(out, "quatf[] orientations", count, [&](auto to, std::size_t i) {
        const Quat q = splats.rotation[i];
        fmt::format_to(to, "({}, {}, {}, {})", q.w, q.x, q.y, q.z);
    });
    put_array(out, "float3[] scales", count, vectors(splats.scale));
    put_array(out, "float[] opacities", count,
              [&](auto to, std::size_t i) { fmt::format_to(to, "{}", splats.opacity[i]); });
    std::vector<Vec3f> dc;
    for (const Vec3f color : splats.color) dc.push_back(harmonics(color));
    out << "    uniform int radiance:sphericalHarmonicsDegree = 0\n";
    put_array(out, "float3[] radiance:sphericalHarmonicsCoefficients", count, vectors(dc));
    out << fmt::format("    custom uniform token {} = \"{}\"\n}}\n", usd::kFrameAttribute, frame);
}

}  // namespace vog::exchange
