// same_points.cpp: Equality of particles after their way through a file.
#include "same_points.h"

#include <algorithm>
#include <cmath>

#include "fuzz_target.h"

namespace vog::fuzz {

void expect_round_trip(const Points& points, const std::string& extension) {
    const std::filesystem::path file = scratch_file("again" + extension);
    if (!accepted([&] { write_points(file, points); })) return;
    Points again;
    const bool read = accepted([&] { again = read_points(file); });
    expect(read, "particles that are written are read");
    expect(again.size() == points.size(), "the number of particles survives");
    expect(again.attributes.size() == points.attributes.size(), "attributes survive");
    for (std::size_t n = 0; n < points.attributes.size(); ++n)
        expect(again.attributes[n].name == points.attributes[n].name, "names survive");
    if (extension == ".vdb") {
        // In the order of leaves: compared as sets along each axis.
        const double step = 1e-6 * point_voxel_size(points);
        for (int axis = 0; axis < 3; ++axis) {
            std::vector<double> a, b;
            for (std::size_t n = 0; n < points.size(); ++n) {
                a.push_back(points.position[n][axis]);
                b.push_back(again.position[n][axis]);
            }
            std::sort(a.begin(), a.end()), std::sort(b.begin(), b.end());
            for (std::size_t n = 0; n < a.size(); ++n)
                expect(std::abs(a[n] - b[n]) <= step + 1e-15 * std::abs(a[n]),
                       "positions survive to a millionth of a voxel");
        }
        return;
    }
    expect(same_bytes(again.position, points.position), "positions survive bit for bit");
    expect(same_bytes(again.velocity, points.velocity), "velocities survive bit for bit");
    for (std::size_t n = 0; n < points.attributes.size(); ++n)
        // Numbers beyond floats are rounded where their unit changes.
        expect(points.attributes[n].unit != 1 ||
                   same_bytes(again.attributes[n].value, points.attributes[n].value),
               "attributes survive bit for bit");
}

}  // namespace vog::fuzz
