// packed_cells.h: the cells of a field while they are chosen and softened, 40 bytes each, in the
// arrays that their Gaussians will have: a model is made of them in place.
#pragma once

#include <span>

#include "convert/moments/cells/bricks.h"
#include "convert/moments/gaussian_moments.h"
#include "vog/gaussians.h"
#include "vog/memory.h"

namespace vog::moments {

class PackedCells {
  public:
    PackedCells() = default;
    /// For cells of these bricks: means are kept from their middle, where floats are finest.
    explicit PackedCells(std::span<const Brick> bricks);

    std::size_t size() const { return mean_.size(); }
    bool empty() const { return mean_.empty(); }
    float mass(std::size_t i) const { return rest_[i].w; }
    /// Mean as an index.
    Moments operator[](std::size_t i) const { return unpacked(mean_[i], variance_[i], rest_[i]); }
    void set(std::size_t i, const Moments& cell);
    void push_back(const Moments& cell);
    void reserve(std::size_t count);
    /// Cells of the same field.
    void append(const PackedCells& others);
    /// Keeps those for which stays(i), in their order. stays is asked once for each, in order.
    template <class Stays>
    void keep_if(const Stays& stays) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < size(); ++i) {
            if (!stays(i)) continue;
            mean_[kept] = mean_[i], variance_[kept] = variance_[i], rest_[kept] = rest_[i];
            ++kept;
        }
        mean_.resize(kept), variance_.resize(kept), rest_.resize(kept);
    }
    /// One Gaussian for each cell, in their order, and no cells any more.
    Gaussians to_gaussians(const MomentFrame& frame) &&;

  private:
    Moments unpacked(Vec3f mean, Vec3f variance, Quat rest) const {
        return {rest.w,
                middle_ + vec_cast<double>(mean),
                {variance.x, rest.x, rest.y, variance.y, rest.z, variance.z}};
    }

    Vec3d middle_;
    BigVector<Vec3f> mean_;      ///< from the middle
    BigVector<Vec3f> variance_;  ///< xx yy zz
    BigVector<Quat> rest_;       ///< mass, then the covariance's xy xz yz
};

}  // namespace vog::moments
