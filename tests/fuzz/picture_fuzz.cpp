// picture_fuzz.cpp: Colours and optical depths written as PNG and EXR and read again.
#include <algorithm>
#include <cmath>

#include "fuzz_target.h"
#include "vog/image.h"

namespace vog::fuzz {

const Limits kLimits{};

namespace {

void colours(Numbers& numbers, int width, int height) {
    Image image(width, height);
    const bool transparent = numbers.flag();
    for (Rgba& c : image.pixel) {
        c = {std::abs(numbers.number()), static_cast<float>(numbers.share()), numbers.number()};
        if (transparent) c.a = static_cast<float>(numbers.share());
    }
    const std::filesystem::path png = scratch_file("a.png"), exr = scratch_file("a.exr");
    Image again;
    if (accepted([&] { write_image(png, image); })) {
        expect(accepted([&] { again = read_image(png); }), "a PNG that is written is read");
        expect(image_bytes(again, true) == image_bytes(image, true), "8 bits survive");
    }
    if (accepted([&] { write_image(exr, image); })) {
        expect(accepted([&] { again = read_image(exr); }), "an EXR that is written is read");
        for (std::size_t n = 0; n < image.pixel.size(); ++n) {
            const Rgba a = image.pixel[n], b = again.pixel[n];
            expect(a.a == b.a, "alpha survives");
            // Multiplied by alpha in the file, which may leave the range of floats.
            if (a.a > 1e-4f && std::abs(a.r) < 1e30f && std::abs(a.r) > 1e-30f)
                expect(std::abs(a.r - b.r) <= 1e-6f * std::abs(a.r), "colours survive to 1e-6");
        }
    }
}

}  // namespace

void run(Bytes input) {
    Numbers numbers(input);
    const int width = 1 + numbers.below(32), height = 1 + numbers.below(32);
    if (numbers.flag()) return colours(numbers, width, height);
    DepthImage image(width, height);
    for (float& depth : image.depth) depth = numbers.number();
    image.extinction = double{numbers.number()};
    const std::filesystem::path exr = scratch_file("t.exr");
    if (!accepted([&] { write_exr(exr, image); })) return;
    DepthImage again;
    expect(accepted([&] { again = read_depth(exr); }), "a depth image that is written is read");
    expect(same_bytes(again.depth, image.depth), "T survives bit for bit");
    expect(again.extinction == image.extinction, "the extinction survives");
}

}  // namespace vog::fuzz
