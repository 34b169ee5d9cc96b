// file_table.cpp: the header as JSON and the table as plain numbers, compressed together.
#include "io/vogz/file_table.h"

#include <fmt/core.h>
#include <zlib.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "data/field_arrays.h"
#include "vog/error.h"

namespace vog::vogz {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<char, 8> kMagic{'V', 'O', 'G', 'Z', '\r', '\n', '\x1a', '\n'};
/// Major version in the lower 16 bits: readers refuse others. Minor version in the upper ones: what a newer one adds, readers of
/// the same major version can leave out.
constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t major_version(std::uint32_t version) { return version & 0xffff; }
/// Far above those of any model; a corrupt length does not allocate more.
constexpr std::uint64_t kMostHeader = std::uint64_t{1} << 32;

/// Fixed bytes at the start of a file, after kMagic.
struct Start {
    std::uint32_t version = kVersion, compression = 0;
    std::uint64_t json = 0, blobs = 0;  ///< bytes of the JSON, number of blobs
    std::uint64_t compressed = 0;       ///< bytes of both
    std::uint32_t checksum = 0, reserved = 0;
};
static_assert(sizeof(Start) == 40);
static_assert(sizeof(Blob) == 48);

Json numbers(Vec3d v) { return {v.x, v.y, v.z}; }
Vec3d vector_of(const Json& json) {
    const auto v = json.get<std::array<double, 3>>();
    return {v[0], v[1], v[2]};
}

template <class Field>
Json field_json(const Field& field, const FieldRounding& rounding, const char* kind) {
    return {{"name", field.name},     {"kind", kind},         {"unit", field.unit},
            {"lower", field.lower},   {"upper", field.upper}, {"reference", rounding.reference},
            {"scale", rounding.unit}, {"step", rounding.step}};
}
template <class Field>
Field field_of(const Json& json) {
    Field field;
    field.name = json.at("name"), field.unit = json.at("unit");
    field.lower = json.at("lower"), field.upper = json.at("upper");
    return field;
}

Json to_json(const FileTable& table) {
    const Gaussians& model = table.description;
    const ShapeRounding& shapes = table.shapes;
    Json json = {{"gaussians", table.count(Kind::gaussians)},
                 {"rotated", table.rotated},
                 {"cutoff", model.cutoff},
                 {"origin", numbers(model.origin)},
                 {"source_voxels", model.source_voxels},
                 {"source", model.source},
                 {"method", model.method},
                 {"options", model.options},
                 {"summary", model.summary},
                 {"precision", {table.precision.step, table.precision.field_step}},
                 {"corner", numbers(shapes.corner)},
                 {"edge", shapes.edge},
                 {"exponent", {shapes.exponent_at_zero, shapes.exponent_per_trace}},
                 {"steps", {shapes.diagonal_step, shapes.shear_step, shapes.mass_step}}};
    if (!model.box.empty()) json["box"] = {numbers(model.box.lower), numbers(model.box.upper)};
    json["fields"] = Json::array();
    std::size_t n = 0;
    for (const ScalarField& field : model.fields.scalar)
        json["fields"].push_back(
            field_json(field, table.fields[n++], field.is_measure ? "measure" : "scalar"));
    for (const VectorField& field : model.fields.vector)
        json["fields"].push_back(field_json(field, table.fields[n++], "vector"));
    return json;
}

void from_json(const Json& json, FileTable& table) {
    Gaussians& model = table.description;
    ShapeRounding& shapes = table.shapes;
    table.rotated = json.at("rotated");
    model.cutoff = json.at("cutoff");
    model.origin = vector_of(json.at("origin"));
    model.source_voxels = json.at("source_voxels");
    model.source = json.at("source"), model.method = json.at("method");
    model.options = json.at("options"), model.summary = json.at("summary");
    table.precision.step = json.at("precision").at(0);
    table.precision.field_step = json.at("precision").at(1);
    shapes.corner = vector_of(json.at("corner"));
    shapes.edge = json.at("edge");
    shapes.exponent_at_zero = json.at("exponent").at(0);
    shapes.exponent_per_trace = json.at("exponent").at(1);
    shapes.diagonal_step = json.at("steps").at(0);
    shapes.shear_step = json.at("steps").at(1);
    shapes.mass_step = json.at("steps").at(2);
    if (json.contains("box")) {
        model.box = {vector_of(json["box"].at(0)), vector_of(json["box"].at(1))};
        if (model.box.empty()) throw Error("a box whose lower corner is above the upper one");
    }
    for (const Json& field : json.at("fields")) {
        const std::string kind = field.at("kind");
        if (kind == "vector") {
            model.fields.vector.push_back(field_of<VectorField>(field));
        } else if (kind == "scalar" || kind == "measure") {
            if (!model.fields.vector.empty()) throw Error("a scalar field behind a vector field");
            model.fields.scalar.push_back(field_of<ScalarField>(field));
            model.fields.scalar.back().is_measure = kind == "measure";
        } else {
            throw Error(fmt::format("a field of the kind {}", kind));
        }
        table.fields.push_back({field.at("reference"), field.at("scale"), field.at("step")});
    }
    check_descriptions(model.fields);
}

/// throws vog::Error unless blobs follow each other as writers write them
void check(const FileTable& table, std::uint64_t left) {
    const std::size_t fields = table.fields.size();
    std::uint64_t bytes = 0;
    std::size_t next_field = fields;
    std::uint32_t count = 0;
    bool links = false;  // expected next
    for (const Blob& blob : table.blobs) {
        bytes += blob.bytes;
        const bool shapes = blob.kind == Kind::gaussians || blob.kind == Kind::nodes;
        if (shapes ? links || next_field != fields
                   : blob.count != count || (blob.kind == Kind::links ? !links : links))
            throw Error("a table whose chunks are not whole");
        if (shapes) {
            links = blob.kind == Kind::nodes;
            next_field = 0;
            count = blob.count;
        } else if (blob.kind == Kind::links) {
            links = false;
        } else if (blob.kind != Kind::field || blob.field != next_field++) {
            throw Error("a table whose fields are in another order");
        }
        if (blob.count == 0 || blob.count > (1u << 20))
            throw Error(fmt::format("a chunk of {} Gaussians", blob.count));
        for (const float corner : blob.box)
            if (!std::isfinite(corner)) throw Error("a chunk whose box is not finite");
    }
    if (links || next_field != fields) throw Error("a table whose last chunk is not whole");
    if (bytes != left)
        throw Error(fmt::format("{} bytes of chunks, expected {}: {}", left, bytes,
                                left < bytes ? "truncated" : "too long"));
}

}  // namespace

std::uint32_t checksum(std::span<const char> bytes) {
    return static_cast<std::uint32_t>(
        crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::size_t FileTable::count(Kind kind) const {
    std::size_t sum = 0;
    for (const Blob& blob : blobs) sum += blob.kind == kind ? blob.count : 0;
    return sum;
}

std::string header_bytes(const FileTable& table) {
    // Names of files and fields are any bytes; JSON is UTF-8.
    std::string body = to_json(table).dump(-1, ' ', false, Json::error_handler_t::replace);
    Start start;
    start.compression = static_cast<std::uint32_t>(table.compression);
    start.json = body.size();
    start.blobs = table.blobs.size();
    body.append(reinterpret_cast<const char*>(table.blobs.data()),
                table.blobs.size() * sizeof(Blob));
    const std::string packed = compressed(body, table.compression);
    start.compressed = packed.size();
    start.checksum = checksum(packed);
    std::string bytes(kMagic.begin(), kMagic.end());
    bytes.append(reinterpret_cast<const char*>(&start), sizeof start);
    return bytes + packed;
}

FileTable read_table(ByteSource& in, std::uint64_t size) {
    if (size < kMagic.size() ||
        std::memcmp(in.take(kMagic.size()), kMagic.data(), kMagic.size()) != 0)
        in.fail("not a compact model (.vogz): another format");
    const auto start = in.number<Start>();
    if (major_version(start.version) != kVersion)
        in.fail(fmt::format("a compact model of version {}, expected {}: written by another vog",
                            major_version(start.version), kVersion));
    if (start.compression > static_cast<std::uint32_t>(Compression::deflate))
        in.fail(fmt::format("corrupt: compression {}", start.compression));
    const std::uint64_t table_bytes = start.blobs < kMostHeader ? start.blobs * sizeof(Blob) : 0;
    // Neither compressor makes less than a thousandth of its bytes of a table.
    constexpr std::uint64_t kMostRatio = 4096;
    if (start.compressed > size || start.json > kMostHeader || start.blobs > kMostHeader ||
        start.json + table_bytes > kMostRatio * (start.compressed + 1))
        in.fail("corrupt: lengths of the header");
    const std::span<const char> packed(in.take(start.compressed), start.compressed);
    if (checksum(packed) != start.checksum) in.fail("corrupt: wrong checksum of the header");
    FileTable table;
    table.compression = static_cast<Compression>(start.compression);
    std::string body(start.json + table_bytes, '\0');
    decompress(in, packed, table.compression, body);
    table.blobs.resize(start.blobs);
    if (start.blobs > 0) std::memcpy(table.blobs.data(), body.data() + start.json, table_bytes);
    table.body_offset = in.position();
    try {
        from_json(Json::parse(body.begin(), body.begin() + static_cast<std::ptrdiff_t>(start.json)),
                  table);
        check(table, size - table.body_offset);
    } catch (const nlohmann::json::exception& error) {
        in.fail(fmt::format("corrupt header: {}", error.what()));
    } catch (const Error& error) {
        in.fail(fmt::format("corrupt: {}", error.what()));
    }
    return table;
}

}  // namespace vog::vogz
