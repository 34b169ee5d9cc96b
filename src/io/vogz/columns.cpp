// columns.cpp: prediction, division into symbols and lower bits, and the two compressors.
#include "io/vogz/columns.h"

#include <fmt/core.h>
#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <numeric>
#include <vector>

#include "io/vogz/bits.h"
#include "vog/error.h"

namespace vog::vogz {

namespace {

using Words = std::span<const std::uint64_t>;
using Numbers = std::span<const std::int64_t>;

/// Upper parts of words below kDirect are symbols themselves; larger ones have a symbol for their width, and their bits
/// below the highest stand apart.
constexpr std::uint64_t kDirect = 192;
constexpr int kLeastWidth = 8;  // of kDirect
constexpr int kMostLowBits = 48, kMostWidth = kMostBits + 1;
constexpr std::size_t kSymbols =
    kDirect + 64 - kLeastWidth + 1;  // of all words; files have those up to kMostWidth

std::size_t symbol_of(std::uint64_t upper) {
    return upper < kDirect
               ? upper
               : kDirect + static_cast<std::size_t>(std::bit_width(upper)) - kLeastWidth;
}
/// Bits of an upper part beside its symbol.
int extra_bits(std::size_t symbol) {
    return symbol < kDirect ? 0 : static_cast<int>(symbol - kDirect) + kLeastWidth - 1;
}

// --- compressors ---

/// Symbols are noise, in which short repetitions are chance: coding them costs more than the symbols themselves.
constexpr int kZstdLevel = 1, kLeastRepetition = 7, kDeflateLevel = 9;

struct FreeContext {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
    void operator()(ZSTD_DCtx* context) const { ZSTD_freeDCtx(context); }
};

/// Buffers of zstd, which take longer to make than a column to code: one a thread.
ZSTD_CCtx& compressor() {
    thread_local const std::unique_ptr<ZSTD_CCtx, FreeContext> context(ZSTD_createCCtx());
    if (!context) throw std::bad_alloc();
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kZstdLevel);
    ZSTD_CCtx_setParameter(context.get(), ZSTD_c_minMatch, kLeastRepetition);
    return *context;
}
ZSTD_DCtx& decompressor() {
    thread_local const std::unique_ptr<ZSTD_DCtx, FreeContext> context(ZSTD_createDCtx());
    if (!context) throw std::bad_alloc();
    return *context;
}

std::string by_zstd(std::span<const char> bytes) {
    std::string out(ZSTD_compressBound(bytes.size()), '\0');
    const std::size_t size =
        ZSTD_compress2(&compressor(), out.data(), out.size(), bytes.data(), bytes.size());
    if (ZSTD_isError(size))
        throw Error(fmt::format("zstd cannot compress: {}", ZSTD_getErrorName(size)));
    out.resize(size);
    return out;
}

/// strategy  Z_HUFFMAN_ONLY: no repetitions
std::string by_deflate(std::span<const char> bytes, int strategy) {
    z_stream stream{};
    constexpr int kWindowBits = 15, kMemory = 9;
    if (deflateInit2(&stream, kDeflateLevel, Z_DEFLATED, kWindowBits, kMemory, strategy) != Z_OK)
        throw Error("zlib cannot compress");
    std::string out(deflateBound(&stream, bytes.size()), '\0');
    stream.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(bytes.data()));
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    const int result = deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    if (result != Z_STREAM_END) throw Error("zlib cannot compress");
    return out;
}

// --- symbols and lower bits ---

/// Bits of a column by an ideal entropy coder.
/// low_bits  of each word that are stored as they are
double cost(Words words, int low_bits) {
    std::array<std::uint32_t, kSymbols> count{};
    for (const std::uint64_t word : words) ++count[symbol_of(word >> low_bits)];
    const auto n = static_cast<double>(words.size());
    double bits = low_bits * n;
    for (std::size_t symbol = 0; symbol < kSymbols; ++symbol) {
        // A Huffman code has a table of half a byte for each symbol.
        constexpr double kTable = 4;
        const double c = count[symbol];
        if (c > 0) bits += c * (std::log2(n / c) + extra_bits(symbol)) + kTable;
    }
    return bits;
}

/// Number of lower bits at the least cost.
int best_low_bits(Words words) {
    const std::uint64_t all =
        std::accumulate(words.begin(), words.end(), std::uint64_t{0}, std::bit_or{});
    constexpr std::size_t kSample = 4096;
    if (words.size() > kSample) words = words.subspan((words.size() - kSample) / 2, kSample);
    // Around the width that leaves half of the words below kDirect.
    std::array<std::size_t, 65> widths{};
    for (const std::uint64_t word : words) ++widths[static_cast<std::size_t>(std::bit_width(word))];
    int middle = 0;
    for (std::size_t below = 0; middle < 64; ++middle) {
        below += widths[static_cast<std::size_t>(middle)];
        if (2 * below >= words.size()) break;
    }
    constexpr int kFinest = 6, kCoarsest = 2;  // bits of the middle word's symbol
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    // Upper parts of the widest word fit, too.
    const auto widest = static_cast<int>(std::bit_width(all));
    const int first = std::clamp(std::max(middle - kFinest, widest - kMostWidth), 0, kMostLowBits);
    for (int low = first; low <= std::clamp(middle - kCoarsest, first, kMostLowBits); ++low) {
        const double bits = cost(words, low);
        if (bits < least) least = bits, best = low;
    }
    return best;
}

/// How the bytes of symbols are stored.
enum class Form : std::uint8_t { constant, plain, compressed };

// --- prediction ---

/// How a number is predicted from those before it.
enum class Prediction : std::uint8_t { fixed, previous, mean_of_four };
constexpr int kPredictions = 3;

/// Predictions in turn: next() for a number, then add(number).
class Predictor {
  public:
    Predictor(Prediction kind, std::int64_t base) : kind_(kind), base_(base) { last_.fill(base); }
    std::int64_t next() const {
        switch (kind_) {
            case Prediction::fixed:
                return base_;
            case Prediction::previous:
                return last_[0];
            case Prediction::mean_of_four:
                break;
        }
        return sum_of_last() >> 2;
    }
    void add(std::int64_t number) { last_ = {number, last_[0], last_[1], last_[2]}; }

  private:
    // Unsigned: numbers of a corrupt file may wrap around.
    std::int64_t sum_of_last() const {
        std::uint64_t sum = 2;
        for (const std::int64_t number : last_) sum += static_cast<std::uint64_t>(number);
        return static_cast<std::int64_t>(sum);
    }
    Prediction kind_;
    std::int64_t base_;
    std::array<std::int64_t, 4> last_;
};

std::int64_t sum(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
std::int64_t difference(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

std::vector<std::uint64_t> residuals(Numbers numbers, Prediction kind, std::int64_t base) {
    std::vector<std::uint64_t> words;
    words.reserve(numbers.size());
    Predictor predictor(kind, base);
    for (const std::int64_t number : numbers) {
        words.push_back(zigzag(difference(number, predictor.next())));
        predictor.add(number);
    }
    return words;
}

}  // namespace

std::string compressed(std::span<const char> bytes, Compression compression) {
    if (compression == Compression::zstd) return by_zstd(bytes);
    std::string plain = by_deflate(bytes, Z_HUFFMAN_ONLY);
    std::string repeated = by_deflate(bytes, Z_DEFAULT_STRATEGY);
    return plain.size() <= repeated.size() ? plain : repeated;
}

void decompress(const ByteSource& in, std::span<const char> bytes, Compression compression,
                std::span<char> out) {
    std::size_t made = 0;
    bool failed = false;
    if (compression == Compression::zstd) {
        made = ZSTD_decompressDCtx(&decompressor(), out.data(), out.size(), bytes.data(),
                                   bytes.size());
        failed = ZSTD_isError(made) != 0;
    } else {
        uLongf size = out.size();
        failed = uncompress(reinterpret_cast<Bytef*>(out.data()), &size,
                            reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()) != Z_OK;
        made = size;
    }
    if (failed || made != out.size())
        in.fail(fmt::format("corrupt: {} compressed bytes, expected {} bytes in them", bytes.size(),
                            out.size()));
}

double column_bits(Words words) { return cost(words, best_low_bits(words)); }

void put_words(std::string& out, Words words, Compression compression) {
    const int low_bits = best_low_bits(words);
    std::string symbols(words.size(), '\0');
    BitWriter bits;
    for (std::size_t n = 0; n < words.size(); ++n) {
        const std::uint64_t upper = words[n] >> low_bits;
        if (std::bit_width(upper) > kMostWidth)
            throw Error(fmt::format("compact model: the number {}, expected below 2^{}", words[n],
                                    kMostWidth));
        const std::size_t symbol = symbol_of(upper);
        symbols[n] = static_cast<char>(symbol);
        if (const int extra = extra_bits(symbol); extra > 0)
            bits.put(upper & ((std::uint64_t{1} << extra) - 1), extra);
        bits.put(words[n] & ((std::uint64_t{1} << low_bits) - 1), low_bits);
    }
    const bool constant =
        std::ranges::all_of(symbols, [&](char c) { return c == symbols.front(); });
    std::string bytes = constant ? symbols.substr(0, 1) : compressed(symbols, compression);
    Form form = constant ? Form::constant : Form::compressed;
    if (bytes.size() >= symbols.size() && !constant) bytes = symbols, form = Form::plain;
    const std::string packed = bits.take();
    put(out, form);
    put(out, static_cast<std::uint8_t>(low_bits));
    put(out, static_cast<std::uint32_t>(bytes.size()));
    put(out, static_cast<std::uint32_t>(packed.size()));
    out += bytes;
    out += packed;
}

void take_words(MemoryBytes& in, std::span<std::uint64_t> words, Compression compression) {
    const auto form = in.number<std::uint8_t>();
    const int low_bits = in.number<std::uint8_t>();
    const auto size = in.number<std::uint32_t>(), packed = in.number<std::uint32_t>();
    if (form > static_cast<std::uint8_t>(Form::compressed) || low_bits > kMostLowBits)
        in.fail(fmt::format("corrupt: a column of form {} with {} lower bits", form, low_bits));
    std::vector<unsigned char> symbols(words.size());
    const std::span<const char> bytes(in.take(size), size);
    const std::size_t plain =
        Form(form) == Form::plain ? words.size() : std::min<std::size_t>(words.size(), 1);
    if (Form(form) == Form::compressed)
        decompress(in, bytes, compression,
                   {reinterpret_cast<char*>(symbols.data()), symbols.size()});
    else if (size != plain)
        in.fail(fmt::format("corrupt: a column of {} bytes, expected {}", size, plain));
    else if (Form(form) == Form::plain)
        std::ranges::copy(bytes, symbols.begin());
    else
        std::ranges::fill(symbols, static_cast<unsigned char>(plain ? bytes[0] : 0));
    BitReader bits({in.take(packed), packed});
    for (std::size_t n = 0; n < words.size(); ++n) {
        std::uint64_t upper = symbols[n];
        if (upper >= kDirect) {
            const int extra = extra_bits(upper);
            if (extra >= kMostWidth) in.fail(fmt::format("corrupt: symbol {}", upper));
            upper = std::uint64_t{1} << extra | bits.take(extra);
        }
        words[n] = upper << low_bits | bits.take(low_bits);
    }
    if (!bits.at_end())
        in.fail(fmt::format("corrupt: {} bytes beside the symbols of a column, expected others",
                            packed));
}

void put_numbers(std::string& out, Numbers numbers, Compression compression) {
    // The middle number, so that half of the others lie on either side.
    std::int64_t base = 0;
    if (!numbers.empty()) {
        std::vector<std::int64_t> sorted(numbers.begin(), numbers.end());
        const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
        std::nth_element(sorted.begin(), middle, sorted.end());
        base = *middle;
    }
    double least = std::numeric_limits<double>::infinity();
    Prediction best = Prediction::fixed;
    std::vector<std::uint64_t> words;
    for (int kind = 0; kind < kPredictions; ++kind) {
        std::vector<std::uint64_t> tried = residuals(numbers, Prediction(kind), base);
        const double bits = column_bits(tried);
        if (!(bits < least)) continue;
        least = bits, best = Prediction(kind);
        words = std::move(tried);
    }
    put(out, best);
    put(out, base);
    put_words(out, words, compression);
}

void take_numbers(MemoryBytes& in, std::span<std::int64_t> numbers, Compression compression) {
    const auto kind = in.number<std::uint8_t>();
    if (kind >= kPredictions) in.fail(fmt::format("corrupt: prediction {}", kind));
    const auto base = in.number<std::int64_t>();
    std::vector<std::uint64_t> words(numbers.size());
    take_words(in, words, compression);
    Predictor predictor(Prediction(kind), base);
    for (std::size_t n = 0; n < numbers.size(); ++n) {
        numbers[n] = sum(predictor.next(), from_zigzag(words[n]));
        predictor.add(numbers[n]);
    }
}

}  // namespace vog::vogz
