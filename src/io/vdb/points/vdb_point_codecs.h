// vdb_point_codecs.h: how PointDataGrids encode numbers: every codec that OpenVDB registers.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "vog/linear.h"

namespace vog::vdb {

struct PointCodec {
    enum class Element { float32, float64, half, int8, int16, int32, int64, uint8, uint16, unit };
    Element element = Element::float32;
    int components = 1;            ///< 1 or 3
    double scale = 1, offset = 0;  ///< value = scale * element + offset

    std::size_t element_bytes() const;
    std::size_t bytes() const {
        return element == Element::unit ? 2 : std::size_t(components) * element_bytes();
    }
    /// A value; numbers in x.
    Vec3d decode(const char* bytes) const;
};

/// By OpenVDB's names: "vec3s" and "fxpt16"; nothing for types that are no numbers.
std::optional<PointCodec> find_codec(const std::string& type, const std::string& codec);

}  // namespace vog::vdb
