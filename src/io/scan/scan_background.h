// scan_background.h: value of empty space in a dense image, above which values are density.
#pragma once

#include "io/scan/scan_file.h"
#include "vog/memory.h"

namespace vog::scan {

/// Value of empty space, from the distribution of the values (docs/scans.md, "Background"):
///   -1000 of Hounsfield units, whose unit the file states or whose air makes a peak at -1000;
///   mode + 4 deviations of a noise peak at the low end of an image without negative values;
///   0 of all other images, and where exact zeros are a 20th of the voxels.
double background_of(const ScanGrid& grid, const BigVector<float>& value);

/// Subtracts the background. Values below it become 0.
void subtract_background(double background, BigVector<float>& value);

}  // namespace vog::scan
