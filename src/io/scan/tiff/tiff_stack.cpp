// tiff_stack.cpp: Descriptions of TIFF files by ImageJ, OME (https://docs.openmicroscopy.org/ome-model) and tifffile.
#include "io/scan/tiff/tiff_stack.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "io/scan/scan_file.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::scan {

namespace {

[[noreturn]] void fail(const TiffTags& tags, const std::string& what) {
    throw Error(fmt::format("{}: {}", tags.name, what));
}

double number_or(const std::string& text, double otherwise) {
    double value = 0;
    const auto [stop, code] = std::from_chars(text.data(), text.data() + text.size(), value);
    return code == std::errc{} && std::isfinite(value) ? value : otherwise;
}
/// Number without its sign: ImageJ's spacing is negative for stacks from the top down.
double size_or(const std::string& text, double otherwise) {
    const double value = number_or(text, 0);
    return value != 0 ? std::abs(value) : otherwise;
}
std::uint64_t count_or(const std::string& text, std::uint64_t otherwise) {
    constexpr double kMost = 1e6;
    const double value = size_or(text, static_cast<double>(otherwise));
    return static_cast<std::uint64_t>(std::min(value, kMost));
}

/// Whether ResolutionUnit is the inch or the centimetre.
bool is_length(std::uint16_t unit) { return unit == 2 || unit == 3; }

/// Value of "key=text" in ImageJ's description.
std::string imagej(const std::string& description, const std::string& key) {
    const std::size_t at = description.find("\n" + key + "=");
    if (at == std::string::npos) return {};
    const std::size_t begin = at + key.size() + 2;
    std::string value = description.substr(begin, description.find('\n', begin) - begin);
    if (value.ends_with('\r')) value.pop_back();
    return value;
}

void set_imagej(const TiffTags& tags, TiffStack& stack) {
    const auto value = [&](const char* key) { return imagej(tags.description, key); };
    stack.channels = count_or(value("channels"), 1);
    stack.frames = count_or(value("frames"), 1);
    const std::uint64_t images = count_or(value("images"), 0);
    if (images % (stack.channels * stack.frames) != 0)
        fail(tags, fmt::format("ImageJ's {} images for {} channels and {} frames", images,
                               stack.channels, stack.frames));
    stack.slices = images / (stack.channels * stack.frames);
    if (tags.x_resolution > 0) stack.edge = {1 / tags.x_resolution, 1 / tags.y_resolution, 1};
    stack.edge.z = size_or(value("spacing"), 1);
    std::string unit = value("unit");
    if (unit.empty() && tags.x_resolution > 0 && is_length(tags.resolution_unit))
        unit = tags.resolution_unit == 2 ? "in" : "cm";
    for (const std::string& own : {unit, value("yunit"), value("zunit")})
        stack.units.push_back(own.empty() ? unit : own);
    stack.source = "rows down, pages along z; voxels as ImageJ states";
    for (int n = 0; n < 3; ++n)
        stack.origin[n] = number_or(value(fmt::format("{}origin", "xyz"[n]).c_str()), 0);
    // Functions of stored values: 0 to 3 are polynomials of degree 1 to 4, 20 is none.
    constexpr double kPolynomials = 4, kNone = 20;
    const double function = number_or(value("cf"), kNone);
    if (function == kNone) return;
    const auto terms =
        static_cast<std::size_t>(function >= 0 && function < kPolynomials ? function + 2 : 0);
    for (std::size_t n = 0; n < terms; ++n)
        if (const std::string c = value(fmt::format("c{}", n).c_str()); !c.empty())
            stack.coefficients.push_back(number_or(c, 0));
    if (terms > 0 && stack.coefficients.size() == terms) {
        stack.value_unit = value("vunit");
        return;
    }
    stack.coefficients.clear();
    stack.note = fmt::format(
        "values as stored, without ImageJ's calibration by function {}, which is no polynomial",
        function);
}

/// Tag of XML with its attributes: "Pixels" of <OME:Pixels SizeX="6">.
struct XmlTag {
    std::string name, text;

    std::string attribute(const std::string& key) const {
        for (std::size_t at = text.find(key); at != std::string::npos;
             at = text.find(key, at + 1)) {
            std::size_t next = text.find_first_not_of(" \t\r\n", at + key.size());
            if (at == 0 || !std::isspace(static_cast<unsigned char>(text[at - 1])) ||
                next == std::string::npos || text[next] != '=')
                continue;
            next = text.find_first_not_of(" \t\r\n", next + 1);
            if (next == std::string::npos || (text[next] != '"' && text[next] != '\'')) continue;
            const std::size_t end = text.find(text[next], next + 1);
            return decoded(text.substr(next + 1, end - next - 1));
        }
        return {};
    }
    /// Characters of Latin-1 by number, as writers escape those of units: &#181; &#xB5;
    static std::string decoded(std::string value) {
        for (std::size_t at = value.find("&#"); at != std::string::npos;
             at = value.find("&#", at + 1)) {
            const bool hex = at + 2 < value.size() && (value[at + 2] | 0x20) == 'x';
            const char* first = value.data() + at + (hex ? 3 : 2);
            unsigned code = 0;
            const char* stop =
                std::from_chars(first, value.data() + value.size(), code, hex ? 16 : 10).ptr;
            if (code == 0x3bc) code = 0xb5;  // the Greek letter
            if (code == 0 || code > 0xff || stop == value.data() + value.size() || *stop != ';')
                continue;
            std::string utf8(1, static_cast<char>(code));
            if (code > 0x7f)
                utf8 = {static_cast<char>(0xc0 | code >> 6),
                        static_cast<char>(0x80 | (code & 0x3f))};
            value.replace(at, static_cast<std::size_t>(stop + 1 - value.data()) - at, utf8);
        }
        return value;
    }
};

std::vector<XmlTag> tags_named(const std::string& xml, const std::string& name) {
    std::vector<XmlTag> tags;
    for (std::size_t at = xml.find('<'); at != std::string::npos; at = xml.find('<', at + 1)) {
        if (xml.compare(at, 4, "<!--") == 0) {
            at = std::min(xml.find("-->", at), xml.size() - 1);
            continue;
        }
        const std::size_t end = xml.find('>', at), stop = xml.find_first_of(" \t\r\n/>", at + 1);
        if (end == std::string::npos || stop == std::string::npos) break;
        std::string own = xml.substr(at + 1, stop - at - 1);
        if (const std::size_t colon = own.find(':'); colon != std::string::npos)
            own.erase(0, colon + 1);
        if (own == name) tags.push_back({own, xml.substr(stop, end - stop)});
    }
    return tags;
}

/// Places of pages by the TiffData of OME; as they lie in the file where there are none.
void set_places(const TiffTags& tags, TiffStack& stack) {
    const std::vector<XmlTag> data = tags_named(tags.description, "TiffData");
    constexpr std::size_t kNone = ~std::size_t{0};
    std::vector<std::size_t> plane_of(stack.planes(), kNone);
    std::size_t placed = 0;
    for (const XmlTag& one : data) {
        const auto first = [&](const char* key) { return count_or(one.attribute(key), 0); };
        const bool all = one.attribute("IFD").empty() && one.attribute("PlaneCount").empty();
        const std::uint64_t page = first("IFD"),
                            plane = stack.plane(first("FirstC") / tags.samples, first("FirstZ"),
                                                first("FirstT")),
                            count =
                                all ? plane_of.size() : count_or(one.attribute("PlaneCount"), 1);
        for (std::uint64_t n = 0; n < count && page + n < plane_of.size(); ++n, ++placed)
            plane_of[page + n] = plane + n;
    }
    if (data.empty()) return;
    if (placed != plane_of.size()) {
        // Pages without a place follow the order of dimensions, if those with one do.
        for (std::size_t page = 0; page < plane_of.size(); ++page)
            if (plane_of[page] != kNone && plane_of[page] != page)
                fail(tags, fmt::format("OME's TiffData place {} of {} planes, in another order "
                                       "than DimensionOrder, expected all",
                                       placed, plane_of.size()));
        return;
    }
    std::vector<bool> found(plane_of.size(), false);
    for (const std::size_t plane : plane_of)
        if (plane >= found.size() || found[plane])
            fail(tags,
                 "OME's TiffData give two pages one place, expected a place of its own for each");
        else
            found[plane] = true;
    stack.plane_of_page = plane_of;
}

void set_ome(const TiffTags& tags, TiffStack& stack) {
    const std::vector<XmlTag> images = tags_named(tags.description, "Pixels");
    if (images.size() != 1)
        fail(tags,
             fmt::format("OME describes {} images in this file, expected one", images.size()));
    std::set<std::string> files;
    for (const XmlTag& uuid : tags_named(tags.description, "UUID"))
        files.insert(printable(uuid.attribute("FileName"), 60));
    files.erase("");
    if (files.size() > 1)
        fail(tags, fmt::format("OME has planes in {} files, {} to {}, expected all in one, as "
                               "Bio-Formats' bfconvert writes them",
                               files.size(), *files.begin(), *files.rbegin()));
    const XmlTag& pixels = images[0];
    stack.channels =
        count_or(pixels.attribute("SizeC"), 1) / std::max<std::uint64_t>(tags.samples, 1);
    stack.frames = count_or(pixels.attribute("SizeT"), 1);
    stack.slices = count_or(pixels.attribute("SizeZ"), 1);
    const std::string order = pixels.attribute("DimensionOrder");
    if (stack.planes() > 1 && (!order.starts_with("XY") || order.size() != 5 ||
                               order.find_first_not_of("CZT", 2) != std::string::npos))
        fail(tags,
             fmt::format(
                 "OME's DimensionOrder '{}', expected XYCZT, XYZCT or another order of C, Z and T",
                 printable(order, 20)));
    if (order.size() == 5) stack.order = order.substr(2);
    constexpr std::uint64_t kMostPlanes = 1 << 20;
    if (stack.planes() == 0 || stack.planes() > kMostPlanes)
        fail(tags,
             fmt::format("OME's {} channels, {} slices and {} frames, expected 1 to {} in all",
                         stack.channels, stack.slices, stack.frames, kMostPlanes));
    set_places(tags, stack);
    for (const XmlTag& channel : tags_named(tags.description, "Channel"))
        stack.channel_names.push_back(printable(channel.attribute("Name"), 60));
    if (stack.channel_names.size() != stack.channels || tags.samples > 1)
        stack.channel_names.clear();
    std::string missing;
    for (int n = 0; n < 3; ++n) {
        const std::string key = fmt::format("PhysicalSize{}", "XYZ"[n]);
        const std::string size = pixels.attribute(key), unit = pixels.attribute(key + "Unit");
        stack.edge[n] = size_or(size, 1);
        stack.units.push_back(unit.empty() ? "um" : unit);
        if (size_or(size, 0) == 0 && (n < 2 || stack.slices > 1))
            missing += (missing.empty() ? "" : ", ") + key;
    }
    stack.source = "rows down, pages along z; voxels as OME states";
    if (missing.empty()) return;
    // Without a size its unit, too, is that of the first axis.
    if (missing.find('X') != std::string::npos) {
        stack.edge = {1, 1, 1};
        stack.units.clear();
        stack.source = "voxels of 1, OME states none";
        return;
    }
    stack.units[1] = missing.find('Y') == std::string::npos ? stack.units[1] : stack.units[0];
    stack.units[2] = missing.find('Z') == std::string::npos ? stack.units[2] : stack.units[0];
    stack.note = fmt::format("OME states no {}, read as 1 {}", missing, stack.units[0]);
}

/// tifffile's {"shape": [2, 10, 8, 6], "axes": "CZYX"}: unnamed axes are slices, then frames, then channels.
void set_shaped(const TiffTags& tags, TiffStack& stack) {
    const auto json = nlohmann::json::parse(tags.description, nullptr, false);
    if (!json.is_object() || !json.contains("shape") || !json["shape"].is_array()) return;
    std::vector<std::uint64_t> shape;
    for (const auto& edge : json["shape"]) {
        constexpr std::uint64_t kMostEdge = 1 << 30;
        if (!edge.is_number_unsigned() || edge.get<std::uint64_t>() > kMostEdge) return;
        shape.push_back(edge.get<std::uint64_t>());
    }
    std::string axes =
        json.contains("axes") && json["axes"].is_string() ? json["axes"].get<std::string>() : "";
    const bool planar =
        shape.size() > 2 && shape[shape.size() - 3] == tags.samples && tags.samples > 1;
    const std::size_t page = tags.samples > 1 ? 3 : 2;
    const auto is_page = [&](std::size_t height) {
        return height + 1 < shape.size() && shape[height] == tags.height &&
               shape[height + 1] == tags.width;
    };
    if (shape.size() < page ||
        !(is_page(shape.size() - page) || (planar && is_page(shape.size() - 2))))
        return;
    if (axes.size() != shape.size()) axes = std::string(shape.size(), 'Q');
    stack.slices = 1;
    stack.order.clear();
    for (std::size_t n = shape.size() - page; n-- > 0;) {
        if (shape[n] == 1) continue;
        const std::map<char, std::uint64_t*> counts{
            {'Z', &stack.slices}, {'T', &stack.frames}, {'C', &stack.channels}};
        std::string names = counts.contains(axes[n]) ? axes.substr(n, 1) : "ZTC";
        if (axes[n] == 'S') names = "C";
        // A name that stands before is not free for an axis without one.
        if (names.size() > 1)
            std::erase_if(names, [&](char c) {
                return axes.substr(0, shape.size() - page).find(c) != std::string::npos;
            });
        std::erase_if(names, [&](char c) { return stack.order.find(c) != std::string::npos; });
        if (names.empty())
            fail(tags,
                 fmt::format("axes {} of shape {}, expected slices, channels and frames at most",
                             printable(axes, 20), json["shape"].dump()));
        *counts.at(names[0]) = shape[n];
        stack.order += names[0];
    }
    for (const char c : std::string("CZT"))
        if (stack.order.find(c) == std::string::npos) stack.order += c;
    constexpr double kMostPlanes = 1 << 30;
    if (static_cast<double>(stack.slices) * static_cast<double>(stack.frames) *
            static_cast<double>(stack.channels) >
        kMostPlanes)
        fail(tags, fmt::format("planes of shape {}, expected fewer", json["shape"].dump()));
    // Pages that were written one by one have a shape of their own each.
    if (stack.planes() == 1) stack.slices = 0;
}

}  // namespace

std::uint64_t TiffStack::plane(std::uint64_t channel, std::uint64_t slice,
                               std::uint64_t frame) const {
    std::uint64_t number = 0, step = 1;
    for (const char axis : order) {
        number += step * (axis == 'C' ? channel : axis == 'Z' ? slice : frame);
        step *= axis == 'C' ? channels : axis == 'Z' ? slices : frames;
    }
    return number;
}

TiffStack tiff_stack(const TiffTags& tags) {
    TiffStack stack;
    stack.blank = number_or(tags.no_data, stack.blank);
    if (tags.description.starts_with("ImageJ=")) {
        set_imagej(tags, stack);
        return stack;
    }
    if (tags.description.find("<OME") != std::string::npos ||
        tags.description.find("<ome:OME") != std::string::npos) {
        set_ome(tags, stack);
        return stack;
    }
    set_shaped(tags, stack);
    if (const Vec3d scale = tags.pixel_scale; scale.x > 0 && scale.y > 0) {
        stack.edge = {scale.x, scale.y, scale.z > 0 ? scale.z : scale.x};
        stack.source =
            "rows down, pages along z; pixels as large as on GeoTIFF's map, from the first one on";
        return stack;
    }
    const double x = tags.x_resolution, y = tags.y_resolution;
    if (x <= 0) return stack;
    if (!is_length(tags.resolution_unit)) {
        if (tags.resolution_unit > 3)
            stack.note = fmt::format(
                "the size of pixels is unknown: the tag ResolutionUnit is {}, expected 1 (none), 2 "
                "(inch) or 3 (centimetre)",
                tags.resolution_unit);
        stack.edge.y = x / y;  // the shape of pixels, without their size
        if (x != y) stack.source = "rows down, pages along z; pixels 1 wide, by the resolution";
        return stack;
    }
    // 72 and 96 pixels an inch are the defaults of programs, which measured nothing.
    if (tags.resolution_unit == 2 && x == y && (x == 72 || x == 96)) return stack;
    const double millimetres = tags.resolution_unit == 2 ? 25.4 : 10;
    stack.edge = {millimetres / x, millimetres / y, millimetres / x};
    stack.units = {"mm"};
    stack.source =
        "rows down, pages along z; pixels by the resolution, slices as thick as they are wide";
    return stack;
}

void name_channels(const TiffStack& stack, std::vector<ScanGrid>& grids) {
    for (std::size_t n = 0; n < grids.size() && !stack.channel_names.empty(); ++n) {
        const std::string& name = stack.channel_names[n % stack.channels];
        if (name.empty()) continue;
        grids[n].plain_name = name;
        grids[n].coordinates = fmt::format("channel {}; {}", name, grids[n].coordinates);
    }
}

}  // namespace vog::scan
