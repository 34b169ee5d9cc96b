// screen_mass.h: the mass that a picture shows, against that of its model, for Gaussians below and
// around a pixel.
#pragma once

#include <functional>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/image.h"

namespace vog::test {

using PictureOf = std::function<DepthImage(const Gaussians&, const Camera&, int, int)>;

/// Sum of T / |D| over the pixels, |D| the length of a pixel's direction with a component of 1 along
/// the view. One Gaussian at depth z has its mass times (pixels_per_unit / z)^2 there.
double screen_sum(const DepthImage& image, const Camera& camera);

/// 65,536 particles of 1e-4 of the model's radius: the mass is theirs to 0.5 %, from three cameras
/// between which they move by less than a pixel.
void expect_mass_of_particles(const PictureOf& render, int size);

/// One round Gaussian of 0.01 to 3 pixels at 25 places in a pixel: the mass is its own to 0.5 %, for
/// the cutoffs 2.25 and 3.03, and where it is below two pixels for others.
void expect_mass_of_one(const PictureOf& render);

/// Needles and discs of 0.02 pixels across, at random rotations: the mass of each is its own
/// to 2.5 %, which a needle along a row reaches, and on average to 0.5 %.
void expect_mass_of_thin_ones(const PictureOf& render);

}  // namespace vog::test
