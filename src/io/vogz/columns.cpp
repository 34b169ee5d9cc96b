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

std::size_t symbol_of(std::uint64_t upper) {
    return upper < kDirect
               ? upper
               : kDirect + static_cast<std::size_t>(std::bit_width(upper)) - kLeastWidth;
}
/// Bits of an upper part beside its symbol.
unsigned extra_bits(std::size_t symbol) {
    return symbol < kDirect ? 0 : static_cast<unsigned>(symbol - kDirect) + kLeastWidth - 1;
}

// --- compressors ---

/// Symbols are noise, in which short repetitions are chance: coding them costs more than the symbols themselves.
constexpr int kZstdLevel = 1, kLeastRepetition = 7, kDeflateLevel = 3;

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

/// Most words that the number of lower bits is chosen by: those in the middle of a column.
constexpr std::size_t kSample = 2048;

template <class Number>
std::span<const Number> sample_of(std::span<const Number> numbers) {
    const std::size_t count = std::min(numbers.size(), kSample);
    return numbers.subspan((numbers.size() - count) / 2, count);
}

/// c log2(c) of counts.
double count_bits(std::uint32_t count) {
    static const std::vector<double> table = [] {
        std::vector<double> bits(kSample + 1, 0.0);
        for (std::size_t c = 2; c < bits.size(); ++c)
            bits[c] = static_cast<double>(c) * std::log2(static_cast<double>(c));
        return bits;
    }();
    return table[count];
}

/// Lower bits of words that are stored as they are, and the bits of a column by an ideal entropy coder of the symbols.
struct Division {
    int low_bits = 0;
    double bits = 0;
};

/// Numbers of bits tried: those that leave the middle word an upper part of 2 to 6 bits.
constexpr int kFinest = 6, kCoarsest = 2, kTried = kFinest - kCoarsest + 1;

/// Division at the least cost.
/// words  kSample at most
Division best_division(Words words) {
    std::array<std::uint32_t, 65> widths{};
    constexpr std::size_t kEvery = 8;
    for (std::size_t n = 0; n < words.size(); n += kEvery)
        ++widths[static_cast<std::size_t>(std::bit_width(words[n]))];
    int middle = 0;
    for (std::size_t below = 0; middle < 64; ++middle) {
        below += widths[static_cast<std::size_t>(middle)];
        if (2 * kEvery * below >= words.size()) break;
    }
    const int finest = std::clamp(middle - kFinest, 0, kMostLowBits),
              coarsest = std::clamp(middle - kCoarsest, finest, kMostLowBits);
    // Numbers of each upper part at the finest division, as far as it is a symbol of its own at the coarsest one, and of each
    // width of larger ones. Coarser divisions add up neighbours.
    constexpr std::size_t kUpper = kDirect << (kTried - 1);
    std::array<std::uint32_t, kUpper> upper{};
    std::array<std::uint32_t, 65> wider{};
    for (const std::uint64_t word : words) {
        const std::uint64_t part = word >> finest;
        if (part < kUpper)
            ++upper[part];
        else
            ++wider[static_cast<std::size_t>(std::bit_width(part))];
    }
    const auto n = static_cast<double>(words.size());
    Division best{finest, std::numeric_limits<double>::infinity()};
    for (int low = finest, end = kUpper; low <= coarsest; ++low, end /= 2) {
        // A Huffman code has a table of half a byte for each symbol.
        constexpr double kTable = 4;
        double bits = n * (low + std::log2(std::max(n, 1.0)));
        const auto add = [&](std::uint32_t count, int extra) {
            if (count > 0) bits += kTable + count * double(extra) - count_bits(count);
        };
        for (std::size_t part = 0; part < kDirect; ++part) add(upper[part], 0);
        std::size_t begin = kDirect;
        for (int width = kLeastWidth; width <= 64; ++width) {
            const std::size_t stop = std::min<std::size_t>(std::size_t{1} << std::min(width, 63),
                                                           static_cast<std::size_t>(end));
            std::uint32_t count = 0;
            for (; begin < stop; ++begin) count += upper[begin];
            if (const int at_finest = width + low - finest; at_finest <= 64)
                count += wider[static_cast<std::size_t>(at_finest)];
            add(count, width - 1);
        }
        if (bits < best.bits) best = {low, bits};
        for (std::size_t part = 0; part < static_cast<std::size_t>(end / 2); ++part)
            upper[part] = upper[2 * part] + upper[2 * part + 1];
    }
    return best;
}

/// How the bytes of symbols are stored.
enum class Form : std::uint8_t { constant, plain, compressed };

// --- prediction ---

/// How a number is predicted from those before it.
enum class Prediction : std::uint8_t { fixed, previous, mean_of_four };
constexpr int kPredictions = 3;

/// Numbers that stand before the first one: the base.
constexpr std::size_t kBefore = 4;

std::int64_t sum(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) + static_cast<std::uint64_t>(b));
}
std::int64_t difference(std::int64_t a, std::int64_t b) {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b));
}

/// Prediction of a number.
/// at  the number; kBefore others stand before it
template <Prediction kind>
std::int64_t predicted(const std::int64_t* at, std::int64_t base) {
    if constexpr (kind == Prediction::fixed) return base;
    if constexpr (kind == Prediction::previous) return at[-1];
    return sum(sum(sum(at[-1], at[-2]), sum(at[-3], at[-4])), 2) >> 2;
}
/// use.operator()<kind>()
template <class Use>
void with_prediction(Prediction kind, const Use& use) {
    switch (kind) {
        case Prediction::fixed:
            return use.template operator()<Prediction::fixed>();
        case Prediction::previous:
            return use.template operator()<Prediction::previous>();
        case Prediction::mean_of_four:
            return use.template operator()<Prediction::mean_of_four>();
    }
}

/// Differences of numbers from their predictions, as words.
/// run  kBefore numbers, then those to predict
void residuals(Numbers run, Prediction kind, std::int64_t base, std::span<std::uint64_t> words) {
    with_prediction(kind, [&]<Prediction known>() {
        for (std::size_t n = 0; n < words.size(); ++n) {
            const std::int64_t* at = run.data() + kBefore + n;
            words[n] = zigzag(difference(*at, predicted<known>(at, base)));
        }
    });
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

double column_bits(Words words) {
    const Words sample = sample_of(words);
    if (sample.empty()) return 0;
    const double share = static_cast<double>(words.size()) / static_cast<double>(sample.size());
    return share * best_division(sample).bits;
}

namespace {

/// put_words at a number of lower bits, or as many more as it takes for the largest word.
void put_divided(std::string& out, Words words, int low_bits, Compression compression) {
    const std::uint64_t all =
        std::accumulate(words.begin(), words.end(), std::uint64_t{0}, std::bit_or{});
    const auto widest = static_cast<int>(std::bit_width(all));
    low_bits = std::clamp(widest - kMostWidth, low_bits, std::max(low_bits, kMostLowBits));
    std::string symbols(words.size(), '\0');
    BitWriter bits(words.size() * static_cast<std::size_t>(std::max(widest, low_bits)));
    const auto low = static_cast<unsigned>(low_bits);
    if (all >> low_bits < kDirect) {
        for (std::size_t n = 0; n < words.size(); ++n)
            symbols[n] = static_cast<char>(words[n] >> low_bits);
        bits.put_each(words, low);
    } else {
        for (std::size_t n = 0; n < words.size(); ++n) {
            const std::uint64_t upper = words[n] >> low_bits;
            if (std::bit_width(upper) > kMostWidth)
                throw Error(fmt::format("compact model: the number {}, expected below 2^{}",
                                        words[n], kMostWidth));
            const std::size_t symbol = symbol_of(upper);
            symbols[n] = static_cast<char>(symbol);
            if (const unsigned extra = extra_bits(symbol); extra > 0)
                bits.put(upper & ((std::uint64_t{1} << extra) - 1), extra);
            bits.put(words[n] & ((std::uint64_t{1} << low) - 1), low);
        }
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

}  // namespace

void put_words(std::string& out, Words words, Compression compression) {
    put_divided(out, words, best_division(sample_of(words)).low_bits, compression);
}

void take_words(MemoryBytes& in, std::span<std::uint64_t> words, Compression compression) {
    const auto form = in.number<std::uint8_t>();
    const unsigned low_bits = in.number<std::uint8_t>();
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
    const unsigned char largest = symbols.empty() ? 0 : std::ranges::max(symbols);
    if (largest < kDirect) {
        bits.take_each(words.size(), low_bits, [&](std::size_t n, std::uint64_t lower) {
            words[n] = std::uint64_t{symbols[n]} << low_bits | lower;
        });
    } else {
        if (extra_bits(largest) >= kMostWidth) in.fail(fmt::format("corrupt: symbol {}", largest));
        for (std::size_t n = 0; n < words.size(); ++n) {
            std::uint64_t upper = symbols[n];
            if (upper >= kDirect) {
                const unsigned extra = extra_bits(upper);
                upper = std::uint64_t{1} << extra | bits.take(extra);
            }
            words[n] = upper << low_bits | bits.take(low_bits);
        }
    }
    if (!bits.at_end())
        in.fail(fmt::format("corrupt: {} bytes beside the symbols of a column, expected others",
                            packed));
}

void put_numbers(std::string& out, Numbers numbers, Compression compression) {
    // The middle number of a sample, so that about half of the others lie on either side.
    const Numbers sample = sample_of(numbers);
    std::int64_t base = 0;
    if (!sample.empty()) {
        constexpr std::size_t kEvery = 4;
        std::vector<std::int64_t> sorted;
        for (std::size_t n = 0; n < sample.size(); n += kEvery) sorted.push_back(sample[n]);
        const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
        std::nth_element(sorted.begin(), middle, sorted.end());
        base = *middle;
    }
    std::vector<std::int64_t> run(kBefore + numbers.size(), base);
    std::ranges::copy(numbers, run.begin() + kBefore);
    const auto first = static_cast<std::size_t>(sample.data() - numbers.data());
    std::vector<std::uint64_t> words(numbers.size());
    Prediction best = Prediction::fixed;
    Division division{0, std::numeric_limits<double>::infinity()};
    for (int kind = 0; kind < kPredictions; ++kind) {
        const std::span<std::uint64_t> tried(words.data(), sample.size());
        residuals(Numbers(run).subspan(first, kBefore + sample.size()), Prediction(kind), base,
                  tried);
        const Division found = best_division(tried);
        if (found.bits < division.bits) division = found, best = Prediction(kind);
    }
    residuals(run, best, base, words);
    put(out, best);
    put(out, base);
    put_divided(out, words, division.low_bits, compression);
}

void take_numbers(MemoryBytes& in, std::span<std::int64_t> numbers, Compression compression) {
    const auto kind = in.number<std::uint8_t>();
    if (kind >= kPredictions) in.fail(fmt::format("corrupt: prediction {}", kind));
    const auto base = in.number<std::int64_t>();
    thread_local std::vector<std::uint64_t> words;
    words.resize(numbers.size());
    take_words(in, words, compression);
    with_prediction(Prediction(kind), [&]<Prediction known>() {
        std::array<std::int64_t, kBefore> before;  // in registers; the last one is the latest
        before.fill(base);
        for (std::size_t n = 0; n < words.size(); ++n) {
            const std::int64_t number =
                sum(predicted<known>(before.data() + kBefore, base), from_zigzag(words[n]));
            before = {before[1], before[2], before[3], number};
            numbers[n] = number;
        }
    });
}

}  // namespace vog::vogz
