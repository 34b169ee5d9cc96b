// ply.cpp: models as binary little-endian PLY. The header says every convention (docs/formats.md);
// the reader takes its layouts by property name and refuses what it does not understand.
#include "vog/ply.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstring>
#include <fstream>
#include <map>
#include <numbers>
#include <sstream>

#include "core/atomic_file.h"
#include "data/hierarchy_links.h"
#include "io/ply/ply_nodes.h"
#include "vog/distributed.h"
#include "vog/error.h"

static_assert(std::endian::native == std::endian::little,
              "PLY bodies are written as memory has them");

namespace vog {

using namespace ply;

namespace {

/// What the header says; properties in file order.
struct Header {
    std::uint64_t vertices = 0, nodes = 0;
    bool has_nodes = false;
    std::vector<std::string> properties;       ///< of a vertex, all float32
    std::vector<std::string> node_properties;  ///< with their types
    std::vector<std::string> comments;
    std::uint64_t body_offset = 0;
};

[[noreturn]] void fail(const std::filesystem::path& file, const std::string& what) {
    throw Error(fmt::format("{}: {}", file.string(), what));
}

Header read_header(const std::filesystem::path& file, std::istream& in) {
    constexpr std::size_t kMaxHeaderLines = 4096;
    Header header;
    std::string line;
    bool format_seen = false, vertex_seen = false, nodes_seen = false;
    const auto next_line = [&] {
        if (!std::getline(in, line) || in.eof())
            fail(file, "truncated: the PLY header has no end_header");
        if (!line.empty() && line.back() == '\r') line.pop_back();
    };

    char magic[4] = {};
    in.read(magic, 4);
    if (in.gcount() < 4 || std::string_view(magic, 3) != "ply" ||
        (magic[3] != '\n' && magic[3] != '\r'))
        fail(file, "not a PLY file (it does not begin with 'ply')");
    if (magic[3] == '\r' && in.peek() == '\n') in.get();
    for (std::size_t n = 0;; ++n) {
        next_line();
        if (n > kMaxHeaderLines) fail(file, "more than 4096 header lines");
        std::istringstream words(line);
        std::string word, type, name;
        words >> word;
        if (word == "end_header") break;
        if (word == "comment") {
            header.comments.push_back(line.size() > 8 ? line.substr(8) : "");
        } else if (word == "obj_info") {
            continue;
        } else if (word == "format") {
            words >> type;
            if (type != "binary_little_endian")
                fail(file, fmt::format("format '{}', expected binary_little_endian", type));
            format_seen = true;
        } else if (word == "element") {
            words >> name;
            const bool nodes = vertex_seen && name == "node" && !nodes_seen;
            if (!nodes && (name != "vertex" || vertex_seen))
                fail(file, fmt::format("element '{}', expected the one element 'vertex', and after "
                                       "it none or the one element 'node'",
                                       name));
            if (!(words >> (nodes ? header.nodes : header.vertices)))
                fail(file, fmt::format("'{}': expected a count", line));
            (nodes ? nodes_seen : vertex_seen) = true;
        } else if (word == "property") {
            words >> type >> name;
            if (nodes_seen) {
                header.node_properties.push_back(type + " " + name);
                continue;
            }
            if (type != "float" && type != "float32")
                fail(file, fmt::format("property '{}', expected float32", line.substr(9)));
            if (std::find(header.properties.begin(), header.properties.end(), name) !=
                header.properties.end())
                fail(file, fmt::format("property '{}' twice", name));
            header.properties.push_back(name);
        } else {
            fail(file, fmt::format("header line '{}' is not PLY", line.substr(0, 60)));
        }
    }
    if (!format_seen) fail(file, "the header has no format line");
    header.has_nodes = nodes_seen;
    if (!vertex_seen) fail(file, "the header has no element vertex");
    header.body_offset = static_cast<std::uint64_t>(in.tellg());
    return header;
}

/// Rest of the first comment that starts with `key` and a blank; nothing if there is none.
const std::string* comment(const Header& header, const std::string& key, std::string& rest) {
    for (const std::string& text : header.comments)
        if (text.starts_with(key + " ")) return rest = text.substr(key.size() + 1), &rest;
    return nullptr;
}

/// Numbers of a comment value; throws where it holds anything else or another count.
std::vector<double> numbers(const std::filesystem::path& file, const std::string& key,
                            const std::string& text, std::size_t expected) {
    std::vector<double> values;
    const char *at = text.data(), *end = at + text.size();
    while (at != end) {
        if (*at == ' ') {
            ++at;
            continue;
        }
        double value;
        const auto [stop, code] = std::from_chars(at, end, value);
        if (code != std::errc{})
            fail(file, fmt::format("comment '{} {}': not a number", key, text));
        values.push_back(value);
        at = stop;
    }
    if (values.size() != expected)
        fail(file, fmt::format("comment '{} {}': {} numbers, expected {}", key, text, values.size(),
                               expected));
    return values;
}

enum class Layout { vog, splatting, volprim };

/// Tells the layout by its property names; anything it cannot place is refused.
Layout layout_of(const std::filesystem::path& file, const Header& header) {
    const auto has = [&](std::string_view name) {
        return std::find(header.properties.begin(), header.properties.end(), name) !=
               header.properties.end();
    };
    std::string all;
    for (const std::string& name : header.properties) all += (all.empty() ? "" : " ") + name;
    for (const char* name : {"x", "y", "z", "scale_0", "scale_1", "scale_2"})
        if (!has(name)) fail(file, fmt::format("no property '{}' (it has: {})", name, all));
    const int rotations = has("rot_0") + has("rot_1") + has("rot_2") + has("rot_3");
    if (rotations != 0 && rotations != 4)
        fail(file,
             fmt::format("{} of the properties rot_0 to rot_3, expected none or all", rotations));

    // One weight property tells whose layout it is.
    const bool sigmat = has("sigmat") || has("sigmat_0");
    if (has("density") + has("opacity") + sigmat != 1)
        fail(file,
             fmt::format("properties '{}' are none of the layouts vog (density), 3DGS (opacity) "
                         "or volprim (sigmat)",
                         all));
    const Layout layout = has("density")   ? Layout::vog
                          : has("opacity") ? Layout::splatting
                                           : Layout::volprim;
    if (layout != Layout::vog && rotations == 0)
        fail(file, "no properties rot_0 to rot_3, expected them beside opacity or sigmat");
    // Colour is not density: the neighbours' appearance coefficients are known and not used.
    const auto known = [&](const std::string& name) {
        static const std::vector<std::string> common = {
            "x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"};
        if (std::find(common.begin(), common.end(), name) != common.end()) return true;
        if (layout == Layout::vog) return name == "density";
        const bool appearance = name.starts_with("f_dc_") || name.starts_with("f_rest_") ||
                                name == "nx" || name == "ny" || name == "nz";
        if (layout == Layout::splatting) return appearance || name == "opacity";
        return appearance || name.starts_with("sigmat") || name.starts_with("albedo") ||
               name.starts_with("emission") || name.starts_with("sh_coeffs");
    };
    for (const std::string& name : header.properties)
        if (!known(name)) fail(file, fmt::format("unknown property '{}'", name));
    return layout;
}

/// The metadata of our own header lines.
void read_comments(const std::filesystem::path& file, const Header& header, Gaussians& model) {
    std::string value;
    if (!comment(header, "cutoff", value)) fail(file, "no header line 'comment cutoff'");
    model.cutoff = static_cast<float>(numbers(file, "cutoff", value, 1)[0]);
    if (comment(header, "box", value)) {
        const auto b = numbers(file, "box", value, 6);
        model.box = {{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
    }
    if (comment(header, "source_voxels", value))
        model.source_voxels =
            static_cast<std::uint64_t>(numbers(file, "source_voxels", value, 1)[0]);
    if (comment(header, "source", value)) model.source = value;
    if (comment(header, "method", value)) model.method = value;
    if (comment(header, "options", value)) model.options = value;
    if (comment(header, "reached", value)) model.summary = value;
}

/// Turns the neighbours' conventions into ours, in place.
void adopt_conventions(Layout layout, Gaussians& model) {
    if (layout == Layout::vog) return;
    constexpr float kThreeSigma = 3.0f;  // where both neighbours cut their kernel
    model.cutoff = kThreeSigma;
    for (std::size_t i = 0; i < model.size(); ++i) {
        Vec3f& s = model.scale[i];
        s = {std::exp(s.x), std::exp(s.y), std::exp(s.z)};  // both store logarithms
        if (layout == Layout::splatting) {
            // Opacity is a logit of the largest alpha. The peak at which a ray through the centre,
            // along the mean direction, has T = -ln(1 - alpha): a = T / (sqrt(2 pi) s), s the
            // geometric mean scale.
            const double alpha = 1 / (1 + std::exp(-double{model.density[i]}));
            const double spread = std::cbrt(double{s.x} * s.y * s.z);
            constexpr double kMaxAlpha = 0.9999;
            model.density[i] = static_cast<float>(-std::log1p(-std::min(alpha, kMaxAlpha)) /
                                                  (std::sqrt(2 * std::numbers::pi) * spread));
        } else {
            // volprim's weight multiplies a unit-mass pdf: peak = weight / ((2 pi)^(3/2) s1 s2 s3).
            model.density[i] = static_cast<float>(
                model.density[i] / (std::pow(2 * std::numbers::pi, 1.5) * s.x * s.y * s.z));
        }
    }
    model.method = layout == Layout::splatting ? "3DGS" : "volprim";
}

/// A hierarchy is ours: its rows are as we write them, or not understood.
/// returns  bytes of a node
std::size_t check_nodes(const std::filesystem::path& file, const Header& header, Layout layout,
                        bool axis_aligned) {
    if (!header.has_nodes) return 0;
    const std::vector<std::string> expected = node_properties(axis_aligned);
    if (layout != Layout::vog || header.node_properties != expected)
        fail(file,
             fmt::format("element 'node' with properties {}, expected {} beside vog's vertices",
                         fmt::join(header.node_properties, ", "), fmt::join(expected, ", ")));
    return bytes_per_node(axis_aligned);
}

std::string header_text(const Gaussians& model, std::uint64_t count, bool rotated,
                        const Hierarchy& hierarchy) {
    // Comments are lines: a newline inside a name must not start a header line of its own.
    const auto one_line = [](std::string text) {
        std::replace_if(
            text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
        return text;
    };
    std::string text = "ply\nformat binary_little_endian 1.0\n";
    text += "comment vog 1\n";
    text +=
        "comment kernel density * exp(-0.5 |W (x - mean)|^2), W = diag(1/scale) * transpose(R)\n";
    text += fmt::format("comment cutoff {}\n", model.cutoff);
    text +=
        "comment units scale: standard deviations in world units, density: peak per world unit, "
        "rot: quaternion w x y z\n";
    if (!model.box.empty())
        text +=
            fmt::format("comment box {} {} {} {} {} {}\n", model.box.lower.x, model.box.lower.y,
                        model.box.lower.z, model.box.upper.x, model.box.upper.y, model.box.upper.z);
    if (model.source_voxels) text += fmt::format("comment source_voxels {}\n", model.source_voxels);
    if (!model.source.empty()) text += "comment source " + one_line(model.source) + "\n";
    if (!model.method.empty()) text += "comment method " + one_line(model.method) + "\n";
    if (!model.options.empty()) text += "comment options " + one_line(model.options) + "\n";
    if (!model.summary.empty()) text += "comment reached " + one_line(model.summary) + "\n";
    if (!hierarchy.empty())
        text +=
            "comment nodes level by level: roots, then of each node in turn its children, nodes "
            "and vertices; radius: of a ball that holds all below, error: half the edge of its "
            "cell\n";
    text += fmt::format("element vertex {}\n", count);
    for (const char* name : {"x", "y", "z", "scale_0", "scale_1", "scale_2"})
        text += fmt::format("property float {}\n", name);
    if (rotated)
        for (int n = 0; n < 4; ++n) text += fmt::format("property float rot_{}\n", n);
    return text + "property float density\n" + node_header(hierarchy) + "end_header\n";
}

std::size_t floats_per_gaussian(const Gaussians& model) { return model.axis_aligned() ? 7 : 11; }

/// hierarchy  null where only a part is read
Gaussians read_model(const std::filesystem::path& file, const ModelPart& part,
                     Hierarchy* hierarchy) {
    require_readable(file);
    std::ifstream in(file, std::ios::binary);
    const Header header = read_header(file, in);
    const Layout layout = layout_of(file, header);

    std::map<std::string, std::size_t> column;
    for (std::size_t n = 0; n < header.properties.size(); ++n) column[header.properties[n]] = n;
    const bool rotated = column.contains("rot_0");

    // The body's length is known: a short or long one is refused before anything is allocated.
    const std::uint64_t stride = header.properties.size();
    const std::size_t node_bytes = check_nodes(file, header, layout, !rotated);
    const std::uint64_t body = std::filesystem::file_size(file) - header.body_offset;
    const bool countable = header.vertices <= body / (stride * sizeof(float)) &&
                           (header.nodes == 0 || header.nodes <= body / node_bytes);
    const std::uint64_t expected =
        countable ? header.vertices * stride * sizeof(float) + header.nodes * node_bytes : 0;
    if (!countable || body != expected)
        fail(file, fmt::format("{} bytes of data, expected {} Gaussians of {} bytes{}: {}", body,
                               header.vertices, stride * sizeof(float),
                               header.has_nodes
                                   ? fmt::format(" and {} nodes of {}", header.nodes, node_bytes)
                                   : "",
                               !countable || body < expected ? "truncated" : "too long"));
    const char* weight = layout == Layout::splatting ? "opacity"
                         : layout == Layout::vog     ? "density"
                         : column.contains("sigmat") ? "sigmat"
                                                     : "sigmat_0";
    const auto first_of = [&](int index) {
        const auto i = static_cast<std::uint64_t>(index);
        const auto parts = static_cast<std::uint64_t>(part.count);
        return header.vertices / parts * i + header.vertices % parts * i / parts;
    };
    const std::uint64_t begin = first_of(part.index);
    const std::size_t n = first_of(part.index + 1) - begin;
    in.seekg(static_cast<std::streamoff>(header.body_offset + begin * stride * sizeof(float)));
    Gaussians model;
    model.mean.resize(n), model.scale.resize(n), model.density.resize(n);
    if (rotated) model.rotation.resize(n);

    // Read and scatter block by block: the whole body is never held twice.
    constexpr std::size_t kBlock = 1 << 16;
    std::vector<float> rows(std::min(n, kBlock) * stride);
    const std::size_t cx = column["x"], cy = column["y"], cz = column["z"], c0 = column["scale_0"],
                      c1 = column["scale_1"], c2 = column["scale_2"], cd = column[weight];
    const std::size_t q0 = rotated ? column["rot_0"] : 0, q1 = rotated ? column["rot_1"] : 0,
                      q2 = rotated ? column["rot_2"] : 0, q3 = rotated ? column["rot_3"] : 0;
    for (std::size_t first = 0; first < n; first += kBlock) {
        const std::size_t count = std::min(kBlock, n - first);
        const auto bytes = static_cast<std::streamsize>(count * stride * sizeof(float));
        if (!in.read(reinterpret_cast<char*>(rows.data()), bytes))
            fail(file, "cannot be read to its end");
        for (std::size_t i = 0; i < count; ++i) {
            const float* row = rows.data() + i * stride;
            model.mean[first + i] = {row[cx], row[cy], row[cz]};
            model.scale[first + i] = {row[c0], row[c1], row[c2]};
            if (rotated) model.rotation[first + i] = {row[q0], row[q1], row[q2], row[q3]};
            model.density[first + i] = row[cd];
        }
    }
    if (layout == Layout::vog) read_comments(file, header, model);
    adopt_conventions(layout, model);

    const std::string source = model.source;
    model.source = file.string();
    validate(model);
    model.source = source;
    if (!hierarchy) return model;
    *hierarchy = {};
    if (header.nodes == 0) return model;
    if (!read_nodes(in, header.nodes, !rotated, *hierarchy))
        fail(file, "cannot be read to its end");
    hierarchy->nodes.cutoff = model.cutoff;
    link(*hierarchy, n, file.string());
    validate(*hierarchy, n, model.cutoff, file.string());
    return model;
}

}  // namespace

Gaussians read_ply(const std::filesystem::path& file, Hierarchy* hierarchy) {
    return read_model(file, {}, hierarchy);
}

Gaussians read_ply(const std::filesystem::path& file, const ModelPart& part) {
    if (part.count < 1 || part.index < 0 || part.index >= part.count)
        fail(file, fmt::format("part {} of {}, expected 0 to one less than a number of parts",
                               part.index, part.count));
    return read_model(file, part, nullptr);
}

std::string ply_header(const Gaussians& description, std::uint64_t count, bool rotated) {
    return header_text(description, count, rotated, {});
}

std::vector<float> ply_rows(const Gaussians& gaussians, std::size_t first, std::size_t count,
                            bool rotated) {
    std::vector<float> rows(count * (rotated ? 11 : 7));
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
    }
    return rows;
}

void write_ply(const std::filesystem::path& file, const Gaussians& gaussians,
               const Hierarchy& hierarchy) {
    validate(gaussians);
    const bool rotated = !gaussians.axis_aligned();
    validate(hierarchy, gaussians.size(), gaussians.cutoff, file.string());
    if (!hierarchy.empty() && hierarchy.nodes.axis_aligned() != gaussians.axis_aligned())
        fail(file, "a model and a hierarchy of which one alone has rotations");
    if (!in_one_order(hierarchy))
        fail(file, "a hierarchy joined of several, expected that of the whole (build_hierarchy)");
    const std::string header = header_text(gaussians, gaussians.size(), rotated, hierarchy);
    write_beside_and_rename(file, [&](const std::filesystem::path& beside) {
        std::ofstream out(beside, std::ios::binary);
        out << header;
        constexpr std::size_t kBlock = 1 << 16;
        for (std::size_t first = 0; first < gaussians.size(); first += kBlock) {
            const std::vector<float> rows =
                ply_rows(gaussians, first, std::min(kBlock, gaussians.size() - first), rotated);
            out.write(reinterpret_cast<const char*>(rows.data()),
                      static_cast<std::streamsize>(rows.size() * sizeof(float)));
        }
        write_nodes(out, hierarchy);
        if (!out.flush()) fail(file, "cannot write: the disk may be full");
    });
}

std::size_t ply_bytes(const Gaussians& gaussians, const Hierarchy& hierarchy) {
    return header_text(gaussians, gaussians.size(), !gaussians.axis_aligned(), hierarchy).size() +
           gaussians.size() * floats_per_gaussian(gaussians) * sizeof(float) +
           hierarchy.size() * bytes_per_node(gaussians.axis_aligned());
}

}  // namespace vog
