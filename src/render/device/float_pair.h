// float_pair.h: Vectors of doubles as sums of two floats, 48 bits, for differences that cancel in one: GPUs of graphics
// cards have 64 times as many units of single precision as of double. A CPU keeps the doubles.
#pragma once

#include "render/device/vector.h"

namespace vog::device {

#if defined(__CUDA_ARCH__) || defined(VOG_FLOAT_PAIRS)

/// high + low.
struct Exact3 {
    Float3 high, low;
};
VOG_HD Exact3 exact(Double3 v) {
    const Float3 high = to_float(v);
    return {high, to_float(v - to_double(high))};
}
VOG_HD Float3 rounded(const Exact3& v) { return v.high; }

/// Exact error of sum = a + b (Knuth, The Art of Computer Programming, volume 2, 4.2.2).
VOG_HD float sum_error(float a, float b, float sum) {
    const float of_b = sum - a;
    return (a - (sum - of_b)) + (b - of_b);
}

/// a * b, never one operation with a sum that follows; and its exact error.
#if defined(__CUDA_ARCH__)
VOG_HD float product(float a, float b) { return __fmul_rn(a, b); }
VOG_HD float product_error(float a, float b, float product) { return __fmaf_rn(a, b, -product); }
#else
VOG_HD float product(float a, float b) { return a * b; }
VOG_HD float product_error(float a, float b, float product) { return fmaf(a, b, -product); }
#endif

/// a - t b, rounded once more than exact.
VOG_HD float less_multiple(float a_high, float a_low, float t, float b_high, float b_low) {
    const float p = product(t, b_high), high = a_high - p;
    const float rest = a_low - (product_error(t, b_high, p) + t * b_low);
    return high + (sum_error(a_high, -p, high) + rest);
}

/// a - b.
VOG_HD Exact3 difference(Float3 a, const Exact3& b) {
    const Float3 high = a - b.high;
    const Float3 error{sum_error(a.x, -b.high.x, high.x), sum_error(a.y, -b.high.y, high.y),
                       sum_error(a.z, -b.high.z, high.z)};
    return {high, error - b.low};
}
/// a - t b.
VOG_HD Float3 less_multiple(const Exact3& a, float t, const Exact3& b) {
    return {less_multiple(a.high.x, a.low.x, t, b.high.x, b.low.x),
            less_multiple(a.high.y, a.low.y, t, b.high.y, b.low.y),
            less_multiple(a.high.z, a.low.z, t, b.high.z, b.low.z)};
}

#else

using Exact3 = Double3;
VOG_HD Exact3 exact(Double3 v) { return v; }
VOG_HD Float3 rounded(const Exact3& v) { return to_float(v); }
VOG_HD Exact3 difference(Float3 a, const Exact3& b) { return to_double(a) - b; }
VOG_HD Float3 less_multiple(const Exact3& a, float t, const Exact3& b) {
    return to_float(a - static_cast<double>(t) * b);
}

#endif

}  // namespace vog::device
