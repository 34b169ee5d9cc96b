// vdb_point_codecs.h: number codecs of PointDataGrid attributes, all that OpenVDB registers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "vog/linear.h"

namespace vog::vdb {

/// Encoding of an attribute's values.
struct PointCodec {
    enum class Element { float32, float64, half, int8, int16, int32, int64, uint8, uint16, unit };
    Element element = Element::float32;
    int components = 1;            ///< 1 or 3
    double scale = 1, offset = 0;  ///< value = scale * element + offset

    std::size_t element_bytes() const;
    /// Bytes of a value with all its components.
    std::size_t bytes() const {
        return element == Element::unit ? 2 : std::size_t(components) * element_bytes();
    }
    /// Decodes a value; single numbers are in x.
    Vec3d decode(const char* bytes) const;
};

/// Codec by OpenVDB's names of type and codec, as in "vec3s", "fxpt16"; none for types that hold no
/// numbers.
std::optional<PointCodec> find_codec(const std::string& type, const std::string& codec);

}  // namespace vog::vdb
