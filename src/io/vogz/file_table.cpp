// file_table.cpp: the header as JSON and the table as plain numbers, compressed together.
#include "io/vogz/file_table.h"

#include <fmt/core.h>
#include <zlib.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "io/model_json.h"
#include "vog/error.h"

namespace vog::vogz {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<char, 8> kMagic{'V', 'O', 'G', 'Z', '\r', '\n', '\x1a', '\n'};
/// Major version in the lower 16 bits: readers refuse others. Minor version in the upper ones: what a newer one adds, readers of
/// the same major version can leave out.
constexpr std::uint32_t kVersion = 1;
/// 1.1: with a tree.
constexpr std::uint32_t kTreeVersion = kVersion | 1u << 16;
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

/// Of each chunk in turn its parent's place, -1 for none, and its error in six digits, rounded up.
Json tree_json(const std::vector<TreeChunk>& tree) {
    Json parents = Json::array(), errors = Json::array();
    for (const TreeChunk& chunk : tree) {
        parents.push_back(chunk.parent ? std::int64_t{*chunk.parent} : -1);
        errors.push_back(six_digits(chunk.error, true));
    }
    return {{"parents", parents}, {"errors", errors}};
}

std::vector<TreeChunk> tree_of(const Json& json) {
    const auto parents = json.at("parents").get<std::vector<std::int64_t>>();
    const auto errors = json.at("errors").get<std::vector<double>>();
    if (parents.size() != errors.size())
        throw Error(
            fmt::format("a tree of {} parents and {} errors", parents.size(), errors.size()));
    std::vector<TreeChunk> tree(parents.size());
    for (std::size_t n = 0; n < tree.size(); ++n) {
        tree[n].error = errors[n];
        if (parents[n] >= static_cast<std::int64_t>(n) || parents[n] < -1)
            throw Error(fmt::format("a tree whose chunk {} has the parent {}", n, parents[n]));
        if (parents[n] >= 0) tree[n].parent = static_cast<std::uint32_t>(parents[n]);
    }
    return tree;
}

Json to_json(const FileTable& table) {
    const Gaussians& model = table.description;
    const ShapeRounding& shapes = table.shapes;
    Json json = {{"gaussians", table.count(Kind::gaussians)}, {"rotated", table.rotated}};
    put_description(json, model);
    json["precision"] = {table.precision.step, table.precision.field_step};
    json["corner"] = vector_json(shapes.corner);
    json["edge"] = shapes.edge;
    json["exponent"] = {shapes.exponent_at_zero, shapes.exponent_per_trace};
    json["steps"] = {shapes.diagonal_step, shapes.shear_step, shapes.mass_step};
    json["fields"] = fields_json(model.fields);
    for (std::size_t n = 0; n < table.fields.size(); ++n) {
        json["fields"][n]["reference"] = table.fields[n].reference;
        json["fields"][n]["scale"] = table.fields[n].unit;
        json["fields"][n]["step"] = table.fields[n].step;
    }
    if (!table.page.empty()) json["page"] = Json::parse(table.page);
    if (!table.tree.empty()) json["tree"] = tree_json(table.tree);
    return json;
}

void from_json(const Json& json, FileTable& table) {
    ShapeRounding& shapes = table.shapes;
    table.rotated = json.at("rotated");
    take_description(json, table.description);
    table.precision.step = json.at("precision").at(0);
    table.precision.field_step = json.at("precision").at(1);
    shapes.corner = vector_of(json.at("corner"));
    shapes.edge = json.at("edge");
    shapes.exponent_at_zero = json.at("exponent").at(0);
    shapes.exponent_per_trace = json.at("exponent").at(1);
    shapes.diagonal_step = json.at("steps").at(0);
    shapes.shear_step = json.at("steps").at(1);
    shapes.mass_step = json.at("steps").at(2);
    table.description.fields = fields_of(json.at("fields"));
    for (const Json& field : json.at("fields"))
        table.fields.push_back({field.at("reference"), field.at("scale"), field.at("step")});
    if (json.contains("tree")) table.tree = tree_of(json["tree"]);
}

/// throws vog::Error for a tree that is not that of the blobs
void check_tree(const FileTable& table) {
    if (table.tree.empty()) return;
    std::vector<const Blob*> chunks;
    for (const Blob& blob : table.blobs)
        if (blob.kind == Kind::gaussians || blob.kind == Kind::nodes) chunks.push_back(&blob);
    if (chunks.size() != table.tree.size())
        throw Error(
            fmt::format("a tree of {} chunks, expected {}", table.tree.size(), chunks.size()));
    for (std::size_t n = 0; n < chunks.size(); ++n) {
        const TreeChunk& chunk = table.tree[n];
        const bool nodes = chunks[n]->kind == Kind::nodes;
        if (!std::isfinite(chunk.error) || chunk.error < 0 || (!nodes && chunk.error > 0))
            throw Error(fmt::format("a tree whose chunk {} has the error {}", n, chunk.error));
        if (!chunk.parent) {
            if (chunks[n]->depth > 0)
                throw Error(fmt::format("a tree whose chunk {} lacks a parent", n));
            continue;
        }
        const Blob& parent = *chunks[*chunk.parent];
        if (parent.kind != Kind::nodes || chunks[n]->depth != parent.depth + 1 ||
            chunk.error > table.tree[*chunk.parent].error)
            throw Error(
                fmt::format("a tree whose chunk {} does not belong to chunk {}", n, *chunk.parent));
    }
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
    check_tree(table);
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
    if (!table.tree.empty()) start.version = kTreeVersion;
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
