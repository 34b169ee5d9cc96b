// erf.glsl: the error function.
// For x >= 0: the first terms of its series, then Abramowitz and Stegun 7.1.26, of absolute error below 1.5e-7.
float erf_positive(float x) {
    float x2 = x * x;
    if (x < 0.3) return 1.12837916709551 * x * (1.0 - x2 * (1.0 / 3.0 - x2 * (0.1 - x2 * (1.0 / 42.0 - x2 / 216.0))));
    float t = 1.0 / (1.0 + 0.3275911 * x);
    float sum = ((((1.061405429 * t - 1.453152027) * t + 1.421413741) * t - 0.284496736) * t + 0.254829592) * t;
    return 1.0 - sum * exp(-x2);
}
float erf_any(float x) { return sign(x) * erf_positive(abs(x)); }
// Integral of a normal distribution from 0 to u.
float normal_to(float u) { return 0.5 * erf_any(0.70710678118654752 * u); }
