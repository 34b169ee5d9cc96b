// surface_files.cpp: triangles as STL, PLY and OBJ.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <iterator>

#include "core/atomic_file.h"
#include "vog/error.h"
#include "vog/surface.h"

namespace vog {

namespace {

static_assert(std::endian::native == std::endian::little);  // as the files are

template <class Value>
void put(std::ofstream& out, const Value& value) {
    out.write(reinterpret_cast<const char*>(&value), sizeof value);
}
void put_point(std::ofstream& out, Vec3d p) { put(out, vec_cast<float>(p)); }

/// throws  vog::Error where 32-bit floats are too coarse for the triangles
void require_floats(const std::filesystem::path& file, const Surface& surface) {
    double largest = 0, edges = 0;
    for (const Vec3d& p : surface.point)
        largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    for (const auto& t : surface.triangle)
        edges += length(surface.point[t[1]] - surface.point[t[0]]);
    const double mean = edges / std::max<double>(1, static_cast<double>(surface.triangle.size()));
    const double step = largest * 0x1p-23;
    if (step > 0.01 * mean)
        throw Error(
            fmt::format("{}: points lie {:.2g} from 0, where 32-bit floats are {:.2g} apart; .obj "
                        "keeps their digits",
                        file.string(), largest, step));
}

void write_stl(std::ofstream& out, const Surface& surface) {
    std::array<char, 80> head{};
    std::string_view(surface.is_ras ? "vog isosurface. SPACE=RAS" : "vog isosurface")
        .copy(head.data(), head.size());
    put(out, head);
    put(out, static_cast<std::uint32_t>(surface.triangle.size()));
    for (const auto& t : surface.triangle) {
        const Vec3d a = surface.point[t[0]], b = surface.point[t[1]], c = surface.point[t[2]];
        const Vec3d normal = cross(b - a, c - a);
        put_point(out, length(normal) > 0 ? normalized(normal) : normal);
        for (const Vec3d corner : {a, b, c}) put_point(out, corner);
        put(out, std::uint16_t{0});
    }
}

void write_ply_faces(std::ofstream& out, const Surface& surface) {
    out << fmt::format(
        "ply\nformat binary_little_endian 1.0\n{}element vertex {}\nproperty float x\nproperty "
        "float "
        "y\nproperty float z\nelement face {}\nproperty list uchar uint vertex_indices\n"
        "end_header\n",
        surface.is_ras ? "comment SPACE=RAS\n" : "", surface.point.size(), surface.triangle.size());
    for (const Vec3d point : surface.point) put_point(out, point);
    for (const auto& triangle : surface.triangle) put(out, std::uint8_t{3}), put(out, triangle);
}

void write_obj(std::ofstream& out, const Surface& surface) {
    if (surface.is_ras) out << "# SPACE=RAS\n";
    const std::ostreambuf_iterator<char> to(out);
    for (const Vec3d p : surface.point) fmt::format_to(to, "v {} {} {}\n", p.x, p.y, p.z);
    for (const auto& t : surface.triangle)
        fmt::format_to(to, "f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
}

}  // namespace

void write_surface(const std::filesystem::path& file, const Surface& surface) {
    const std::string extension = file.extension().string();
    const auto write =
        extension == ".stl"   ? write_stl
        : extension == ".ply" ? write_ply_faces
        : extension == ".obj"
            ? write_obj
            : throw Error(fmt::format("{}: expected .stl, .ply or .obj", file.string()));
    if (extension != ".obj") require_floats(file, surface);
    write_file(file, [&](std::ofstream& out) { write(out, surface); });
}

}  // namespace vog
