// glb.cpp: binary glTF 2.0 with KHR_gaussian_splatting: points with rotations x y z w, linear scales and opacities. COLOR_0 is
// for viewers without the extension, which draw points: linear red, green, blue, and the opacity.
// Source: github.com/KhronosGroup/glTF, extensions/2.0/Khronos/KHR_gaussian_splatting/README.md.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "io/exchange/splat_files.h"
#include "io/exchange/splat_frame.h"

namespace vog::exchange {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint32_t kMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
constexpr int kUnsignedByte = 5121, kFloat = 5126, kVertices = 34962;

/// Bytes of COLOR_0, which is linear where splats are sRGB as displayed (IEC 61966-2-1).
std::array<std::uint8_t, 4> fallback_color(Vec3f color, float opacity) {
    std::array<std::uint8_t, 4> bytes{};
    for (int k = 0; k < 4; ++k) {
        const float c = k < 3 ? std::clamp(color[k], 0.0f, 1.0f) : opacity;
        const float linear = k == 3          ? c
                             : c <= 0.04045f ? c / 12.92f
                                             : std::pow((c + 0.055f) / 1.055f, 2.4f);
        bytes[static_cast<std::size_t>(k)] = static_cast<std::uint8_t>(std::lround(255 * linear));
    }
    return bytes;
}

}  // namespace

void write_glb(std::ofstream& out, const Splats& splats, const std::string& frame) {
    const std::size_t count = splats.size();
    std::string body;
    Json accessors = Json::array(), views = Json::array(), attributes;
    const auto add = [&](const std::string& name, const char* type, const auto& values,
                         int component = kFloat) {
        const std::size_t bytes = values.size() * sizeof(values.front());
        attributes[name] = accessors.size();
        accessors.push_back({{"bufferView", views.size()},
                             {"componentType", component},
                             {"count", count},
                             {"type", type}});
        if (component != kFloat) accessors.back()["normalized"] = true;
        views.push_back({{"buffer", 0},
                         {"byteOffset", body.size()},
                         {"byteLength", bytes},
                         {"target", kVertices}});
        body.append(reinterpret_cast<const char*>(values.data()), bytes);
    };
    add("POSITION", "VEC3", splats.mean);
    Vec3f lower = splats.mean.front(), upper = lower;
    for (const Vec3f m : splats.mean)
        for (int axis = 0; axis < 3; ++axis) {
            lower[axis] = std::min(lower[axis], m[axis]);
            upper[axis] = std::max(upper[axis], m[axis]);
        }
    accessors[0]["min"] = {lower.x, lower.y, lower.z};
    accessors[0]["max"] = {upper.x, upper.y, upper.z};
    std::vector<std::array<float, 4>> rotation;
    for (const Quat q : splats.rotation) rotation.push_back({q.x, q.y, q.z, q.w});
    add("KHR_gaussian_splatting:ROTATION", "VEC4", rotation);
    add("KHR_gaussian_splatting:SCALE", "VEC3", splats.scale);
    add("KHR_gaussian_splatting:OPACITY", "SCALAR", splats.opacity);
    std::vector<Vec3f> dc;
    for (const Vec3f color : splats.color) dc.push_back(harmonics(color));
    add("KHR_gaussian_splatting:SH_DEGREE_0_COEF_0", "VEC3", dc);
    std::vector<std::array<std::uint8_t, 4>> points;
    for (std::size_t i = 0; i < count; ++i)
        points.push_back(fallback_color(splats.color[i], splats.opacity[i]));
    add("COLOR_0", "VEC4", points, kUnsignedByte);

    const Json primitive = {{"mode", 0},
                            {"attributes", attributes},
                            {"extensions",
                             {{"KHR_gaussian_splatting",
                               {{"kernel", "ellipse"}, {"colorSpace", "srgb_rec709_display"}}}}}};
    const Json json = {{"asset", {{"version", "2.0"}, {"generator", "vog"}}},
                       {"extensionsUsed", {"KHR_gaussian_splatting"}},
                       {"scene", 0},
                       {"scenes", {{{"nodes", {0}}, {"extras", {{kFrameKey, frame}}}}}},
                       {"nodes", {{{"mesh", 0}}}},
                       {"meshes", {{{"primitives", {primitive}}}}},
                       {"accessors", accessors},
                       {"bufferViews", views},
                       {"buffers", {{{"byteLength", body.size()}}}}};
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    const auto put = [&](std::size_t value) {
        const auto word = static_cast<std::uint32_t>(value);
        out.write(reinterpret_cast<const char*>(&word), sizeof word);
    };
    constexpr std::size_t kHeader = 12, kChunkHeader = 8;
    put(kMagic), put(2), put(kHeader + kChunkHeader + text.size() + kChunkHeader + body.size());
    put(text.size()), put(kJsonChunk);
    out << text;
    put(body.size()), put(kBinaryChunk);
    out << body;
}

}  // namespace vog::exchange
