// nrrd.cpp: NRRD (.nrrd, .nhdr): https://teem.sourceforge.net/nrrd/format.html
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

#include "io/scan/nrrd/nrrd_head.h"
#include "io/scan/scan_file.h"
#include "io/scan/scan_values.h"
#include "io/scan/text_head.h"
#include "vog/text.h"

namespace vog::scan {

namespace {

Number type_of(const NrrdHead& head) {
    // Names of teem's library, between commas.
    static constexpr std::pair<Number, const char*> kTypes[] = {
        {Number::int8, "signed char,int8,int8_t"},
        {Number::uint8, "uchar,unsigned char,uint8,uint8_t"},
        {Number::int16, "short,short int,signed short,signed short int,int16,int16_t"},
        {Number::uint16, "ushort,unsigned short,unsigned short int,uint16,uint16_t"},
        {Number::int32, "int,signed int,int32,int32_t"},
        {Number::uint32, "uint,unsigned int,uint32,uint32_t"},
        {Number::int64,
         "longlong,long long,long long int,signed long long,signed long long int,int64,int64_t"},
        {Number::uint64, "ulonglong,unsigned long long,unsigned long long int,uint64,uint64_t"},
        {Number::float32, "float"},
        {Number::float64, "double"}};
    const std::string type = lower_case(head.text("type"));
    for (const auto& [number, names] : kTypes) {
        std::istringstream words(names);
        for (std::string name; std::getline(words, name, ',');)
            if (name == type) return number;
    }
    head.fail(fmt::format("type '{}', expected integers of 8 to 64 bits, float or double",
                          printable(head.text("type"), 40)));
}

double component(const std::vector<double>& v, std::size_t n) { return n < v.size() ? v[n] : 0; }
Vec3d in_space(const std::vector<double>& v) {
    return {component(v, 0), component(v, 1), component(v, 2)};
}

/// Quoted words: "mm" "mm" "".
std::vector<std::string> quoted(const std::string& text) {
    std::vector<std::string> words;
    for (std::size_t at = text.find('"'); at != std::string::npos; at = text.find('"', at)) {
        const std::size_t end = text.find('"', at + 1);
        if (end == std::string::npos) break;
        words.push_back(text.substr(at + 1, end - at - 1));
        at = end + 1;
    }
    return words;
}

/// Axes in space, and the one of frames or channels.
struct NrrdAxes {
    std::vector<std::size_t> space;
    std::optional<std::size_t> other;
};

/// Whether an axis is in space: by its direction, else by its kind, else unless its spacing is NaN.
/// Some writers state no spacing at all by NaN: then it says nothing of the axes.
std::vector<bool> space_axes(const NrrdHead& head, std::size_t dimension,
                             const NrrdVectors& directions) {
    std::vector<bool> space(dimension, true);
    const std::vector<std::string> kinds = words_of(lower_case(head.text("kinds")));
    std::vector<double> spacings;
    if (head.fields.contains("spacings"))
        spacings = numbers_of(head.file, "spacings", head.text("spacings"), dimension);
    const bool stated = std::ranges::any_of(spacings, [](double s) { return !std::isnan(s); });
    for (std::size_t n = 0; n < dimension; ++n) {
        const std::string kind = kinds.size() == dimension ? kinds[n] : "???";
        if (!directions.empty())
            // A fourth component is time, along which space must not lie.
            space[n] = directions[n] && component(*directions[n], 3) == 0;
        else if (kind == "???" || kind == "none")
            space[n] = !stated || !std::isnan(spacings[n]);
        else
            space[n] = kind == "domain" || kind == "space";
        if (directions.empty() || space[n] || !directions[n]) continue;
        if (in_space(*directions[n]) != Vec3d{})
            head.fail(
                fmt::format("axis {} runs in space and in time, expected one of them", n + 1));
    }
    return space;
}

NrrdAxes axes_of(const NrrdHead& head, std::size_t dimension, const NrrdVectors& directions) {
    NrrdAxes axes;
    std::vector<std::size_t> others;
    const std::vector<bool> space = space_axes(head, dimension, directions);
    for (std::size_t n = 0; n < dimension; ++n) (space[n] ? axes.space : others).push_back(n);
    // Without kinds the last of four axes is that of frames.
    if (axes.space.size() == 4) {
        others.push_back(axes.space.back());
        axes.space.pop_back();
    }
    if (axes.space.size() < 2 || axes.space.size() > 3 || others.size() > 1)
        head.fail(
            fmt::format("{} axes in space and {} others, expected 2 or 3 in space and at most one "
                        "other (frames or channels)",
                        axes.space.size(), others.size()));
    if (others.empty()) return axes;
    axes.other = others.front();
    if (*axes.other != 0 && *axes.other + 1 != dimension)
        head.fail(
            fmt::format("frames or channels along axis {} of {}, expected the first or the last",
                        *axes.other + 1, dimension));
    return axes;
}

/// Whether the world's x runs to the left and its y to the back.
struct Anatomy {
    bool left = false, posterior = false, known = false;
};

Anatomy anatomy_of(const NrrdHead& head) {
    std::string space = lower_case(head.text("space"));
    if (space.ends_with("-time")) space.resize(space.size() - 5);
    if (space.ends_with("t") && space.size() == 4) space.pop_back();
    if (space == "right-anterior-superior" || space == "ras") return {false, false, true};
    if (space == "left-anterior-superior" || space == "las") return {true, false, true};
    if (space == "left-posterior-superior" || space == "lps") return {true, true, true};
    if (space.empty() || space.starts_with("scanner-xyz") || space.starts_with("3d-right-handed"))
        return {};
    head.fail(
        fmt::format("space '{}', expected right-anterior-superior, left-anterior-superior, "
                    "left-posterior-superior, scanner-xyz or 3D-right-handed",
                    printable(head.text("space"), 40)));
}

/// Edge of the voxels along an axis, and the centre of the first one; NaN: not stated.
struct NrrdSpan {
    double edge = 1, first = 0;
};

/// Span of an axis by its spacing and its least and largest place, each NaN where it is not stated.
/// axis  counts from 1, for messages
/// throws vog::Error where they contradict each other
NrrdSpan span_of(const NrrdHead& head, std::size_t axis, std::int64_t voxels,
                 const std::string& center, double spacing, double least, double most) {
    if (std::isinf(spacing) || std::isinf(least) || std::isinf(most))
        head.fail(fmt::format("axis {} with spacing {} from {} to {}, expected finite numbers",
                              axis, spacing, least, most));
    const auto count = static_cast<double>(voxels);
    const double cells = (most - least) / count,
                 nodes = voxels > 1 ? (most - least) / (count - 1) : cells;
    const auto is_spacing = [&](double edge) {
        constexpr double kRounding = 1e-3;
        return std::abs(spacing - edge) <= kRounding * std::abs(spacing);
    };
    // Places are those of the first and the last sample, or of the outer faces of their cells.
    const bool node = center == "node" || (center != "cell" && is_spacing(nodes) && voxels > 1);
    NrrdSpan span;
    const double between = node ? nodes : cells;
    if (std::isfinite(spacing + between) && !is_spacing(between))
        head.fail(
            fmt::format("axis {} from {} to {}, which is a spacing of {}, but its spacing is {}, "
                        "expected one of them",
                        axis, least, most, between, spacing));
    if (std::isfinite(spacing))
        span.edge = spacing;
    else if (std::isfinite(between))
        span.edge = between;
    if (std::isnan(least)) least = most - span.edge * (node ? count - 1 : count);
    span.first = least + (node ? 0 : span.edge / 2);
    return span;
}

/// Voxels by spacings, from axis mins or up to axis maxs where those are given.
/// note  receives the axes without a place beside others that have one
Affine map_by_spacings(const NrrdHead& head, const std::vector<std::int64_t>& sizes,
                       const NrrdAxes& axes, std::string& note) {
    const std::size_t dimension = sizes.size();
    std::array<Vec3d, 3> axis{Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    const auto numbers = [&](const char* key) {
        return head.fields.contains(key) ? numbers_of(head.file, key, head.text(key), dimension)
                                         : std::vector<double>(dimension, std::nan(""));
    };
    // Places in a named space need directions: ITK refuses spacings there, others read them without the space.
    for (const char* key : {"space origin", "space"})
        if (head.fields.contains(key))
            head.fail(fmt::format("{} without space directions, expected both or neither", key));
    const std::vector<double> spacings = numbers("spacings"), mins = numbers("axis mins"),
                              maxs = numbers("axis maxs");
    std::vector<std::string> centers = words_of(lower_case(head.text("centers")));
    if (centers.size() != dimension) centers.assign(dimension, "");
    Vec3d origin;
    std::size_t placed = 0;
    for (std::size_t n = 0; n < axes.space.size(); ++n) {
        const std::size_t from = axes.space[n];
        const NrrdSpan span = span_of(head, from + 1, sizes[from], centers[from], spacings[from],
                                      mins[from], maxs[from]);
        axis[n][static_cast<int>(n)] = span.edge;
        if (std::isnan(span.first)) {
            note += fmt::format("{}axis {} has no least place, read as 0", note.empty() ? "" : "; ",
                                from + 1);
            continue;
        }
        origin[static_cast<int>(n)] = span.first;
        ++placed;
    }
    if (placed == 0) note.clear();
    return affine_of_axes(axis, origin);
}

/// throws vog::Error for vectors with other components than the space has dimensions
void check_space(const NrrdHead& head, const NrrdVectors& directions) {
    const std::string space = lower_case(head.text("space"));
    const bool time = space.ends_with("time") || (space.size() == 4 && space.ends_with('t'));
    std::optional<std::size_t> expected;
    if (!space.empty()) expected = time ? 4 : 3;
    if (head.fields.contains("space dimension"))
        expected = integers_of(head.file, "space dimension", head.text("space dimension"), 1)[0];
    NrrdVectors vectors = directions;
    if (head.fields.contains("space origin"))
        std::ranges::copy(vectors_of(head, "space origin"), std::back_inserter(vectors));
    for (const auto& vector : vectors) {
        if (vector && !expected) expected = vector->size();
        if (vector && vector->size() != expected)
            head.fail(
                fmt::format("a space direction or origin of {} components in a space of {} "
                            "dimensions, expected one for each",
                            vector->size(), *expected));
    }
}

Affine map_by_directions(const NrrdHead& head, const NrrdAxes& axes,
                         const NrrdVectors& directions) {
    for (const char* key : {"axis mins", "axis maxs"})
        if (head.fields.contains(key) && !head.fields.contains("space origin"))
            head.fail(fmt::format("{} beside space directions, expected space origin", key));
    std::array<Vec3d, 3> axis;
    for (std::size_t n = 0; n < axes.space.size(); ++n)
        axis[n] = in_space(*directions[axes.space[n]]);
    // A single slice is as thick as its voxels are wide.
    if (axes.space.size() == 2) axis[2] = length(axis[0]) * normalized(cross(axis[0], axis[1]));
    Vec3d origin;
    if (head.fields.contains("space origin")) {
        const auto vectors = vectors_of(head, "space origin");
        if (vectors.size() != 1 || !vectors[0]) head.fail("space origin, expected one vector");
        origin = in_space(*vectors[0]);
    }
    return affine_of_axes(axis, origin);
}

void set_encoding(const NrrdHead& head, StoredArray& array) {
    const std::string encoding = lower_case(head.text("encoding"));
    static constexpr std::pair<const char*, Encoding> kEncodings[] = {
        {"raw", Encoding::raw}, {"gzip", Encoding::deflate}, {"gz", Encoding::deflate},
        {"hex", Encoding::hex}, {"ascii", Encoding::text},   {"text", Encoding::text},
        {"txt", Encoding::text}};
    const auto* found = std::ranges::find(kEncodings, encoding, [](auto& e) { return e.first; });
    if (found == std::end(kEncodings))
        head.fail(fmt::format("encoding '{}', expected raw, gzip (unu save -e gzip), hex or ascii",
                              printable(encoding, 40)));
    array.encoding = found->second;
    const std::string endian = lower_case(head.text("endian"));
    if (endian != "little" && endian != "big" &&
        (!endian.empty() || (bytes_of(array.type) > 1 && array.encoding != Encoding::text)))
        head.fail(fmt::format("endian '{}', expected little or big", printable(endian, 40)));
    array.big_endian = endian == "big";
}

/// Place of the values: behind the head, or in files of their own. Lines are skipped in the files, bytes in what they
/// hold when unpacked.
void set_place(const NrrdHead& head, const std::vector<std::int64_t>& sizes, StoredArray& array) {
    if (!head.fields.contains("data file"))
        array.parts = {{head.file, head.bytes, 0}};
    else
        for (const auto& file : data_files(head.file, head.text("data file"), head.list, sizes))
            array.parts.push_back({file, 0, 0});
    array.behind_head = !head.fields.contains("data file");
    array.advice = fmt::format(": state 'byte skip: -1' for the last ones{}",
                               array.behind_head ? "" : ", or 'byte skip: 0' for the first");
    // Several heads may state places in one file.
    if (!array.behind_head &&
        (head.fields.contains("line skip") || head.fields.contains("byte skip")))
        array.spare = kAnySpare;
    std::int64_t lines = 0, skip = 0;
    if (head.fields.contains("line skip"))
        lines = integers_of(head.file, "line skip", head.text("line skip"), 1)[0];
    if (head.fields.contains("byte skip"))
        skip = integers_of(head.file, "byte skip", head.text("byte skip"), 1)[0];
    if (lines < 0 || skip < -std::numeric_limits<std::int32_t>::max())
        head.fail(
            fmt::format("line skip {} and byte skip {}, expected lines from 0 on", lines, skip));
    for (StoredPart& part : array.parts) {
        // Values at the end need no lines before them, but a packed stream begins behind them.
        if (skip >= 0 || array.is_packed()) part.begin = skip_lines(part.file, part.begin, lines);
        if (skip > 0 && array.is_packed())
            part.skip = static_cast<std::uint64_t>(skip);
        else if (skip > 0)
            part.begin += static_cast<std::uint64_t>(skip);
    }
    // -1: the values are the last bytes; -2: they end one byte before the end.
    if (skip >= 0) return;
    place_at_end(array, static_cast<std::uint64_t>(-skip - 1));
    array.spare = kAnySpare;
}

std::vector<std::string> nrrd_names(const NrrdHead& head, std::size_t dimension,
                                    const NrrdAxes& axes, std::uint64_t count) {
    if (!axes.other) return numbered_names("t", 1);
    const std::vector<std::string> kinds = words_of(lower_case(head.text("kinds")));
    const std::string kind = kinds.size() == dimension ? kinds[*axes.other] : "";
    if (kind.starts_with("rgb") && count <= 4) return color_names(count);
    const bool told = kind == "vector" || kind == "point" || kind.find("-") != kind.npos ||
                      kind.find("color") != kind.npos;
    const bool time = kind == "time" || kind == "list" || (!told && *axes.other > 0);
    return numbered_names(time ? "t" : "c", count);
}

}  // namespace

ScanFile open_nrrd(const std::filesystem::path& file) {
    const NrrdHead head = read_nrrd_head(file);
    for (const char* key : {"type", "dimension", "sizes", "encoding"})
        if (!head.fields.contains(key)) head.fail(fmt::format("no field '{}'", key));
    const std::int64_t rank = integers_of(file, "dimension", head.text("dimension"), 1)[0];
    if (rank < 2 || rank > 4) head.fail(fmt::format("{} axes, expected 2 to 4", rank));
    const auto dimension = static_cast<std::size_t>(rank);
    const std::vector<std::int64_t> sizes =
        integers_of(file, "sizes", head.text("sizes"), dimension);

    NrrdVectors directions;
    if (head.fields.contains("space directions")) {
        directions = vectors_of(head, "space directions");
        if (directions.size() != dimension)
            head.fail(
                fmt::format("{} space directions, expected {}", directions.size(), dimension));
    }
    const NrrdAxes axes = axes_of(head, dimension, directions);
    const auto edge = [&](std::size_t n) {
        return n < axes.space.size() ? sizes[axes.space[n]] : 1;
    };
    StoredArray array;
    array.type = type_of(head);
    array.voxels = checked_voxels(file, edge(0), edge(1), edge(2));
    if (axes.other) {
        const std::int64_t count = sizes[*axes.other];
        if (count < 1 || count > kMostGrids)
            head.fail(fmt::format("{} frames or channels, expected 1 to {}", count, kMostGrids));
        array.grids = static_cast<std::uint64_t>(count);
        array.interleaved = *axes.other == 0;
    }
    set_encoding(head, array);
    set_place(head, sizes, array);

    ScanFile scan;
    ScanGrid grid;
    grid.size = {static_cast<std::int32_t>(edge(0)), static_cast<std::int32_t>(edge(1)),
                 static_cast<std::int32_t>(edge(2))};
    grid.type = type_name(array.type);
    grid.value_unit = head.text("sample units");
    if (directions.empty()) {
        grid.world_from_index = map_by_spacings(head, sizes, axes, scan.note);
    } else {
        check_space(head, directions);
        const Anatomy anatomy = anatomy_of(head);
        grid.world_from_index =
            to_ras(map_by_directions(head, axes, directions), anatomy.left, anatomy.posterior);
        if (anatomy.known) {
            grid.standing = kPatient;
            grid.coordinates = fmt::format("RAS (right, anterior, superior), from {}",
                                           printable(head.text("space"), 40));
        }
    }
    // Units of the axes, or of the world's.
    const bool by_axis = directions.empty() || !head.fields.contains("space units");
    const std::vector<std::string> quotes = quoted(head.text(by_axis ? "units" : "space units"));
    std::vector<std::string> units;
    for (std::size_t n = 0; n < axes.space.size(); ++n)
        if (const std::size_t from = by_axis ? axes.space[n] : n; from < quotes.size())
            units.push_back(quotes[from]);
    if (by_axis && !directions.empty() && !units.empty() &&
        std::ranges::count(units, units[0]) != std::ssize(units))
        head.fail(fmt::format("units '{}' beside space directions, expected space units",
                              printable(head.text("units"), 40)));
    set_units(file, units, grid);
    // So ITK writes images of four axes, without the name of its space.
    if (head.text("space dimension") == "4" && head.text("space").empty())
        scan.note =
            "places are as the file has them, without a space; if ITK wrote it, its x runs to the "
            "left and its y to the back";
    scan.read = reader_of(array);
    scan.grids = named_copies(grid, nrrd_names(head, dimension, axes, array.grids));
    return scan;
}

}  // namespace vog::scan
