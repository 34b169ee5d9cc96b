// packed_cells.h: cells as float32 arrays, 40 bytes each, which become the arrays of a model in
// place.
#pragma once

#include <span>
#include <vector>

#include "convert/moments/cells/bricks.h"
#include "convert/moments/gaussian_moments.h"
#include "vog/gaussians.h"
#include "vog/memory.h"

namespace vog::moments {

/// Mass, mean and covariance of the cells of one field.
class PackedCells {
  public:
    PackedCells() = default;
    /// bricks  of the field: means are stored relative to the middle of their box, so that float32
    ///         resolves them wherever the data lie
    explicit PackedCells(std::span<const Brick> bricks);

    std::size_t size() const { return mean_.size(); }
    bool empty() const { return mean_.empty(); }
    float mass(std::size_t i) const { return rest_[i].w; }
    /// Moments of cell i, mean in index space.
    Moments operator[](std::size_t i) const { return unpacked(mean_[i], variance_[i], rest_[i]); }
    void set(std::size_t i, const Moments& cell);
    void push_back(const Moments& cell);
    void reserve(std::size_t count);
    /// Appends cells of the same field.
    void append(const PackedCells& others);
    /// Removes the cells for which is_kept(i) is false. is_kept is called once for each i,
    /// ascending.
    template <class IsKept>
    void keep_if(const IsKept& is_kept) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < size(); ++i) {
            if (!is_kept(i)) continue;
            mean_[kept] = mean_[i], variance_[kept] = variance_[i], rest_[kept] = rest_[i];
            ++kept;
        }
        mean_.resize(kept), variance_.resize(kept), rest_.resize(kept);
    }
    /// Turns each cell into a Gaussian, in order, in the memory of the cells.
    Gaussians to_gaussians(const MomentFrame& frame) &&;

  private:
    Moments unpacked(Vec3f mean, Vec3f variance, Quat rest) const {
        return {rest.w,
                middle_ + vec_cast<double>(mean),
                {variance.x, rest.x, rest.y, variance.y, rest.z, variance.z}};
    }

    Vec3d middle_;
    BigVector<Vec3f> mean_;      ///< relative to middle_
    BigVector<Vec3f> variance_;  ///< xx yy zz
    BigVector<Quat> rest_;       ///< x y z: covariance xy xz yz; w: mass
};

/// The parts in their order, as one list; `none` has the field's bricks and no cells.
PackedCells joined_cells(std::vector<PackedCells> parts, const PackedCells& none);

}  // namespace vog::moments
