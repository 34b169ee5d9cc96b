// illumination.h: Light that reaches points of a volume, through what absorbs it on the way.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "render/device/light/light_lattice.h"
#include "render/light/extinction_lattice.h"
#include "vog/volume_picture.h"

namespace vog {
struct Collective;
}

namespace vog::lights {

/// Shares of light that reach the cells of a lattice.
class Illumination {
  public:
    /// All light reaches every point.
    Illumination() = default;
    explicit Illumination(const ExtinctionLattice& extinction);
    /// Lights from directions, of any length > 0, world. Those that are there already stay as they are.
    /// octaves  of multiple scattering
    void set_direct(const ExtinctionLattice& extinction, std::span<const Vec3d> towards,
                    int octaves);
    /// Light from all directions.
    void set_ambient(const ExtinctionLattice& extinction);
    /// Whether light is shaded by gradients.
    void set_shaded(bool shaded) { shaded_ = shaded; }
    void clear_direct() { direct_.clear(), towards_.clear(); }
    void clear_ambient() { ambient_.clear(); }

    /// Valid while this lives, unchanged; for points relative to an origin, in a unit of length.
    device::LightLattice lattice(Vec3d origin = {}, double unit = 1) const;
    const std::vector<float>& direct() const { return direct_; }
    const std::vector<float>& ambient() const { return ambient_; }
    const std::vector<float>& opaque() const { return opaque_; }
    /// Edge of a cell, world units; infinite where all light reaches every point.
    double edge() const { return edge_; }

  private:
    std::vector<float> direct_, ambient_;  ///< of LightLattice
    std::vector<float> opaque_;            ///< empty: no cell is
    std::vector<Vec3d> towards_{};
    int octaves_ = 1;
    bool surfaces_ = false, shaded_ = false;
    Vec3d first_{};
    double edge_ = HUGE_VAL;
    Vec3i size_{2, 2, 2};
    double shift_ = 1;
};

/// A model's field under a transfer function.
struct LitModel {
    const Gaussians& gaussians;
    const ScalarField& field;
    const by_value::LightOfMoments& light;  ///< of the field's values
    double unit = 1;                        ///< factor of that light
    const Collective* processes = nullptr;  ///< that hold parts of the model; null: this one alone
};
/// Of a model.
/// forward    direction of the view: a light from the eye lies behind it, infinitely far away
/// returns    all light everywhere for a look without shadows and occlusion
Illumination illumination(const LitModel& model, const VolumeLook& look, Vec3d forward);

/// That of a model's latest picture. Another light keeps the lattice, and what does not depend on the light.
class KeptIllumination {
  public:
    /// version  another one for another transfer function or field
    /// returns  whether it has changed
    bool update(int version, const LitModel& model, const VolumeLook& look, Vec3d forward);
    const Illumination& operator*() const { return light_; }

  private:
    std::optional<ExtinctionLattice> extinction_;
    Illumination light_;
    int version_ = -1;
    VolumeLook look_{};
    std::vector<Vec3d> towards_{};
};
/// Directions of the lights of a look that cast shadows.
/// forward  of the view, from which a light at the eye comes
std::vector<Vec3d> directions_of(const VolumeLook& look, Vec3d forward);

/// Of voxels, on a lattice that is finer: the truth of the one of a model.
/// fields  [volumes] scalar; without values the volume's own
Illumination illumination(std::span<const Volume> volumes, std::span<const VoxelField> fields,
                          const ValueTransfer& transfer, const VolumeLook& look, Vec3d forward,
                          const Collective* processes);

/// Of data that absorb each other's light: layers of a picture.
/// box        holds all of this process
/// of_voxels  whether none of them is a model
/// add        adds their extinction, of all processes
/// processes  that hold parts of the data; null: this one alone
Illumination illumination(Box box, bool of_voxels,
                          const std::function<void(ExtinctionLattice&)>& add,
                          const VolumeLook& look, Vec3d forward,
                          const Collective* processes = nullptr);

/// Optical depths from the centres of cells out of the lattice, by lines that step from layer to layer of cells, across the axis
/// that the direction is longest along.
/// towards  of any length > 0
/// returns  [cells] as ExtinctionLattice::sum
std::vector<float> depths_towards(const ExtinctionLattice& extinction, Vec3d towards);

}  // namespace vog::lights
