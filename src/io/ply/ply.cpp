// ply.cpp: reading and writing models as binary little-endian PLY. The header states every
// convention (docs/formats.md); layouts are recognised by property name.
#include "vog/ply.h"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <fstream>
#include <map>
#include <numbers>

#include "core/atomic_file.h"
#include "core/paging.h"
#include "data/fields/field_arrays.h"
#include "data/fields/field_limits.h"
#include "data/hierarchy_links.h"
#include "io/exchange/finite_splats.h"
#include "io/exchange/splat_density.h"
#include "io/exchange/splat_frame.h"
#include "io/model_part.h"
#include "io/ply/ply_fields.h"
#include "io/ply/ply_header.h"
#include "io/ply/ply_nodes.h"
#include "io/ply/ply_part.h"
#include "io/ply/ply_rows.h"
#include "vog/distributed.h"
#include "vog/error.h"

static_assert(std::endian::native == std::endian::little,
              "rows are written in memory's byte order");

namespace vog {

using namespace ply;

namespace {

constexpr std::size_t kBlock = 1 << 16;  // rows read or written at a time

/// Converts the conventions of 3DGS and volprim files to vog's, in place.
void adopt_conventions(Layout layout, Gaussians& model) {
    if (layout == Layout::vog) return;
    model.cutoff = exchange::kSplatCutoff;
    for (std::size_t i = 0; i < model.size(); ++i) {
        Vec3f& s = model.scale[i];
        if (!std::isfinite(s.x + s.y + s.z)) s = {NAN, NAN, NAN};  // the logarithm of 0 as well
        s = {std::exp(s.x), std::exp(s.y), std::exp(s.z)};         // both files store logarithms
        if (layout == Layout::splatting) {
            // Opacity is a logit.
            model.density[i] =
                exchange::splat_density(1 / (1 + std::exp(-double{model.density[i]})), s);
        } else {
            // volprim's weight multiplies a unit-mass pdf: peak = weight / ((2 pi)^(3/2) s1 s2 s3).
            model.density[i] = static_cast<float>(
                model.density[i] / (std::pow(2 * std::numbers::pi, 1.5) * s.x * s.y * s.z));
        }
    }
    model.method = layout == Layout::splatting ? "3DGS" : "volprim";
}

/// Checks that the body's length matches the header before anything is allocated for it.
void check_length(const std::filesystem::path& file, const Header& header) {
    const std::uint64_t body = std::filesystem::file_size(file) - header.body_offset;
    std::uint64_t expected = 0;
    bool exact = true, countable = true;
    std::string rows;
    for (const Element& element : header.elements) {
        const std::size_t bytes = row_bytes(header, element);
        exact &= bytes > 0;  // rows of lists and of ASCII have at least a byte a property
        const std::uint64_t least = bytes ? bytes : element.properties.size();
        // Counts larger than the body are refused before they are multiplied, so nothing overflows.
        countable &= least == 0 || element.count <= body / least;
        if (countable) expected += element.count * least;
        const bool vertex = element.name == "vertex";
        rows += fmt::format("{}{} {} of {} bytes", rows.empty() ? "" : " and ", element.count,
                            vertex ? "Gaussians" : element.name + "s", least);
    }
    const bool short_of = !countable || body < expected;
    if (short_of || (exact && body != expected))
        fail(file, fmt::format("{} bytes of data, expected {}: {}", body, rows,
                               short_of ? "truncated" : "too long"));
}

/// Reads `count` rows from where `in` is, values as the file has them.
/// fields  of the file: names, units and ranges
/// origin  that positions become relative to
Gaussians read_rows(const std::filesystem::path& file, std::istream& in, const Header& header,
                    Layout layout, const Fields& fields, std::size_t count, Vec3d origin) {
    std::map<std::string, std::size_t> column;
    for (std::size_t n = 0; n < header.properties.size(); ++n) column[header.properties[n]] = n;
    const bool rotated = column.contains("rot_0");
    const char* weight = layout == Layout::splatting ? "opacity"
                         : layout == Layout::vog     ? "density"
                         : column.contains("sigmat") ? "sigmat"
                                                     : "sigmat_0";
    Gaussians model;
    model.origin = origin;
    model.mean.resize(count), model.scale.resize(count), model.density.resize(count);
    if (rotated) model.rotation.resize(count);
    model.fields = empty_fields(fields);
    each_array([&](auto& array) { array.resize(count); }, model.fields);
    const auto columns = columns_of(model.fields);
    std::vector<std::size_t> place_of;  // of each column in a row
    for (const std::string& name : column_names(fields)) place_of.push_back(column[name]);

    // Block by block, so that the body is not held twice.
    const std::size_t stride = header.properties.size();
    std::vector<float> rows;
    const std::size_t cx = column["x"], cy = column["y"], cz = column["z"], c0 = column["scale_0"],
                      c1 = column["scale_1"], c2 = column["scale_2"], cd = column[weight];
    const std::size_t q0 = rotated ? column["rot_0"] : 0, q1 = rotated ? column["rot_1"] : 0,
                      q2 = rotated ? column["rot_2"] : 0, q3 = rotated ? column["rot_3"] : 0;
    std::vector<double> shift(stride);
    shift[cx] = origin.x, shift[cy] = origin.y, shift[cz] = origin.z;
    for (std::size_t first = 0; first < count; first += kBlock) {
        const std::size_t block = std::min(kBlock, count - first);
        read_vertices(file, in, header, block, shift, rows);
        for (std::size_t i = 0; i < block; ++i) {
            const float* row = rows.data() + i * stride;
            model.mean[first + i] = {row[cx], row[cy], row[cz]};
            model.scale[first + i] = {row[c0], row[c1], row[c2]};
            if (rotated) model.rotation[first + i] = {row[q0], row[q1], row[q2], row[q3]};
            model.density[first + i] = row[cd];
        }
        for (std::size_t c = 0; c < columns.size(); ++c)
            for (std::size_t i = 0; i < block; ++i)
                columns[c][first + i] = rows[i * stride + place_of[c]];
        keep_memory();
    }
    return model;
}

/// Reads a header, and checks the length of what follows.
struct CheckedHeader : Header {
    Layout layout = Layout::vog;
    bool rotated = false;
    Fields fields{};  ///< names, units and ranges

    CheckedHeader(const std::filesystem::path& file, std::istream& in)
        : Header(read_header(file, in)),
          layout(layout_of(file, *this)),
          rotated(std::ranges::find(properties, "rot_0") != properties.end()) {
        if (layout == Layout::vog) fields = described_fields(file, *this);
        refuse_unknown(file, *this, layout, fields);
        require_columns(file, *this, fields);
        if (layout == Layout::vog) check_nodes(file, *this, !rotated, fields);
        check_length(file, *this);
    }
};

}  // namespace

Gaussians ply::read_part(const std::filesystem::path& file, const ModelPart& part,
                         Hierarchy* hierarchy, const exchange::SplatRules& rules) {
    require_readable(file);
    std::ifstream in(file, std::ios::binary);
    const CheckedHeader header(file, in);
    const auto [layout, rotated] = std::pair(header.layout, header.rotated);

    const auto [begin, end] = run_of(part, header.vertices);
    const std::size_t count = end - begin;
    // Doubles far from 0 lose the digits that tell Gaussians apart: the whole file states their origin.
    Vec3d origin;
    const Property& x =
        *std::ranges::find(header.elements[header.vertex].properties, "x", &Property::name);
    if (layout != Layout::vog && x.type == Type::float64) {
        skip_to_vertices(file, in, header);
        Box box;
        for (const Vec3f& mean :
             read_rows(file, in, header, layout, header.fields, header.vertices, {}).mean)
            box.include(vec_cast<double>(mean));
        origin = model_origin(box);
    }
    skip_to_vertices(file, in, header);
    skip_vertices(file, in, header, begin);
    Gaussians model = read_rows(file, in, header, layout, header.fields, count, origin);
    if (layout == Layout::vog) read_comments(file, header, model);
    adopt_conventions(layout, model);
    if (layout != Layout::vog) exchange::keep_finite(model, file.string(), rules);
    if (layout == Layout::splatting) read_frame(file, header, model);

    // Messages of validate() name the model's source: here the file that was read.
    const std::string source = model.source;
    model.source = file.string();
    validate(model);
    model.source = source;
    limit_planes(model);  // of older versions
    if (!hierarchy) return model;
    *hierarchy = {};
    if (layout != Layout::vog || !header.nodes() || header.nodes()->count == 0) return model;
    if (!read_nodes(in, header.nodes()->count, !rotated, header.fields, *hierarchy))
        fail(file, "cannot be read to its end");
    hierarchy->nodes.cutoff = model.cutoff;
    link(*hierarchy, count, file.string());
    hierarchy->nodes.origin = model.origin;
    validate(*hierarchy, model, file.string());
    limit_planes(hierarchy->nodes);
    return model;
}

bool is_whole_ply(const std::filesystem::path& file) {
    try {
        require_readable(file);
        std::ifstream in(file, std::ios::binary);
        CheckedHeader(file, in);
        return true;
    } catch (const Error&) {
        return false;
    }
}

Gaussians read_ply(const std::filesystem::path& file, Hierarchy* hierarchy) {
    return read_part(file, {}, hierarchy, {});
}

Gaussians read_ply(const std::filesystem::path& file, const ModelPart& part) {
    require_part(part, file.string());
    return read_part(file, part, nullptr, {});
}

std::string ply_header(const Gaussians& description, std::uint64_t count, bool rotated) {
    return header_text(description, count, rotated, {});
}

std::size_t ply_row_floats(bool rotated, const Fields& fields) {
    return (rotated ? 11 : 7) + columns_of(fields).size();
}

std::vector<float> ply_rows(const Gaussians& gaussians, std::size_t first, std::size_t count,
                            bool rotated) {
    const auto columns = columns_of(gaussians.fields);
    std::vector<float> rows(count * ply_row_floats(rotated, gaussians.fields));
    float* row = rows.data();
    for (std::size_t i = first; i < first + count; ++i) {
        const auto put = [&row](auto... values) { ((*row++ = values), ...); };
        put(gaussians.mean[i].x, gaussians.mean[i].y, gaussians.mean[i].z);
        put(gaussians.scale[i].x, gaussians.scale[i].y, gaussians.scale[i].z);
        if (rotated) {
            const Quat q = gaussians.axis_aligned() ? Quat{} : gaussians.rotation[i];
            put(q.w, q.x, q.y, q.z);
        }
        put(gaussians.density[i]);
        for (const auto& column : columns) put(column[i]);
    }
    return rows;
}

void write_ply(const std::filesystem::path& file, const Gaussians& gaussians,
               const Hierarchy& hierarchy) {
    validate(gaussians);
    const bool rotated = !gaussians.axis_aligned();
    validate(hierarchy, gaussians, file.string());
    if (!hierarchy.empty() && hierarchy.nodes.axis_aligned() != gaussians.axis_aligned())
        fail(file,
             "the model has rotations and its hierarchy has none, or the reverse; expected both "
             "alike");
    if (!in_one_order(hierarchy))
        fail(file,
             "a hierarchy joined from several, expected one built of the whole model "
             "(build_hierarchy)");
    const std::string header = header_text(gaussians, gaussians.size(), rotated, hierarchy);
    write_file(file, [&](std::ofstream& out) {
        out << header;
        for (std::size_t first = 0; first < gaussians.size(); first += kBlock) {
            const std::vector<float> rows =
                ply_rows(gaussians, first, std::min(kBlock, gaussians.size() - first), rotated);
            out.write(reinterpret_cast<const char*>(rows.data()),
                      static_cast<std::streamsize>(rows.size() * sizeof(float)));
        }
        write_nodes(out, hierarchy);
    });
}

std::size_t ply_bytes(const Gaussians& gaussians, const Hierarchy& hierarchy) {
    const bool rotated = !gaussians.axis_aligned();
    return header_text(gaussians, gaussians.size(), rotated, hierarchy).size() +
           gaussians.size() * ply_row_floats(rotated, gaussians.fields) * sizeof(float) +
           hierarchy.size() * bytes_per_node(gaussians.axis_aligned(), gaussians.fields);
}

}  // namespace vog
