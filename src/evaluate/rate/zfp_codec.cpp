// zfp_codec.cpp: blocks of floats by libzfp at fixed accuracy.
#include "evaluate/rate/float_codecs.h"

#ifdef VOG_ZFP
#include <zfp.h>

#include <memory>

#include "vog/error.h"
#endif

namespace vog::evaluation {

#ifdef VOG_ZFP

namespace {

struct CloseZfp {
    void operator()(zfp_stream* stream) const { zfp_stream_close(stream); }
    void operator()(zfp_field* field) const { zfp_field_free(field); }
    void operator()(bitstream* bits) const { stream_close(bits); }
};

/// One array 8 x 8 x 8 N: ZFP's blocks of 4^3 values then lie each in one block of 8^3.
struct ZfpArray {
    std::unique_ptr<zfp_field, CloseZfp> field;
    std::unique_ptr<zfp_stream, CloseZfp> stream{zfp_stream_open(nullptr)};
    std::unique_ptr<bitstream, CloseZfp> bits;

    explicit ZfpArray(std::span<const float> value)
        // ZFP's interface has no constant arrays; compression writes none.
        : field(zfp_field_3d(const_cast<float*>(value.data()), zfp_type_float, 8, 8,
                             value.size() / 64)) {}
    void open(char* buffer, std::size_t bytes) {
        bits.reset(stream_open(buffer, bytes));
        zfp_stream_set_bit_stream(stream.get(), bits.get());
        zfp_stream_rewind(stream.get());
    }
};

std::string zfp_encoded(std::span<const float> value, double tolerance) {
    ZfpArray array(value);
    zfp_stream_set_accuracy(array.stream.get(), tolerance);
    std::string bytes(zfp_stream_maximum_size(array.stream.get(), array.field.get()), '\0');
    array.open(bytes.data(), bytes.size());
    zfp_write_header(array.stream.get(), array.field.get(), ZFP_HEADER_FULL);
    const std::size_t size = zfp_compress(array.stream.get(), array.field.get());
    if (size == 0) throw Error("ZFP: compression failed");
    bytes.resize(size);
    return bytes;
}

void zfp_decoded(const std::string& bytes, std::span<float> value) {
    ZfpArray array(value);
    // ZFP reads whole words.
    std::string padded = bytes + std::string(sizeof(std::uint64_t), '\0');
    array.open(padded.data(), padded.size());
    const std::unique_ptr<zfp_field, CloseZfp> stored(zfp_field_alloc());
    if (zfp_read_header(array.stream.get(), stored.get(), ZFP_HEADER_FULL) == 0 ||
        stored->type != zfp_type_float || stored->nx != 8 || stored->ny != 8 ||
        stored->nz != array.field->nz || zfp_decompress(array.stream.get(), array.field.get()) == 0)
        throw Error("ZFP: corrupt values");
}

}  // namespace

const FloatCodec* zfp_codec() {
    static const FloatCodec codec{"ZFP", zfp_encoded, zfp_decoded};
    return &codec;
}

#else

const FloatCodec* zfp_codec() { return nullptr; }

#endif

}  // namespace vog::evaluation
