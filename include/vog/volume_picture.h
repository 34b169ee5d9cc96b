// vog/volume_picture.h: light of volume rendering: emission and absorption under a transfer function of a field's
// values (docs/volume_rendering.md).
//   dL/dt = s (c - L),   s = extinction at the field's value there, c = its colour
// Extinction per length is that of the value where the field is the measure itself, else that times the measure:
// other fields are weighed by density.
#pragma once

#include <span>
#include <vector>

#include "vog/camera.h"
#include "vog/clip.h"
#include "vog/image.h"
#include "vog/linear.h"

namespace vog {

/// Default numbers of depth slabs. Light shows how rough surfaces are that thick slabs make; a maximum has more: means over
/// thick ones are lower than the largest within.
inline constexpr int kVolumeSlabs = 32, kLitSlabs = 64, kMaximumSlabs = 128;

/// A light infinitely far away.
struct DirectionalLight {
    /// Direction to it, of any length > 0: world, or right, up and towards the viewer; 0 0 0: the eye itself.
    Vec3d towards{};
    bool of_camera = false;  ///< whether it turns with the view: lights_in_view()
    double strength = 1;     ///< factor of diffuse and specular light, >= 0
    friend bool operator==(const DirectionalLight&, const DirectionalLight&) = default;
};

/// Light and clipping of a volume picture.
struct VolumeLook {
    /// Shading of Blinn and Phong by the field's gradient; colour = (ambient + diffuse n.l) colour + specular (n.h)^power,
    /// at most 1, with the normal n towards the eye. Where the field has no gradient: the colour itself.
    /// Off: only emission and absorption.
    bool light = false;
    /// Lights of `light` or `shadows`, which add up, kMostDirectionalLights at most; none: one at the eye.
    std::vector<DirectionalLight> lights{};
    bool studio = false;  ///< whether resolve() sets shadows, occlusion and kStudioOctaves
    double ambient = 0.3, diffuse = 0.7, specular = 0.2, power = 20;  ///< weights >= 0; power > 0
    /// Whether what absorbs light on its way casts shadows: diffuse and specular light times exp(-optical depth towards the
    /// light). Colours without shading by the gradient are (ambient + diffuse exp(-depth)) / (ambient + diffuse) of theirs.
    bool shadows = false;
    /// Ambient occlusion: ambient light times the mean of exp(-optical depth) over all directions. Without `light` and
    /// `shadows` all light is ambient.
    bool occlusion = false;
    /// Octaves of multiple scattering: the mean of exp(-depth / 2^k), weighted by 1 / 2^k, k from 0 to below this, in place of exp(-depth).
    /// Source: Wrenninge, "Oz: The Great and Volumetric", SIGGRAPH 2013 talks.
    int octaves = 1;
    /// Asymmetry g of the phase function of Henyey and Greenstein, (-1, 1), with shadows: light from the direction, where no
    /// surface is shaded, times (1 - g^2) / (1 + g^2 - 2 g c)^1.5, c the cosine of the angle that it turns by, at most white.
    /// Above 0 it is scattered forward. Source: Henyey and Greenstein, Astrophysical Journal 93, 1941.
    double asymmetry = 0;
    Clipping clip{};          ///< space that is shown; exact on every ray
    bool clip_lights = true;  ///< whether clips also cut what absorbs light on its way

    /// Whether light changes with the place: it shows the thickness of slabs.
    bool is_lit() const { return light || shadows || occlusion || studio; }
    friend bool operator==(const VolumeLook&, const VolumeLook&) = default;
};
/// Direction towards a light from the upper left of a view, world units.
Vec3d studio_light(const Camera& camera);
/// Octaves that change a picture: further ones have next to no weight.
inline constexpr int kMostOctaves = 16, kStudioOctaves = 3;
inline constexpr int kMostDirectionalLights = 8;
/// Lights of a look, at least one.
std::vector<DirectionalLight> lights_of(const VolumeLook& look);
/// Lights that turn with the view as directions of the world.
VolumeLook lights_in_view(VolumeLook look, const CameraFrame& frame);
/// throws  vog::Error for an invalid clip, weights and strengths that are negative or not finite, a power that is not > 0, octaves off
///         [1, kMostOctaves], an asymmetry off (-1, 1), too many lights
void validate(const VolumeLook& look);

/// Light over a background, colours as displayed. A transparent background (a = 0) keeps alpha: as in every
/// Image the colour is then not multiplied by it (write_exr multiplies, as that format has it).
/// light   [height * width] premultiplied colours (Sums::light)
/// throws  vog::Error for a background with a component off [0, 1]
Image over(std::span<const Rgba> light, int width, int height, const Rgba& background);

}  // namespace vog
