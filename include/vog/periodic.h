// vog/periodic.h: periodic boxes of simulations: what leaves through a face enters through the opposite one.
// A model of a periodic box has images: each Gaussian whose support crosses a face lies behind the opposite face, too. Inside the
// box its density is the periodic one, and its mass that of the data; pictures show the inside (inside_period).
#pragma once

#include <optional>
#include <span>

#include "vog/clip.h"
#include "vog/gaussians.h"
#include "vog/points.h"
#include "vog/volume.h"

namespace vog {

struct Collective;

/// Box of 1, 3 or 6 numbers: an edge or the edges from 0, or the lower and the upper corner, world units.
/// throws  vog::Error for another count, and for edges that are not finite and above 0
Box box_of_numbers(std::span<const double> numbers);

/// Moves positions by whole edges of the box into it, [lower, upper).
void wrap(Points& points, const Box& box);

/// Box of the domain of a mesh: that of its coarsest volume, where all of its cells are active; empty for other data, whose
/// active voxels do not state where the domain ends.
/// collective  processes that hold other parts of the volumes; null: a single process
Box domain_box(std::span<const Volume> volumes, const Collective* collective = nullptr);

/// Adds the images of Gaussians that cross a face, each behind its Gaussian, and states the box in model.box and
/// model.options. Parts of a model that are joined afterwards are the whole with its images.
/// throws  vog::Error for a Gaussian wider than the box
void add_periodic_images(Gaussians& model, const Box& box);
/// Option of `vog convert` by which a model's header states its box.
inline constexpr const char* kPeriodicOption = "--periodic ";
/// Box of a model with images; none: not periodic.
std::optional<Box> periodic_box(const Gaussians& model);
/// A model without its images, for programs that do not clip; other models are returned unchanged.
Gaussians without_images(Gaussians model);
/// Mass of the data of a model: without its images, whose centres lie outside the box; of other models that of all Gaussians.
double mass_without_images(const Gaussians& model);
/// The part of a clip inside the box of a model with images; the clip itself for other models.
/// throws  vog::Error where nothing of the clip's box lies inside
Clipping inside_period(Clipping clip, const Gaussians& model);

}  // namespace vog
