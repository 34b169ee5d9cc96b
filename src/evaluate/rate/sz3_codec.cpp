// sz3_codec.cpp: blocks of floats by SZ3 at an absolute bound.
#include "evaluate/rate/float_codecs.h"

#ifdef VOG_SZ3
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"  // templates of the library, instantiated here
#pragma GCC diagnostic ignored "-Wshadow"
#include <SZ3/api/sz.hpp>
#pragma GCC diagnostic pop

#include <memory>

#include "vog/error.h"
#endif

namespace vog::evaluation {

#ifdef VOG_SZ3

namespace {

std::string sz3_encoded(std::span<const float> value, double tolerance) {
    SZ3::Config config(value.size() / 64, 8, 8);
    config.errorBoundMode = SZ3::EB_ABS;
    config.absErrorBound = tolerance;
    std::size_t size = 0;
    const std::unique_ptr<char[]> bytes(SZ_compress(config, value.data(), size));
    return {bytes.get(), size};
}

void sz3_decoded(const std::string& bytes, std::span<float> value) {
    SZ3::Config config;
    float* out = value.data();
    try {
        SZ_decompress(config, bytes.data(), bytes.size(), out);
    } catch (const std::exception& error) {
        throw Error(std::string("SZ3: ") + error.what());
    }
    if (config.num != value.size()) throw Error("SZ3: corrupt values");
}

}  // namespace

const FloatCodec* sz3_codec() {
    static const FloatCodec codec{"SZ3", sz3_encoded, sz3_decoded};
    return &codec;
}

#else

const FloatCodec* sz3_codec() { return nullptr; }

#endif

}  // namespace vog::evaluation
