// glb_read.cpp: Gaussians of binary glTF 2.0: primitives of KHR_gaussian_splatting, placed by their nodes.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "io/byte_source.h"
#include "io/exchange/splat_density.h"
#include "io/exchange/splat_frame.h"
#include "io/exchange/splat_models.h"
#include "vog/error.h"

namespace vog::exchange {

namespace {

using Json = nlohmann::json;

constexpr const char* kExtension = "KHR_gaussian_splatting";

/// Whether what a file requires may change its splats: it does unless it is about surfaces, lights or notes, or read here.
bool changes_splats(const std::string& extension) {
    if (extension == kExtension || extension == "KHR_mesh_quantization") return false;
    static constexpr const char* kOthers[] = {"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                              "KHR_lights_",    "EXT_lights_",  "KHR_xmp"};
    return std::ranges::none_of(kOthers, [&](const char* of) { return extension.starts_with(of); });
}

/// Where a node puts its splats: factor * (rotation of p) + translation.
struct Placement {
    Vec3d translation{0, 0, 0};
    Quat rotation{};
    double factor = 1;
};

Vec3d turned(Quat q, Vec3d v) { return matrix_from_quat(q) * v; }

Placement placement_of(const Json& node, const Placement& parent) {
    if (node.contains("matrix"))
        throw Error("a node with a matrix, expected a translation, a rotation and one scale");
    Placement own;
    if (node.contains("translation")) {
        const auto t = node["translation"].get<std::array<double, 3>>();
        own.translation = {t[0], t[1], t[2]};
    }
    if (node.contains("rotation")) {
        const auto r = node["rotation"].get<std::array<float, 4>>();
        own.rotation = {r[3], r[0], r[1], r[2]};
    }
    if (node.contains("scale")) {
        const auto s = node["scale"].get<std::array<double, 3>>();
        if (!(s[0] > 0) || std::abs(s[1] / s[0] - 1) > 1e-6 || std::abs(s[2] / s[0] - 1) > 1e-6)
            throw Error(fmt::format("a node scaled by {}, {}, {}, expected one factor above 0",
                                    s[0], s[1], s[2]));
        own.factor = s[0];
    }
    return {parent.translation + parent.factor * turned(parent.rotation, own.translation),
            product_of(parent.rotation, own.rotation), parent.factor * own.factor};
}

/// Numbers of an accessor, as floats.
class Accessors {
  public:
    Accessors(const Json& gltf, std::span<const char> body) : gltf_(gltf), body_(body) {}

    std::size_t bytes() const { return body_.size(); }
    /// Numbers of an attribute in rows of `width`.
    std::vector<float> of(const Json& attributes, const std::string& name,
                          std::size_t width) const {
        if (!attributes.contains(name)) throw Error(fmt::format("splats without {}", name));
        const Json& accessor = gltf_.at("accessors").at(attributes[name].get<std::size_t>());
        if (accessor.contains("sparse") || !accessor.contains("bufferView"))
            throw Error(fmt::format("{}: a sparse accessor, expected a whole one", name));
        const Json& view = gltf_.at("bufferViews").at(accessor["bufferView"].get<std::size_t>());
        if (view.at("buffer").get<std::size_t>() != 0 || gltf_.at("buffers").at(0).contains("uri"))
            throw Error("a buffer in another file, expected a .glb with its data inside");
        const auto type = accessor.at("componentType").get<int>();
        const std::size_t bytes = size_of(type, name);
        const bool is_width = accessor.at("type") == (width == 1   ? "SCALAR"
                                                      : width == 3 ? "VEC3"
                                                                   : "VEC4");
        if (!is_width) throw Error(fmt::format("{} of the type {}", name, accessor["type"].dump()));
        const auto count = accessor.at("count").get<std::size_t>();
        const auto stride = view.value("byteStride", width * bytes);
        const auto begin =
            view.value("byteOffset", std::size_t{0}) + accessor.value("byteOffset", std::size_t{0});
        // Each number alone is below the body's size, so that their sums do not wrap around.
        const std::size_t size = body_.size();
        if (count == 0) return {};
        if (stride < width * bytes || stride > size || begin > size || count > size / stride + 1 ||
            begin + (count - 1) * stride + width * bytes > size)
            throw Error(fmt::format("{}: {} rows of {} bytes from {} on, in {} bytes", name, count,
                                    stride, begin, size));
        // Places of KHR_mesh_quantization may be whole numbers, which nodes scale.
        const bool is_share = name != "POSITION" || accessor.value("normalized", false);
        std::vector<float> out(count * width);
        for (std::size_t n = 0; n < count; ++n)
            for (std::size_t k = 0; k < width; ++k)
                out[n * width + k] =
                    number(body_.data() + begin + n * stride + k * bytes, type, is_share);
        return out;
    }

  private:
    enum Component { int8 = 5120, uint8, int16, uint16, float32 = 5126 };

    static std::size_t size_of(int type, const std::string& name) {
        switch (type) {
            case int8:
            case uint8:
                return 1;
            case int16:
            case uint16:
                return 2;
            case float32:
                return 4;
            default:
                throw Error(fmt::format(
                    "{}: component type {}, expected floats or normalized integers of 8 or 16 bits",
                    name, type));
        }
    }
    /// A whole number, or its share of the type's largest.
    template <class T>
    static float whole(const char* at, bool is_share) {
        T value{};
        std::memcpy(&value, at, sizeof value);
        if (!is_share) return static_cast<float>(value);
        return std::max(
            -1.0f, static_cast<float>(value) / static_cast<float>(std::numeric_limits<T>::max()));
    }
    static float number(const char* at, int type, bool is_share) {
        switch (type) {
            case int8:
                return whole<std::int8_t>(at, is_share);
            case uint8:
                return whole<std::uint8_t>(at, is_share);
            case int16:
                return whole<std::int16_t>(at, is_share);
            case uint16:
                return whole<std::uint16_t>(at, is_share);
            default:
                float value = 0;
                std::memcpy(&value, at, sizeof value);
                return value;
        }
    }
    const Json& gltf_;
    std::span<const char> body_;
};

/// Appends the splats of a primitive.
void add_primitive(const Json& primitive, const Accessors& accessors, const Placement& placement,
                   Gaussians& model) {
    const Json& attributes = primitive.at("attributes");
    const std::string prefix = std::string(kExtension) + ":";
    const std::vector<float> mean = accessors.of(attributes, "POSITION", 3),
                             rotation = accessors.of(attributes, prefix + "ROTATION", 4),
                             scale = accessors.of(attributes, prefix + "SCALE", 3),
                             opacity = accessors.of(attributes, prefix + "OPACITY", 1);
    const std::size_t count = opacity.size();
    if (mean.size() != 3 * count || rotation.size() != 4 * count || scale.size() != 3 * count)
        throw Error(fmt::format("{} opacities of {} splats", count, mean.size() / 3));
    // Three floats and eight numbers of a byte at least: splats that share bytes would take memory without end.
    constexpr std::size_t kLeastBytes = 20;
    if ((model.size() + count) * kLeastBytes > accessors.bytes())
        throw Error(fmt::format("{} splats in {} bytes", model.size() + count, accessors.bytes()));
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d p{mean[3 * i], mean[3 * i + 1], mean[3 * i + 2]};
        model.mean.push_back(vec_cast<float>(placement.translation +
                                             placement.factor * turned(placement.rotation, p)));
        const Quat q{rotation[4 * i + 3], rotation[4 * i], rotation[4 * i + 1],
                     rotation[4 * i + 2]};
        model.rotation.push_back(product_of(placement.rotation, q));
        model.scale.push_back(static_cast<float>(placement.factor) *
                              Vec3f{scale[3 * i], scale[3 * i + 1], scale[3 * i + 2]});
        if (opacity[i] < 0 || opacity[i] > 1)
            throw Error(fmt::format("opacity {} of splat {}, expected 0 to 1", opacity[i], i));
        model.density.push_back(splat_density(double{opacity[i]}, model.scale.back()));
    }
}

/// Appends the splats of a node and of those below it.
/// above  nodes above it
void add_node(const Json& gltf, std::size_t index, const Placement& parent, int above,
              std::vector<bool>& seen, const Accessors& accessors, Gaussians& model) {
    constexpr int kMostAbove = 64;
    if (above > kMostAbove || seen.at(index))
        throw Error(fmt::format("node {} below two others or itself, or below {} and more", index,
                                kMostAbove));
    seen[index] = true;
    const Json& node = gltf.at("nodes").at(index);
    const Placement placement = placement_of(node, parent);
    if (node.contains("mesh"))
        for (const Json& primitive :
             gltf.at("meshes").at(node["mesh"].get<std::size_t>()).at("primitives")) {
            const Json extensions = primitive.value("extensions", Json::object());
            if (!extensions.contains(kExtension)) continue;
            const Json packing = extensions[kExtension].value("extensions", Json::object());
            if (!packing.empty())
                throw Error(fmt::format("splats packed by {}, expected plain ones",
                                        packing.items().begin().key()));
            add_primitive(primitive, accessors, placement, model);
        }
    for (const Json& child : node.value("children", Json::array()))
        add_node(gltf, child.get<std::size_t>(), placement, above + 1, seen, accessors, model);
}

/// Root nodes of the scene, the first where none is chosen; without scenes, nodes that are no children.
std::vector<std::size_t> roots_of(const Json& gltf) {
    const Json scenes = gltf.value("scenes", Json::array());
    if (!scenes.empty())
        return scenes.at(gltf.value("scene", std::size_t{0}))
            .value("nodes", std::vector<std::size_t>{});
    const Json& nodes = gltf.at("nodes");
    std::vector<bool> is_child(nodes.size());
    for (const Json& node : nodes)
        for (const Json& child : node.value("children", Json::array()))
            is_child.at(child.get<std::size_t>()) = true;
    std::vector<std::size_t> roots;
    for (std::size_t n = 0; n < is_child.size(); ++n)
        if (!is_child[n]) roots.push_back(n);
    return roots;
}

}  // namespace

Gaussians read_glb(const std::filesystem::path& file) {
    FileBytes in(file);
    constexpr std::uint32_t kMagic = 0x46546c67, kJsonChunk = 0x4e4f534a, kBinaryChunk = 0x004e4942;
    constexpr std::uint64_t kHeader = 12, kChunkHeader = 8;
    if (in.size() < kHeader + kChunkHeader || in.number<std::uint32_t>() != kMagic)
        in.fail("not a binary glTF file (.glb)");
    if (const auto version = in.number<std::uint32_t>(); version != 2)
        in.fail(fmt::format("glTF of version {}, expected 2", version));
    if (const auto bytes = in.number<std::uint32_t>(); bytes != in.size())
        in.fail(fmt::format("{} bytes, expected {}: {}", in.size(), bytes,
                            in.size() < bytes ? "truncated" : "too long"));
    const auto json_bytes = in.number<std::uint32_t>();
    if (in.number<std::uint32_t>() != kJsonChunk) in.fail("corrupt: no JSON chunk");
    const std::string text(in.take(json_bytes), json_bytes);
    BigVector<char> body;
    if (!in.at_end()) {
        const auto body_bytes = in.number<std::uint32_t>();
        if (in.number<std::uint32_t>() != kBinaryChunk) in.fail("corrupt: no binary chunk");
        const char* bytes = in.take(body_bytes);
        body.assign(bytes, bytes + body_bytes);
    }
    Gaussians model;
    try {
        const Json gltf = Json::parse(text);
        for (const Json& needed : gltf.value("extensionsRequired", Json::array()))
            if (changes_splats(needed.get<std::string>()))
                throw Error(fmt::format("needs the extension {}, expected a file without it",
                                        needed.dump()));
        const Accessors accessors(gltf, {body.data(), body.size()});
        std::vector<bool> seen(gltf.at("nodes").size());
        for (const std::size_t node : roots_of(gltf))
            add_node(gltf, node, {}, 0, seen, accessors, model);
        const Json::json_pointer frame(
            fmt::format("/scenes/{}/extras/{}", gltf.value("scene", std::size_t{0}), kFrameKey));
        if (gltf.contains(frame)) restore_frame(model, gltf[frame].get<std::string>(), Upright::y);
    } catch (const std::out_of_range& error) {
        throw Error(fmt::format("{}: corrupt: a node that is not there", file.string()));
    } catch (const Json::exception& error) {
        throw Error(fmt::format("{}: corrupt: {}", file.string(), error.what()));
    } catch (const Error& error) {
        throw Error(fmt::format("{}: {}", file.string(), error.what()));
    }
    if (model.size() == 0)
        throw Error(
            fmt::format("{}: no splats, expected primitives with {}", file.string(), kExtension));
    return model;
}

}  // namespace vog::exchange
