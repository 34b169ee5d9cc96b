// tiff.cpp: TIFF stacks by libtiff: pages of one file, or a folder or pattern of files with a slice each.
#include <fmt/format.h>

#include "io/scan/scan_file.h"
#include "vog/dense.h"
#include "vog/error.h"

#ifdef VOG_TIFF
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/paging.h"
#include "io/scan/scan_values.h"
#include "io/scan/tiff/tiff_files.h"
#include "io/scan/tiff/tiff_handle.h"
#include "io/scan/tiff/tiff_stack.h"
#include "vog/text.h"
#endif

namespace vog::scan {

#ifndef VOG_TIFF

ScanFile open_tiff(const std::filesystem::path& file) {
    throw Error(fmt::format("{}: this build reads no TIFF (libtiff was absent when it was built)",
                            file.string()));
}

#else

namespace {

/// Form of a page's pixels.
struct PageForm {
    std::uint32_t width = 0, height = 0;
    std::uint16_t samples = 1;
    bool planar = false;      ///< samples in planes of their own
    std::uint32_t depth = 1;  ///< slices of a page of several
    Number type = Number::uint8;
    bool white = false;  ///< whole numbers count down from white
    friend bool operator==(const PageForm&, const PageForm&) = default;
};

PageForm form_of(const Tiff& tiff) {
    PageForm form;
    form.width = tiff.tag<std::uint32_t>(TIFFTAG_IMAGEWIDTH, 0);
    form.height = tiff.tag<std::uint32_t>(TIFFTAG_IMAGELENGTH, 0);
    form.samples = tiff.tag<std::uint16_t>(TIFFTAG_SAMPLESPERPIXEL, 1);
    const auto bits = tiff.tag<std::uint16_t>(TIFFTAG_BITSPERSAMPLE, 1);
    const auto format = tiff.tag<std::uint16_t>(TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_UINT);
    const char* kind = format == SAMPLEFORMAT_INT      ? "int"
                       : format == SAMPLEFORMAT_IEEEFP ? "float"
                                                       : "uint";
    const std::optional<Number> type = number_named(fmt::format("{}{}", kind, bits));
    if (!type || format > SAMPLEFORMAT_VOID)
        tiff.fail(fmt::format("samples of {} bits in format {}", bits, format));
    form.type = *type;
    const auto photometric = tiff.tag<std::uint16_t>(TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
    form.white = photometric == PHOTOMETRIC_MINISWHITE && format == SAMPLEFORMAT_UINT;
    if (photometric == PHOTOMETRIC_PALETTE || photometric == PHOTOMETRIC_YCBCR)
        tiff.fail("colours by a palette or in YCbCr");
    if (form.samples > 4 || form.samples == 0)
        tiff.fail(fmt::format("{} samples a pixel", form.samples));
    form.planar =
        form.samples > 1 &&
        tiff.tag<std::uint16_t>(TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG) != PLANARCONFIG_CONTIG;
    form.depth = tiff.tag<std::uint32_t>(TIFFTAG_IMAGEDEPTH, 1);
    constexpr std::uint32_t kMostDepth = 1 << 20;
    if (form.depth < 1 || form.depth > kMostDepth || (form.depth > 1 && form.samples > 1))
        tiff.fail(fmt::format("{} slices of {} samples in a page", form.depth, form.samples));
    return form;
}

/// Planes at full resolution, by file, directory, and place among several in one directory.
struct Page {
    std::size_t file = 0;
    std::uint16_t directory = 0;
    std::uint32_t plane = 0;
    bool single = true;  ///< the only plane of its directory
};

/// Copies rows of `from` into `to` [width * height], by one sample of `samples` side by side.
void put(const PageForm& form, const char* from, std::uint32_t width, std::uint32_t rows,
         std::uint32_t stride_px, std::uint32_t x0, std::uint32_t y0, std::size_t sample, float* to,
         Singles& singles) {
    const std::size_t bytes = bytes_of(form.type), samples = form.planar ? 1 : form.samples;
    for (std::uint32_t y = 0; y < rows && y0 + y < form.height; ++y)
        for (std::uint32_t x = 0; x < width && x0 + x < form.width; ++x)
            to[std::size_t{y0 + y} * form.width + x0 + x] = singles(number_from(
                from + ((std::size_t{y} * stride_px + x) * samples + (form.planar ? 0 : sample)) *
                           bytes,
                form.type));
}

/// Reads one of several planes that follow each other without packing behind the first one's offset.
void read_run(Tiff& tiff, const Page& page, const PageForm& form, std::size_t sample, float* to,
              Singles& singles) {
    TIFF* handle = tiff.handle.get();
    if (tiff.tag<std::uint16_t>(TIFFTAG_COMPRESSION, COMPRESSION_NONE) != COMPRESSION_NONE ||
        form.planar)
        tiff.fail("several packed planes in one page");
    const std::uint32_t strips = TIFFNumberOfStrips(handle);
    for (std::uint32_t n = 1; n < strips; ++n)
        if (TIFFGetStrileOffset(handle, n) !=
            TIFFGetStrileOffset(handle, n - 1) + TIFFGetStrileByteCount(handle, n - 1))
            tiff.fail("several planes in one page, in strips apart");
    const std::uint64_t number = bytes_of(form.type);
    std::vector<char> plane(std::size_t{form.width} * form.height * form.samples * number);
    ScanBytes bytes(tiff.name, TIFFGetStrileOffset(handle, 0));
    bytes.skip(page.plane * plane.size());
    bytes.read(plane.data(), plane.size());
    if (TIFFIsByteSwapped(handle))
        for (std::size_t n = 0; n < plane.size(); n += number)
            std::reverse(plane.data() + n, plane.data() + n + number);
    put(form, plane.data(), form.width, form.height, form.width, 0, 0, sample, to, singles);
}

void read_page(Tiff& tiff, const Page& page, const PageForm& form, std::size_t sample, float* to,
               Singles& singles) {
    TIFF* handle = tiff.handle.get();
    if (!TIFFSetDirectory(handle, page.directory)) tiff.fail("a page cannot be read");
    if (form_of(tiff) != form) tiff.fail("pages of several forms");
    if (const auto packing = tiff.tag<std::uint16_t>(TIFFTAG_COMPRESSION, COMPRESSION_NONE);
        !TIFFIsCODECConfigured(packing))
        throw Error(
            fmt::format("{}: compression {}, which this build's libtiff does not read, expected "
                        "none, Deflate or LZW",
                        tiff.name, packing));
    const std::size_t pixel = (form.planar ? 1 : form.samples) * bytes_of(form.type);
    const auto which = static_cast<std::uint16_t>(form.planar ? sample : 0);
    std::vector<char> buffer;
    if (TIFFIsTiled(handle) && !page.single && form.depth == 1)
        tiff.fail("several planes in one page of tiles");
    if (TIFFIsTiled(handle)) {
        const auto width = tiff.tag<std::uint32_t>(TIFFTAG_TILEWIDTH, 0);
        const auto height = tiff.tag<std::uint32_t>(TIFFTAG_TILELENGTH, 0);
        // libtiff knows tiles of one slice only.
        const auto depth = tiff.tag<std::uint32_t>(TIFFTAG_TILEDEPTH, 1);
        if (width == 0 || height == 0 || depth != 1 ||
            std::uint64_t{width} * height > (std::uint64_t{1} << 29) / pixel)
            tiff.fail(fmt::format("tiles of {} x {} x {}", width, height, depth));
        buffer.resize(std::size_t{width} * height * pixel);
        if (TIFFTileSize(handle) > static_cast<tmsize_t>(buffer.size()))
            tiff.fail("tiles of another size");
        for (std::uint32_t y = 0; y < form.height; y += height)
            for (std::uint32_t x = 0; x < form.width; x += width) {
                if (TIFFReadTile(handle, buffer.data(), x, y, page.plane, which) < 0)
                    tiff.fail("truncated or corrupt");
                put(form, buffer.data(), width, height, width, x, y, sample, to, singles);
            }
        return;
    }
    if (!page.single) return read_run(tiff, page, form, sample, to, singles);
    const auto rows =
        std::min(tiff.tag<std::uint32_t>(TIFFTAG_ROWSPERSTRIP, form.height), form.height);
    if (rows == 0 || rows > (std::uint64_t{1} << 29) / (pixel * form.width))
        tiff.fail(fmt::format("strips of {} rows", rows));
    buffer.resize(std::size_t{rows} * form.width * pixel);
    for (std::uint32_t y = 0; y < form.height; y += rows) {
        const std::uint32_t count = std::min(rows, form.height - y);
        const auto bytes = static_cast<tmsize_t>(std::size_t{count} * form.width * pixel);
        if (TIFFReadEncodedStrip(handle, TIFFComputeStrip(handle, y, which), buffer.data(),
                                 bytes) != bytes)
            tiff.fail("truncated or corrupt");
        put(form, buffer.data(), form.width, count, form.width, 0, y, sample, to, singles);
    }
}

/// Least number of a stored page's bytes; more pixels than 2000 a byte no codec packs.
void check_bytes(const Tiff& tiff, const PageForm& form) {
    constexpr double kMostRatio = 4000;
    const double pixels = static_cast<double>(form.width) * form.height * form.samples;
    const double bytes = static_cast<double>(std::filesystem::file_size(tiff.name));
    if (pixels > kMostRatio * bytes)
        tiff.fail(fmt::format("{} x {} pixels in {} bytes", form.width, form.height, bytes));
}

TiffStack stack_of(const Tiff& tiff, const PageForm& form) {
    TiffTags tags{
        tiff.name,
        tiff.text(TIFFTAG_IMAGEDESCRIPTION),
        form.width,
        form.height,
        form.samples,
        tiff.tag<float>(TIFFTAG_XRESOLUTION, 0),
        tiff.tag<float>(TIFFTAG_YRESOLUTION, 0),
        tiff.other_unit.value_or(tiff.tag<std::uint16_t>(TIFFTAG_RESOLUTIONUNIT, RESUNIT_INCH))};
    const double x = tags.x_resolution, y = tags.y_resolution;
    if (!(x > 0 && y > 0 && std::isfinite(x) && std::isfinite(y)))
        tags.x_resolution = tags.y_resolution = 0;
    // Of OME's files, some only name the one with the description.
    if (tags.description.find("BinaryOnly") != std::string::npos) return {};
    constexpr std::uint32_t kPixelScale = 33550, kNoData = 42113;  // GeoTIFF's, GDAL's
    if (const auto scale = tiff.numbers<double>(kPixelScale, TIFF_DOUBLE); scale.size() == 3)
        tags.pixel_scale = {scale[0], scale[1], scale[2]};
    const auto no_data = tiff.numbers<char>(kNoData, TIFF_ASCII);
    tags.no_data.assign(no_data.begin(), no_data.end());
    TiffStack stack = tiff_stack(tags);
    // ImageJ shows such files by a colour map, and has their values as stored.
    if (form.white && !tags.description.starts_with("ImageJ="))
        stack.coefficients = {std::ldexp(1.0, 8 * int(bytes_of(form.type))) - 1, -1};
    if (const auto turn = tiff.tag<std::uint16_t>(TIFFTAG_ORIENTATION, ORIENTATION_TOPLEFT);
        turn > ORIENTATION_TOPLEFT && turn <= ORIENTATION_LEFTBOT)
        stack.note += fmt::format("{}rows and columns as stored, without the tag Orientation {}",
                                  stack.note.empty() ? "" : "; ", turn);
    return stack;
}

/// throws vog::Error where a slice states other voxels than the first one
void check_spacing(const Tiff& tiff, const TiffStack& own, const std::filesystem::path& first,
                   const TiffStack& stack) {
    constexpr double kRounding = 1e-4;
    if (own.source == TiffStack{}.source ||
        (own.units == stack.units &&
         length(own.edge - stack.edge) <= kRounding * length(stack.edge)))
        return;
    const auto voxels = [](const TiffStack& one) {
        return fmt::format("{:.6g} x {:.6g} x {:.6g} {}", one.edge.x, one.edge.y, one.edge.z,
                           one.units.empty() ? "" : printable(one.units[0], 20));
    };
    throw Error(fmt::format("{}: voxels of {}, expected {} as in {}", tiff.name, voxels(own),
                            voxels(stack), first.filename().string()));
}

/// Pages of all files in the order of their planes. `form` and `stack` become those of the first file.
std::vector<Page> pages_of(const std::filesystem::path& file,
                           const std::vector<std::filesystem::path>& files, PageForm& form,
                           TiffStack& stack) {
    std::vector<Page> pages;
    for (std::size_t n = 0; n < files.size(); ++n) {
        Tiff tiff(files[n]);
        if (n == 0)
            form = form_of(tiff), stack = stack_of(tiff, form);
        else
            check_spacing(tiff, stack_of(tiff, form), files[0], stack);
        check_bytes(tiff, form);
        for (std::uint32_t directory = 0;; ++directory) {
            if (directory > std::numeric_limits<std::uint16_t>::max())
                tiff.fail("more than 65,535 pages");
            // Smaller copies of a page are not slices.
            if ((tiff.tag<std::uint32_t>(TIFFTAG_SUBFILETYPE, 0) & FILETYPE_REDUCEDIMAGE) == 0) {
                if (form_of(tiff) != form) tiff.fail("pages of several forms");
                for (std::uint32_t plane = 0; plane < form.depth; ++plane)
                    pages.push_back(
                        {n, static_cast<std::uint16_t>(directory), plane, form.depth == 1});
            }
            if (!TIFFReadDirectory(tiff.handle.get())) break;
        }
        if (!tiff.fault.empty()) tiff.fail("truncated or corrupt");
        constexpr std::uint32_t kMetaMorph = 33629;  // planes behind one page
        if (pages.size() == n + 1 && TIFFFindField(tiff.handle.get(), kMetaMorph, TIFF_ANY))
            tiff.fail("planes as MetaMorph has them");
    }
    // One page whose description states more planes: they follow it.
    if (const std::uint64_t planes = stack.planes();
        pages.size() == 1 && planes > 1 && form.depth == 1) {
        const std::uint64_t bytes = std::filesystem::file_size(files[0]),
                            plane = std::uint64_t{form.width} * form.height * form.samples *
                                    bytes_of(form.type);
        if (plane == 0 || planes > bytes / plane)
            throw Error(fmt::format("{}: {} planes of {} bytes in a file of {}", file.string(),
                                    planes, plane, bytes));
        pages.assign(planes, {0, pages[0].directory, 0, false});
        for (std::uint32_t n = 0; n < planes; ++n) pages[n].plane = n;
    }
    const std::uint64_t images = stack.channels * stack.frames;
    // Slices of several files: each describes only its own.
    if (files.size() > 1) stack.slices = 0, stack.plane_of_page.clear();
    if (stack.slices == 0 && images > 0) stack.slices = pages.size() / images;
    if (pages.size() != stack.planes() || (images > 1 && (form.samples > 1 || files.size() > 1)))
        throw Error(fmt::format(
            "{}: {} pages of {} samples in {} files for {} slices, {} channels and {} frames",
            file.string(), pages.size(), form.samples, files.size(), stack.slices, stack.channels,
            stack.frames));
    if (!stack.plane_of_page.empty()) {
        const std::vector<Page> as_stored = pages;
        for (std::size_t n = 0; n < pages.size(); ++n) pages[stack.plane_of_page[n]] = as_stored[n];
    }
    return pages;
}

ScanGrid grid_of(const std::filesystem::path& file, const PageForm& form, const TiffStack& stack) {
    ScanGrid grid;
    grid.size = Vec3i(int(form.width), int(form.height), int(stack.slices));
    grid.type = type_name(form.type);
    grid.world_from_index = affine_from_voxels(stack.edge);
    for (int n = 0; n < 3; ++n)
        grid.world_from_index.translation[n] = 0 - stack.origin[n] * stack.edge[n];  // no -0
    grid.value_unit = stack.value_unit;
    grid.coordinates = stack.source;
    set_units(file, stack.units, grid);
    return grid;
}

}  // namespace

ScanFile open_tiff(const std::filesystem::path& file) {
    const std::vector<std::filesystem::path> files = tiff_files(file);
    PageForm form;
    TiffStack stack;
    const std::vector<Page> pages = pages_of(file, files, form, stack);
    const std::uint64_t slice = checked_voxels(file, form.width, form.height, 1);
    checked_voxels(file, form.width, form.height, static_cast<std::int64_t>(stack.slices));
    const auto names =
        form.samples > 1 ? color_names(form.samples) : frame_names(stack.frames, stack.channels);
    ScanFile scan{named_copies(grid_of(file, form, stack), names), stack.note};
    name_channels(stack, scan.grids);
    scan.read = [files, pages, form, stack, slice](std::size_t n) {
        const std::size_t sample = form.samples > 1 ? n : 0, image = form.samples > 1 ? 0 : n;
        BigVector<float> values;
        resize_kept(values, stack.slices * slice);
        std::optional<Tiff> tiff;
        Singles stored, calibrated;
        constexpr double kMost = std::numeric_limits<float>::max();  // GDAL rounds it up
        stored.blank = form.type == Number::float32
                           ? static_cast<float>(std::clamp(stack.blank, -kMost, kMost))
                           : stack.blank;
        std::size_t open = files.size();
        for (std::size_t z = 0; z < stack.slices; ++z) {
            const auto at = stack.plane(image % stack.channels, z, image / stack.channels);
            const Page& page = pages[at];
            if (page.file != open) tiff.emplace(files[page.file]), open = page.file;
            float* const plane = values.data() + z * slice;
            read_page(*tiff, page, form, sample, plane, stored);
            if (!stack.coefficients.empty())
                std::transform(plane, plane + slice, plane, [&](float number) {
                    double value = 0;
                    for (std::size_t c = stack.coefficients.size(); c-- > 0;)
                        value = value * double{number} + stack.coefficients[c];
                    return calibrated(value);
                });
            keep_memory();
        }
        stored.check(files[0].string());
        calibrated.check(files[0].string());
        return values;
    };
    return scan;
}

#endif

}  // namespace vog::scan
