// vdb_write.cpp: writing of volumes as .vdb files: the container here, the trees by OpenVDB.
// Not by openvdb::io::File: it ignores a full disk, compresses every leaf twice, stores a random
// identifier, so that equal grids give different files, and refuses voxels below 1.4e-5.
#include <openvdb/io/Archive.h>

#include <algorithm>
#include <fstream>

#include "core/atomic_file.h"
#include "io/vdb/vdb_volume.h"
#include "vog/openvdb.h"
#include "vog/volume_io.h"

namespace vog {

using namespace vdb;

namespace {

constexpr float kLargestHalf = 65504;

template <class T>
void put(std::ostream& out, const T& value) {
    out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

void require_half_range(const Volume& volume, const std::string& where) {
    float largest = 0;
    for (const Leaf& leaf : volume.leaves)
        for (float value : leaf.value) largest = std::max(largest, value);
    for (const Tile& tile : volume.tiles) largest = std::max(largest, tile.value);
    if (largest > kLargestHalf)
        throw Error(fmt::format("{}: density {} as half floats, expected at most {}", where,
                                largest, kLargestHalf));
}

/// throws vog::Error unless there is a grid and several grids have distinct names
void require_names(std::span<const Volume> volumes, const std::string& where) {
    if (volumes.empty()) throw Error(fmt::format("{}: cannot write: no grid", where));
    for (std::size_t a = 0; volumes.size() > 1 && a < volumes.size(); ++a)
        for (std::size_t b = 0; b <= a; ++b)
            if (volumes[a].name.empty() || (b < a && volumes[a].name == volumes[b].name))
                throw Error(fmt::format("{}: cannot write: several grids named '{}'", where,
                                        volumes[a].name));
}

void write_header(std::ostream& out, std::size_t grids) {
    put(out, std::int64_t{openvdb::OPENVDB_MAGIC});
    put(out, openvdb::OPENVDB_FILE_VERSION);
    put(out, openvdb::OPENVDB_LIBRARY_MAJOR_VERSION);
    put(out, openvdb::OPENVDB_LIBRARY_MINOR_VERSION);
    put(out, char{1});                              // grids have their positions
    out << "00000000-0000-0000-0000-000000000000";  // identifier
    put(out, std::uint32_t{0});                     // number of metadata entries
    put(out, static_cast<std::int32_t>(grids));
}

/// Position in the file. A failing tellp changes no state of the stream.
/// throws std::ios_base::failure
std::int64_t position(std::ostream& out) {
    const std::int64_t at = out.tellp();
    if (at < 0) out.setstate(std::ios::failbit);
    return at;
}

void write_grid(std::ostream& out, const GridToWrite& write) {
    // A variable of OpenVDB: blosc where it was built with that.
    const std::uint32_t compression = openvdb::io::Archive::DEFAULT_COMPRESSION_FLAGS;
    const openvdb::GridBase& grid = *write.grid;
    // The stream's metadata counts the passes in which points are written.
    openvdb::io::StreamMetadata::Ptr metadata(new openvdb::io::StreamMetadata), none;
    openvdb::io::setStreamMetadataPtr(out, metadata, false);
    openvdb::io::setDataCompression(out, compression);
    openvdb::writeString(out, grid.getName());
    openvdb::writeString(out, grid.type() + (grid.saveFloatAsHalf() ? "_HalfFloat" : ""));
    openvdb::writeString(out, "");  // no grid to share a tree with
    const std::int64_t positions = position(out);
    for (int i = 0; i < 3; ++i) put(out, std::int64_t{0});

    const std::int64_t begin = position(out);
    put(out, compression);
    grid.writeMeta(out);
    grid.writeTransform(out);
    grid.writeTopology(out);
    const std::int64_t voxels = position(out);
    if (write.write_values)
        write.write_values(out);
    else
        grid.writeBuffers(out);
    const std::int64_t end = position(out);
    out.seekp(positions);
    for (const std::int64_t at : {begin, voxels, end}) put(out, at);
    out.seekp(end);
    openvdb::io::setStreamMetadataPtr(out, none, false);
}

}  // namespace

void vdb::write_vdb_grids(const std::filesystem::path& file, std::size_t count,
                          const std::function<GridToWrite(std::size_t)>& grid_of) {
    const std::string where = file.string();
    with_vdb_errors(where, [&] {
        write_file(file, [&](std::ofstream& out) {
            write_header(out, count);
            for (std::size_t n = 0; n < count; ++n) {
                const GridToWrite write = grid_of(n);
                write.grid->setCreator("vog");
                write_grid(out, write);
            }
        });
    });
}

void write_vdb(const std::filesystem::path& file, const Volume& volume, bool half) {
    write_vdb(file, std::span(&volume, 1), half);
}

void write_vdb(const std::filesystem::path& file, std::span<const Volume> volumes, bool half) {
    const std::string where = file.string();
    require_names(volumes, where);
    for (const Volume& volume : volumes) {
        validate(volume);
        if (volume.empty()) throw Error(fmt::format("{}: cannot write: no active voxels", where));
        if (half) require_half_range(volume, where);
    }
    const auto grid_of = [&](std::size_t n) -> GridToWrite {
        const openvdb::FloatGrid::Ptr grid = grid_from_volume(volumes[n]);
        grid->setSaveFloatAsHalf(half);
        grid->addStatsMetadata();
        return {grid, {}};
    };
    write_vdb_grids(file, volumes.size(), grid_of);
}

}  // namespace vog
