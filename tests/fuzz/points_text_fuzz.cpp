// points_text_fuzz.cpp: Readers of particles in text; what is read is written and read again.
#include <iterator>
#include <span>

#include "fuzz_target.h"
#include "same_points.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    if (input.empty()) return;
    // The first byte chooses the format.
    constexpr const char* kExtensions[] = {".xyz", ".csv", ".tsv",    ".txt",
                                           ".dat", ".pts", ".extxyz", ".asc"};
    std::string extension = kExtensions[input[0] % std::size(kExtensions)];
    if (input[0] == 0xff) extension += ".gz";
    const std::filesystem::path file = input_file(input.subspan(1), extension);
    for (const bool lenient : {false, true}) {
        Points points;
        std::vector<std::string> notes;
        const PointReadOptions options{.values = {lenient, false}};
        if (!accepted([&] { points = read_points(std::span(&file, 1), options, &notes); }))
            continue;
        expect(accepted([&] { validate(points); }), "particles that are read are valid");
        for (const char* to : {".xyz", ".csv", ".tsv"}) expect_round_trip(points, to);
    }
}

}  // namespace vog::fuzz
