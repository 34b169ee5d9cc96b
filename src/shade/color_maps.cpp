// color_maps.cpp: named transfer functions.
// viridis, inferno, magma, plasma: S. van der Walt, N. Smith, E. Firing (CC0); cividis: J. Nunez,
// C. Anderton, R. Renslow; turbo: A. Mikhailov, Google (Apache 2.0); cubehelix: D. A. Green, BASI
// 39 (2011); coolwarm: K. Moreland, ISVC 2009; jet and hot: MATLAB's. Published tables of 256
// entries are reduced to the fewest entries whose linear interpolation stays within 1/255 of all.
#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <span>
#include <string>

#include "shade/color_spaces.h"
#include "shade/transfer_function.h"
#include "vog/error.h"
#include "vog/shade.h"

namespace vog {

using namespace shading;
namespace {

/// Entries of a 256-entry table as 0xIIRRGGBB: index, red, green, blue.
// clang-format off
constexpr std::uint32_t kViridis[] = {
    0x00440154, 0x0446075a, 0x17482173, 0x27453581, 0x3e3c508b, 0x632b758e, 0x8120928c, 0x921fa187,
    0x9f27ad81, 0xae3bbb75, 0xbf5cc863, 0xd084d44b, 0xeccde11d, 0xf3dfe318, 0xf9efe51c, 0xfffde725,
};
constexpr std::uint32_t kInferno[] = {
    0x00000004, 0x03010108, 0x0d08051d, 0x1a180c3c, 0x282f0a5b, 0x32400a67, 0x4057106e, 0x577c1d6d,
    0x6ea02a63, 0x84c13a50, 0x9ade5238, 0xaff1711f, 0xc2fa9207, 0xc9fc9f07, 0xd1fcae12, 0xdef9c72f,
    0xe9f4dd4f, 0xf1f1ec6d, 0xf8f3f68a, 0xfffcffa4,
};
constexpr std::uint32_t kMagma[] = {
    0x00000004, 0x0602020d, 0x140e0b2b, 0x25241253, 0x3036106b, 0x3a471078, 0x4a601880, 0x668c2981,
    0x7fb5367a, 0x97db476a, 0xa6ed5a5f, 0xb1f66c5c, 0xbdfb835f, 0xcefea36f, 0xe3feca8d, 0xfffcfdbf,
};
constexpr std::uint32_t kPlasma[] = {
    0x000d0887, 0x0419068c, 0x12350498, 0x2a5c01a6, 0x3a7501a8, 0x468707a6, 0x58a01a9c, 0x77c33d80,
    0x9ee56a5d, 0xbff89441, 0xd8feb82c, 0xe9fbd324, 0xf9f3ee27, 0xfdf1f525, 0xfff0f921,
};
constexpr std::uint32_t kCividis[] = {
    0x0000224e, 0x1300306f, 0x17013271, 0x1b0f3570, 0x23203a6f, 0x3538476c, 0x5b5d616e, 0x7e7b7a78,
    0x9d989277, 0xbfbbad6d, 0xdbd9c55c, 0xeeeed649, 0xf9fbe138, 0xfcfee434, 0xfffee838,
};
constexpr std::uint32_t kTurbo[] = {
    0x0030123b, 0x04351e58, 0x0b3c3286, 0x134249b1, 0x1b455ed3, 0x224771e9, 0x294682f8, 0x2e448ffe,
    0x343d9efe, 0x3c2fb2f4, 0x4323c3e4, 0x4c19d5cd, 0x5218e0bd, 0x571de7b2, 0x5e2cf09e, 0x6543f787,
    0x747dff56, 0x7d9cfe40, 0x85b1f936, 0x8fcbed34, 0x9ce7d739, 0xa6f6c33a, 0xadfcb336, 0xb7fe992c,
    0xc3f9751d, 0xd0eb500e, 0xdadc3b07, 0xe7c12302, 0xf3a11201, 0xff7a0403,
};
constexpr std::uint32_t kCubehelix[] = {
    0x00000000, 0x090e050f, 0x14180f25, 0x211b1f3d, 0x2c18314a, 0x3715444f, 0x4116554b, 0x4b1d6443,
    0x552b6f39, 0x61467830, 0x6b637a2f, 0x747e7a36, 0x7c967a42, 0x87b3795b, 0x92c87b7c, 0x9dd381a0,
    0xa8d48dc1, 0xb3cf9ddb, 0xbec8b1ec, 0xc9c2c5f3, 0xd4c2d7f3, 0xe0cbe8f0, 0xebdbf3ef, 0xf6effaf4,
    0xffffffff,
};
// clang-format on

std::vector<ColorPoint> from_table(std::span<const std::uint32_t> entries) {
    std::vector<ColorPoint> points;
    for (const std::uint32_t entry : entries) {
        const auto part = [entry](int shift) {
            return static_cast<float>(entry >> shift & 0xff) / 255.0f;
        };
        points.push_back({part(24), part(16), part(8), part(0)});
    }
    return points;
}

/// One colour for all values, as of a channel of a microscope; names and colours are CSS's.
template <std::uint32_t kColor>
std::vector<ColorPoint> plain() {
    constexpr std::uint32_t kEntry[] = {kColor};
    return from_table(kEntry);
}

std::vector<ColorPoint> moreland_coolwarm() {
    const ColorPoint cool{0, 59 / 255.0f, 76 / 255.0f, 192 / 255.0f};
    const ColorPoint warm{1, 180 / 255.0f, 4 / 255.0f, 38 / 255.0f};
    return sample_colors(ColorSpace::kDiverging, {cool, warm});
}

struct NamedMap {
    const char* name;
    std::vector<ColorPoint> (*make)();
};

// Last two: the paper's maps for particles (white to red on black) and Enzo (blue to white).
const NamedMap kMaps[] = {
    {"white", plain<0xffffff>},
    {"red", plain<0xff0000>},
    {"lime", plain<0x00ff00>},
    {"blue", plain<0x0000ff>},
    {"cyan", plain<0x00ffff>},
    {"magenta", plain<0xff00ff>},
    {"yellow", plain<0xffff00>},
    {"orange", plain<0xffa500>},
    {"gray",
     [] {
         return std::vector<ColorPoint>{{0, 0, 0, 0}, {1, 1, 1, 1}};
     }},
    {"viridis", [] { return from_table(kViridis); }},
    {"cividis", [] { return from_table(kCividis); }},
    {"plasma", [] { return from_table(kPlasma); }},
    {"inferno", [] { return from_table(kInferno); }},
    {"ember", [] { return colors_from(from_table(kInferno), 0.38f); }},
    {"magma", [] { return from_table(kMagma); }},
    {"hot",
     [] {
         return std::vector<ColorPoint>{
             {0, 0, 0, 0}, {0.375f, 1, 0, 0}, {0.75f, 1, 1, 0}, {1, 1, 1, 1}};
     }},
    {"cubehelix", [] { return from_table(kCubehelix); }},
    {"coolwarm", moreland_coolwarm},
    {"turbo", [] { return from_table(kTurbo); }},
    {"jet",
     [] {
         return std::vector<ColorPoint>{{0, 0, 0, 0.5f},   {0.125f, 0, 0, 1}, {0.375f, 0, 1, 1},
                                        {0.625f, 1, 1, 0}, {0.875f, 1, 0, 0}, {1, 0.5f, 0, 0}};
     }},
    {"white-red",
     [] {
         return std::vector<ColorPoint>{{0, 1, 1, 1}, {1, 1, 0, 0}};
     }},
    {"blue-white",
     [] {
         return std::vector<ColorPoint>{{0, 0, 0, 1}, {1, 1, 1, 1}};
     }},
};

/// Map by name, independent of case, '_' or '-', and "grey" or "gray"; null if there is none.
const NamedMap* find_map(std::string name) {
    for (char& c : name)
        c = c == '_' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (name == "grey") name = "gray";
    const auto* map = std::find_if(std::begin(kMaps), std::end(kMaps),
                                   [&](const NamedMap& m) { return m.name == name; });
    return map == std::end(kMaps) ? nullptr : map;
}

}  // namespace

std::vector<std::string> transfer_function_names() {
    std::vector<std::string> names;
    for (const NamedMap& map : kMaps) names.emplace_back(map.name);
    return names;
}

std::string shading::transfer_function_name_list() {
    std::string list;
    for (const NamedMap& map : kMaps) list += (list.empty() ? "" : ", ") + std::string(map.name);
    return list;
}

bool shading::is_transfer_function_name(const std::string& name) {
    return find_map(name) != nullptr;
}

TransferFunction named_transfer_function(const std::string& name) {
    const NamedMap* map = find_map(name);
    if (!map)
        throw Error(fmt::format("no transfer function named '{}' (there are: {})", name,
                                transfer_function_name_list()));
    return {map->name, map->make(), {}};
}

TransferFunction sampled_transfer_function(const std::string& name, std::span<const Rgba> colors) {
    TransferFunction tf{name, {}, {}};
    const bool clear = std::ranges::any_of(colors, [](const Rgba& c) { return c.a != 1; });
    for (std::size_t i = 0; i < colors.size(); ++i) {
        const float v = colors.size() > 1
                            ? static_cast<float>(static_cast<double>(i) /
                                                 static_cast<double>(colors.size() - 1))
                            : 0;
        tf.color.push_back({v, colors[i].r, colors[i].g, colors[i].b});
        if (clear) tf.opacity.push_back({v, colors[i].a});
    }
    require_valid("transfer function " + name, tf);
    return tf;
}

Rgba named_background(const std::string& name) {
    if (name == "black") return {0, 0, 0, 1};
    if (name == "white") return {1, 1, 1, 1};
    if (name == "transparent") return {0, 0, 0, 0};
    throw Error(
        fmt::format("no background named '{}' (there are: black, white, transparent)", name));
}

}  // namespace vog
