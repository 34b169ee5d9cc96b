// any_hit.h: Any-hit programs: the treatment of each intersection of a ray with a Gaussian.
// `accumulate` adds its tau at once. `collect`, the paper's, keeps hits, sorts them by entry and
// integrates them front to back; here slab by slab, so that a full buffer drops no hit.
#pragma once

#include "render/device/gaussian_hit.h"

namespace vog::device {

/// Rounding that makes a sum of taus the same in any order, so that a picture does not depend on the
/// bounding volume hierarchy or its traversal. Each tau is rounded to a multiple of a coarse quantum
/// plus a multiple of a fine one, both powers of two, and double precision adds either kind exactly:
/// the coarse quantum is 2^-50 of a bound on T, the fine one 2^-80, with room for 2^20 remainders.
struct SumRounding {
    double coarse_shift;  ///< 1.5 * 2^52 quanta: adding and subtracting it rounds to a quantum
    double fine_shift;
    double fine;  ///< the fine quantum
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
    // T > 0 for every pixel with a hit, however faint.
    sum.fine += coarse + fine > 0 ? fine : rounding.fine;
}

/// Adds a value of either sign, as exactly, where the sums of magnitudes are within the same bound.
VOG_HD void add_signed(DepthSum& sum, double value, const SumRounding& rounding) {
    const double coarse = (value + rounding.coarse_shift) - rounding.coarse_shift;
    const double rest = value - coarse;
    sum.coarse += coarse;
    sum.fine += (rest + rounding.fine_shift) - rounding.fine_shift;
}

/// One hit, ordered by entry; equal entries (Gaussians around the eye all have 0) by index.
struct CollectedHit {
    float entry;     ///< t at which the ray enters the support
    uint32_t index;  ///< of the Gaussian
};
VOG_HD bool before(const CollectedHit& a, const CollectedHit& b) {
    return a.entry < b.entry || (a.entry == b.entry && a.index < b.index);
}

constexpr int kMaxHitsPerSlab = 256;

/// The `capacity` nearest hits beyond `last`: a binary heap with the farthest on top.
struct HitList {
    CollectedHit hit[kMaxHitsPerSlab];
    CollectedHit last;  ///< last hit of the previous slab
    int32_t capacity, count;
    int32_t first_slab;  ///< 1: no previous slab, `last` is unused
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

/// Adds a hit, dropping the farthest if the list is full.
/// returns  false if the list is full of hits that enter before this one: traversal may end at this entry. Not of
///          hits that enter with it, since a traversal that ends at an entry may leave out others there
VOG_HD bool collect(HitList& list, const CollectedHit& hit) {
    if (!list.first_slab && !before(list.last, hit)) return true;  // in an earlier slab
    if (list.count == list.capacity) {
        if (!before(hit, list.hit[0])) return !(hit.entry > list.hit[0].entry);
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

/// Margin for rounding in the hierarchy's floats, scene units: rays end this much later and slabs
/// start this much earlier.
constexpr float kRaySlack = 0x1p-18f;

/// Smallest t at which the traversal for this slab may start: its hits enter no earlier than the
/// last hit of the previous slab. 0 with the paper's boxes, which may lie before the entries.
VOG_HD float slab_start(const HitList& list, bool boxed) {
    return list.first_slab || boxed ? 0.0f : fmaxf(list.last.entry - kRaySlack, 0.0f);
}

/// Sorts the hits by heap sort, nearest first.
VOG_HD void sort_by_entry(HitList& list) {
    for (int32_t end = list.count - 1; end > 0; --end) {
        const CollectedHit farthest = list.hit[0];
        list.hit[0] = list.hit[end];
        list.hit[end] = farthest;
        sift_down(list.hit, end, 0);
    }
}

/// Factor on the tau of Gaussian `index`; shares is null where all are 1.
VOG_HD float share_of(const float* shares, uint32_t index) { return shares ? shares[index] : 1.0f; }

/// Integrates the sorted hits front to back.
/// shares      of the Gaussians, or null
/// stop_depth  optical depth at which a ray ends; infinite: never
/// returns     true if another slab must follow: the list was full and the ray has not ended
VOG_HD bool integrate(const HitList& list, const Gaussian* gaussians, const float* shares,
                      const Ray& ray, float cutoff2, double stop_depth, const SumRounding& rounding,
                      DepthSum& sum) {
    for (int32_t n = 0; n < list.count; ++n) {
        const Gaussian& g = gaussians[list.hit[n].index];
        Hit hit;
        if (intersect(g, ray, cutoff2, hit))
            add_depth(sum, share_of(shares, list.hit[n].index) * clipped_depth(g, hit, ray),
                      rounding);
        if (sum.depth() >= stop_depth) return false;
    }
    return list.count == list.capacity;
}

}  // namespace vog::device
