// finite_splats.cpp: splats whose numbers are not all finite: refused or left out.
#include "io/exchange/finite_splats.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "vog/error.h"

namespace vog::exchange {

void keep_finite(Gaussians& model, const std::string& where, const SplatRules& rules) {
    const auto is_finite = [&](std::size_t i) {
        const Vec3f m = model.mean[i], s = model.scale[i];
        const Quat q = model.axis_aligned() ? Quat{} : model.rotation[i];
        const float turn = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
        return std::isfinite(m.x + m.y + m.z) && std::isfinite(s.x + s.y + s.z) &&
               std::isfinite(model.density[i]) && std::isfinite(turn) && turn > 0;
    };
    std::vector<std::size_t> kept;
    std::size_t first = model.size();
    for (std::size_t i = 0; i < model.size(); ++i)
        if (is_finite(i))
            kept.push_back(i);
        else
            first = std::min(first, i);
    const std::size_t left_out = model.size() - kept.size();
    if (left_out == 0) return;
    if (!rules.values.skip_nonfinite)
        throw Error(fmt::format(
            "{}: {} splats with a number that is not finite, or with a rotation of 0, the first is "
            "number {}, expected neither (--skip-nonfinite leaves such splats out)",
            where, left_out, first));
    if (kept.empty())
        throw Error(fmt::format("{}: no splat with finite numbers and a rotation", where));
    model = select(model, kept);
    if (rules.notes) rules.notes->skipped_nonfinite += left_out;
}

}  // namespace vog::exchange
