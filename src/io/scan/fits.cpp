// fits.cpp: FITS cubes by cfitsio, plain, gzip'd or packed by tiles: https://fits.gsfc.nasa.gov/fits_standard.html
#include <fmt/format.h>

#include "io/scan/scan_file.h"
#include "vog/error.h"

#ifdef VOG_CFITSIO
#include <fitsio.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
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

constexpr std::uint64_t kBlock = 2880;

/// Open file. Names with brackets are names: fits_open_diskfile knows no extended ones. Files packed by gzip, in one
/// member or several, and those that do not end with a whole block are opened in memory.
struct Fits {
    std::string name;
    fitsfile* handle = nullptr;
    std::uint64_t size = 0;  ///< bytes, unpacked, without those added here
    BigVector<char> memory;
    void* begin = nullptr;  ///< of `memory`, where the library looks it up
    std::size_t memory_size = 0;

    explicit Fits(const std::filesystem::path& file) : name(file.string()) {
        require_readable(file);
        int status = 0;
        if (name.size() >= FLEN_FILENAME)
            throw Error(fmt::format("{}: a path of {} bytes, expected less than {}", name,
                                    name.size(), FLEN_FILENAME));
        const bool packed = is_gzip(file);
        if (packed) memory = unpacked_bytes(file);
        size = packed ? memory.size() : std::filesystem::file_size(file);
        if (!packed && size % kBlock != 0) {
            ScanBytes bytes(file);
            resize_kept(memory, size);
            bytes.read(memory.data(), size);
        }
        if (memory.empty()) {
            fits_open_diskfile(&handle, name.c_str(), READONLY, &status);
        } else {
            memory.resize((size + kBlock - 1) / kBlock * kBlock);
            begin = memory.data(), memory_size = memory.size();
            fits_open_memfile(&handle, "cube", READONLY, &begin, &memory_size, 0, nullptr, &status);
        }
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
    /// throws vog::Error where the file ends before the data of the current HDU do
    void check_data() const {
        LONGLONG head = 0, data = 0, end = 0;
        int status = 0;
        check(fits_get_hduaddrll(handle, &head, &data, &end, &status));
        double values = 1;
        const double rank = number("NAXIS", 0);
        for (int n = 1; n <= rank; ++n) values *= number("NAXIS" + std::to_string(n), 0);
        const double bytes = std::abs(number("BITPIX", 8)) / 8 * number("GCOUNT", 1) *
                             (number("PCOUNT", 0) + values);
        if (const double needed = static_cast<double>(data) + bytes;
            needed > static_cast<double>(size))
            throw Error(
                fmt::format("{}: truncated: {} bytes, expected {} or more", name, size, needed));
    }
    bool has(const std::string& key) const {
        char card[FLEN_CARD];
        int status = 0;
        return fits_read_card(handle, key.c_str(), card, &status) == 0;
    }
    double number(const std::string& key, double otherwise) const {
        double value = otherwise;
        int status = 0;
        if (fits_read_key(handle, TDOUBLE, key.c_str(), &value, nullptr, &status) == 0)
            return value;
        if (status != KEY_NO_EXIST && status != VALUE_UNDEFINED)
            throw Error(fmt::format("{}: {} is '{}', expected a number", name, key, text(key)));
        return otherwise;
    }
    std::string text(const std::string& key) const {
        char value[FLEN_VALUE] = "";
        int status = 0;
        if (fits_read_key(handle, TSTRING, key.c_str(), value, nullptr, &status) != 0) return {};
        return printable(value, 40);
    }
};

constexpr std::size_t kNoAxis = 99;

/// Images of an HDU: its axes along x, y and z, and the others, along which there are several images.
struct FitsImage {
    int hdu = 1, bits = 8;
    std::vector<long> edge;
    std::array<std::size_t, 3> space{kNoAxis, kNoAxis, kNoAxis};
    std::vector<std::size_t> others;
    std::uint64_t voxels = 0, images = 1;

    long size(std::size_t n) const { return space[n] == kNoAxis ? 1 : edge[space[n]]; }
    /// Pixel of each axis where image n begins, from 1.
    std::vector<long> first_pixel(std::size_t n) const {
        std::vector<long> pixel(edge.size(), 1);
        for (const std::size_t axis : others) {
            const auto count = static_cast<std::size_t>(edge[axis]);
            pixel[axis] = static_cast<long>(n % count) + 1;
            n /= count;
        }
        return pixel;
    }
};

/// Key of an axis, or of a pair of axes in either of the two spellings: CD1_2, CD001002.
std::string axis_key(const char* key, std::size_t axis) {
    return fmt::format("{}{}", key, axis + 1);
}
std::string pair_key(const Fits& fits, const char* key, std::size_t row, std::size_t column) {
    const std::string old = fmt::format("{}{:03}{:03}", key, row + 1, column + 1);
    return fits.has(old) ? old : fmt::format("{}{}_{}", key, row + 1, column + 1);
}

/// Linear world coordinates of the file, as wcslib has them: CDi_j, where absent 0; else CDELTi PCi_j.
class FitsWorld {
  public:
    FitsWorld(const Fits& fits, const FitsImage& image)
        : fits_(fits), rank_(image.edge.size()), entry_(rank_ * rank_) {
        const std::size_t rank = rank_;
        bool cd = false, pc = false;
        const auto each = [&](const auto& run) {
            for (std::size_t n = 0; n < rank * rank; ++n) run(n / rank, n % rank);
        };
        each([&](std::size_t row, std::size_t column) {
            cd |= fits.has(pair_key(fits, "CD", row, column));
            pc |= fits.has(pair_key(fits, "PC", row, column));
        });
        stated_ = cd || pc;
        for (std::size_t axis = 0; axis < rank; ++axis)
            for (const char* key : {"CDELT", "CRVAL", "CRPIX"})
                stated_ |= fits.has(axis_key(key, axis));
        each([&](std::size_t row, std::size_t column) {
            entry_[row * rank + column] =
                cd && !pc ? fits.number(pair_key(fits, "CD", row, column), 0)
                          : fits.number(axis_key("CDELT", row), 1) *
                                fits.number(pair_key(fits, "PC", row, column), row == column);
        });
        if (cd && pc) note("both PC and CD, which FITS forbids: PC and CDELT place the voxels");
        for (std::size_t axis = 0; axis < rank; ++axis) {
            const std::string crota = axis_key("CROTA", axis);
            if (!cd && !pc && fits.number(crota, 0) != 0)
                note(fmt::format("{} is not applied: it turns the axes of the sky only", crota));
            bool in_matrix = !cd || pc;
            for (std::size_t n = 0; n < rank; ++n)
                in_matrix |= entry(axis, n) != 0 || entry(n, axis) != 0;
            if (in_matrix) continue;
            entry_[axis * rank + axis] = 1;
            if (std::ranges::find(image.space, axis) == image.space.end()) continue;
            note(fmt::format("CD has no entry for axis {}: its voxels are 1 long, as in wcslib",
                             axis + 1));
        }
    }
    bool stated() const { return stated_; }
    const std::string& note() const { return note_; }
    double entry(std::size_t row, std::size_t column) const {
        return row == kNoAxis || column == kNoAxis ? (row == column ? 1 : 0)
                                                   : entry_[row * rank_ + column];
    }
    double origin(std::size_t row) const {
        return row == kNoAxis ? 0 : fits_.number(axis_key("CRVAL", row), 0);
    }
    double reference(std::size_t column) const {  ///< counts from 1
        return column == kNoAxis ? 1 : fits_.number(axis_key("CRPIX", column), 0);
    }

  private:
    void note(const std::string& text) { note_ += (note_.empty() ? "" : "; ") + text; }

    const Fits& fits_;
    std::size_t rank_;
    std::vector<double> entry_;
    bool stated_ = false;
    std::string note_{};
};

/// Map of pixels to the world's units where the axes have one unit, or units of length; else voxels of 1.
/// pixel    of the axes that are not in space
/// returns  departures of the keywords from FITS, and how they are read; empty: none
std::string set_map(const Fits& fits, const FitsImage& image, const std::vector<long>& pixel,
                    ScanGrid& grid) {
    std::vector<std::string> units, types;
    const FitsWorld world(fits, image);
    for (const std::size_t axis : image.space) {
        units.push_back(axis == kNoAxis ? "" : fits.text(axis_key("CUNIT", axis)));
        types.push_back(axis == kNoAxis ? "" : fits.text(axis_key("CTYPE", axis)));
    }
    // steps  with the length of a pixel along each axis, by the rows of its unit
    const auto axes = [&](bool steps) {
        std::string text;
        for (std::size_t n = 0; n < 3; ++n) {
            if (types[n].empty() && units[n].empty()) continue;
            double step = 0;
            for (std::size_t row = 0; row < 3; ++row)
                if (units[row] == units[n])
                    step = std::hypot(step, world.entry(image.space[row], image.space[n]));
            text +=
                fmt::format("{}{}{}{}{}{}", text.empty() ? "" : ", ", types[n],
                            types[n].empty() ? "" : " ", steps ? fmt::format("{:.6g}", step) : "",
                            steps && !units[n].empty() ? " " : "", units[n]);
            if (text.ends_with(' ')) text.pop_back();
        }
        return text;
    };
    if (grid.size.z > 1) grid.standing.up = {0, 0, 1};  // an image alone lies across z
    if (!world.stated()) {
        grid.coordinates = "pixels, the file states no others";
        return {};
    }
    // An angle and a frequency have no common length; nor is a sphere a plane.
    const bool celestial = std::ranges::any_of(types, [](const std::string& t) {
        return t.size() > 5 && t.find('-') != std::string::npos && t[4] == '-';
    });
    const std::string lengths = axes(false), steps = axes(true);
    if (grid.size.z == 1) units.pop_back();
    if (!have_common_unit(units) || celestial) {
        grid.coordinates = fmt::format("pixels; steps of the axes are {}", steps);
        return {};
    }
    Affine map;
    for (int r = 0; r < 3; ++r) {
        const std::size_t row = image.space[static_cast<std::size_t>(r)];
        map.translation[r] = world.origin(row);
        for (int c = 0; c < 3; ++c) {
            const std::size_t column = image.space[static_cast<std::size_t>(c)];
            map.linear(r, c) = row == kNoAxis || column == kNoAxis ? (r == c ? 1.0 : 0.0)
                                                                   : world.entry(row, column);
            map.translation[r] += map.linear(r, c) * (1 - world.reference(column));
        }
        for (std::size_t axis = 0; axis < image.edge.size() && row != kNoAxis; ++axis)
            if (std::ranges::find(image.space, axis) == image.space.end())
                map.translation[r] += world.entry(row, axis) *
                                      (static_cast<double>(pixel[axis]) - world.reference(axis));
    }
    // A single slice is as thick as its pixels are wide.
    if (image.space[2] == kNoAxis) map.linear(2, 2) = length(map.linear.column(0));
    grid.world_from_index = map;
    set_units(fits.name, units, grid);
    grid.coordinates = lengths.empty() ? "those of the file" : lengths;
    return world.note();
}

/// Sets the axes in space: all of three or fewer, else the first three longer than 1. Axes of polarisation are not.
void set_axes(const Fits& fits, FitsImage& image) {
    std::vector<std::size_t> longer, single;
    for (std::size_t axis = 0; axis < image.edge.size(); ++axis) {
        const bool stokes = fits.text(axis_key("CTYPE", axis)) == "STOKES";
        if (image.edge[axis] > 1 && stokes)
            image.others.push_back(axis);
        else if (image.edge[axis] > 1 || image.edge.size() <= 3)
            longer.push_back(axis);
        else
            single.push_back(axis);
    }
    if (longer.size() > 3)
        image.others.insert(image.others.end(), longer.begin() + 3, longer.end());
    longer.insert(longer.end(), single.begin(), single.end());
    std::copy_n(longer.begin(), std::min<std::size_t>(longer.size(), 3), image.space.begin());
    std::ranges::sort(image.others);
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
    for (std::size_t n = 0; n < image.edge.size(); ++n)
        if (image.edge[n] < 1)
            throw Error(fmt::format("{}: {} pixels along axis {}, expected 1 or more", fits.name,
                                    image.edge[n], n + 1));
    set_axes(fits, image);
    image.voxels = checked_voxels(fits.name, image.size(0), image.size(1), image.size(2));
    for (const std::size_t axis : image.others) {
        if (image.edge[axis] > kMostGrids ||
            image.images * static_cast<std::uint64_t>(image.edge[axis]) > kMostGrids)
            throw Error(fmt::format("{}: {} images along axis {}, expected 1 to {} in all",
                                    fits.name, image.edge[axis], axis + 1, kMostGrids));
        image.images *= static_cast<std::uint64_t>(image.edge[axis]);
    }
    fits.check_data();
    // Rice's and deflate's largest ratios are some 1000.
    constexpr double kMostRatio = 4000;
    const auto bytes = static_cast<double>(fits.size);
    const double needed = static_cast<double>(image.voxels) * static_cast<double>(image.images);
    if (needed > (packed ? kMostRatio * bytes : bytes))
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

BigVector<float> read_image(Fits& fits, const FitsImage& image, std::size_t n) {
    int status = 0;
    fits.check(fits_movabs_hdu(fits.handle, image.hdu, nullptr, &status));
    BigVector<float> values;
    resize_kept(values, image.voxels);
    double blank = std::numeric_limits<double>::quiet_NaN();
    std::vector<long> first = image.first_pixel(n), last = first, step(first.size(), 1);
    const auto range = [&](std::size_t axis, long from, long count) {
        if (image.space[axis] == kNoAxis) return;
        first[image.space[axis]] = from + 1;
        last[image.space[axis]] = from + count;
    };
    constexpr long kStep = long{1} << 22;
    const long row = image.size(0), rows = std::max(kStep / row, 1L);
    std::vector<double> buffer;
    Singles singles;
    float* to = values.data();
    for (long z = 0; z < image.size(2); ++z)
        for (long y = 0; y < image.size(1); y += rows) {
            const long count = std::min(rows, image.size(1) - y);
            range(0, 0, row), range(1, y, count), range(2, z, 1);
            buffer.resize(static_cast<std::size_t>(row) * static_cast<std::size_t>(count));
            int any = 0;
            fits.check(fits_read_subset(fits.handle, TDOUBLE, first.data(), last.data(),
                                        step.data(), &blank, buffer.data(), &any, &status));
            to = std::ranges::transform(buffer, to, std::ref(singles)).out;
            keep_memory();
        }
    singles.check(fits.name, "BSCALE");
    return values;
}

/// Names of HDUs: EXTNAME, with EXTVER where several have it; else by number, "value" of a single image.
std::vector<std::string> hdu_names(Fits& fits, const std::vector<FitsImage>& images) {
    std::vector<std::string> names, versions;
    for (const FitsImage& image : images) {
        int status = 0;
        fits.check(fits_movabs_hdu(fits.handle, image.hdu, nullptr, &status));
        std::string name = fits.text("EXTNAME");
        if (name == "COMPRESSED_IMAGE") name.clear();  // the default of packed images
        versions.push_back(fmt::format("{}[{}]", name, fits.number("EXTVER", 1)));
        if (name.empty())
            name = images.size() == 1 ? ScanGrid{}.name : fmt::format("hdu{}", image.hdu);
        names.push_back(name);
    }
    // Equal versions, too, are numbered by open_scan.
    std::vector<std::string> result = names;
    for (std::size_t n = 0; n < names.size(); ++n)
        if (std::ranges::count(names, names[n]) > 1 &&
            std::ranges::count(versions, versions[n]) == 1)
            result[n] = versions[n];
    return result;
}

}  // namespace

ScanFile open_fits(const std::filesystem::path& file) {
    const auto fits = std::make_shared<Fits>(file);
    int status = 0, hdus = 0;
    fits->check(fits_get_num_hdus(fits->handle, &hdus, &status));
    constexpr int kMostHdus = 1000;
    std::vector<FitsImage> images;
    for (int hdu = 1; hdu <= std::min(hdus, kMostHdus); ++hdu) {
        fits->check(fits_movabs_hdu(fits->handle, hdu, nullptr, &status));
        FitsImage image;
        image.hdu = hdu;
        if (read_shape(*fits, image)) images.push_back(image);
    }
    if (images.empty())
        throw Error(fmt::format("{}: no image of 2 axes or more, expected a cube", file.string()));
    const std::vector<std::string> names = hdu_names(*fits, images);
    std::vector<std::pair<std::size_t, std::size_t> > place;
    ScanFile scan;
    for (std::size_t i = 0; i < images.size(); ++i) {
        const FitsImage& image = images[i];
        fits->check(fits_movabs_hdu(fits->handle, image.hdu, nullptr, &status));
        ScanGrid first;
        first.size = {static_cast<std::int32_t>(image.size(0)),
                      static_cast<std::int32_t>(image.size(1)),
                      static_cast<std::int32_t>(image.size(2))};
        first.type = type_of(image.bits);
        first.value_unit = fits->text("BUNIT");
        std::vector<long> pixel = image.first_pixel(0);
        const std::string note = set_map(*fits, image, pixel, first);
        if (scan.note.find(note) == std::string::npos)
            scan.note += (scan.note.empty() ? "" : "; ") + note;
        // World steps along the axes that are not in space.
        std::vector<Vec3d> step(pixel.size());
        for (const std::size_t axis : image.others) {
            ScanGrid next = first;
            pixel[axis] = 2;
            set_map(*fits, image, pixel, next);
            pixel[axis] = 1;
            step[axis] = next.world_from_index.translation - first.world_from_index.translation;
        }
        for (std::uint64_t n = 0; n < image.images; ++n) {
            ScanGrid grid = first;
            const std::vector<long> at = image.first_pixel(n);
            for (const std::size_t axis : image.others)
                grid.world_from_index.translation = grid.world_from_index.translation +
                                                    static_cast<double>(at[axis] - 1) * step[axis];
            grid.name = names[i];
            if (image.images > 1)
                grid.name =
                    images.size() == 1 ? fmt::format("c{}", n) : fmt::format("{}_{}", names[i], n);
            scan.grids.push_back(grid);
            place.emplace_back(i, n);
        }
    }
    if (fits->size % kBlock != 0)
        scan.note +=
            fmt::format("{}{} bytes, not blocks of {} as FITS has them; all values are there",
                        scan.note.empty() ? "" : "; ", fits->size, kBlock);
    scan.read = [fits, images, place](std::size_t n) {
        return read_image(*fits, images[place[n].first], place[n].second);
    };
    return scan;
}

#endif

}  // namespace vog::scan
