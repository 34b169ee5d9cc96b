// vog/scan_io.h: dense images as volumes: NIfTI, NRRD, MetaImage, raw values, TIFF stacks, FITS cubes.
// vog::read_volume and every other reader of volumes choose these formats by extension (docs/scans.md). A voxel is
// active where its value is above the background (Volume::background, 0 unless the values show another); with
// VdbOptions::ones where it is not 0, in an image with negative values wherever it is a number.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "vog/volume_io.h"

namespace vog {

/// Whether read_volume reads a file of this extension: .vdb, .nvdb, either with .gz, or that of a dense image.
bool is_volume_file(const std::filesystem::path& file);

/// Description of one grid of a file, and what dense images state beside it.
struct VolumeInfo {
    GridInfo grid;            ///< class "dense image" and the type of the stored values for these
    std::string coordinates;  ///< space of the world: "RAS, from the sform"; empty: as stored
    std::string length_unit;  ///< unit of world lengths: "mm"; empty: not known
    std::string value_unit;   ///< "HU"; empty: not known
    std::string note;  ///< departures of the file from its format, and how it is read; empty: none
    double background = 0;  ///< Volume::background that read_volume finds in a dense image
};

/// Describes the grids of a file that read_volume reads, in file order.
/// throws  vog::Error as read_volume does
std::vector<VolumeInfo> inspect_volume(const std::filesystem::path& file);

/// Places that the head of a dense image states, without its values.
struct VolumeHead {
    Vec3d voxel_size{1, 1, 1};  ///< edges, in world units
    Vec3d origin;               ///< world position of the first voxel's centre
    std::string length_unit;    ///< as VolumeInfo::length_unit
    std::string value_unit;     ///< as VolumeInfo::value_unit
};
/// Reads the head of one grid of a dense image; edges of 1 without units for other files.
/// throws  vog::Error as read_volume does
VolumeHead volume_head(const std::filesystem::path& file, const std::string& grid = {});

/// Departures of a dense image from its format, and how it is read: "a.fits: 4800 bytes, ..."; empty: none. read_volume
/// has them among its notes; VolumeReader (vog/distributed.h) does not.
/// throws  vog::Error as read_volume does
std::string volume_note(const std::filesystem::path& file);

}  // namespace vog
