// nvdb_write.cpp: writing of OpenVDB grids as .nvdb files, one segment a grid, by NanoVDB's own converter.
#include "io/nvdb/nvdb_write.h"

#define NANOVDB_USE_ZIP
#define NANOVDB_USE_BLOSC
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>

#include "core/atomic_file.h"
#include "io/vdb/vdb_grid.h"

namespace vog::nvdb {

namespace {

/// By type, of the two that are written: NanoVDB's choice among all of OpenVDB's takes the compiler a minute.
nanovdb::GridHandle<> nano_grid(const openvdb::GridBase::Ptr& grid) {
    if (const auto vectors = openvdb::gridPtrCast<openvdb::Vec3SGrid>(grid))
        return nanovdb::openToNanoVDB(*vectors);
    return nanovdb::openToNanoVDB(dynamic_cast<const openvdb::FloatGrid&>(*grid));
}

}  // namespace

void write_nvdb_grids(const std::filesystem::path& file, std::size_t count,
                      const std::function<openvdb::GridBase::Ptr(std::size_t)>& grid_of) {
    vdb::with_vdb_errors(file.string(), [&] {
        write_file(file, [&](std::ofstream& out) {
            for (std::size_t n = 0; n < count; ++n)
                nanovdb::io::writeGrid(out, nano_grid(grid_of(n)), nanovdb::io::Codec::BLOSC);
        });
    });
}

}  // namespace vog::nvdb
