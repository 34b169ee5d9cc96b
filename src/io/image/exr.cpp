// exr.cpp: reading and writing OpenEXR: depth images (one channel Y) and colours (R, G, B, A).
#include <fmt/core.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfStringAttribute.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <exception>
#include <fstream>
#include <map>
#include <new>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "data/image_checks.h"
#include "io/image/image_files.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog {

using namespace image_files;
namespace {

constexpr const char* kExtinction = "extinction";  ///< header attribute of a depth image
constexpr const char* kRecord = "vog";             ///< header attribute with a picture's record

/// Text of an OpenEXR exception, without the file name before `". `.
std::string reason(const std::exception& error) {
    std::string text = error.what();
    if (const auto cut = text.find("\". "); cut != std::string::npos) text.erase(0, cut + 3);
    return text;
}

std::int32_t next_number(std::ifstream& stream) {  // little-endian
    std::array<unsigned char, 4> bytes{};
    stream.read(reinterpret_cast<char*>(bytes.data()), bytes.size());
    return static_cast<std::int32_t>(bytes[0] | bytes[1] << 8 | bytes[2] << 16 |
                                     static_cast<std::uint32_t>(bytes[3]) << 24);
}

/// Whether a value of this type can have `size` bytes, those that follow in the stream.
bool fits_type(std::ifstream& stream, const std::string& type, std::int64_t size) {
    static const std::map<std::string, std::int64_t> kBytes{
        {"box2i", 16},      {"box2f", 16},   {"chromaticities", 32},
        {"compression", 1}, {"double", 8},   {"envmap", 1},
        {"float", 4},       {"int", 4},      {"keycode", 28},
        {"lineOrder", 1},   {"m33f", 36},    {"m33d", 72},
        {"m44f", 64},       {"m44d", 128},   {"rational", 8},
        {"tiledesc", 9},    {"timecode", 8}, {"v2i", 8},
        {"v2f", 8},         {"v2d", 16},     {"v3i", 12},
        {"v3f", 12},        {"v3d", 24},     {"deepImageState", 1}};
    if (const auto known = kBytes.find(type); known != kBytes.end()) return size == known->second;
    const std::streamoff end = stream.tellg() + std::streamoff{size};
    if (type == "chlist") {  // name, 16 bytes, ..., an empty name
        std::string channel;
        while (std::getline(stream, channel, '\0') && !channel.empty() && stream.tellg() < end)
            stream.seekg(16, std::ios::cur);
        return channel.empty() && stream.tellg() == end;
    }
    if (type == "preview") {  // width, height, 4 bytes a pixel
        const std::int64_t width = next_number(stream), height = next_number(stream);
        return width >= 0 && height >= 0 && size == 8 + 4 * width * height;
    }
    if (type == "stringvector") {  // length, text, ...
        while (stream.tellg() < end) {
            const std::int64_t length = next_number(stream);
            if (length < 0 || length > end - stream.tellg()) return false;
            stream.seekg(length, std::ios::cur);
        }
        return stream.tellg() == end;
    }
    return true;
}

/// Checks the sizes of all header attributes against their types and the size of the file: OpenEXR
/// allocates what a size declares, up to 2 GiB, before it reads, and finds the next attribute where
/// the value itself ends. Layout: magic number, version, then name, type, size and value of each
/// attribute, then an empty name.
/// throws vog::Error for other sizes, several parts or deep pixels
void require_valid_header(const std::filesystem::path& file) {
    constexpr std::int32_t kDeepFlag = 0x800, kMultiPartFlag = 0x1000;
    const std::string name = file.string();
    std::ifstream stream(file, std::ios::binary);
    next_number(stream);  // the magic number
    const std::int32_t version = next_number(stream);
    if (version & (kDeepFlag | kMultiPartFlag))
        throw Error(fmt::format(
            "{}: an EXR of several parts or deep pixels, expected one flat image", name));
    const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(file));
    std::string attribute, type;
    while (std::getline(stream, attribute, '\0') && !attribute.empty()) {
        std::getline(stream, type, '\0');
        const std::int64_t size = next_number(stream);
        const std::streamoff value = stream.tellg();
        if (!stream || size < 0 || size > bytes - value)
            throw Error(fmt::format("{}: not a whole EXR image: attribute {} goes beyond the end",
                                    name, printable(attribute, 100)));
        if (!fits_type(stream, type, size))
            throw Error(fmt::format(
                "{}: not a whole EXR image: attribute {} of type '{}' cannot have {} bytes", name,
                printable(attribute, 100), printable(type, 40), size));
        stream.clear();
        stream.seekg(value + size);
    }
}

/// Runs `read` with every exception of OpenEXR converted to vog::Error.
template <class Read>
auto reading(const std::filesystem::path& file, Read read) {
    try {
        require_valid_header(file);
        return read();
    } catch (const Error&) {
        throw;
    } catch (const std::bad_alloc&) {
        throw Error(fmt::format("{}: not enough memory for this EXR image", file.string()));
    } catch (const std::exception& error) {
        throw Error(fmt::format("{}: not a whole EXR image: {}", file.string(), reason(error)));
    }
}

/// Open EXR file of one flat part with a checked header; pixels are not read.
struct ExrFile {
    std::string name;
    std::ifstream stream;
    Imf::StdIFStream bytes;
    Imf::MultiPartInputFile parts;

    explicit ExrFile(const std::filesystem::path& file)
        : name(file.string()),
          stream(file, std::ios::binary),
          bytes(stream, "EXR"),
          parts(bytes, 0, false) {  // false: do not reconstruct a broken offset table
        if (header().hasType() && !Imf::isImage(header().type()))
            throw Error(
                fmt::format("{}: part of type '{}', expected a flat image", name, header().type()));
        if (header().dataWindow() != header().displayWindow())
            throw Error(
                fmt::format("{}: data window and display window differ, expected a picture that is "
                            "neither cropped nor larger than shown",
                            name));
        require_valid_size(name, width(), height());
        if (!parts.partComplete(0))
            throw Error(fmt::format("{}: not a whole EXR image: rows are missing", name));
    }

    const Imf::Header& header() const { return parts.header(0); }
    std::int64_t width() const {
        const Imath::Box2i& window = header().dataWindow();
        return std::int64_t{window.max.x} - window.min.x + 1;
    }
    std::int64_t height() const {
        const Imath::Box2i& window = header().dataWindow();
        return std::int64_t{window.max.y} - window.min.y + 1;
    }
    /// Names of the channels in alphabetical order: "A, B, G, R".
    std::string channel_names() const {
        std::string names;
        const Imf::ChannelList& channels = header().channels();
        for (auto channel = channels.begin(); channel != channels.end(); ++channel)
            names += (names.empty() ? "" : ", ") + std::string(channel.name());
        return names.empty() ? "none" : names;
    }
};

void require_channel_type(const ExrFile& exr, const char* name, bool half_too) {
    const Imf::Channel& channel = exr.header().channels()[name];
    if (channel.xSampling != 1 || channel.ySampling != 1)
        throw Error(fmt::format("{}: channel {} is subsampled {}x{}, expected 1x1", exr.name, name,
                                channel.xSampling, channel.ySampling));
    if (channel.type == Imf::FLOAT || (half_too && channel.type == Imf::HALF)) return;
    throw Error(fmt::format("{}: channel {} is {}, expected float32{}", exr.name, name,
                            channel.type == Imf::HALF ? "half" : "uint32",
                            half_too ? " or half" : ""));
}

/// Reads all rows into `pixels`; a Pixel is one float per name, 1 for channels that the file lacks.
/// Pages are touched as rows are read, so that a header alone cannot occupy memory.
template <class Pixel>
void read_rows(ExrFile& exr, const std::vector<const char*>& names, std::vector<Pixel>& pixels) {
    constexpr std::int64_t kBlockRows = 256;  // the largest chunk of any compression (DWAB)
    const Imath::Box2i window = exr.header().dataWindow();
    const std::size_t row_bytes = static_cast<std::size_t>(exr.width()) * sizeof(Pixel);
    Imf::InputPart part(exr.parts, 0);
    pixels.reserve(static_cast<std::size_t>(exr.width() * exr.height()));
    for (std::int64_t row = 0; row < exr.height(); row += kBlockRows) {
        const std::int64_t rows = std::min(kBlockRows, exr.height() - row);
        pixels.resize(static_cast<std::size_t>((row + rows) * exr.width()));
        auto* target = reinterpret_cast<float*>(pixels.data() + row * exr.width());
        const int first_y = static_cast<int>(window.min.y + row);
        Imf::FrameBuffer buffer;
        for (std::size_t i = 0; i < names.size(); ++i)
            buffer.insert(names[i], Imf::Slice::Make(Imf::FLOAT, target + i,
                                                     Imath::V2i(window.min.x, first_y), exr.width(),
                                                     rows, sizeof(Pixel), row_bytes, 1, 1, 1.0));
        part.setFrameBuffer(buffer);
        part.readPixels(first_y, static_cast<int>(first_y + rows - 1));
    }
}

double read_extinction(const ExrFile& exr) {
    const Imf::Header& header = exr.header();
    if (header.find(kExtinction) == header.end()) return 1;
    if (const auto* wide = header.findTypedAttribute<Imf::DoubleAttribute>(kExtinction))
        return wide->value();
    if (const auto* narrow = header.findTypedAttribute<Imf::FloatAttribute>(kExtinction))
        return narrow->value();
    throw Error(fmt::format("{}: attribute {} is of type '{}', expected double or float", exr.name,
                            kExtinction, header[kExtinction].typeName()));
}

/// Bytes to a file for OpenEXR, whose destructors write too and must not throw: the first error is
/// kept until finish().
class ExrOutput : public Imf::OStream {
  public:
    explicit ExrOutput(std::ofstream& out) : Imf::OStream("EXR"), out_(out) {
        out_.exceptions(std::ios::goodbit);
    }
    void write(const char bytes[], int count) override {
        if (failed()) return;
        out_.write(bytes, count);
        position_ += static_cast<std::uint64_t>(count);
        keep_error();
    }
    std::uint64_t tellp() override { return position_; }
    void seekp(std::uint64_t position) override {
        if (failed()) return;
        out_.seekp(static_cast<std::streamoff>(position));
        position_ = position;
        keep_error();
    }
    /// throws std::ios_base::failure for the first error, with its errno
    void finish() {
        errno = error_;
        out_.exceptions(std::ios::failbit | std::ios::badbit);
    }

  private:
    bool failed() const { return !out_; }
    void keep_error() {
        if (failed()) error_ = errno;
    }
    std::ofstream& out_;
    std::uint64_t position_ = 0;
    int error_ = 0;
};

/// Writes interleaved float32 channels with lossless compression.
void write_channels(const std::filesystem::path& file, Imf::Header header, const float* values,
                    const std::vector<const char*>& names, const std::string& record) {
    if (!record.empty()) header.insert(kRecord, Imf::StringAttribute(record));
    const auto width = header.dataWindow().max.x + 1, height = header.dataWindow().max.y + 1;
    const std::size_t pixel_bytes = names.size() * sizeof(float);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer buffer;
    for (std::size_t i = 0; i < names.size(); ++i) {
        header.channels().insert(names[i], Imf::Channel(Imf::FLOAT));
        buffer.insert(names[i],
                      Imf::Slice::Make(Imf::FLOAT, values + i, Imath::V2i(0, 0), width, height,
                                       pixel_bytes, pixel_bytes * static_cast<std::size_t>(width)));
    }
    write_file(file, [&](std::ofstream& out) {
        ExrOutput bytes(out);
        try {
            Imf::OutputFile output(bytes, header);
            output.setFrameBuffer(buffer);
            output.writePixels(height);
        } catch (const std::exception& error) {
            throw Error(fmt::format("{}: cannot write: {}", file.string(), reason(error)));
        }
        bytes.finish();
    });
}

}  // namespace

bool is_depth_file(const std::filesystem::path& file) {
    if (image_format(file) != ImageFormat::kExr) return false;
    return reading(file, [&] { return ExrFile(file).channel_names() == "Y"; });
}

DepthImage read_depth(const std::filesystem::path& file) {
    if (image_format(file) != ImageFormat::kExr)
        throw Error(fmt::format("{}: not an EXR image, expected a depth image", file.string()));
    return reading(file, [&] {
        ExrFile exr(file);
        if (exr.channel_names() != "Y")
            throw Error(fmt::format("{}: channels {}, expected only Y: a depth image", exr.name,
                                    exr.channel_names()));
        require_channel_type(exr, "Y", false);
        DepthImage image;
        image.width = static_cast<int>(exr.width());
        image.height = static_cast<int>(exr.height());
        image.extinction = read_extinction(exr);
        read_rows(exr, {"Y"}, image.depth);
        require_valid(exr.name, image);
        return image;
    });
}

Image image_files::read_exr(const std::filesystem::path& file) {
    return reading(file, [&] {
        ExrFile exr(file);
        const std::string names = exr.channel_names();
        if (names != "B, G, R" && names != "A, B, G, R")
            throw Error(fmt::format("{}: channels {}, expected R, G, B and perhaps A{}", exr.name,
                                    names, names == "Y" ? " (this is a depth image)" : ""));
        for (const char* name : {"R", "G", "B"}) require_channel_type(exr, name, true);
        if (names.front() == 'A') require_channel_type(exr, "A", true);
        Image image;
        image.width = static_cast<int>(exr.width());
        image.height = static_cast<int>(exr.height());
        read_rows(exr, {"R", "G", "B", "A"}, image.pixel);
        for (Rgba& pixel : image.pixel)  // EXR stores premultiplied colours
            if (pixel.a > 0 && pixel.a != 1)
                pixel = {pixel.r / pixel.a, pixel.g / pixel.a, pixel.b / pixel.a, pixel.a};
        require_valid(exr.name, image);
        return image;
    });
}

bool image_files::has_channels(const std::filesystem::path& file,
                               const std::array<const char*, 3>& names) {
    return reading(file, [&] {
        const ExrFile exr(file);
        const Imf::ChannelList& channels = exr.header().channels();
        std::size_t count = 0;
        for (auto channel = channels.begin(); channel != channels.end(); ++channel) ++count;
        return count == names.size() && std::ranges::all_of(names, [&](const char* name) {
                   return channels.findChannel(name) != nullptr;
               });
    });
}

std::vector<std::array<float, 3>> image_files::read_channels(
    const std::filesystem::path& file, const std::array<const char*, 3>& names, int& width,
    int& height) {
    return reading(file, [&] {
        ExrFile exr(file);
        for (const char* name : names) require_channel_type(exr, name, false);
        width = static_cast<int>(exr.width());
        height = static_cast<int>(exr.height());
        std::vector<std::array<float, 3>> pixels;
        read_rows(exr, {names.begin(), names.end()}, pixels);
        return pixels;
    });
}

void image_files::write_exr(const std::filesystem::path& file, int width, int height,
                            const std::vector<const char*>& names,
                            const std::vector<float>& interleaved, const std::string& record) {
    write_channels(file, Imf::Header(width, height), interleaved.data(), names, record);
}

std::string image_files::exr_record(const std::filesystem::path& file) {
    return reading(file, [&] {
        const ExrFile exr(file);
        const auto* text = exr.header().findTypedAttribute<Imf::StringAttribute>(kRecord);
        return text ? text->value() : std::string();
    });
}

void write_exr(const std::filesystem::path& file, const Image& image, const std::string& record) {
    require_valid(file.string(), image);
    static_assert(sizeof(Rgba) == 4 * sizeof(float));
    std::vector<Rgba> multiplied = image.pixel;
    for (Rgba& pixel : multiplied)
        pixel = {pixel.r * pixel.a, pixel.g * pixel.a, pixel.b * pixel.a, pixel.a};
    write_channels(file, Imf::Header(image.width, image.height), &multiplied.front().r,
                   {"R", "G", "B", "A"}, record);
}

void write_exr(const std::filesystem::path& file, const DepthImage& image,
               const std::string& record) {
    require_valid(file.string(), image);
    Imf::Header header(image.width, image.height);
    header.insert(kExtinction, Imf::DoubleAttribute(image.extinction));
    write_channels(file, header, image.depth.data(), {"Y"}, record);
}

}  // namespace vog
