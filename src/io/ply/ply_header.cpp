// ply_header.cpp: parsing, checking and writing the header of a PLY model.
#include "io/ply/ply_header.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <istream>
#include <sstream>
#include <string_view>
#include <utility>

#include "io/exchange/splat_frame.h"
#include "io/ply/ply_fields.h"
#include "io/ply/ply_nodes.h"
#include "vog/error.h"
#include "vog/surface.h"
#include "vog/text.h"

namespace vog::ply {

namespace {

constexpr std::size_t kMaxLines = 4096;
constexpr std::array<std::string_view, 3> kFormats{"binary_little_endian", "binary_big_endian",
                                                   "ascii"};
/// Both names of each Type, in their order.
constexpr std::array<std::array<std::string_view, 2>, 8> kTypes{{{"char", "int8"},
                                                                 {"uchar", "uint8"},
                                                                 {"short", "int16"},
                                                                 {"ushort", "uint16"},
                                                                 {"int", "int32"},
                                                                 {"uint", "uint32"},
                                                                 {"float", "float32"},
                                                                 {"double", "float64"}}};

/// Header lines one after another, into a Header.
class HeaderReader {
  public:
    HeaderReader(const std::filesystem::path& file, std::istream& in) : file_(file), in_(in) {}

    Header read() {
        read_magic();
        for (std::size_t n = 0;; ++n) {
            const std::string line = next_line();
            if (n > kMaxLines) fail(file_, fmt::format("more than {} header lines", kMaxLines));
            if (!read_line(line)) break;
        }
        if (!has_format_) fail(file_, "the header has no format line");
        header_.body_offset = static_cast<std::uint64_t>(in_.tellg());
        const auto vertex = std::ranges::find(header_.elements, "vertex", &Element::name);
        if (vertex == header_.elements.end()) fail(file_, "the header has no element vertex");
        header_.vertex = static_cast<std::size_t>(vertex - header_.elements.begin());
        header_.vertices = vertex->count;
        for (const Property& property : vertex->properties) {
            if (property.is_list)
                fail(file_, fmt::format("property '{}' of a vertex is a list, expected a number",
                                        property.name));
            header_.properties.push_back(property.name);
        }
        return std::move(header_);
    }

  private:
    void read_magic() {
        char magic[4] = {};
        in_.read(magic, 4);
        if (in_.gcount() < 4 || std::string_view(magic, 3) != "ply" ||
            (magic[3] != '\n' && magic[3] != '\r'))
            fail(file_, "not a PLY file (it does not begin with 'ply')");
        // Lines may end in CR alone; the body may then begin with a byte that looks like LF.
        if (magic[3] == '\r' && in_.peek() != '\n') header_.line_end = '\r';
        if (magic[3] == '\r' && in_.peek() == '\n') in_.get();
    }

    std::string next_line() {
        std::string line;
        if (!std::getline(in_, line, header_.line_end) || in_.eof())
            fail(file_, "truncated: the PLY header has no end_header");
        if (!line.empty() && line.back() == '\r') line.pop_back();
        return line;
    }

    /// False for end_header.
    bool read_line(const std::string& line) {
        std::istringstream words(line);
        std::string word;
        words >> word;
        if (word == "end_header") return false;
        if (word == "comment") {
            header_.comments.push_back(line.size() > 8 ? line.substr(8) : "");
        } else if (word == "format") {
            std::string type;
            words >> type;
            const auto known = std::ranges::find(kFormats, type);
            if (known == kFormats.end())
                fail(file_, fmt::format("format '{}', expected ascii or binary", type));
            header_.format = static_cast<Format>(known - kFormats.begin());
            has_format_ = true;
        } else if (word == "element") {
            read_element(line, words);
        } else if (word == "property") {
            read_property(line, words);
        } else if (word != "obj_info") {
            fail(file_, fmt::format("header line '{}' is not PLY", line.substr(0, 60)));
        }
        return true;
    }

    void read_element(const std::string& line, std::istream& words) {
        Element element;
        words >> element.name;
        if (std::ranges::find(header_.elements, element.name, &Element::name) !=
            header_.elements.end())
            fail(file_, fmt::format("element '{}' twice", element.name));
        if (!(words >> element.count)) fail(file_, fmt::format("'{}': expected a count", line));
        header_.elements.push_back(std::move(element));
    }

    void read_property(const std::string& line, std::istream& words) {
        if (header_.elements.empty()) fail(file_, fmt::format("'{}' before an element", line));
        std::vector<Property>& properties = header_.elements.back().properties;
        Property property;
        std::string type, count;
        words >> type;
        property.is_list = type == "list";
        if (property.is_list) {
            words >> count >> type;
            property.count = type_named(line, count);
        }
        property.type = type_named(line, type);
        words >> property.name;
        if (std::ranges::find(properties, property.name, &Property::name) != properties.end())
            fail(file_, fmt::format("property '{}' twice", property.name));
        properties.push_back(std::move(property));
    }
    Type type_named(const std::string& line, const std::string& name) const {
        for (std::size_t type = 0; type < kTypes.size(); ++type)
            if (name == kTypes[type][0] || name == kTypes[type][1]) return static_cast<Type>(type);
        fail(file_,
             fmt::format("'{}': type '{}', expected char to double", line.substr(0, 60), name));
    }

    const std::filesystem::path& file_;
    std::istream& in_;
    Header header_;
    bool has_format_ = false;
};

/// Printable text behind `key` and a blank of the first such comment, in `rest`; null if there is
/// none.
const std::string* comment(const Header& header, const std::string& key, std::string& rest) {
    for (const std::string& text : header.comments)
        if (text.starts_with(key + " "))
            return rest = printable(text.substr(key.size() + 1)), &rest;
    return nullptr;
}

/// Parses a comment's value as exactly `expected` numbers.
/// throws vog::Error otherwise
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

std::uint64_t count(const std::filesystem::path& file, const std::string& key,
                    const std::string& text) {
    std::uint64_t value = 0;
    const char* end = text.data() + text.size();
    const auto [stop, code] = std::from_chars(text.data(), end, value);
    if (code != std::errc{} || stop != end)
        fail(file, fmt::format("comment '{} {}': expected a whole number >= 0", key, text));
    return value;
}

}  // namespace

std::size_t bytes_of(Type type) {
    constexpr std::array<std::size_t, 8> kBytes{1, 1, 2, 2, 4, 4, 4, 8};
    return kBytes[static_cast<std::size_t>(type)];
}

void fail(const std::filesystem::path& file, const std::string& what) {
    throw Error(fmt::format("{}: {}", file.string(), what));
}

Header read_header(const std::filesystem::path& file, std::istream& in) {
    return HeaderReader(file, in).read();
}

Layout layout_of(const std::filesystem::path& file, const Header& header) {
    const auto has = [&](std::string_view name) {
        return std::find(header.properties.begin(), header.properties.end(), name) !=
               header.properties.end();
    };
    std::string all;
    for (const std::string& name : header.properties) all += (all.empty() ? "" : " ") + name;
    if (has("packed_position"))
        fail(file, "a packed PLY of SuperSplat, expected a plain one (splat-transform unpacks it)");
    if (has("x") && has("y") && has("z") && !has("scale_0") && is_surface_file(file))
        fail(file,
             "a mesh of triangles, expected splats: vog render VOLUME --show volume --layer "
             "MESH.ply draws it in a volume");
    if (has("x") && has("y") && has("z") && !has("scale_0"))
        fail(file, fmt::format("points without scales (it has: {}), expected splats; particles are "
                               "read as text (.csv, .xyz), .hdf5 or .vdb",
                               all));
    for (const char* name : {"x", "y", "z", "scale_0", "scale_1", "scale_2"})
        if (!has(name)) fail(file, fmt::format("no property '{}' (it has: {})", name, all));
    const int rotations = has("rot_0") + has("rot_1") + has("rot_2") + has("rot_3");
    if (rotations != 0 && rotations != 4)
        fail(file,
             fmt::format("{} of the properties rot_0 to rot_3, expected none or all", rotations));

    // The weight property identifies the layout.
    const bool sigmat = has("sigmat") || has("sigmat_0");
    if (has("density") + has("opacity") + sigmat != 1)
        fail(file, fmt::format("properties '{}' are none of the layouts vog (density), 3DGS "
                               "(opacity) or volprim (sigmat)",
                               all));
    const Layout layout = has("density")   ? Layout::vog
                          : has("opacity") ? Layout::splatting
                                           : Layout::volprim;
    if (layout != Layout::vog && rotations == 0)
        fail(file, "no properties rot_0 to rot_3, expected them beside opacity or sigmat");
    return layout;
}

void refuse_unknown(const std::filesystem::path& file, const Header& header, Layout layout,
                    const Fields& fields) {
    if (layout != Layout::vog) return;
    const std::vector<std::string> known = gaussian_properties(true, fields);
    if (header.format != Format::little_endian)
        fail(file, fmt::format("format '{}', expected binary_little_endian",
                               kFormats[static_cast<std::size_t>(header.format)]));
    for (const Property& property : header.elements[header.vertex].properties) {
        if (std::ranges::find(known, property.name) == known.end())
            fail(file, fmt::format("unknown property '{}'", property.name));
        if (property.type != Type::float32)
            fail(file, fmt::format("property '{}', expected float32", property.name));
    }
    for (std::size_t n = 0; n < header.elements.size(); ++n)
        if (n != header.vertex && (n != header.vertex + 1 || header.elements[n].name != "node"))
            fail(file, fmt::format("element '{}', expected the one element 'vertex', and after it "
                                   "none or the one element 'node'",
                                   header.elements[n].name));
}

std::size_t check_nodes(const std::filesystem::path& file, const Header& header, bool axis_aligned,
                        const Fields& fields) {
    const Element* nodes = header.nodes();
    if (!nodes) return 0;
    std::vector<std::string> found;
    for (const Property& property : nodes->properties)
        found.push_back(fmt::format("{}{} {}", property.is_list ? "list " : "",
                                    kTypes[static_cast<std::size_t>(property.type)][0],
                                    property.name));
    const std::vector<std::string> expected = node_properties(axis_aligned, fields);
    if (found != expected)
        fail(file,
             fmt::format("element 'node' with properties {}, expected {} beside vog's vertices",
                         fmt::join(found, ", "), fmt::join(expected, ", ")));
    return bytes_per_node(axis_aligned, fields);
}

void read_comments(const std::filesystem::path& file, const Header& header, Gaussians& model) {
    std::string value;
    // Minor versions add comments, which readers of the same major version leave out.
    if (comment(header, "vog", value) && value != "1" && !value.starts_with("1."))
        fail(file, fmt::format("a model of version {}, expected 1: written by another vog", value));
    if (!comment(header, "cutoff", value)) fail(file, "no header line 'comment cutoff'");
    model.cutoff = static_cast<float>(numbers(file, "cutoff", value, 1)[0]);
    if (comment(header, "origin", value)) {
        const auto o = numbers(file, "origin", value, 3);
        model.origin = {o[0], o[1], o[2]};
    }
    if (comment(header, "box", value)) {
        const auto b = numbers(file, "box", value, 6);
        model.box = {{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
        for (std::size_t axis = 0; axis < 3; ++axis)
            if (!(b[axis] <= b[axis + 3]) || !std::isfinite(b[axis + 3] - b[axis]))
                fail(file,
                     fmt::format("comment 'box {}': expected finite lower corners, then upper ones",
                                 value));
    }
    if (comment(header, "voxels", value)) {
        const auto b = numbers(file, "voxels", value, 6);
        model.content.voxels = {{b[0], b[1], b[2]}, {b[3], b[4], b[5]}};
    }
    if (comment(header, "hull", value)) {
        const auto count = 1 + static_cast<std::size_t>(std::ranges::count(value, ' '));
        if (count % 3 != 0)
            fail(file,
                 fmt::format("comment 'hull' of {} numbers, expected x y z of each point", count));
        const auto h = numbers(file, "hull", value, count);
        for (std::size_t n = 0; n < count; n += 3)
            model.content.hull.push_back({h[n], h[n + 1], h[n + 2]});
    }
    for (const auto& [name, direction] :
         {std::pair{"up", &model.content.standing.up}, {"front", &model.content.standing.front}})
        if (comment(header, name, value)) {
            const auto v = numbers(file, name, value, 3);
            *direction = {v[0], v[1], v[2]};
        }
    comment(header, "length_unit", model.content.units.length);
    comment(header, "density_unit", model.content.units.density);
    model.content.by_value = comment(header, "by_value", value);
    if (comment(header, "source_voxels", value))
        model.source_voxels = count(file, "source_voxels", value);
    if (comment(header, "source", value)) model.source = value;
    if (comment(header, "method", value)) model.method = value;
    if (comment(header, "options", value)) model.options = value;
    if (comment(header, "reached", value)) model.summary = value;
}

void read_frame(const std::filesystem::path& file, const Header& header, Gaussians& model) try {
    std::string value;
    if (comment(header, exchange::kFrameKey, value))
        exchange::restore_frame(model, value, exchange::Upright::minus_y);
} catch (const Error& error) {
    fail(file, error.what());
}

std::string header_text(const Gaussians& model, std::uint64_t count, bool rotated,
                        const Hierarchy& hierarchy) {
    // A newline in a name would start a new header line.
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
    if (model.origin != Vec3d{})
        text += fmt::format("comment origin {} {} {}\n", model.origin.x, model.origin.y,
                            model.origin.z);
    const auto add_box = [&](const char* name, const Box& box) {
        if (!box.empty())
            text += fmt::format("comment {} {} {} {} {} {} {}\n", name, box.lower.x, box.lower.y,
                                box.lower.z, box.upper.x, box.upper.y, box.upper.z);
    };
    add_box("box", model.box);
    add_box("voxels", model.content.voxels);
    for (const auto& [name, v] :
         {std::pair{"up", model.content.standing.up}, {"front", model.content.standing.front}})
        if (v != Vec3d{}) text += fmt::format("comment {} {} {} {}\n", name, v.x, v.y, v.z);
    for (const auto& [name, unit] : {std::pair{"length_unit", model.content.units.length},
                                     {"density_unit", model.content.units.density}})
        if (!unit.empty()) text += fmt::format("comment {} {}\n", name, one_line(unit));
    if (model.content.by_value) text += "comment by_value 1\n";
    if (!model.content.hull.empty()) {
        text += "comment hull";
        for (const Vec3d& p : model.content.hull) text += fmt::format(" {} {} {}", p.x, p.y, p.z);
        text += "\n";
    }
    if (model.source_voxels) text += fmt::format("comment source_voxels {}\n", model.source_voxels);
    if (!model.source.empty()) text += "comment source " + one_line(model.source) + "\n";
    if (!model.method.empty()) text += "comment method " + one_line(model.method) + "\n";
    if (!model.options.empty()) text += "comment options " + one_line(model.options) + "\n";
    if (!model.summary.empty()) text += "comment reached " + one_line(model.summary) + "\n";
    text += field_comments(model.fields);
    if (!hierarchy.empty())
        text +=
            "comment nodes level by level: roots, then of each node in turn its children, nodes "
            "and vertices; radius: of a ball that holds all below, error: half the edge of its "
            "cell\n";
    text += fmt::format("element vertex {}\n", count);
    for (const std::string& name : gaussian_properties(rotated, model.fields))
        text += "property float " + name + "\n";
    text += node_header(hierarchy) + "end_header\n";
    const auto lines = static_cast<std::size_t>(std::ranges::count(text, '\n'));
    if (lines > kMaxLines)
        throw Error(fmt::format("{} fields in a PLY header of {} lines, expected at most {} lines",
                                model.fields.names().size(), lines, kMaxLines));
    return text;
}

}  // namespace vog::ply
