// map_files.cpp: reading of maps: NumPy's .npy and EXR of the channels column, mean and deviation.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <fstream>
#include <string_view>
#include <system_error>

#include "core/atomic_file.h"
#include "data/image_checks.h"
#include "io/image/image_files.h"
#include "vog/compare_maps.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog {

namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::array<const char*, 3> kChannels{"column", "mean", "deviation"};

bool is_npy(const std::filesystem::path& file) {
    require_readable(file);
    std::string magic(kMagic.size(), '\0');
    std::ifstream(file, std::ios::binary).read(magic.data(), std::ssize(magic));
    return magic == kMagic;
}

/// Header of an .npy file.
struct NpyHeader {
    std::int64_t height = 0, width = 0;
    bool wide = false;  ///< float64
};

[[noreturn]] void refuse(const std::string& name, const std::string& header) {
    throw Error(fmt::format(
        "{}: {}, expected a NumPy array (height, width) of float32 or float64 in C order", name,
        printable(header, 100)));
}

NpyHeader header_of(const std::string& name, std::ifstream& in) {
    const auto byte = [&in] { return static_cast<std::size_t>(in.get() & 0xff); };
    in.seekg(std::ssize(kMagic));
    const std::size_t version = byte();
    (void)byte();
    std::size_t length = byte() | byte() << 8;
    if (version == 2) length |= byte() << 16 | byte() << 24;
    constexpr std::size_t kMostHeader = 1 << 16;
    if (!in || version < 1 || version > 2 || length > kMostHeader)
        refuse(name, "not a whole .npy file of version 1 or 2");
    std::string text(length, '\0');
    if (!in.read(text.data(), std::ssize(text))) refuse(name, "a header cut short");
    // {'descr': '<f4', 'fortran_order': False, 'shape': (480, 640), } and blanks
    std::string_view rest = text;
    const auto require = [&](bool valid) {
        if (!valid) refuse(name, text.substr(0, text.find('\n')));
    };
    const auto skip = [&](std::string_view expected) {
        require(rest.starts_with(expected));
        rest.remove_prefix(expected.size());
    };
    const auto number = [&] {
        constexpr std::ptrdiff_t kMostDigits = 9;
        std::int64_t value = 0;
        const auto [end, code] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
        const std::ptrdiff_t digits = end - rest.data();
        require(code == std::errc{} && value >= 0 && digits <= kMostDigits);
        rest.remove_prefix(static_cast<std::size_t>(digits));
        return value;
    };
    skip("{'descr': '<f");
    const bool is_double = rest.starts_with('8');
    skip(is_double ? "8" : "4");
    skip("', 'fortran_order': False, 'shape': (");
    const std::int64_t height = number();
    skip(", ");
    const std::int64_t width = number();
    skip("), }");
    require(rest.find_first_not_of(" \t\r\n") == rest.npos);
    return {height, width, is_double};
}

}  // namespace

bool is_map_file(const std::filesystem::path& file) { return is_npy(file) || is_field_file(file); }

bool is_field_file(const std::filesystem::path& file) {
    return image_files::image_format(file) == image_files::ImageFormat::kExr &&
           image_files::has_channels(file, kChannels);
}

ValueMap read_map(const std::filesystem::path& file) {
    const std::string name = file.string();
    if (!is_npy(file)) throw Error(name + ": not a NumPy file, expected .npy");
    static_assert(std::endian::native == std::endian::little);
    std::ifstream in(file, std::ios::binary);
    const NpyHeader header = header_of(name, in);
    require_valid_size(name, header.width, header.height);
    const std::int64_t pixels = header.width * header.height, bytes = header.wide ? 8 : 4;
    const std::int64_t held = static_cast<std::int64_t>(std::filesystem::file_size(file)) -
                              static_cast<std::int64_t>(in.tellg());
    if (held != pixels * bytes)
        throw Error(fmt::format("{}: {} bytes of values, expected {} for {}x{} pixels", name, held,
                                pixels * bytes, header.width, header.height));
    ValueMap map{static_cast<int>(header.width), static_cast<int>(header.height), {}};
    map.value.resize(static_cast<std::size_t>(pixels));
    if (header.wide) {
        std::vector<double> values(map.value.size());
        in.read(reinterpret_cast<char*>(values.data()), pixels * bytes);
        std::ranges::transform(values, map.value.begin(),
                               [](double v) { return static_cast<float>(v); });
    } else {
        in.read(reinterpret_cast<char*>(map.value.data()), pixels * bytes);
    }
    if (!in) throw Error(name + ": cannot be read to its end");
    return map;
}

FieldMaps read_field_maps(const std::filesystem::path& file) {
    if (!is_field_file(file))
        throw Error(fmt::format("{}: not an EXR of the channels column, mean and deviation",
                                file.string()));
    FieldMaps maps;
    for (const auto& [column, mean, deviation] :
         image_files::read_channels(file, kChannels, maps.width, maps.height)) {
        if (!(column >= 0))
            throw Error(fmt::format("{}: column {} at pixel {}, expected numbers >= 0",
                                    file.string(), column, maps.column.size()));
        maps.column.push_back(column);
        maps.mean.push_back(mean);
        maps.deviation.push_back(deviation);
    }
    return maps;
}

}  // namespace vog
