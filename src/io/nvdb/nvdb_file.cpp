// nvdb_file.cpp: segments and grid descriptions of .nvdb files, decompression, header checks.
#include "io/nvdb/nvdb_file.h"

#include <blosc.h>
#include <fmt/core.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <map>

#include "core/paging.h"
#include "io/file_extension.h"
#include "vog/error.h"

namespace vog::nvdb {

namespace {

// Until 32.5, files and grids start with "NanoVDB0"; since 32.6, grids in memory start with
// "NanoVDB1" and files with "NanoVDB2". All versions 32 share one layout.
constexpr std::uint64_t kMagic0 = 0x304244566f6e614e;
constexpr std::uint64_t kMagicGrid = 0x314244566f6e614e;
constexpr std::uint64_t kMagicFile = 0x324244566f6e614e;

/// Description of a grid in the file; its name follows.
struct Description {
    std::uint64_t grid_bytes, file_bytes, name_hash, voxels;
    nanovdb::GridType type;
    std::uint32_t grid_class;
    double world_box[6];
    std::int32_t index_box[6];
    double voxel_size[3];
    std::uint32_t name_bytes;
    std::uint32_t nodes[4], tiles[3];
    std::uint16_t codec, blind_data;
    std::uint32_t version;
};
static_assert(sizeof(Description) == 176);

/// Version as text. Since 29.0 the id holds 11 bits major, 11 minor, 10 patch; before, one number.
std::string version_text(std::uint32_t id) {
    if (id < 29u << 21) return std::to_string(id);
    return fmt::format("{}.{}.{}", id >> 21, id >> 10 & 0x7ff, id & 0x3ff);
}

bool is_supported(std::uint32_t version) { return version >> 21 == NANOVDB_MAJOR_VERSION_NUMBER; }

/// Decompresses a zlib stream behind its length of 8 bytes.
void unpack_zip(MemoryBytes& in, NanoBuffer& grid) {
    const auto packed = in.number<std::uint64_t>();
    const char* from = in.take(packed);
    uLongf unpacked = grid.size();
    const int status = uncompress(reinterpret_cast<Bytef*>(grid.data()), &unpacked,
                                  reinterpret_cast<const Bytef*>(from), packed);
    if (status != Z_OK || unpacked != grid.size())
        in.fail(fmt::format("corrupt: zip stream of {} bytes decompressed, expected {}", unpacked,
                            grid.size()));
}

/// Decompresses blosc chunks of 1 GiB, each behind its length of 8 bytes.
void unpack_blosc(MemoryBytes& in, NanoBuffer& grid) {
    constexpr std::size_t kChunk = std::size_t{1} << 30;
    for (std::size_t done = 0; done < grid.size();) {
        const std::size_t expected = std::min(kChunk, grid.size() - done);
        const auto packed = in.number<std::uint64_t>();
        const char* from = in.take(packed);
        std::size_t declared = 0;
        const bool valid = blosc_cbuffer_validate(from, packed, &declared) == 0;
        if (!valid || declared != expected ||
            blosc_decompress_ctx(from, grid.data() + done, expected, 1) !=
                static_cast<int>(expected))
            in.fail(fmt::format("corrupt: blosc chunk of {} bytes decompressed, expected {}",
                                valid ? declared : 0, expected));
        done += expected;
    }
}

/// Checks the parts of a decompressed grid's header that do not depend on its value type.
void check_header(const NanoBuffer& grid, const std::string& where) {
    const auto fail = [&](const std::string& what) {
        throw Error(fmt::format("{}: corrupt: {}", where, what));
    };
    if (grid.size() < sizeof(nanovdb::GridData)) fail("shorter than the header of a grid");
    const auto& data = *reinterpret_cast<const nanovdb::GridData*>(grid.data());
    if (data.mMagic != kMagic0 && data.mMagic != kMagicGrid) fail("not a NanoVDB grid");
    if (!is_supported(data.mVersion.id()))
        throw Error(fmt::format("{}: NanoVDB grid version {}, expected {}.x", where,
                                version_text(data.mVersion.id()), NANOVDB_MAJOR_VERSION_NUMBER));
    if (data.mGridSize != grid.size())
        fail(fmt::format("a grid of {} bytes, expected {}", data.mGridSize, grid.size()));
}

}  // namespace

bool is_nvdb(const std::filesystem::path& file) { return stored_extension(file) == ".nvdb"; }

NvdbFile::NvdbFile(const std::filesystem::path& file) : name_(file.string()), file_(file) {
    do read_segment();
    while (file_.position() < file_.size());
    std::map<std::string, int> repeats, numbers;
    for (const NvdbEntry& entry : entries_) ++repeats[entry.plain_name];
    for (NvdbEntry& entry : entries_)
        if (repeats[entry.plain_name] > 1)
            entry.name += fmt::format("[{}]", numbers[entry.plain_name]++);
}

void NvdbFile::read_segment() {
    const auto magic = file_.size() < sizeof kMagic0 ? 0 : file_.number<std::uint64_t>();
    if (magic == kMagicGrid)
        throw Error(
            fmt::format("{}: a NanoVDB grid without a file header, expected a .nvdb file", name_));
    if (magic != kMagic0 && magic != kMagicFile) {
        if (!entries_.empty()) file_.fail("corrupt: no NanoVDB header after the last grid");
        throw Error(fmt::format("{}: not a NanoVDB file", name_));
    }
    const auto version = file_.number<std::uint32_t>();
    if (!is_supported(version))
        throw Error(
            fmt::format("{}: NanoVDB file version {}, expected {}.x (write it again with NanoVDB "
                        "{}, or convert the .vdb)",
                        name_, version_text(version), NANOVDB_MAJOR_VERSION_NUMBER,
                        NANOVDB_MAJOR_VERSION_NUMBER));
    const auto count = file_.number<std::uint16_t>();
    const auto codec = file_.number<std::uint16_t>();
    constexpr std::uint16_t kCodecs = 3;
    if (codec >= kCodecs)
        file_.fail(fmt::format("codec {}, expected 0 (none), 1 (zip) or 2 (blosc)", codec));

    // A segment has all its descriptions, then all its grids.
    const std::size_t first = entries_.size();
    for (int i = 0; i < count; ++i) {
        const auto description = file_.number<Description>();
        NvdbEntry entry;
        const char* name = file_.take(description.name_bytes);
        entry.plain_name = grid_name({name, strnlen(name, description.name_bytes)});
        entry.name = entry.plain_name;
        entry.type = description.type;
        entry.codec = codec;
        entry.voxels = description.voxels;
        entry.level_set =
            description.grid_class == static_cast<std::uint32_t>(nanovdb::GridClass::LevelSet);
        entry.grid_bytes = description.grid_bytes;
        entry.end = description.file_bytes;
        entries_.push_back(std::move(entry));
    }
    for (std::size_t i = first; i < entries_.size(); ++i) {
        NvdbEntry& entry = entries_[i];
        const std::uint64_t bytes = entry.end;
        // Largest ratios: zlib 1032, LZ4 255.
        constexpr std::uint64_t kMaxRatio = 1032;
        if (codec == 0 ? entry.grid_bytes != bytes : entry.grid_bytes / kMaxRatio > bytes)
            file_.fail(fmt::format("corrupt: grid '{}' of {} bytes packed into {}", entry.name,
                                   entry.grid_bytes, bytes));
        entry.begin = file_.position();
        if (bytes > file_.size() - entry.begin)
            file_.fail(fmt::format("truncated or corrupt: expected {} more bytes, got {}", bytes,
                                   file_.size() - entry.begin));
        file_.seek(entry.begin + bytes);
        entry.end = file_.position();
    }
}

NanoBuffer NvdbFile::load(const NvdbEntry& entry) {
    const BigVector<char> packed = file_.range(entry.begin, entry.end);
    NanoBuffer grid(entry.grid_bytes);
    MemoryBytes in(packed, where(entry), entry.begin);
    switch (entry.codec) {
        case 1:
            unpack_zip(in, grid);
            break;
        case 2:
            unpack_blosc(in, grid);
            break;
        default:
            for (std::size_t at = 0; at < grid.size(); keep_memory()) {
                constexpr std::size_t kStep = 1 << 20;
                const std::size_t bytes = std::min(kStep, grid.size() - at);
                std::memcpy(grid.data() + at, in.take(bytes), bytes);
                at += bytes;
            }
    }
    if (!in.at_end()) in.fail("corrupt: bytes left after the grid");
    check_header(grid, where(entry));
    return grid;
}

std::string NvdbFile::where(const NvdbEntry& entry) const {
    return fmt::format("{}: grid '{}'", name_, entry.name);
}

std::string nano_type_name(nanovdb::GridType type) {
    if (type < nanovdb::GridType::End) return nanovdb::toStr(type);
    return fmt::format("type {}", static_cast<std::uint32_t>(type));
}

std::uint32_t crc32(const void* data, std::size_t bytes) {
    return static_cast<std::uint32_t>(::crc32_z(0, static_cast<const Bytef*>(data), bytes));
}

}  // namespace vog::nvdb
