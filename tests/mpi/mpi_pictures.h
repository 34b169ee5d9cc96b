// mpi_pictures.h: fixture that compares pictures of vog-mpi with those of vog.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "mpi_command.h"
#include "vog/compare_maps.h"

namespace vog::test {

/// Sums of single precision in another order.
inline constexpr double kSamePicture = 1e-6;

/// Parameter: number of ranks.
class MpiPictures : public Mpi, public testing::WithParamInterface<int> {
  protected:
    /// Renders to a file by vog and by the ranks.
    /// arguments  of the command, ending in the option of the output
    void render_both(const std::string& arguments, const std::string& output) const {
        must("render --size 150x90 " + arguments + " one" + output);
        must_mpi(GetParam(), "render --size 150x90 " + arguments + " many" + output);
    }
    /// Largest difference of colours and alpha of pictures over a transparent background.
    double picture_difference(const std::string& arguments) const {
        render_both(arguments + " --show volume --background transparent -o", ".exr");
        const Image one = read_image(dir_ / "one.exr"), many = read_image(dir_ / "many.exr");
        EXPECT_EQ(one.pixel.size(), many.pixel.size());
        double largest = 0, most = 0;
        for (std::size_t n = 0; n < one.pixel.size(); ++n) {
            const Rgba &a = one.pixel[n], &b = many.pixel[n];
            most = std::max(most, double{a.a});
            // Files divide by alpha: colours of faint pixels have the digits of the product alone.
            for (const float d :
                 {a.r * a.a - b.r * b.a, a.g * a.a - b.g * b.a, a.b * a.a - b.b * b.a, a.a - b.a})
                largest = std::max(largest, std::abs(double{d}));
        }
        EXPECT_GT(most, 0.5);
        return largest;
    }
    /// Largest difference of maps, relative to the largest value; they cover the same pixels.
    static double map_difference(const std::vector<float>& one, const std::vector<float>& many) {
        EXPECT_EQ(one.size(), many.size());
        double largest = 0, most = 0;
        for (std::size_t n = 0; n < one.size(); ++n) {
            EXPECT_EQ(std::isnan(one[n]), std::isnan(many[n])) << n;
            if (std::isnan(one[n])) continue;
            most = std::max(most, std::abs(double{one[n]}));
            largest = std::max(largest, std::abs(double{one[n]} - double{many[n]}));
        }
        EXPECT_GT(most, 0);
        return largest / most;
    }
    /// Maps of --show mean with their column and deviation.
    struct Differences {
        double column, mean, deviation;
        double most() const { return std::max({column, mean, deviation}); }
    };
    Differences field_difference(const std::string& arguments) const {
        render_both(arguments + " --values-out", ".exr");
        const FieldMaps one = read_field_maps(dir_ / "one.exr"),
                        many = read_field_maps(dir_ / "many.exr");
        return {map_difference(one.column, many.column), map_difference(one.mean, many.mean),
                map_difference(one.deviation, many.deviation)};
    }
    double maximum_difference(const std::string& arguments) const {
        return value_difference(arguments + " --show maximum");
    }
    double value_difference(const std::string& arguments) const {
        render_both(arguments + " --values-out", ".npy");
        return map_difference(read_map(dir_ / "one.npy").value, read_map(dir_ / "many.npy").value);
    }
};

}  // namespace vog::test
