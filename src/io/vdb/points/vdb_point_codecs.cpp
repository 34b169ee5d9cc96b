// vdb_point_codecs.cpp: decoding of point attributes. Source: openvdb/points/AttributeArray.h.
#include "io/vdb/points/vdb_point_codecs.h"

#include <openvdb/math/Half.h>
#include <openvdb/math/QuantizedUnitVec.h>
#include <openvdb/math/Vec3.h>

#include <cstring>

namespace vog::vdb {

namespace {

template <class Number>
double number(const char* bytes) {
    Number value;
    std::memcpy(&value, bytes, sizeof value);
    return static_cast<double>(value);
}

double element_value(PointCodec::Element element, const char* bytes) {
    using Element = PointCodec::Element;
    switch (element) {
        case Element::float32:
            return number<float>(bytes);
        case Element::float64:
            return number<double>(bytes);
        case Element::half: {
            openvdb::math::internal::half value;
            value.setBits(static_cast<unsigned short>(number<std::uint16_t>(bytes)));
            return static_cast<double>(static_cast<float>(value));
        }
        case Element::int8:
            return number<std::int8_t>(bytes);
        case Element::int16:
            return number<std::int16_t>(bytes);
        case Element::int32:
            return number<std::int32_t>(bytes);
        case Element::int64:
            return number<std::int64_t>(bytes);
        case Element::uint8:
            return number<std::uint8_t>(bytes);
        case Element::uint16:
            return number<std::uint16_t>(bytes);
        case Element::unit:
            break;  // PointCodec::decode handles all three components at once
    }
    return 0;
}

}  // namespace

std::size_t PointCodec::element_bytes() const {
    switch (element) {
        case Element::int8:
        case Element::uint8:
            return 1;
        case Element::half:
        case Element::int16:
        case Element::uint16:
        case Element::unit:
            return 2;
        case Element::float32:
        case Element::int32:
            return 4;
        case Element::float64:
        case Element::int64:
            return 8;
    }
    return 0;
}

Vec3d PointCodec::decode(const char* from) const {
    if (element == Element::unit) {
        std::uint16_t packed;
        std::memcpy(&packed, from, sizeof packed);
        const openvdb::math::Vec3<float> v = openvdb::math::QuantizedUnitVec::unpack(packed);
        return {v.x(), v.y(), v.z()};
    }
    Vec3d value;
    for (int axis = 0; axis < components; ++axis)
        value[axis] =
            scale * element_value(element, from + std::size_t(axis) * element_bytes()) + offset;
    return value;
}

std::optional<PointCodec> find_codec(const std::string& type, const std::string& codec) {
    using Element = PointCodec::Element;
    PointCodec found;
    found.components = type == "vec3s" || type == "vec3d" || type == "vec3i" ? 3 : 1;
    if (codec == "null") {
        if (type == "float" || type == "vec3s")
            found.element = Element::float32;
        else if (type == "double" || type == "vec3d")
            found.element = Element::float64;
        else if (type == "int32" || type == "vec3i")
            found.element = Element::int32;
        else if (type == "bool" || type == "int8")
            found.element = Element::int8;
        else if (type == "int16")
            found.element = Element::int16;
        else if (type == "int64")
            found.element = Element::int64;
        else
            return std::nullopt;
        return found;
    }
    if (type != "float" && type != "vec3s") return std::nullopt;
    if (codec == "trnc") {
        found.element = Element::half;
        return found;
    }
    if (codec == "uvec" && found.components == 3) {
        found.element = Element::unit;
        return found;
    }
    // Fixed point: fxpt* for positions in [-1/2, 1/2], ufxpt* for numbers in [0, 1].
    if (codec == "fxpt8" || codec == "ufxpt8") {
        found.element = Element::uint8;
        found.scale = 1.0 / 255;
    } else if (codec == "fxpt16" || codec == "ufxpt16") {
        found.element = Element::uint16;
        found.scale = 1.0 / 65535;
    } else {
        return std::nullopt;
    }
    if (codec.front() == 'f') found.offset = -0.5;
    return found;
}

}  // namespace vog::vdb
