// fits.cpp: FITS cubes by cfitsio, plain, gzip'd or packed by tiles: https://fits.gsfc.nasa.gov/fits_standard.html
#include <fmt/format.h>

#include "io/scan/scan_file.h"
#include "vog/error.h"

#ifdef VOG_CFITSIO
#include <fitsio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>

#include "core/atomic_file.h"
#include "core/paging.h"
#include "io/scan/scan_values.h"
#include "vog/text.h"
#endif

namespace vog::scan {

#ifndef VOG_CFITSIO

ScanFile open_fits(const std::filesystem::path& file) {
    throw Error(fmt::format("{}: this build reads no FITS (cfitsio was absent when it was built)",
                            file.string()));
}

#else

namespace {

/// Open file. Names with brackets are names: fits_open_diskfile knows no extended ones.
struct Fits {
    std::string name;
    fitsfile* handle = nullptr;

    explicit Fits(const std::filesystem::path& file) : name(file.string()) {
        require_readable(file);
        int status = 0;
        if (name.size() >= FLEN_FILENAME)
            throw Error(fmt::format("{}: a path of {} bytes, expected less than {}", name,
                                    name.size(), FLEN_FILENAME));
        check_gzip(file);
        fits_open_diskfile(&handle, name.c_str(), READONLY, &status);
        check(status);
    }
    ~Fits() {
        int status = 0;
        if (handle) fits_close_file(handle, &status);
        fits_clear_errmsg();
    }
    Fits(const Fits&) = delete;
    Fits& operator=(const Fits&) = delete;

    /// throws vog::Error with the library's words for a status that is a fault
    void check(int status) const {
        if (status == 0) return;
        char text[FLEN_STATUS];
        fits_get_errstatus(status, text);
        fits_clear_errmsg();
        throw Error(
            fmt::format("{}: {}, expected a FITS image of 2 to 4 axes", name, printable(text)));
    }
    /// The library allocates the length that ends a gzip'd file before it unpacks.
    void check_gzip(const std::filesystem::path& file) const {
        if (!is_gzip(file)) return;
        std::ifstream stream(file, std::ios::binary);
        std::array<unsigned char, 4> last{};
        stream.seekg(-4, std::ios::end);
        stream.read(reinterpret_cast<char*>(last.data()), 4);
        const std::uint64_t length = last[0] | std::uint64_t{last[1]} << 8 |
                                     std::uint64_t{last[2]} << 16 | std::uint64_t{last[3]} << 24;
        constexpr std::uint64_t kMostRatio = 1032, kHead = 4096;
        const std::uint64_t most = (std::filesystem::file_size(file) + kHead) * kMostRatio;
        if (!stream || length > most)
            throw Error(
                fmt::format("{}: truncated or corrupt: {} bytes unpacked, expected at most {}",
                            name, length, most));
    }
    bool has(const std::string& key) const {
        char card[FLEN_CARD];
        int status = 0;
        return fits_read_card(handle, key.c_str(), card, &status) == 0;
    }
    double number(const std::string& key, double otherwise) const {
        double value = otherwise;
        int status = 0;
        return fits_read_key(handle, TDOUBLE, key.c_str(), &value, nullptr, &status) == 0
                   ? value
                   : otherwise;
    }
    std::string text(const std::string& key) const {
        char value[FLEN_VALUE] = "";
        int status = 0;
        if (fits_read_key(handle, TSTRING, key.c_str(), value, nullptr, &status) != 0) return {};
        return printable(value, 40);
    }
};

/// Image of an HDU: its first three axes longer than 1, or all in order, and one of several images.
struct FitsImage {
    int hdu = 1, bits = 8;
    std::vector<long> edge;
    std::uint64_t voxels = 0, images = 1;
};

/// Map of pixels to the world's units where the axes have one unit; else voxels of 1.
void set_map(const Fits& fits, ScanGrid& grid) {
    std::array<std::string, 3> unit, type;
    bool known = false;
    for (std::size_t n = 0; n < 3; ++n) {
        const std::string axis = std::to_string(n + 1);
        unit[n] = fits.text("CUNIT" + axis);
        type[n] = fits.text("CTYPE" + axis);
        known |= fits.has("CDELT" + axis) || fits.has("CD" + axis + "_" + axis) ||
                 fits.has("CRVAL" + axis);
    }
    const bool flat = grid.size.z == 1;
    const bool same = unit[0] == unit[1] && (flat || unit[1] == unit[2]);
    std::string axes;
    for (std::size_t n = 0; n < 3; ++n)
        if (!type[n].empty() || !unit[n].empty())
            axes += fmt::format("{}{}{}{}", axes.empty() ? "" : ", ", type[n],
                                type[n].empty() || unit[n].empty() ? "" : " ", unit[n]);
    if (!known) {
        grid.coordinates = "pixels, the file states no others";
        return;
    }
    // An angle and a frequency have no common length; nor is a sphere a plane.
    const bool celestial = std::ranges::any_of(type, [](const std::string& t) {
        return t.size() > 5 && t.find('-') != std::string::npos && t[4] == '-';
    });
    if (!same || celestial) {
        grid.coordinates = fmt::format("pixels; its axes are {}", axes);
        return;
    }
    std::array<Vec3d, 3> axis{Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Vec3d origin;
    const bool matrix = fits.has("CD1_1") || fits.has("CD1_2") || fits.has("CD2_2");
    for (int r = 0; r < 3; ++r) {
        const std::string row = std::to_string(r + 1);
        origin[r] = fits.number("CRVAL" + row, 0);
        const double edge = fits.number("CDELT" + row, 1);
        for (int c = 0; c < 3; ++c) {
            const std::string place = row + "_" + std::to_string(c + 1);
            const double own = r == c ? 1.0 : 0.0;
            // CDi_j has no default of 1 where some of them are given, but for axes without any.
            const double entry =
                matrix ? fits.number("CD" + place, r == 2 && !fits.has("CD3_3") ? own * edge : 0)
                       : edge * fits.number("PC" + place, own);
            axis[static_cast<std::size_t>(c)][r] = entry;
        }
    }
    Affine map = affine_of_axes(axis, {});
    Vec3d reference;  // CRPIX counts from 1
    for (int n = 0; n < 3; ++n) reference[n] = fits.number("CRPIX" + std::to_string(n + 1), 0) - 1;
    map.translation = origin - map.linear * reference;
    grid.world_from_index = map;
    grid.length_unit = unit[0];
    grid.coordinates = axes.empty() ? "those of the file" : axes;
}

/// Whether the current HDU is an image of 2 axes or more; sets its shape.
bool read_shape(const Fits& fits, FitsImage& image) {
    int status = 0, kind = 0, rank = 0;
    fits.check(fits_get_hdu_type(fits.handle, &kind, &status));
    const bool packed = fits_is_compressed_image(fits.handle, &status) != 0;
    if (kind != IMAGE_HDU && !packed) return false;
    fits.check(fits_get_img_dim(fits.handle, &rank, &status));
    if (rank < 2) return false;
    constexpr int kMostAxes = 9;
    if (rank > kMostAxes) fits.check(BAD_NAXIS);
    image.edge.resize(static_cast<std::size_t>(rank));
    fits.check(fits_get_img_size(fits.handle, rank, image.edge.data(), &status));
    fits.check(fits_get_img_equivtype(fits.handle, &image.bits, &status));
    image.edge.resize(std::max<std::size_t>(image.edge.size(), 3), 1);
    image.voxels = checked_voxels(fits.name, image.edge[0], image.edge[1], image.edge[2]);
    for (std::size_t n = 3; n < image.edge.size(); ++n) {
        if (image.edge[n] < 1 || image.edge[n] > kMostGrids ||
            image.images * static_cast<std::uint64_t>(image.edge[n]) > kMostGrids)
            throw Error(fmt::format("{}: {} images along axis {}, expected 1 to {} in all",
                                    fits.name, image.edge[n], n + 1, kMostGrids));
        image.images *= static_cast<std::uint64_t>(image.edge[n]);
    }
    // Rice's and deflate's largest ratios are some 1000.
    constexpr double kMostRatio = 4000;
    const bool plain = !packed && !is_gzip(fits.name);
    const double bytes = static_cast<double>(std::filesystem::file_size(fits.name));
    const double needed = static_cast<double>(image.voxels) * static_cast<double>(image.images);
    if (needed > (plain ? bytes : kMostRatio * bytes))
        throw Error(
            fmt::format("{}: truncated: {} bytes, expected {} values", fits.name, bytes, needed));
    return true;
}

const char* type_of(int bits) {
    switch (bits) {
        case BYTE_IMG:
            return "uint8";
        case SBYTE_IMG:
            return "int8";
        case SHORT_IMG:
            return "int16";
        case USHORT_IMG:
            return "uint16";
        case LONG_IMG:
            return "int32";
        case ULONG_IMG:
            return "uint32";
        case LONGLONG_IMG:
            return "int64";
        case ULONGLONG_IMG:
            return "uint64";
        case FLOAT_IMG:
            return "float32";
        default:
            return "float64";
    }
}

BigVector<float> read_image(const std::filesystem::path& file, const FitsImage& image,
                            std::size_t n) {
    Fits fits(file);
    int status = 0;
    fits.check(fits_movabs_hdu(fits.handle, image.hdu, nullptr, &status));
    BigVector<float> values;
    resize_kept(values, image.voxels);
    float blank = std::numeric_limits<float>::quiet_NaN();
    constexpr std::uint64_t kStep = std::uint64_t{1} << 22;
    for (std::uint64_t at = 0; at < image.voxels; at += kStep) {
        const std::uint64_t count = std::min(kStep, image.voxels - at);
        int any = 0;
        fits_read_img(fits.handle, TFLOAT, static_cast<LONGLONG>(n * image.voxels + at + 1),
                      static_cast<LONGLONG>(count), &blank, values.data() + at, &any, &status);
        // A double beyond float's range is set to the largest one.
        if (status == NUM_OVERFLOW) status = 0;
        fits.check(status);
        keep_memory();
    }
    return values;
}

}  // namespace

ScanFile open_fits(const std::filesystem::path& file) {
    Fits fits(file);
    int status = 0, hdus = 0;
    fits.check(fits_get_num_hdus(fits.handle, &hdus, &status));
    constexpr int kMostHdus = 1000;
    std::vector<FitsImage> images;
    std::vector<std::pair<std::size_t, std::size_t> > place;
    ScanFile scan;
    for (int hdu = 1; hdu <= std::min(hdus, kMostHdus); ++hdu) {
        fits.check(fits_movabs_hdu(fits.handle, hdu, nullptr, &status));
        FitsImage image;
        image.hdu = hdu;
        if (!read_shape(fits, image)) continue;
        ScanGrid grid;
        grid.size = {static_cast<std::int32_t>(image.edge[0]),
                     static_cast<std::int32_t>(image.edge[1]),
                     static_cast<std::int32_t>(image.edge[2])};
        grid.type = type_of(image.bits);
        grid.value_unit = fits.text("BUNIT");
        set_map(fits, grid);
        const std::string named = fits.text("EXTNAME");
        const std::string base = named.empty() ? fmt::format("hdu{}", hdu) : named;
        for (std::uint64_t n = 0; n < image.images; ++n) {
            grid.name = image.images > 1 ? fmt::format("{}_{}", base, n) : base;
            scan.grids.push_back(grid);
            place.emplace_back(images.size(), n);
        }
        images.push_back(image);
    }
    if (scan.grids.empty())
        throw Error(fmt::format("{}: no image of 2 axes or more, expected a cube", file.string()));
    if (scan.grids.size() == 1) scan.grids[0].name = ScanGrid{}.name;
    if (images.size() == 1 && scan.grids.size() > 1) {
        const std::vector<std::string> names = numbered_names("c", scan.grids.size());
        for (std::size_t n = 0; n < names.size(); ++n) scan.grids[n].name = names[n];
    }
    scan.read = [file, images, place](std::size_t n) {
        return read_image(file, images[place[n].first], place[n].second);
    };
    return scan;
}

#endif

}  // namespace vog::scan
