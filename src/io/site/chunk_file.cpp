// chunk_file.cpp: coding of chunks by the coders of compact models.
#include "io/site/chunk_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "data/fields/field_arrays.h"
#include "data/fields/field_limits.h"
#include "io/site/chunk_name.h"
#include "io/vogz/chunk_fields.h"
#include "io/vogz/chunk_shapes.h"
#include "io/vogz/file_table.h"
#include "vog/error.h"

namespace vog::site {

using namespace vogz;

namespace {

constexpr std::array<char, 4> kFieldMagic{'V', 'O', 'G', 'F'};
constexpr std::uint32_t kFieldVersion = 1;

/// Bytes of a field's file before its columns, after kFieldMagic and checksum.
struct FieldStart {
    double reference = 0, scale = 1, step = 0;
};

/// Nodes, then Gaussians: runs that are coded by themselves, without empty ones.
std::vector<std::span<const std::uint32_t>> runs_of(std::span<const std::uint32_t> order,
                                                    std::size_t nodes) {
    std::vector<std::span<const std::uint32_t>> runs{order.first(nodes), order.subspan(nodes)};
    std::erase_if(runs, [](const auto& run) { return run.empty(); });
    return runs;
}

template <class T>
void put(std::string& bytes, const T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

template <class Field>
std::string field_content(const Field& field, const FieldRounding& rounding,
                          const std::vector<std::span<const std::uint32_t>>& runs,
                          const std::vector<std::vector<double>>& spreads) {
    std::string body;
    put(body, FieldStart{rounding.reference, rounding.unit, rounding.step});
    std::size_t count = 0;
    for (std::size_t n = 0; n < runs.size(); ++n) {
        body += field_chunk(field, rounding, runs[n], spreads[n], Compression::deflate);
        count += runs[n].size();
    }
    std::string bytes(kFieldMagic.begin(), kFieldMagic.end());
    put(bytes, kFieldVersion);
    put(bytes, static_cast<std::uint32_t>(count));
    put(bytes, checksum(body));
    return bytes + body;
}

/// Sets a field of a decoded chunk.
template <class Field>
void read_field_file(const std::string& bytes, const std::string& file,
                     const std::vector<std::size_t>& ends, std::span<const double> spread,
                     Field& field) {
    MemoryBytes in(bytes, file, 0);
    if (!std::equal(kFieldMagic.begin(), kFieldMagic.end(), in.take(kFieldMagic.size())))
        in.fail("damaged: no field of a chunk");
    if (in.number<std::uint32_t>() != kFieldVersion) in.fail("of another version, expected 1");
    const auto count = in.number<std::uint32_t>();
    const auto expected = in.number<std::uint32_t>();
    if (checksum(std::span(bytes).subspan(in.offset())) != expected || count != spread.size())
        in.fail("damaged: wrong checksum or number of Gaussians");
    const auto start = in.number<FieldStart>();
    const FieldRounding rounding{start.reference, start.scale, start.step};
    std::size_t begin = 0;
    for (const std::size_t end : ends) {
        read_field(in, rounding, Compression::deflate, field, begin,
                   spread.subspan(begin, end - begin));
        begin = end;
    }
    if (!in.at_end()) in.fail("damaged: more bytes than a field has");
}

}  // namespace

std::vector<FieldRounding> field_roundings(const Fields& fields, double step) {
    std::vector<FieldRounding> all;
    for (const ScalarField& field : fields.scalar) all.push_back(field_rounding(field, step));
    for (const VectorField& field : fields.vector) all.push_back(field_rounding(field, step));
    return all;
}

std::array<float, 6> box_of(const Gaussians& chunk, double step) {
    constexpr float kMost = std::numeric_limits<float>::max();
    const auto outward = [](double v, float limit) {
        return std::nextafter(static_cast<float>(std::clamp<double>(v, -kMost, kMost)), limit);
    };
    Box box;
    for (std::size_t i = 0; i < chunk.size(); ++i) {
        const Box support = support_box(chunk, i);
        const Vec3d wider = 4 * step * 0.5 * (support.upper - support.lower);
        box.include(support.lower - wider);
        box.include(support.upper + wider);
    }
    std::array<float, 6> corners{};
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        corners[k] = outward(box.lower[axis] - chunk.origin[axis], -kMost);
        corners[k + 3] = outward(box.upper[axis] - chunk.origin[axis], kMost);
    }
    return corners;
}

std::vector<std::string> chunk_contents(const Gaussians& chunk, std::size_t nodes,
                                        const VogzPrecision& precision,
                                        const std::vector<FieldRounding>& fields) {
    FileTable table;
    table.description.origin = chunk.origin;
    table.description.cutoff = chunk.cutoff;
    table.rotated = !chunk.axis_aligned();
    table.compression = Compression::deflate;
    table.precision = precision;
    table.shapes = shape_rounding(chunk, precision.step);
    std::vector<std::uint32_t> order(chunk.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto runs = runs_of(order, nodes);
    std::string body;
    std::vector<std::vector<double>> spreads;
    const std::array<float, 6> box = box_of(chunk, precision.step);
    for (const auto run : runs) {
        ShapeChunk shapes = shape_chunk(chunk, run, table.shapes, table.compression);
        Blob blob;
        blob.count = static_cast<std::uint32_t>(run.size());
        blob.bytes = static_cast<std::uint32_t>(shapes.bytes.size());
        blob.checksum = checksum(shapes.bytes);
        blob.box = box;
        table.blobs.push_back(blob);
        body += shapes.bytes;
        spreads.push_back(std::move(shapes.spread));
    }
    std::vector<std::string> contents{header_bytes(table) + body};
    auto rounding = fields.begin();
    const auto add = [&](const auto& field) {
        contents.push_back(field_content(field, *rounding++, runs, spreads));
    };
    std::ranges::for_each(chunk.fields.scalar, add);
    std::ranges::for_each(chunk.fields.vector, add);
    return contents;
}

Gaussians read_chunk(const std::filesystem::path& folder, const Row& row,
                     const ManifestModel& model) {
    const std::filesystem::path file = shapes_path(folder, row.name);
    std::vector<std::string> contents{read_whole(file, row.bytes.front())};
    for (std::size_t k = 1; k < row.bytes.size(); ++k)
        contents.push_back(read_whole(field_path(folder, row.name, k - 1), row.bytes[k]));
    if (content_name(contents) != row.name)
        throw Error(
            fmt::format("{}: damaged: the chunk has other bytes than were written", file.string()));

    MemoryBytes in(contents.front(), file.string(), 0);
    const FileTable table = read_table(in, contents.front().size());
    if (table.count(Kind::gaussians) != row.gaussians || table.rotated != model.rotated ||
        table.count(Kind::nodes) != 0 || !table.fields.empty())
        in.fail("damaged: not the chunk that the manifest describes");
    Gaussians chunk;
    chunk.origin = table.description.origin;
    chunk.cutoff = table.description.cutoff;
    chunk.fields = empty_fields(model.description.fields);
    allocate(chunk, row.gaussians, table.rotated);
    std::vector<double> spread(row.gaussians);
    std::vector<std::size_t> ends;
    for (const Blob& blob : table.blobs) {
        const std::size_t begin = ends.empty() ? 0 : ends.back();
        MemoryBytes own(std::span(contents.front()).subspan(in.offset(), blob.bytes), file.string(),
                        in.position());
        read_shapes(own, table.shapes, table.compression, chunk, begin,
                    std::span(spread).subspan(begin, blob.count));
        in.skip(blob.bytes);
        ends.push_back(begin + blob.count);
    }
    std::size_t k = 1;
    const auto read = [&](auto& field) {
        read_field_file(contents[k], field_path(folder, row.name, k - 1).string(), ends, spread,
                        field);
        ++k;
    };
    std::ranges::for_each(chunk.fields.scalar, read);
    std::ranges::for_each(chunk.fields.vector, read);
    chunk.source = file.string();
    validate(chunk);
    limit_planes(chunk);  // of older versions, and rounded ones
    if (chunk.cutoff != model.description.cutoff)
        throw Error(fmt::format("{}: damaged: a cutoff of {}, expected {}", file.string(),
                                chunk.cutoff, model.description.cutoff));
    return chunk;
}

void allocate(Gaussians& model, std::size_t count, bool rotated) {
    model.mean.resize(count), model.scale.resize(count), model.density.resize(count);
    model.rotation.resize(rotated ? count : 0);
    each_array([&](auto& array) { array.resize(count); }, model.fields);
}

void place(const Gaussians& chunk, std::size_t first, std::size_t last, Gaussians& model,
           std::size_t slot) {
    const auto copy = [&](const auto& from, auto& to) {
        if (!from.empty())
            std::copy(from.begin() + static_cast<std::ptrdiff_t>(first),
                      from.begin() + static_cast<std::ptrdiff_t>(last),
                      to.begin() + static_cast<std::ptrdiff_t>(slot));
    };
    copy(chunk.mean, model.mean), copy(chunk.scale, model.scale);
    copy(chunk.rotation, model.rotation), copy(chunk.density, model.density);
    each_array(copy, chunk.fields, model.fields);
}

}  // namespace vog::site
