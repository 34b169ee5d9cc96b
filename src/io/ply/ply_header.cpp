// ply_header.cpp: parsing, checking and writing the header of a PLY model.
#include "io/ply/ply_header.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <istream>
#include <set>
#include <sstream>
#include <string_view>
#include <utility>

#include "data/field_arrays.h"
#include "io/ply/ply_fields.h"
#include "io/ply/ply_nodes.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::ply {

namespace {

constexpr std::size_t kMaxLines = 4096;

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
        if (!has_vertices_) fail(file_, "the header has no element vertex");
        header_.body_offset = static_cast<std::uint64_t>(in_.tellg());
        return std::move(header_);
    }

  private:
    void read_magic() {
        char magic[4] = {};
        in_.read(magic, 4);
        if (in_.gcount() < 4 || std::string_view(magic, 3) != "ply" ||
            (magic[3] != '\n' && magic[3] != '\r'))
            fail(file_, "not a PLY file (it does not begin with 'ply')");
        if (magic[3] == '\r' && in_.peek() == '\n') in_.get();
    }

    std::string next_line() {
        std::string line;
        if (!std::getline(in_, line) || in_.eof())
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
            if (type != "binary_little_endian")
                fail(file_, fmt::format("format '{}', expected binary_little_endian", type));
            has_format_ = true;
        } else if (word == "element") {
            read_element(line, words);
        } else if (word == "property") {
            read_property(words);
        } else if (word != "obj_info") {
            fail(file_, fmt::format("header line '{}' is not PLY", line.substr(0, 60)));
        }
        return true;
    }

    void read_element(const std::string& line, std::istream& words) {
        std::string name;
        words >> name;
        const bool nodes = has_vertices_ && name == "node" && !header_.has_nodes;
        if (!nodes && (name != "vertex" || has_vertices_))
            fail(file_, fmt::format("element '{}', expected the one element 'vertex', and after "
                                    "it none or the one element 'node'",
                                    name));
        if (!(words >> (nodes ? header_.nodes : header_.vertices)))
            fail(file_, fmt::format("'{}': expected a count", line));
        (nodes ? header_.has_nodes : has_vertices_) = true;
    }

    void read_property(std::istream& words) {
        std::string type, name;
        words >> type >> name;
        if (header_.has_nodes) {
            header_.node_properties.push_back(type + " " + name);
            return;
        }
        if (type != "float" && type != "float32")
            fail(file_, fmt::format("property '{} {}', expected float32", type, name));
        if (std::find(header_.properties.begin(), header_.properties.end(), name) !=
            header_.properties.end())
            fail(file_, fmt::format("property '{}' twice", name));
        header_.properties.push_back(name);
    }

    const std::filesystem::path& file_;
    std::istream& in_;
    Header header_;
    bool has_format_ = false, has_vertices_ = false;
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

/// Whether a layout has the property. Appearance coefficients of 3DGS and volprim are accepted and
/// ignored: they are not density.
bool known_property(Layout layout, const std::string& name) {
    static const std::vector<std::string> common = {
        "x", "y", "z", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"};
    if (std::find(common.begin(), common.end(), name) != common.end()) return true;
    if (layout == Layout::vog) return name == "density";
    const bool appearance = name.starts_with("f_dc_") || name.starts_with("f_rest_") ||
                            name == "nx" || name == "ny" || name == "nz";
    if (layout == Layout::splatting) return appearance || name == "opacity";
    return appearance || name.starts_with("sigmat") || name.starts_with("albedo") ||
           name.starts_with("emission") || name.starts_with("sh_coeffs");
}

}  // namespace

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
    for (const char* name : {"x", "y", "z", "scale_0", "scale_1", "scale_2"})
        if (!has(name)) fail(file, fmt::format("no property '{}' (it has: {})", name, all));
    const int rotations = has("rot_0") + has("rot_1") + has("rot_2") + has("rot_3");
    if (rotations != 0 && rotations != 4)
        fail(file,
             fmt::format("{} of the properties rot_0 to rot_3, expected none or all", rotations));

    // The weight property identifies the layout.
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
    return layout;
}

void refuse_unknown(const std::filesystem::path& file, const Header& header, Layout layout,
                    const Fields& fields) {
    const std::vector<std::string> columns = column_names(fields);
    const std::set<std::string> of_fields(columns.begin(), columns.end());
    for (const std::string& name : header.properties)
        if (!known_property(layout, name) && !of_fields.contains(name))
            fail(file, fmt::format("unknown property '{}'", name));
}

std::size_t check_nodes(const std::filesystem::path& file, const Header& header, Layout layout,
                        bool axis_aligned, const Fields& fields) {
    if (!header.has_nodes) return 0;
    const std::vector<std::string> expected = node_properties(axis_aligned, fields);
    if (layout != Layout::vog || header.node_properties != expected)
        fail(file,
             fmt::format("element 'node' with properties {}, expected {} beside vog's vertices",
                         fmt::join(header.node_properties, ", "), fmt::join(expected, ", ")));
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
                fail(file, fmt::format("comment 'box {}': expected finite lower corners, then "
                                       "upper ones",
                                       value));
    }
    if (comment(header, "source_voxels", value))
        model.source_voxels = count(file, "source_voxels", value);
    if (comment(header, "source", value)) model.source = value;
    if (comment(header, "method", value)) model.method = value;
    if (comment(header, "options", value)) model.options = value;
    if (comment(header, "reached", value)) model.summary = value;
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
    if (!model.box.empty())
        text +=
            fmt::format("comment box {} {} {} {} {} {}\n", model.box.lower.x, model.box.lower.y,
                        model.box.lower.z, model.box.upper.x, model.box.upper.y, model.box.upper.z);
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
    for (const char* name : {"x", "y", "z", "scale_0", "scale_1", "scale_2"})
        text += fmt::format("property float {}\n", name);
    if (rotated)
        for (int n = 0; n < 4; ++n) text += fmt::format("property float rot_{}\n", n);
    text += "property float density\n";
    for (const std::string& name : column_names(model.fields))
        text += "property float " + name + "\n";
    text += node_header(hierarchy) + "end_header\n";
    const auto lines = static_cast<std::size_t>(std::ranges::count(text, '\n'));
    if (lines > kMaxLines)
        throw Error(fmt::format("{} fields in a PLY header of {} lines, expected at most {} lines",
                                model.fields.names().size(), lines, kMaxLines));
    return text;
}

}  // namespace vog::ply
