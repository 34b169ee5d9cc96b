// vogz_fuzz.cpp: Compact models: files, headers whose checksum is right, chunks, and models of any numbers on their way
// through a file.
#include <algorithm>
#include <cmath>
#include <fstream>

#include "data/fields/field_arrays.h"
#include "drawn.h"
#include "fuzz_target.h"
#include "io/vogz/chunk_fields.h"
#include "io/vogz/chunk_shapes.h"
#include "io/vogz/file_table.h"
#include "vog/vogz.h"

namespace vog::fuzz {

// Equal Gaussians take no bytes each.
const Limits kLimits{.memory_ratio = 4096};

namespace {

using namespace vogz;

/// A file as it is.
void read_file(Bytes input) {
    const std::filesystem::path file = input_file(input, ".vogz");
    Gaussians model;
    Hierarchy hierarchy;
    if (!accepted([&] { model = read_vogz(file, &hierarchy); })) return;
    expect(accepted([&] { validate(model); }), "a model that is read is valid");
    VogzInfo info;
    expect(accepted([&] { info = read_vogz_info(file); }),
           "a model that is read has a description");
    expect(info.gaussians == model.size(), "the description has the number of Gaussians");
    const std::filesystem::path again = scratch_file("again.vogz");
    if (!accepted([&] { write_vogz(again, model, hierarchy); })) return;
    expect(accepted([&] { read_vogz(again); }), "a model that is written is read");
}

/// A header of any JSON and table.
void read_header(Bytes input) {
    if (input.size() < 2) return;
    const std::size_t json = std::min<std::size_t>(input[0] + 256u * input[1], input.size() - 2);
    FileTable plain;
    std::string file = header_bytes(plain);
    const std::string body(input.begin() + 2, input.end());
    const std::string packed = compressed(body, Compression::zstd);
    const std::uint64_t sizes[] = {json, (body.size() - json) / sizeof(Blob), packed.size()};
    const std::uint32_t sum = checksum(packed);
    constexpr std::size_t kSizes = 16, kSum = 40, kBody = 48;
    std::memcpy(file.data() + kSizes, sizes, sizeof sizes);
    std::memcpy(file.data() + kSum, &sum, sizeof sum);
    file.resize(kBody);
    file += packed;
    MemoryBytes in(file, "header", 0);
    accepted([&] { read_table(in, file.size()); });
}

/// Chunks of any bytes.
void read_chunks(Bytes input) {
    Numbers numbers(input);
    const Compression compression = numbers.flag() ? Compression::deflate : Compression::zstd;
    const auto count = static_cast<std::size_t>(numbers.below(300)) + 1;
    Gaussians model = drawn_model(numbers);
    if (model.size() == 0 || !accepted([&] { validate(model); })) return;
    ShapeRounding rounding;
    if (!accepted([&] { rounding = shape_rounding(model, 0.01); })) return;
    Gaussians read;
    read.mean.resize(count), read.scale.resize(count), read.density.resize(count);
    if (!model.axis_aligned()) read.rotation.resize(count);
    read.fields.scalar.resize(1), read.fields.vector.resize(1);
    each_array([&](auto& array) { array.resize(count); }, read.fields);
    Hierarchy hierarchy;
    hierarchy.node_count.resize(count), hierarchy.leaf_count.resize(count);
    hierarchy.radius.resize(count), hierarchy.error.resize(count);
    std::vector<double> spread(count, 1);
    const std::string bytes(input.begin(), input.end());
    const std::span<const char> last =
        std::span(bytes).subspan(std::min<std::size_t>(16, bytes.size()));
    const auto read_by = [&](const auto& reader) {
        MemoryBytes in(last, "chunk", 0);
        accepted([&] { reader(in); });
    };
    read_by([&](MemoryBytes& in) { read_shapes(in, rounding, compression, read, 0, spread); });
    read_by([&](MemoryBytes& in) {
        read_field(in, {0, 1, 0.01}, compression, read.fields.scalar[0], 0, spread);
    });
    read_by([&](MemoryBytes& in) {
        read_field(in, {0, 1, 0.01}, compression, read.fields.vector[0], 0, spread);
    });
    read_by([&](MemoryBytes& in) { read_links(in, compression, hierarchy, 0, count); });
}

/// Models of any numbers.
void write_and_read(Bytes input) {
    Numbers numbers(input);
    Gaussians model = drawn_model(numbers);
    model.fields = drawn_fields(numbers, model.size());
    if (!accepted([&] { validate(model); })) return;
    const std::filesystem::path file = scratch_file("drawn.vogz");
    VogzReport report;
    if (!accepted([&] { report = write_vogz(file, model); })) return;
    Gaussians read;
    expect(accepted([&] { read = read_vogz(file); }), "a model that is written is read");
    expect(read.size() + report.left_out == model.size(), "all Gaussians with density are kept");
    expect(read.fields.names() == model.fields.names(), "all fields are kept");
}

}  // namespace

void run(Bytes input) {
    if (input.empty()) return;
    const Bytes rest = input.subspan(1);
    switch (input.front() % 4) {
        case 0:
            return read_file(rest);
        case 1:
            return read_header(rest);
        case 2:
            return read_chunks(rest);
        default:
            return write_and_read(rest);
    }
}

}  // namespace vog::fuzz
