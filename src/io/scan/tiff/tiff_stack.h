// tiff_stack.h: Descriptions of TIFF files: the order of their planes, and the voxels.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "io/scan/scan_file.h"
#include "vog/linear.h"

namespace vog::scan {

/// Tags of the first page that describe a file.
struct TiffTags {
    std::string name, description;
    std::uint32_t width = 0, height = 0;
    std::uint16_t samples = 1;
    double x_resolution = 0, y_resolution = 0;  ///< pixels a unit; 0: none
    std::uint16_t resolution_unit = 2;          ///< 1 none, 2 inch, 3 centimetre
    Vec3d pixel_scale{};                        ///< GeoTIFF's edges of a pixel on the map; 0: none
    std::string no_data{};                      ///< GDAL's number for pixels without one
};

/// Channels, slices and frames of a stack, and its voxels.
struct TiffStack {
    std::uint64_t channels = 1, frames = 1;
    std::uint64_t slices = 0;   ///< 0: as many as planes make
    std::string order = "CZT";  ///< of planes, the fastest first
    std::vector<std::size_t>
        plane_of_page;  ///< where the description gives each page its place; else empty
    Vec3d edge{1, 1, 1};
    Vec3d origin;                      ///< index of the world's origin
    std::vector<double> coefficients;  ///< value = c0 + c1 stored + c2 stored^2 ...; empty: stored
    double blank = std::numeric_limits<double>::quiet_NaN();  ///< stored where there is no value
    std::string value_unit;
    std::vector<std::string> units;            ///< of x, y, z
    std::vector<std::string> channel_names{};  ///< [channels] as a microscope calls them; or none
    std::string source = "voxels of 1, the file states none";
    std::string note;  ///< what the description leaves out; empty: nothing

    /// Number of the planes; 0: not stated.
    std::uint64_t planes() const { return channels * frames * slices; }
    /// Number of a plane in the order of the file.
    std::uint64_t plane(std::uint64_t channel, std::uint64_t slice, std::uint64_t frame) const;
};

/// Stack by ImageJ's, OME's or tifffile's description, else by the resolution.
/// throws vog::Error for descriptions of several images, and of axes that are no channels, slices or frames
TiffStack tiff_stack(const TiffTags& tags);

/// Lets the grids of frames and channels be chosen by the channels' names, too, which their coordinates state.
void name_channels(const TiffStack& stack, std::vector<ScanGrid>& grids);

}  // namespace vog::scan
