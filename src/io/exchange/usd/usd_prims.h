// usd_prims.h: prims of one OpenUSD layer of text, with the attributes of splats.
// Source: OpenUSD 26.x, schema ParticleField3DGaussianSplat of usdVol.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/byte_source.h"

namespace vog::exchange::usd {

/// Attribute of vog's own, a token: the frame of splat_frame.h.
inline constexpr const char* kFrameAttribute = "vog:frame";
inline constexpr const char* kSplatType = "ParticleField3DGaussianSplat";

/// Attributes of splats that make up a Gaussian, and the numbers of each splat; orientations are w x y z.
inline constexpr std::array<const char*, 4> kAttributes{"positions", "orientations", "scales",
                                                        "opacities"};
inline constexpr std::array<std::size_t, 4> kComponents{3, 4, 3, 1};

/// Index in kAttributes of a name; the half floats of the schema, `positionsh` and so on, are the same attribute.
struct AttributeName {
    std::size_t index = 0;
    bool half = false;
};
std::optional<AttributeName> attribute_named(std::string_view name);

/// A prim, with its own opinions alone: nothing is composed.
struct Prim {
    std::string name;
    std::ptrdiff_t parent = -1;  ///< index in the list of prims, -1 at the root
    bool splats = false;         ///< defined here, of the type kSplatType
    bool absent = false;         ///< a class, an override or inactive: nothing in it is drawn
    bool moved = false;          ///< has xformOpOrder
    std::string frame;           ///< value of kFrameAttribute; empty: none
    std::string sampled;         ///< attribute of splats with values at several times
    std::array<std::vector<float>, kAttributes.size()> numbers;  ///< rows of kComponents
    std::array<bool, kAttributes.size()> half{};                 ///< numbers are of the half floats
};

/// Takes an attribute's numbers. Float32 goes before half floats.
void set_numbers(Prim& prim, AttributeName name, std::vector<float> numbers);

/// Prims of a layer as text, `#usda 1.0`.
/// throws  vog::Error naming `file` for other versions, truncated or corrupt files
std::vector<Prim> read_text(FileBytes& in, const std::string& file);

}  // namespace vog::exchange::usd
