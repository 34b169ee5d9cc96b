// metaimage.cpp: MetaImage (.mha, .mhd) of ITK: https://itk.org/Wiki/ITK/MetaIO/Documentation
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "io/scan/scan_file.h"
#include "io/scan/scan_values.h"
#include "io/scan/text_head.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::scan {

namespace {

/// Lines "Key = value", by their keys in lower case; the last one names the place of the values.
struct MetaHead {
    std::filesystem::path file;
    std::multimap<std::string, std::string> fields;
    std::vector<std::string> list;  ///< names of files behind "ElementDataFile = LIST"
    std::uint64_t bytes = 0;        ///< to the end of the head

    /// Value of these keys, which mean the same; empty: none of them is in the head.
    /// throws vog::Error where they have several values
    std::string text(std::initializer_list<const char*> keys) const {
        const std::string* value = nullptr;
        for (const char* key : keys)
            for (auto [at, end] = fields.equal_range(key); at != end; ++at) {
                if (value && *value != at->second)
                    fail(fmt::format("{} '{}' and '{}', expected one of them", key,
                                     printable(*value, 40), printable(at->second, 40)));
                value = &at->second;
            }
        return value ? *value : std::string();
    }
    bool flag(std::initializer_list<const char*> keys, bool otherwise) const {
        const std::string value = lower_case(text(keys));
        if (value.empty()) return otherwise;
        if (value == "true" || value == "t" || value == "1") return true;
        if (value == "false" || value == "f" || value == "0") return false;
        fail(fmt::format("{} '{}', expected True or False", *keys.begin(), printable(value, 40)));
    }
    [[noreturn]] void fail(const std::string& what) const {
        throw Error(fmt::format("{}: {}", file.string(), what));
    }
};

MetaHead read_meta_head(const std::filesystem::path& file) {
    MetaHead head;
    head.file = file;
    TextHead text(file);
    std::string line;
    while (!head.fields.contains("elementdatafile")) {
        if (!text.next(line))
            head.fail("a head without 'ElementDataFile = ...', expected a MetaImage");
        if (without_blanks(line).empty()) continue;
        const std::size_t equals = line.find_first_of("=:");
        if (equals == std::string::npos)
            head.fail(fmt::format("line '{}', expected 'Key = value'", printable(line, 40)));
        const std::string key = lower_case(without_blanks(line.substr(0, equals)));
        head.fields.emplace(key, without_blanks(line.substr(equals + 1)));
    }
    head.bytes = text.position();
    if (const auto words = words_of(head.text({"elementdatafile"}));
        !words.empty() && words[0] == "LIST")
        while (text.next(line))
            if (const std::string name(without_blanks(line)); !name.empty())
                head.list.push_back(name);
    return head;
}

Number type_of(const MetaHead& head) {
    static const std::map<std::string, Number> kTypes{
        {"MET_CHAR", Number::int8},       {"MET_UCHAR", Number::uint8},
        {"MET_SHORT", Number::int16},     {"MET_USHORT", Number::uint16},
        {"MET_INT", Number::int32},       {"MET_UINT", Number::uint32},
        {"MET_LONG", Number::int32},      {"MET_ULONG", Number::uint32},
        {"MET_LONG_LONG", Number::int64}, {"MET_ULONG_LONG", Number::uint64},
        {"MET_FLOAT", Number::float32},   {"MET_DOUBLE", Number::float64}};
    std::string name = head.text({"elementtype"});
    if (name.ends_with("_ARRAY")) name.resize(name.size() - 6);  // of several channels
    const auto at = kTypes.find(name);
    if (at == kTypes.end())
        head.fail(
            fmt::format("ElementType '{}', expected MET_CHAR, MET_UCHAR, MET_SHORT, ... MET_FLOAT "
                        "or MET_DOUBLE",
                        printable(name, 40)));
    return at->second;
}

/// Map of the voxels: row n of the matrix is the direction of axis n.
Affine map_of(const MetaHead& head, std::size_t rank) {
    std::vector<double> spacing(rank, 1), origin(rank, 0), matrix(rank * rank, 0);
    for (std::size_t n = 0; n < rank; ++n) matrix[n * rank + n] = 1;
    const auto set = [&](std::vector<double>& values, std::initializer_list<const char*> keys) {
        const std::string text = head.text(keys);
        if (!text.empty()) values = numbers_of(head.file, *keys.begin(), text, values.size());
    };
    set(spacing, {head.fields.contains("elementspacing") ? "elementspacing" : "elementsize"});
    set(origin, {"offset", "position", "origin"});
    set(matrix, {"transformmatrix", "rotation", "orientation"});
    std::array<Vec3d, 3> axis{Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Vec3d first;
    const std::size_t spatial = std::min<std::size_t>(rank, 3);
    for (std::size_t n = 0; n < spatial; ++n) {
        for (std::size_t c = 0; c < spatial; ++c)
            axis[n][static_cast<int>(c)] = spacing[n] * matrix[n * rank + c];
        first[static_cast<int>(n)] = origin[n];
    }
    for (std::size_t n = 0; n < 3 && rank > 3; ++n)
        if (matrix[n * rank + 3] != 0 || matrix[3 * rank + n] != 0)
            head.fail("a TransformMatrix that mixes space and time, expected 0 there");
    if (rank == 2) axis[2] = {0, 0, spacing[0]};
    return affine_of_axes(axis, first);
}

void set_place(const MetaHead& head, const std::vector<std::int64_t>& sizes, StoredArray& array) {
    const std::string named = head.text({"elementdatafile"});
    const bool local = lower_case(named) == "local";
    if (local)
        array.parts = {{head.file, head.bytes, 0}};
    else
        for (const auto& file : data_files(head.file, named, head.list, sizes))
            array.parts.push_back({file, 0, 0});
    const std::string header = head.text({"headersize"});
    array.behind_head = local;
    std::vector<std::string> ways;
    if (array.type == Number::int32 || array.type == Number::uint32)
        ways.push_back("ElementType = MET_LONG_LONG for 8 bytes each");
    if (head.text({"elementnumberofchannels"}).empty())
        ways.push_back("ElementNumberOfChannels for several in each voxel");
    if (array.encoding == Encoding::raw) ways.push_back("HeaderSize = -1 for the last ones");
    if (!ways.empty()) array.advice = fmt::format(": state {}", fmt::join(ways, ", or "));
    if (header.empty()) return;
    if (!local) array.spare = kAnySpare;
    const std::int64_t skip = integers_of(head.file, "HeaderSize", header, 1)[0];
    if (skip < -1) head.fail(fmt::format("HeaderSize {}, expected -1 or more", skip));
    if (skip == -1) {
        // The values are the last bytes of the file; packed ones as many as CompressedDataSize states.
        if (array.encoding == Encoding::deflate) {
            const std::string packed = head.text({"compresseddatasize"});
            if (packed.empty())
                head.fail("HeaderSize -1 of packed values, expected CompressedDataSize");
            const std::int64_t bytes = integers_of(head.file, "CompressedDataSize", packed, 1)[0];
            for (StoredPart& part : array.parts) {
                const auto size = static_cast<std::int64_t>(std::filesystem::file_size(part.file));
                if (bytes < 0 || bytes > size)
                    head.fail(
                        fmt::format("CompressedDataSize {} of a file of {} bytes", bytes, size));
                part.begin = static_cast<std::uint64_t>(size - bytes);
            }
        } else {
            place_at_end(array);
        }
    } else if (!local) {
        for (StoredPart& part : array.parts) part.begin = static_cast<std::uint64_t>(skip);
    }
}

}  // namespace

ScanFile open_metaimage(const std::filesystem::path& file) {
    const MetaHead head = read_meta_head(file);
    if (const std::string kind = lower_case(head.text({"objecttype"}));
        !kind.empty() && kind != "image")
        head.fail(fmt::format("ObjectType '{}', expected Image", printable(kind, 40)));
    for (const char* key : {"ndims", "dimsize"})
        if (!head.fields.contains(key)) head.fail(fmt::format("no '{}'", key));
    const std::int64_t rank = integers_of(file, "NDims", head.text({"ndims"}), 1)[0];
    if (rank < 2 || rank > 4) head.fail(fmt::format("{} axes, expected 2 to 4", rank));
    const auto dimension = static_cast<std::size_t>(rank);
    const std::vector<std::int64_t> sizes =
        integers_of(file, "DimSize", head.text({"dimsize"}), dimension);

    StoredArray array;
    array.type = type_of(head);
    array.voxels = checked_voxels(file, sizes[0], sizes[1], rank > 2 ? sizes[2] : 1);
    std::int64_t channels = 1;
    if (const std::string text = head.text({"elementnumberofchannels"}); !text.empty())
        channels = integers_of(file, "ElementNumberOfChannels", text, 1)[0];
    const std::int64_t frames = rank > 3 ? sizes[3] : 1;
    if (channels < 1 || frames < 1 || channels > kMostGrids || frames > kMostGrids)
        head.fail(fmt::format("{} channels and {} frames, expected 1 to {}", channels, frames,
                              kMostGrids));
    if (channels > 1 && frames > 1)
        head.fail(
            fmt::format("{} channels in {} frames, expected one of either", channels, frames));
    array.grids = static_cast<std::uint64_t>(std::max(channels, frames));
    array.interleaved = channels > 1;
    array.big_endian = head.flag({"binarydatabyteordermsb", "elementbyteordermsb"}, false);
    if (head.flag({"compresseddata"}, false)) array.encoding = Encoding::deflate;
    if (!head.flag({"binarydata"}, true)) array.encoding = Encoding::text;
    for (const auto& [key, number] : {std::pair{"elementtointensityfunctionslope", &array.slope},
                                      {"elementtointensityfunctionoffset", &array.offset}})
        if (const std::string text = head.text({key}); !text.empty())
            *number = numbers_of(file, key, text, 1)[0];
    if (!std::isfinite(array.slope + array.offset) || array.slope == 0)
        head.fail(
            fmt::format("values times {} plus {} by ElementToIntensityFunction, expected finite "
                        "numbers and no slope of 0",
                        array.slope, array.offset));
    if (array.slope != 1) array.scale = "ElementToIntensityFunctionSlope";
    set_place(head, sizes, array);

    ScanGrid grid;
    grid.size = {static_cast<std::int32_t>(sizes[0]), static_cast<std::int32_t>(sizes[1]),
                 static_cast<std::int32_t>(rank > 2 ? sizes[2] : 1)};
    grid.type = type_name(array.type);
    // ITK's world is LPS. ITK writes AnatomicalOrientation into every file, "????" where it has no name for the axes.
    const bool anatomical = head.fields.contains("anatomicalorientation");
    grid.world_from_index = to_ras(map_of(head, dimension), anatomical, anatomical);
    grid.coordinates =
        anatomical
            ? "RAS (right, anterior, superior), from ITK's LPS"
            : "those of the file, which has no AnatomicalOrientation (ITK reads them as LPS)";
    if (anatomical) grid.standing = kPatient;
    const std::string unit = lower_case(head.text({"distanceunits"}));
    if (!unit.empty() && unit != "?") set_units(file, {unit}, grid);
    ScanFile scan;
    scan.read = reader_of(array);
    scan.grids = named_copies(grid, numbered_names(channels > 1 ? "c" : "t", array.grids));
    return scan;
}

}  // namespace vog::scan
