// nvdb_quantize.cpp: writing of volumes as .nvdb files of quantised floats, by NanoVDB's own converter.
#include "io/nvdb/nvdb_quantize.h"

#define NANOVDB_USE_ZIP
#define NANOVDB_USE_BLOSC
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>

#include "core/atomic_file.h"
#include "io/vdb/vdb_grid.h"
#include "vog/openvdb.h"

namespace vog::nvdb {

namespace {

template <class Codes>
nanovdb::GridHandle<> converted(const openvdb::FloatGrid& grid, float tolerance) {
    nanovdb::OpenToNanoVDB<float, Codes> convert;
    convert.oracle().setTolerance(tolerance);
    return convert(grid, nanovdb::StatsMode::Default, nanovdb::ChecksumMode::Default, 0,
                   nanovdb::HostBuffer());
}

nanovdb::GridHandle<> converted(const openvdb::FloatGrid& grid, NanoCodes codes, float tolerance) {
    switch (codes) {
        case NanoCodes::f32:
            return converted<float>(grid, tolerance);
        case NanoCodes::fp4:
            return converted<nanovdb::Fp4>(grid, tolerance);
        case NanoCodes::fp8:
            return converted<nanovdb::Fp8>(grid, tolerance);
        case NanoCodes::fp16:
            return converted<nanovdb::Fp16>(grid, tolerance);
        case NanoCodes::fpn:
            break;
    }
    return converted<nanovdb::FpN>(grid, tolerance);
}

}  // namespace

void write_nvdb(const std::filesystem::path& file, const Volume& volume, NanoCodes codes,
                float tolerance, bool zip) {
    const std::string where = file.string();
    validate(volume);
    if (volume.empty()) throw Error(fmt::format("{}: cannot write: no active voxels", where));
    if (codes == NanoCodes::fpn && !(tolerance > 0))
        throw Error(fmt::format("{}: tolerance {}, expected above 0", where, tolerance));
    vdb::with_vdb_errors(where, [&] {
        const nanovdb::GridHandle<> grid = converted(*grid_from_volume(volume), codes, tolerance);
        write_file(file, [&](std::ofstream& out) {
            nanovdb::io::writeGrid(out, grid,
                                   zip ? nanovdb::io::Codec::ZIP : nanovdb::io::Codec::BLOSC);
        });
    });
}

}  // namespace vog::nvdb
