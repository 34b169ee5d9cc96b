// ray_exchange.h: Light along rays whose voxels lie on several processes. Each process has some pieces of a ray, in any
// order with those of the others: runs of leaves are no convex boxes. All pieces of a pixel meet on one process, which
// composites them by depth; the root receives pixels.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "render/reference/fields/ray_light.h"
#include "vog/distributed.h"
#include "vog/image.h"

namespace vog::reference {

/// Pieces of this process on a ray. Between them may be others'.
class RayPieces {
  public:
    /// joined  a run of pieces that touch becomes one of the same light: exact where nothing of other processes overlaps
    ///         them, and a tenth to a hundredth of what is sent
    explicit RayPieces(bool joined) : joined_(joined) {}

    /// Begins with another volume.
    void begin() {
        close();
        passed_ = 1;
    }
    /// Adds a piece of the volume behind those so far, also one that absorbs nothing.
    /// depth    its optical depth
    /// returns  whether anything behind it in this volume would be seen
    bool add(Segment segment, double depth, const ValueLight& light) {
        if (!joined_ || !open_ || segment.first > run_.last) {
            close();
            run_ = segment;
            open_ = true;
        }
        run_.last = segment.last;
        if (depth > 0) {
            inside_.add(depth, light.r, light.g, light.b);
            depth_ += depth;
        }
        return passed_ * inside_.transmittance >= device::kOpaqueLight;
    }
    /// All pieces, their extinction per t.
    std::vector<LitPiece> finish() {
        close();
        return std::move(pieces_);
    }

  private:
    void close();

    bool joined_, open_ = false;
    Segment run_{};
    Compositor inside_{};
    double depth_ = 0, passed_ = 1;  ///< of the run; transmittance of the volume before it
    std::vector<LitPiece> pieces_;
};

/// Pixels from the pieces of all processes.
/// rays     [pixels * samples] this process's pieces; left empty
/// returns  [pixels] on the root: means over the rays of each; empty elsewhere
std::vector<Rgba> composite_parts(std::vector<std::vector<LitPiece>>& rays, std::size_t samples,
                                  const Collective& processes);

}  // namespace vog::reference
