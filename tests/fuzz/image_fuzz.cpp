// image_fuzz.cpp: Readers of pictures and maps, PNG, EXR and NumPy; what is read is written and read again.
#include <cmath>
#include <limits>

#include "fuzz_target.h"
#include "vog/compare_maps.h"
#include "vog/image.h"

namespace vog::fuzz {

// Codecs of EXR shrink equal pixels without limit, so a header alone tells little. The reader reserves memory for the
// pixels that it declares and touches it row by row; libFuzzer's limit of resident memory holds here.
const Limits kLimits{.memory_ratio = std::numeric_limits<double>::infinity()};

void run(Bytes input) {
    const std::filesystem::path file = input_file(input, ".image");
    accepted([&] { (void)is_depth_file(file); });
    Image image;
    if (accepted([&] { image = read_image(file); })) {
        const std::filesystem::path png = scratch_file("again.png");
        Image again;
        if (accepted([&] { write_image(png, image); })) {
            expect(accepted([&] { again = read_image(png); }), "a PNG that is written is read");
            expect(image_bytes(again, true) == image_bytes(image, true), "8 bits survive");
        }
    }
    DepthImage depth;
    if (accepted([&] { depth = read_depth(file); })) {
        const std::filesystem::path exr = scratch_file("again.exr");
        DepthImage again;
        const bool written = accepted([&] { write_exr(exr, depth); });
        expect(written, "a depth image that is read is written");
        expect(accepted([&] { again = read_depth(exr); }), "a depth image that is written is read");
        expect(same_bytes(again.depth, depth.depth), "T survives bit for bit");
        expect(again.extinction == depth.extinction, "the extinction survives");
    }
    accepted([&] { (void)is_map_file(file); });
    ValueMap map;
    if (accepted([&] { map = read_map(file); })) {
        const std::filesystem::path npy = scratch_file("again.npy");
        ValueMap again;
        expect(accepted([&] { write_map(npy, map); }), "a map that is read is written");
        expect(accepted([&] { again = read_map(npy); }), "a map that is written is read");
        expect(same_bytes(again.value, map.value), "values survive bit for bit");
    }
    FieldMaps maps;
    if (accepted([&] { maps = read_field_maps(file); }))
        accepted([&] { (void)compare(maps, maps); });
}

}  // namespace vog::fuzz
