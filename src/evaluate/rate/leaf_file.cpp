// leaf_file.cpp: layout of files of leaves.
//   "vogleaf1", mask (1 byte), 7 bytes 0
//   bytes of topology and of values, each: uncompressed, compressed (uint64)
//   topology by zstd: transform (12 doubles), leaves, tiles (uint64), column by column steps from origin to origin over 8
//   (int32), which leaves are dense (1 byte), masks of the others, tiles as they are
//   values by the codec, then by zstd
#include "evaluate/rate/leaf_file.h"

#include <fmt/core.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <vector>

#include "core/atomic_file.h"
#include "io/byte_source.h"
#include "vog/error.h"

namespace vog::evaluation {

namespace {

constexpr char kMagic[] = "vogleaf1";
constexpr int kStrongestZstd = 19;
static_assert(std::endian::native == std::endian::little);

struct Header {
    std::array<char, 8> magic{};
    std::uint8_t mask = 0;
    std::array<std::uint8_t, 7> unused{};
    std::array<std::uint64_t, 4> bytes{};  ///< topology, coded topology, values, coded values
};

std::string zstd(const std::string& bytes) {
    const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(),
                                                                       ZSTD_freeCCtx);
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kStrongestZstd);
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);
    std::string out(ZSTD_compressBound(bytes.size()), '\0');
    const std::size_t size =
        ZSTD_compress2(context.get(), out.data(), out.size(), bytes.data(), bytes.size());
    if (ZSTD_isError(size)) throw Error(fmt::format("zstd: {}", ZSTD_getErrorName(size)));
    out.resize(size);
    return out;
}

/// throws vog::Error unless `coded` holds `bytes` bytes
std::string unzstd(const char* coded, std::size_t coded_bytes, std::size_t bytes,
                   const std::string& where) {
    if (ZSTD_getFrameContentSize(coded, coded_bytes) != bytes)
        throw Error(fmt::format("{}: corrupt", where));
    std::string out(bytes, '\0');
    if (ZSTD_decompress(out.data(), bytes, coded, coded_bytes) != bytes)
        throw Error(fmt::format("{}: corrupt", where));
    return out;
}

template <class T>
void put(std::string& out, const T& value) {
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Rows of 8 voxels differ little from the row beside them.
std::array<std::uint64_t, 8> row_differences(const std::array<std::uint64_t, 8>& mask) {
    std::array<std::uint64_t, 8> out;
    for (std::size_t x = 0; x < 8; ++x)
        out[x] = mask[x] ^ (mask[x] << 8) ^ (x ? mask[x - 1] ^ (mask[x - 1] << 8) : 0);
    return out;
}
std::array<std::uint64_t, 8> rows_of(std::array<std::uint64_t, 8> mask) {
    for (std::size_t x = 0; x < 8; ++x) {
        for (const int shift : {8, 16, 32}) mask[x] ^= mask[x] << shift;
        if (x) mask[x] ^= mask[x - 1];
    }
    return mask;
}

std::string topology_of(const Volume& volume, LeafMask mask, bool differences) {
    std::string out;
    put(out, volume.world_from_index);
    put(out, std::uint64_t{volume.leaves.size()});
    put(out, std::uint64_t{volume.tiles.size()});
    put(out, std::uint8_t{differences});
    for (const int Vec3i::*axis : {&Vec3i::x, &Vec3i::y, &Vec3i::z}) {
        std::uint32_t before = 0;
        for (const Leaf& leaf : volume.leaves) {
            const auto at = static_cast<std::uint32_t>(leaf.origin.*axis / kLeafEdge);
            put(out, at - before);
            before = at;
        }
    }
    if (mask == LeafMask::stored) {
        for (const Leaf& leaf : volume.leaves) put(out, std::uint8_t{leaf.dense()});
        for (const Leaf& leaf : volume.leaves)
            if (!leaf.dense()) put(out, differences ? row_differences(leaf.mask) : leaf.mask);
    }
    for (const Tile& tile : volume.tiles) {
        for (const std::int32_t number : {tile.origin.x, tile.origin.y, tile.origin.z, tile.edge})
            put(out, number);
        put(out, tile.value);
    }
    return out;
}

Volume volume_from(const std::string& topology, LeafMask mask, const std::string& where) {
    MemoryBytes in(topology, where, 0);
    Volume volume;
    volume.world_from_index = in.number<Affine>();
    const auto leaves = in.number<std::uint64_t>(), tiles = in.number<std::uint64_t>();
    const bool differences = in.number<std::uint8_t>() != 0;
    if (leaves > topology.size() / 12 || tiles > topology.size() / 20)
        throw Error(fmt::format("{}: corrupt", where));
    volume.leaves.resize(leaves);
    for (int Vec3i::*axis : {&Vec3i::x, &Vec3i::y, &Vec3i::z}) {
        std::uint32_t at = 0;
        for (Leaf& leaf : volume.leaves) {
            at += in.number<std::uint32_t>();
            leaf.origin.*axis = static_cast<int>(at * std::uint32_t{kLeafEdge});
        }
    }
    std::vector<std::uint8_t> dense(leaves, 0);
    if (mask == LeafMask::stored) {
        for (std::uint8_t& flag : dense) flag = in.number<std::uint8_t>();
        for (std::size_t n = 0; n < leaves; ++n) {
            if (dense[n])
                volume.leaves[n].mask.fill(~std::uint64_t{0});
            else if (const auto words = in.number<std::array<std::uint64_t, 8>>(); differences)
                volume.leaves[n].mask = rows_of(words);
            else
                volume.leaves[n].mask = words;
        }
    }
    for (std::size_t n = 0; n < tiles; ++n) {
        Tile& tile = volume.tiles.emplace_back();
        tile.origin.x = in.number<std::int32_t>();
        tile.origin.y = in.number<std::int32_t>();
        tile.origin.z = in.number<std::int32_t>();
        tile.edge = in.number<std::int32_t>();
        tile.value = in.number<float>();
    }
    return volume;
}

/// Gives the inactive voxels of a cube of 4^3, ZFP's block, the mean of neighbours that have values, from those beside
/// active voxels outwards.
void continue_values(const Leaf& leaf, Vec3i first, float* value) {
    std::array<std::int8_t, 64> known{};
    const auto offset = [&](int n) {
        return leaf_offset(first.x + (n >> 4), first.y + (n >> 2 & 3), first.z + (n & 3));
    };
    int missing = 0;
    for (int n = 0; n < 64; ++n) missing += !(known[std::size_t(n)] = leaf.active(offset(n)));
    if (missing == 64) return;
    while (missing > 0) {
        const std::array<std::int8_t, 64> before = known;
        for (int n = 0; n < 64; ++n) {
            if (before[std::size_t(n)]) continue;
            float sum = 0, count = 0;
            for (const int stride : {16, 4, 1})
                for (const int step : {-1, 1}) {
                    const int place = n / stride % 4 + step;
                    if (place < 0 || place > 3 || !before[std::size_t(n + step * stride)]) continue;
                    sum += value[offset(n + step * stride)];
                    ++count;
                }
            if (count == 0) continue;
            value[offset(n)] = sum / count;
            known[std::size_t(n)] = 1;
            --missing;
        }
    }
}

std::vector<float> values_of(const Volume& volume, LeafMask mask) {
    std::vector<float> values(volume.leaves.size() * kLeafVoxels);
    for (std::size_t n = 0; n < volume.leaves.size(); ++n) {
        const Leaf& leaf = volume.leaves[n];
        float* const value = values.data() + n * kLeafVoxels;
        std::ranges::copy(leaf.value, value);
        if (mask == LeafMask::none || leaf.dense()) continue;
        for (int x = 0; x < 8; x += 4)
            for (int y = 0; y < 8; y += 4)
                for (int z = 0; z < 8; z += 4) continue_values(leaf, {x, y, z}, value);
    }
    return values;
}

}  // namespace

std::uint64_t write_leaf_file(const std::filesystem::path& file, const Volume& volume,
                              const FloatCodec& codec, double tolerance, LeafMask mask) {
    std::string topology = topology_of(volume, mask, false), coded = zstd(topology);
    if (std::string other = topology_of(volume, mask, true), shorter = zstd(other);
        shorter.size() < coded.size()) {
        topology = std::move(other);
        coded = std::move(shorter);
    }
    std::string values, coded_values;
    if (!volume.leaves.empty()) {
        values = codec.encode(values_of(volume, mask), tolerance);
        coded_values = zstd(values);
    }
    Header header;
    std::copy_n(kMagic, header.magic.size(), header.magic.begin());
    header.mask = mask == LeafMask::stored;
    header.bytes = {topology.size(), coded.size(), values.size(), coded_values.size()};
    write_file(file, [&](std::ofstream& out) {
        out.write(reinterpret_cast<const char*>(&header), sizeof header);
        out << coded << coded_values;
    });
    return sizeof header + coded.size();
}

Volume read_leaf_file(const std::filesystem::path& file, const FloatCodec& codec) {
    const std::string where = file.string();
    require_readable(file);
    std::ifstream in(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(in), {}};
    Header header;
    if (bytes.size() < sizeof header) throw Error(fmt::format("{}: truncated", where));
    std::memcpy(&header, bytes.data(), sizeof header);
    if (!std::equal(header.magic.begin(), header.magic.end(), kMagic))
        throw Error(fmt::format("{}: no file of leaves", where));
    const auto [topology_bytes, topology_coded, value_bytes, value_coded] = header.bytes;
    const std::size_t rest = bytes.size() - sizeof header;
    if (topology_coded > rest || value_coded != rest - topology_coded)
        throw Error(fmt::format("{}: truncated", where));
    const char* const at = bytes.data() + sizeof header;
    const LeafMask mask = header.mask ? LeafMask::stored : LeafMask::none;
    Volume volume = volume_from(unzstd(at, topology_coded, topology_bytes, where), mask, where);
    volume.source = where;
    if (volume.leaves.empty()) return volume;
    std::vector<float> values(volume.leaves.size() * kLeafVoxels);
    codec.decode(unzstd(at + topology_coded, value_coded, value_bytes, where), values);
    for (std::size_t n = 0; n < volume.leaves.size(); ++n) {
        Leaf& leaf = volume.leaves[n];
        for (int offset = 0; offset < kLeafVoxels; ++offset) {
            const float value = std::max(0.0f, values[n * kLeafVoxels + std::size_t(offset)]);
            if (mask == LeafMask::none ? value > 0 : leaf.active(offset)) leaf.set(offset, value);
        }
    }
    return volume;
}

}  // namespace vog::evaluation
