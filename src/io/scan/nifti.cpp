// nifti.cpp: NIfTI-1 and NIfTI-2 (.nii, .nii.gz): https://nifti.nimh.nih.gov
// Read here, not by libnifti: its reader of values sets those that are not finite to 0 and missing ones too, and it
// allocates what the head claims before it looks at the file.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>

#include "io/scan/scan_file.h"
#include "io/scan/scan_values.h"
#include "vog/error.h"

namespace vog::scan {

namespace {

/// Head of either version, in the order of its fields.
struct NiftiHead {
    bool second = false;  ///< NIfTI-2
    std::array<std::int64_t, 8> dim{};
    std::array<double, 8> pixdim{};
    int datatype = 0, bits = 0, qform = 0, sform = 0, units = 0;
    double vox_offset = 0, slope = 0, inter = 0;
    std::array<double, 3> quatern{}, shift{};
    std::array<std::array<double, 4>, 3> srow{};
};

/// Numbers at places of a head, in either byte order.
class HeadBytes {
  public:
    HeadBytes(std::span<const char> bytes, bool swapped) : bytes_(bytes), swapped_(swapped) {}
    template <class T>
    T at(std::size_t place) const {
        std::array<char, sizeof(T)> copy;
        std::memcpy(copy.data(), bytes_.data() + place, sizeof(T));
        if (swapped_) std::ranges::reverse(copy);
        return std::bit_cast<T>(copy);
    }

  private:
    std::span<const char> bytes_;
    bool swapped_;
};

constexpr std::size_t kFirstBytes = 348, kSecondBytes = 540;

NiftiHead first_head(const HeadBytes& in) {
    NiftiHead head;
    for (std::size_t n = 0; n < 8; ++n) {
        head.dim[n] = in.at<std::int16_t>(40 + 2 * n);
        head.pixdim[n] = in.at<float>(76 + 4 * n);
    }
    head.datatype = in.at<std::int16_t>(70);
    head.bits = in.at<std::int16_t>(72);
    head.vox_offset = in.at<float>(108);
    head.slope = in.at<float>(112);
    head.inter = in.at<float>(116);
    head.units = in.at<std::uint8_t>(123);
    head.qform = in.at<std::int16_t>(252);
    head.sform = in.at<std::int16_t>(254);
    for (std::size_t n = 0; n < 3; ++n) {
        head.quatern[n] = in.at<float>(256 + 4 * n);
        head.shift[n] = in.at<float>(268 + 4 * n);
        for (std::size_t c = 0; c < 4; ++c) head.srow[n][c] = in.at<float>(280 + 16 * n + 4 * c);
    }
    return head;
}

NiftiHead second_head(const HeadBytes& in) {
    NiftiHead head;
    head.second = true;
    head.datatype = in.at<std::int16_t>(12);
    head.bits = in.at<std::int16_t>(14);
    for (std::size_t n = 0; n < 8; ++n) {
        head.dim[n] = in.at<std::int64_t>(16 + 8 * n);
        head.pixdim[n] = in.at<double>(104 + 8 * n);
    }
    head.vox_offset = static_cast<double>(in.at<std::int64_t>(168));
    head.slope = in.at<double>(176);
    head.inter = in.at<double>(184);
    head.qform = in.at<std::int32_t>(344);
    head.sform = in.at<std::int32_t>(348);
    for (std::size_t n = 0; n < 3; ++n) {
        head.quatern[n] = in.at<double>(352 + 8 * n);
        head.shift[n] = in.at<double>(376 + 8 * n);
        for (std::size_t c = 0; c < 4; ++c) head.srow[n][c] = in.at<double>(400 + 32 * n + 8 * c);
    }
    head.units = in.at<std::int32_t>(500);
    return head;
}

/// Type of a value and the number of its components.
struct NiftiType {
    Number type;
    std::uint64_t components = 1;
};

NiftiType type_of(const std::filesystem::path& file, int code) {
    switch (code) {
        case 2:
            return {Number::uint8};
        case 4:
            return {Number::int16};
        case 8:
            return {Number::int32};
        case 16:
            return {Number::float32};
        case 64:
            return {Number::float64};
        case 128:
            return {Number::uint8, 3};
        case 256:
            return {Number::int8};
        case 512:
            return {Number::uint16};
        case 768:
            return {Number::uint32};
        case 1024:
            return {Number::int64};
        case 1280:
            return {Number::uint64};
        case 2304:
            return {Number::uint8, 4};
        default:
            throw Error(fmt::format(
                "{}: values of NIfTI's datatype {}, expected integers of 8 to 64 bits, float32, "
                "float64 or RGB (2, 4, 8, 16, 64, 128, 256, 512, 768, 1024, 1280, 2304)",
                file.string(), code));
    }
}

/// Map by the quaternion (b, c, d) and the voxel sizes; pixdim[0] is -1 for a mirrored z.
Affine qform_map(const std::filesystem::path& file, const NiftiHead& head, Vec3d edge) {
    auto [b, c, d] = head.quatern;
    const double square = b * b + c * c + d * d;
    constexpr double kMostSquare = 1.01;  // above 1 by rounding
    if (!(square <= kMostSquare))
        throw Error(fmt::format("{}: quaternion ({}, {}, {}), expected a length up to 1",
                                file.string(), b, c, d));
    if (const double length = std::sqrt(square); length > 1) b /= length, c /= length, d /= length;
    const double a = std::sqrt(std::max(1 - (b * b + c * c + d * d), 0.0));
    const Mat3 rotation{
        {Vec3d{a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)},
         Vec3d{2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)},
         Vec3d{2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - b * b - c * c}}};
    const double mirror = head.pixdim[0] < 0 ? -1 : 1;
    return affine_of_axes({edge.x * rotation.column(0), edge.y * rotation.column(1),
                           (mirror * edge.z) * rotation.column(2)},
                          {head.shift[0], head.shift[1], head.shift[2]});
}

void add_note(std::string& notes, const std::string& note) {
    notes += (notes.empty() ? "" : "; ") + note;
}

/// Edges of a voxel, as nibabel has them: 1 for 0, and without their sign.
Vec3d voxel_edges(const NiftiHead& head, std::string& notes) {
    Vec3d edge;
    for (int n = 0; n < 3; ++n) {
        const double stated = head.pixdim[static_cast<std::size_t>(n) + 1];
        edge[n] = stated == 0 ? 1 : std::abs(stated);
        if (stated <= 0 && n < head.dim[0])
            add_note(notes, fmt::format("pixdim[{}] is {}, read as {}", n + 1, stated, edge[n]));
    }
    return edge;
}

/// Map of the voxels, by the method that the standard prefers among those in the head. An sform of zeros is none.
void set_map(const std::filesystem::path& file, const NiftiHead& head, ScanGrid& grid,
             std::string& notes) {
    Affine sform;
    for (std::size_t r = 0; r < 3; ++r) {
        sform.linear.row[r] = {head.srow[r][0], head.srow[r][1], head.srow[r][2]};
        sform.translation[static_cast<int>(r)] = head.srow[r][3];
    }
    const double det = determinant(sform.linear);
    const bool singular = head.sform > 0 && (det == 0 || !std::isfinite(det));
    if (singular && head.qform <= 0)
        throw Error(fmt::format(
            "{}: an sform that is singular and no qform, expected one of them to place the voxels",
            file.string()));
    if (singular) add_note(notes, "its sform is singular, the qform places its voxels");
    if (head.sform > 0 && !singular) {
        grid.world_from_index = sform;
        grid.coordinates = "RAS (right, anterior, superior), from the sform";
        grid.standing = kPatient;
    } else if (head.qform > 0) {
        grid.world_from_index = qform_map(file, head, voxel_edges(head, notes));
        grid.coordinates = "RAS (right, anterior, superior), from the qform";
        grid.standing = kPatient;
    } else {
        const Vec3d edge = voxel_edges(head, notes);
        grid.world_from_index =
            affine_of_axes({Vec3d{edge.x, 0, 0}, {0, edge.y, 0}, {0, 0, edge.z}}, {});
        grid.coordinates = "voxel sizes only, without an orientation";
    }
    constexpr const char* kUnits[] = {"", "m", "mm", "um"};
    if ((head.units & 7) < 4) grid.length_unit = kUnits[head.units & 7];
}

NiftiHead read_head(const std::filesystem::path& file, ScanBytes& bytes, bool& swapped) {
    const auto foreign = [&](const std::string& got) -> Error {
        return Error(fmt::format("{}: {}, expected NIfTI-1 ('n+1') or NIfTI-2 ('n+2') in one file",
                                 file.string(), got));
    };
    if (bytes.most_left() < kFirstBytes) throw foreign(fmt::format("{} bytes", bytes.most_left()));
    std::array<char, kSecondBytes> first;
    bytes.read(first.data(), kFirstBytes);
    const auto size = HeadBytes(first, false).at<std::uint32_t>(0);
    const auto other = HeadBytes(first, true).at<std::uint32_t>(0);
    swapped = other == kFirstBytes || other == kSecondBytes;
    const std::uint32_t head_bytes = swapped ? other : size;
    if (head_bytes == kFirstBytes) {
        if (std::memcmp(first.data() + 344, "n+1", 4) != 0)
            throw foreign(std::memcmp(first.data() + 344, "ni1", 4) == 0
                              ? "a NIfTI-1 head whose values lie in an .img"
                              : "a head of 348 bytes without the mark 'n+1'");
        return first_head({first, swapped});
    }
    if (head_bytes != kSecondBytes) throw foreign("no NIfTI head");
    if (std::memcmp(first.data() + 4, "n+2", 4) != 0)
        throw foreign("a head of 540 bytes without the mark 'n+2'");
    bytes.read(first.data() + kFirstBytes, kSecondBytes - kFirstBytes);
    return second_head({first, swapped});
}

/// Names of images: axis 4 is time, the fastest; axes behind it have the components of vectors.
std::vector<std::string> names_of(std::uint64_t images, std::uint64_t times) {
    if (times == images) return numbered_names("t", images);
    if (times <= 1) return numbered_names("c", images);
    std::vector<std::string> names;
    for (std::uint64_t n = 0; n < images; ++n)
        names.push_back(fmt::format("t{}c{}", n % times, n / times));
    return names;
}

}  // namespace

ScanFile open_nifti(const std::filesystem::path& file) {
    const bool deflated = is_gzip(file);
    ScanBytes bytes(file, 0, deflated ? Encoding::deflate : Encoding::raw);
    bool swapped = false;
    const NiftiHead head = read_head(file, bytes, swapped);
    ScanFile scan;

    const std::int64_t rank = head.dim[0];
    if (rank < 1 || rank > 7)
        throw Error(fmt::format("{}: {} axes, expected 1 to 7", file.string(), rank));
    // Behind the first axis 0 is 1, as ITK reads it.
    const auto edge = [&](std::size_t n) {
        const std::int64_t stated = static_cast<std::int64_t>(n) <= rank ? head.dim[n] : 1;
        return stated == 0 && n > 1 ? 1 : stated;
    };
    for (std::size_t n = 2; n < 8; ++n)
        if (static_cast<std::int64_t>(n) <= rank && head.dim[n] == 0)
            add_note(scan.note, fmt::format("dim[{}] is 0, read as 1", n));
    const NiftiType type = type_of(file, head.datatype);
    StoredArray array;
    array.encoding = deflated ? Encoding::deflate : Encoding::raw;
    array.big_endian = swapped != (std::endian::native == std::endian::big);
    array.type = type.type;
    array.voxels = checked_voxels(file, edge(1), edge(2), edge(3));
    // The head, and 4 bytes that announce extensions.
    const auto least = static_cast<double>((head.second ? kSecondBytes : kFirstBytes) + 4);
    double offset = head.vox_offset;
    if (offset == 0) {
        offset = least;
        add_note(scan.note, fmt::format("vox_offset is 0, read as {}", offset));
    }
    if (!(offset >= least && offset < 9e15))
        throw Error(fmt::format("{}: values at byte {}, expected {} or more", file.string(), offset,
                                least));
    array.parts = {{file, 0, static_cast<std::uint64_t>(offset)}};
    // As the standard has it: slope 0 is none. nibabel treats NaN the same way.
    if (head.slope != 0 && !std::isnan(head.slope) && type.components == 1) {
        if (!std::isfinite(head.slope) || !std::isfinite(head.inter))
            throw Error(fmt::format("{}: scl_slope is {} and scl_inter {}, expected finite numbers",
                                    file.string(), head.slope, head.inter));
        array.slope = head.slope;
        array.offset = head.inter;
    }
    std::uint64_t frames = 1;
    for (std::size_t n = 4; n < 8; ++n) {
        const std::int64_t count = edge(n);
        if (count < 1 || count > kMostGrids ||
            frames * static_cast<std::uint64_t>(count) > kMostGrids)
            throw Error(fmt::format("{}: {} images along axis {}, expected 1 to {} in all",
                                    file.string(), count, n, kMostGrids));
        frames *= static_cast<std::uint64_t>(count);
    }
    if (frames > 1 && type.components > 1)
        throw Error(fmt::format("{}: {} frames of RGB, expected one", file.string(), frames));
    array.grids = frames * type.components;
    array.interleaved = type.components > 1;
    array.spare = array.voxels / static_cast<std::uint64_t>(edge(3)) * type.components *
                      bytes_of(array.type) -
                  1;
    array.scale = "scl_slope";
    array.advice = ": state the size of all of them in dim";

    ScanGrid grid;
    grid.size = {static_cast<std::int32_t>(edge(1)), static_cast<std::int32_t>(edge(2)),
                 static_cast<std::int32_t>(edge(3))};
    grid.type = type_name(array.type);
    set_map(file, head, grid, scan.note);
    scan.read = reader_of(array);
    scan.grids = named_copies(grid, type.components > 1
                                        ? color_names(type.components)
                                        : names_of(frames, static_cast<std::uint64_t>(edge(4))));
    return scan;
}

}  // namespace vog::scan
