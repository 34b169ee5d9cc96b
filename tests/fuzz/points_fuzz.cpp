// points_fuzz.cpp: Particles written in every format and read again.
#include "fuzz_target.h"
#include "same_points.h"

namespace vog::fuzz {

const Limits kLimits{};

void run(Bytes input) {
    Numbers numbers(input);
    Points points;
    const int count = 1 + numbers.below(32);
    const bool moving = numbers.flag();
    const double far = numbers.flag() ? double{numbers.number()} : 0;
    points.attributes.resize(static_cast<std::size_t>(numbers.below(3)));
    for (std::size_t n = 0; n < points.attributes.size(); ++n)
        points.attributes[n].name = n == 0 ? "mass" : numbers.text(12);
    for (int n = 0; n < count; ++n) {
        points.position.push_back(
            {far + double{numbers.number()}, double{numbers.number()}, double{numbers.number()}});
        if (moving)
            points.velocity.push_back({numbers.number(), numbers.number(), numbers.number()});
        for (PointAttribute& attribute : points.attributes)
            attribute.value.push_back(numbers.number());
    }
    if (!accepted([&] { validate(points); })) return;
    for (const char* to : {".xyz", ".csv", ".tsv", ".vdb"}) expect_round_trip(points, to);
}

}  // namespace vog::fuzz
