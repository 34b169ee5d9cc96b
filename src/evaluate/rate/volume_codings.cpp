// volume_codings.cpp: writers and readers of OpenVDB and NanoVDB, and files of leaves by codecs of floats.
#include "evaluate/rate/volume_codings.h"

#include <fmt/core.h>

#include "evaluate/rate/float_codecs.h"
#include "evaluate/rate/leaf_file.h"
#include "io/nvdb/nvdb_quantize.h"
#include "io/vdb/vdb_zip.h"
#include "vog/volume_io.h"

namespace vog::evaluation {

namespace {

namespace fs = std::filesystem;

VolumeCoding vdb_coding(const std::string& step, bool half, bool zip) {
    return {"vdb",
            step,
            ".vdb",
            0,
            [=](const Volume& volume, const fs::path& file) {
                if (zip)
                    vdb::write_vdb_zip(file, volume, half);
                else
                    write_vdb(file, volume, half);
                return std::uint64_t{0};
            },
            [](const fs::path& file) { return read_vdb(file); }};
}

VolumeCoding nano_coding(const std::string& series, const std::string& step, nvdb::NanoCodes codes,
                         double tolerance) {
    return {series,
            step,
            ".nvdb",
            tolerance,
            [=](const Volume& volume, const fs::path& file) {
                nvdb::write_nvdb(file, volume, codes, static_cast<float>(tolerance), true);
                return std::uint64_t{0};
            },
            [](const fs::path& file) { return read_nvdb(file); }};
}

std::string tolerance_text(double tolerance) { return fmt::format("tolerance {:.3g}", tolerance); }

GradedCodec leaf_codec(const std::string& series, const FloatCodec& codec, LeafMask mask,
                       const std::string& extension) {
    return {series, [=, &codec](double tolerance) -> VolumeCoding {
                return {series,
                        tolerance_text(tolerance),
                        extension,
                        tolerance,
                        [=, &codec](const Volume& volume, const fs::path& file) {
                            return write_leaf_file(file, volume, codec, tolerance, mask);
                        },
                        [&codec](const fs::path& file) { return read_leaf_file(file, codec); }};
            }};
}

}  // namespace

std::vector<VolumeCoding> fixed_codings(double largest, std::vector<std::string>& absent) {
    using nvdb::NanoCodes;
    constexpr double kLargestHalf = 65504;
    std::vector<VolumeCoding> codings{vdb_coding("float, blosc", false, false),
                                      vdb_coding("float, zip", false, true)};
    if (largest <= kLargestHalf) {
        codings.push_back(vdb_coding("half, blosc", true, false));
        codings.push_back(vdb_coding("half, zip", true, true));
    } else {
        absent.push_back(fmt::format("vdb, half: a density of {:.6g}, and half floats end at {}",
                                     largest, kLargestHalf));
    }
    codings.push_back(nano_coding("NanoVDB", "float", NanoCodes::f32, 0));
    codings.push_back(nano_coding("NanoVDB", "Fp16", NanoCodes::fp16, 0));
    codings.push_back(nano_coding("NanoVDB", "Fp8", NanoCodes::fp8, 0));
    codings.push_back(nano_coding("NanoVDB", "Fp4", NanoCodes::fp4, 0));
    return codings;
}

std::vector<GradedCodec> graded_codecs(std::vector<std::string>& absent) {
    std::vector<GradedCodec> codecs{{"NanoVDB FpN", [](double tolerance) {
                                         return nano_coding("NanoVDB FpN",
                                                            tolerance_text(tolerance),
                                                            nvdb::NanoCodes::fpn, tolerance);
                                     }}};
    if (const FloatCodec* zfp = zfp_codec()) {
        codecs.push_back(leaf_codec("ZFP and masks", *zfp, LeafMask::stored, ".zfp"));
        codecs.push_back(leaf_codec("ZFP, no masks", *zfp, LeafMask::none, ".zfp"));
    } else {
        absent.emplace_back("ZFP: not in this build");
    }
    if (const FloatCodec* sz3 = sz3_codec()) {
        codecs.push_back(leaf_codec("SZ3 and masks", *sz3, LeafMask::stored, ".sz3"));
        codecs.push_back(leaf_codec("SZ3, no masks", *sz3, LeafMask::none, ".sz3"));
    } else {
        absent.emplace_back("SZ3: not in this build");
    }
    return codecs;
}

}  // namespace vog::evaluation
