// vdb_transform.cpp: bytes of the seven map types of openvdb/math/Maps.h.
#include "io/vdb/vdb_transform.h"

#include <fmt/core.h>

#include <array>

namespace vog::vdb {

namespace {

using Matrix4 = std::array<double, 16>;  // row by row, for row vectors: world = index * matrix

// Derived numbers behind the scale s of a scale map: |s|, 1/s, 1/s^2, 1/(2s).
constexpr std::uint64_t kDerivedBytes = 4 * sizeof(Vec3d);

Vec3d read_vector(ByteSource& in) {
    const auto v = in.number<std::array<double, 3>>();
    return {v[0], v[1], v[2]};
}

Affine scale_translate(Vec3d scale, Vec3d translation) {
    return {{{Vec3d{scale.x, 0, 0}, Vec3d{0, scale.y, 0}, Vec3d{0, 0, scale.z}}}, translation};
}

std::optional<Affine> affine_from_matrix(const Matrix4& m) {
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) return std::nullopt;  // perspective
    Affine affine;
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) affine.linear(r, c) = m[static_cast<std::size_t>(4 * c + r)];
    affine.translation = {m[12], m[13], m[14]};
    return affine;
}

std::optional<Affine> read_map(const std::string& type, ByteSource& in) {
    if (type == "AffineMap" || type == "UnitaryMap")
        return affine_from_matrix(in.number<Matrix4>());
    if (type == "TranslationMap") return scale_translate({1, 1, 1}, read_vector(in));
    if (type == "ScaleMap" || type == "UniformScaleMap") {
        const Vec3d scale = read_vector(in);
        in.take(kDerivedBytes);
        return scale_translate(scale, {});
    }
    if (type == "ScaleTranslateMap" || type == "UniformScaleTranslateMap") {
        const Vec3d translation = read_vector(in);
        const Vec3d scale = read_vector(in);
        in.take(kDerivedBytes);
        return scale_translate(scale, translation);
    }
    if (type == "NonlinearFrustumMap") {
        in.take(2 * sizeof(Vec3d) + 2 * sizeof(double));  // box, taper, depth
        const std::string second = in.string();
        if (second == type) in.fail("corrupt: a frustum transform inside a frustum transform");
        read_map(second, in);
        return std::nullopt;
    }
    in.fail("corrupt: unknown kind of transform");
}

template <class T>
void append(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

void append_name(std::string& bytes, const std::string& name) {
    append(bytes, static_cast<std::uint32_t>(name.size()));
    bytes += name;
}

}  // namespace

std::optional<Affine> read_transform(ByteSource& in) { return read_map(in.string(), in); }

std::string transform_bytes(const Affine& world_from_index) {
    const auto& [m, t] = world_from_index;
    std::string bytes;

    const Vec3d s{m(0, 0), m(1, 1), m(2, 2)};
    if (m == scale_translate(s, {}).linear) {
        const bool uniform = s.x == s.y && s.x == s.z;
        append_name(bytes, uniform ? "UniformScaleTranslateMap" : "ScaleTranslateMap");
        append(bytes, t);
        append(bytes, s);
        append(bytes, Vec3d{std::abs(s.x), std::abs(s.y), std::abs(s.z)});
        const Vec3d inverse{1 / s.x, 1 / s.y, 1 / s.z};
        append(bytes, inverse);
        append(bytes, Vec3d{inverse.x * inverse.x, inverse.y * inverse.y, inverse.z * inverse.z});
        append(bytes, 0.5 * inverse);
        return bytes;
    }
    append_name(bytes, "AffineMap");
    append(bytes, Matrix4{m(0, 0), m(1, 0), m(2, 0), 0, m(0, 1), m(1, 1), m(2, 1), 0,  //
                          m(0, 2), m(1, 2), m(2, 2), 0, t.x, t.y, t.z, 1});
    return bytes;
}

}  // namespace vog::vdb
