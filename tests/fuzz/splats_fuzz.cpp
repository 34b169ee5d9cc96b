// splats_fuzz.cpp: Readers of the splats of other programs: .spz, packed or of any bytes, .glb, whole or of any JSON and
// body, and .usd as text.
#include <zlib.h>

#include <fstream>

#include "fuzz_target.h"
#include "vog/model_io.h"

namespace vog::fuzz {

// Gzip makes a thousand bytes of one.
const Limits kLimits{.memory_ratio = 8192};

namespace {

void read(const std::string& bytes, const char* extension) {
    const std::filesystem::path file = input_file(
        Bytes(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()), extension);
    Gaussians model;
    if (!accepted([&] { model = read_model(file); })) return;
    expect(accepted([&] { validate(model); }), "a model that is read is valid");
}

std::string gzipped(Bytes input) {
    z_stream stream{};
    deflateInit2(&stream, 1, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY);
    std::string out(deflateBound(&stream, input.size()) + 32, '\0');
    stream.next_in = const_cast<Bytef*>(input.data());
    stream.avail_in = static_cast<uInt>(input.size());
    stream.next_out = reinterpret_cast<Bytef*>(out.data());
    stream.avail_out = static_cast<uInt>(out.size());
    deflate(&stream, Z_FINISH);
    out.resize(stream.total_out);
    deflateEnd(&stream);
    return out;
}

/// Two bytes with the length of the JSON, the JSON, the body.
std::string glb_of(Bytes input) {
    const std::size_t json =
        input.size() < 2 ? 0 : std::min<std::size_t>(input[0] + 256u * input[1], input.size() - 2);
    const Bytes rest = input.subspan(std::min<std::size_t>(2, input.size()));
    const std::uint32_t text = static_cast<std::uint32_t>(json),
                        body = static_cast<std::uint32_t>(rest.size() - json);
    const std::uint32_t head[] = {0x46546c67, 2, 28 + text + body, text, 0x4e4f534a};
    const std::uint32_t chunk[] = {body, 0x004e4942};
    std::string out(reinterpret_cast<const char*>(head), sizeof head);
    out.append(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(json));
    out.append(reinterpret_cast<const char*>(chunk), sizeof chunk);
    out.append(rest.begin() + static_cast<std::ptrdiff_t>(json), rest.end());
    return out;
}

}  // namespace

void run(Bytes input) {
    if (input.empty()) return;
    const Bytes rest = input.subspan(1);
    const std::string plain(rest.begin(), rest.end());
    constexpr std::uint8_t kUsd = 0xf0;
    if (input.front() == kUsd) return read(plain, ".usd");
    if (input.front() == kUsd + 1) return read("#usda 1.0\n" + plain, ".usd");
    switch (input.front() % 4) {
        case 0:
            return read(plain, ".spz");
        case 1:
            return read(gzipped(rest), ".spz");
        case 2:
            return read(plain, ".glb");
        default:
            return read(glb_of(rest), ".glb");
    }
}

}  // namespace vog::fuzz
