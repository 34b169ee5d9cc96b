// vog/scan_io.h: dense images as volumes: NIfTI, NRRD, MetaImage, raw values, TIFF stacks, FITS cubes.
// vog::read_volume and every other reader of volumes choose these formats by extension (docs/scans.md). A voxel is
// active where its value is not 0; with VdbOptions::ones, in an image with negative values, wherever it is a number.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "vog/volume_io.h"

namespace vog {

/// Whether read_volume reads a file of this extension: .vdb, .nvdb, or that of a dense image.
bool is_volume_file(const std::filesystem::path& file);

/// Description of one grid of a file, and what dense images state beside it.
struct VolumeInfo {
    GridInfo grid;            ///< class "dense image" and the type of the stored values for these
    std::string coordinates;  ///< space of the world: "RAS, from the sform"; empty: as stored
    std::string length_unit;  ///< unit of world lengths: "mm"; empty: not known
    std::string value_unit;   ///< "HU"; empty: not known
};

/// Describes the grids of a file that read_volume reads, in file order; of a .nvdb the one that is read without
/// a name.
/// throws  vog::Error as read_volume does
std::vector<VolumeInfo> inspect_volume(const std::filesystem::path& file);

}  // namespace vog
