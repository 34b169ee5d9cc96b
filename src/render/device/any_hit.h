// device/any_hit.h: what becomes of a hit. `accumulate` adds its tau at once and forgets it.
// `collect` is the paper's: keep hits, sort them by entry, integrate front to back; here in slabs,
// so that a full buffer drops nothing.
#pragma once

#include "render/device/gaussian_hit.h"

namespace vog::device {

/// A sum of taus that is the same in any order, so that the picture depends neither on how a
/// hierarchy was built nor on how it is walked. Each tau is cut into a multiple of a coarse and one
/// of a fine quantum, both powers of two, and double precision adds either kind exactly: the
/// coarse is 2^-50 of a bound on T, the fine 2^-80 of it, and 2^20 remainders fit above that.
struct SumRounding {
    double coarse_shift;  ///< 1.5 * 2^52 quanta: adding and subtracting it rounds to a quantum
    double fine_shift;
    double fine;  ///< the quantum
};
struct DepthSum {
    double coarse, fine;
    VOG_HD double depth() const;
};

VOG_HD double DepthSum::depth() const { return coarse + fine; }

VOG_HD void add_depth(DepthSum& sum, float tau, const SumRounding& rounding) {
    if (!(tau > 0)) return;
    const double exact = static_cast<double>(tau);
    const double coarse = (exact + rounding.coarse_shift) - rounding.coarse_shift;
    const double rest = exact - coarse;
    const double fine = (rest + rounding.fine_shift) - rounding.fine_shift;
    sum.coarse += coarse;
    // However faint, what was met shows: T > 0.
    sum.fine += coarse + fine > 0 ? fine : rounding.fine;
}

/// Hits in the order of entry; equal entries (all those around the eye) in the order of Gaussians.
struct CollectedHit {
    float entry;
    uint32_t index;
};
VOG_HD bool before(const CollectedHit& a, const CollectedHit& b) {
    return a.entry < b.entry || (a.entry == b.entry && a.index < b.index);
}

constexpr int kMaxHitsPerSlab = 256;

/// The nearest `capacity` hits beyond `last`: a heap with the farthest on top.
struct HitList {
    CollectedHit hit[kMaxHitsPerSlab];
    CollectedHit last;  ///< where the slab before ended
    int32_t capacity, count;
    int32_t first_slab;  ///< there was none before: `last` does not count
};

VOG_HD void sift_down(CollectedHit* heap, int32_t count, int32_t at) {
    const CollectedHit moved = heap[at];
    while (2 * at + 1 < count) {
        int32_t child = 2 * at + 1;
        if (child + 1 < count && before(heap[child], heap[child + 1])) ++child;
        if (!before(moved, heap[child])) break;
        heap[at] = heap[child];
        at = child;
    }
    heap[at] = moved;
}

/// returns  false if the list is full of nearer hits: no hit at this entry or beyond can be of this
///          slab, and traversal need go no further
VOG_HD bool collect(HitList& list, const CollectedHit& hit) {
    if (!list.first_slab && !before(list.last, hit)) return true;  // of an earlier slab
    if (list.count == list.capacity) {
        if (!before(hit, list.hit[0])) return false;
        list.hit[0] = hit;
        sift_down(list.hit, list.count, 0);
        return true;
    }
    int32_t at = list.count++;
    while (at > 0 && before(list.hit[(at - 1) / 2], hit)) {
        list.hit[at] = list.hit[(at - 1) / 2];
        at = (at - 1) / 2;
    }
    list.hit[at] = hit;
    return true;
}

VOG_HD void begin_slab(HitList& list, const CollectedHit* last) {
    list.count = 0;
    list.first_slab = last == nullptr;
    if (last) list.last = *last;
}

/// Slack of the hierarchy's floats, in scene units: a ray is this much longer than it must be, and
/// a slab's starts this much earlier.
constexpr float kRaySlack = 0x1p-18f;

/// Where a traversal for this slab may start: its hits enter no earlier than the last of the slab
/// before. The paper's boxes may lie before the entries of what they find: no gain there.
VOG_HD float slab_start(const HitList& list, bool boxed) {
    return list.first_slab || boxed ? 0.0f : fmaxf(list.last.entry - kRaySlack, 0.0f);
}

/// Heap sort: nearest first.
VOG_HD void sort_by_entry(HitList& list) {
    for (int32_t end = list.count - 1; end > 0; --end) {
        const CollectedHit farthest = list.hit[0];
        list.hit[0] = list.hit[end];
        list.hit[end] = farthest;
        sift_down(list.hit, end, 0);
    }
}

/// Integrates the sorted hits front to back.
/// stop_depth  optical depth at which a ray is called opaque; infinite: never
/// returns     whether to go on with another slab: there may be hits beyond, and light left
VOG_HD bool integrate(const HitList& list, const Gaussian* gaussians, const Ray& ray, float cutoff2,
                      double stop_depth, const SumRounding& rounding, DepthSum& sum) {
    for (int32_t n = 0; n < list.count; ++n) {
        const Gaussian& g = gaussians[list.hit[n].index];
        Hit hit;
        if (intersect(g, ray, cutoff2, hit)) add_depth(sum, optical_depth(g, hit), rounding);
        if (sum.depth() >= stop_depth) return false;
    }
    return list.count == list.capacity;
}

}  // namespace vog::device
