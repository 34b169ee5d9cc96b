// volume_codings.h: files of a volume's own voxels that models are compared with, by the tools of others.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "vog/volume.h"

namespace vog::evaluation {

/// One way to write a volume.
struct VolumeCoding {
    std::string series, step;  ///< as in RateRow
    std::string extension;     ///< of its files: ".vdb"
    double tolerance = 0;      ///< of values, in the unit of density; 0: none is chosen
    /// Writes a file. Returns bytes of origins and masks where they stand apart, else 0.
    std::function<std::uint64_t(const Volume&, const std::filesystem::path&)> write;
    /// Reads the file, all that is left of the volume.
    std::function<Volume(const std::filesystem::path&)> read;
};

/// OpenVDB's float and half, by blosc and zip, and NanoVDB's float, Fp16, Fp8 and Fp4 by zip.
/// largest  density
/// absent   receives codings that do not take the largest density, and why
std::vector<VolumeCoding> fixed_codings(double largest, std::vector<std::string>& absent);

/// Codec with a tolerance.
struct GradedCodec {
    std::string series;
    std::function<VolumeCoding(double tolerance)> at;
};
/// NanoVDB's FpN, ZFP with and without masks, SZ3.
/// absent  receives codecs that this build lacks
std::vector<GradedCodec> graded_codecs(std::vector<std::string>& absent);

}  // namespace vog::evaluation
