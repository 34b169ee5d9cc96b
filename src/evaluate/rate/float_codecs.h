// float_codecs.h: lossy codes of blocks of 8^3 floats by the libraries of others, as far as this build has them.
#pragma once

#include <span>
#include <string>

namespace vog::evaluation {

/// Code of N blocks of 8^3 floats, the third index fastest, within an absolute tolerance.
struct FloatCodec {
    std::string name;  ///< "ZFP"
    /// value      [N * 512], N >= 1
    /// tolerance  > 0, largest error of a value
    std::string (*encode)(std::span<const float> value, double tolerance);
    /// bytes    of encode
    /// value    receives [N * 512]
    /// throws   vog::Error if the library refuses the bytes
    void (*decode)(const std::string& bytes, std::span<float> value);
};

/// ZFP at fixed accuracy; null where the build has no libzfp.
const FloatCodec* zfp_codec();
/// SZ3 at an absolute bound; null where the build has no SZ3.
const FloatCodec* sz3_codec();

}  // namespace vog::evaluation
