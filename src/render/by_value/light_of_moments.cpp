// light_of_moments.cpp: Linear pieces of light per unit of the measure, and the table of means.
#include "render/by_value/light_of_moments.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel.h"
#include "render/by_value/value_pieces.h"
#include "vog/distributed.h"

namespace vog::by_value {

namespace {

using Sum = std::array<double, 4>;

/// Share of the range below which a measure counts as this share: its light per unit would be infinite.
constexpr double kLeastShare = 1e-3;

Sum mix(const Sum& a, const Sum& b, double share) {
    Sum sum;
    for (std::size_t c = 0; c < 4; ++c) sum[c] = a[c] + share * (b[c] - a[c]);
    return sum;
}

double least_measure(const ValueRange& range) {
    return kLeastShare * std::max(std::abs(range.lower - range.background),
                                  std::abs(range.upper - range.background));
}

/// Light per unit of the measure by value.
class UnitLight {
  public:
    UnitLight(const ValueTransfer& transfer, const ValueRange& range, bool per_value, double unit)
        : pieces_(transfer),
          per_value_(per_value),
          unit_(unit),
          background_(range.background),
          least_(least_measure(range)) {}
    Sum operator()(double value) const {
        constexpr double kMost = 1e30;  // of floats, with room for sums
        // Of a measure towards 0 the limit: to go to 0 there would make lines where the lower value of a pair passes it.
        const double shown = per_value_ ? std::max(value, background_ + least_) : value;
        const ValueLight light = pieces_(shown);
        double s = unit_ * light.extinction;
        if (per_value_) s = value < background_ ? 0 : s / (shown - background_);
        s = std::min(s, kMost);
        return {s * light.r, s * light.g, s * light.b, s};
    }

  private:
    ValuePieces pieces_;
    bool per_value_;
    double unit_, background_, least_;
};

/// Divides a piece until light is linear in it to a 500th of its own.
class Divider {
  public:
    Divider(const UnitLight& light, const ValueRange& range,
            std::vector<device::LightPiece>& pieces)
        : light_(light), range_(range), pieces_(pieces) {}
    void divide(double from, const Sum& first, double to, const Sum& last, int depth) {
        constexpr double kError = 2e-3;
        constexpr int kDeepest = 9;
        const double middle = 0.5 * (from + to);
        const Sum at = light_(middle), line = mix(first, last, 0.5);
        double most = 0, off = 0;
        for (std::size_t c = 0; c < 4; ++c) {
            most = std::max(most, at[c]);
            off = std::max(off, std::abs(at[c] - line[c]));
        }
        if (off > kError * most && depth < kDeepest) {
            divide(from, first, middle, at, depth + 1);
            divide(middle, at, to, last, depth + 1);
            return;
        }
        device::LightPiece piece;
        piece.start = static_cast<float>(range_.share(from));
        piece.end = static_cast<float>(range_.share(to));
        if (!(piece.end > piece.start)) return;  // narrower than floats
        for (std::size_t c = 0; c < 4; ++c) {
            piece.first[c] = static_cast<float>(first[c]);
            piece.last[c] = static_cast<float>(last[c]);
        }
        pieces_.push_back(piece);
    }

  private:
    const UnitLight& light_;
    const ValueRange& range_;
    std::vector<device::LightPiece>& pieces_;
};

/// Whether light goes on from a piece to the next without a step.
bool joined(const device::LightPiece& a, const device::LightPiece& b) {
    for (int c = 0; c < 4; ++c)
        if (std::abs(a.last[c] - b.first[c]) > 1e-5f * std::max(a.last[3], b.first[3]))
            return false;
    return true;
}

/// Joins pieces to which one line comes as near as to the function itself: points that a file states between others.
void join_pieces(std::vector<device::LightPiece>& pieces) {
    constexpr std::size_t kMost = 64;
    constexpr float kError = 2e-3f;
    std::size_t kept = 0;
    for (std::size_t first = 0; first < pieces.size();) {
        device::LightPiece whole = pieces[first];
        std::size_t next = first + 1;
        for (; next < pieces.size() && next - first < kMost; ++next) {
            if (!joined(pieces[next - 1], pieces[next])) break;
            device::LightPiece longer = whole;
            longer.end = pieces[next].end;
            std::copy_n(pieces[next].last, 4, longer.last);
            bool follows = true;
            for (std::size_t n = first; n < next && follows; ++n) {
                const float at = (pieces[n].end - longer.start) / (longer.end - longer.start);
                for (int c = 0; c < 4; ++c) {
                    const float line = longer.first[c] + at * (longer.last[c] - longer.first[c]);
                    follows =
                        follows && std::abs(line - pieces[n].last[c]) <= kError * pieces[n].last[3];
                }
            }
            if (!follows) break;
            whole = longer;
        }
        pieces[kept++] = whole;
        first = next;
    }
    pieces.resize(kept);
}

/// ValueRange::order
std::vector<float> labels_of(const ScalarField& field, const Collective* processes) {
    constexpr std::size_t kMost = 512;
    constexpr double kMostNumbers = 1 << 16;  // from the least to the largest, of several processes
    std::vector<float> labels;
    const auto whole = [&](float value) {
        const auto at = std::ranges::lower_bound(labels, value);
        if (at == labels.end() || *at != value) labels.insert(at, value);
        return value == std::rint(value) && labels.size() <= kMost;
    };
    double others =
        std::ranges::any_of(field.deviation, [](float deviation) { return deviation != 0; }) ||
        std::ranges::any_of(field.gradient, [](Vec3f gradient) { return gradient != Vec3f{}; }) ||
        !std::ranges::all_of(field.value, whole);
    const bool shared = processes && processes->several();
    if (shared) processes->max({&others, 1});
    if (others > 0 || (!shared && labels.size() < 2)) return {};
    const double numbers = field.upper - field.lower + 1;
    if (!shared) return labels;
    if (!(numbers <= kMostNumbers)) return {};
    std::vector<double> there(static_cast<std::size_t>(numbers));
    for (const float label : labels) there[static_cast<std::size_t>(label - field.lower)] = 1;
    processes->max(there);
    labels.clear();
    for (std::size_t n = 0; n < there.size(); ++n)
        if (there[n] > 0)
            labels.push_back(static_cast<float>(field.lower + static_cast<double>(n)));
    return labels;
}

}  // namespace

double ValueRange::share_of_label(double value) const {
    const auto at = std::ranges::lower_bound(order, value, std::less<>());
    const double between = at != order.end() && double{*at} == value ? 0 : 0.5;
    return (static_cast<double>(at - order.begin()) - between) /
           static_cast<double>(order.size() - 1);
}

double ValueRange::value(double share) const {
    if (order.empty()) return lower + share * (upper - lower);
    const double last = static_cast<double>(order.size() - 1);
    return order[static_cast<std::size_t>(std::rint(std::clamp(share, 0.0, 1.0) * last))];
}

ValueRange value_range(const ScalarField& field, const Collective* processes) {
    if (field.upper > field.lower) {
        std::vector<float> labels = labels_of(field, processes);
        return {field.lower, field.upper, field.background, !labels.empty(), std::move(labels)};
    }
    const double margin = std::max(std::abs(field.lower), 1e-300) * 1e-3;
    return {field.lower - margin, field.upper + margin, field.background};
}

LightOfMoments::LightOfMoments(const ValueTransfer& transfer, const ValueRange& range,
                               bool per_value, double unit)
    : range_(range) {
    shape_.labels = !range.order.empty();
    shape_.labels ? add_labels(transfer, per_value, unit) : add_pieces(transfer, per_value, unit);
    set_seen();
    shape_.gradient = gradient_factor(transfer);
    if (shape_.gradient.any())
        per_gradient_ = (range.upper - range.lower) / transfer.gradient.back().magnitude;
    const double first = std::min(transfer.color.front().value, transfer.opacity.front().value);
    const double last = std::max(transfer.color.back().value, transfer.opacity.back().value);
    double low = std::clamp(range.share(first), 0.0, 1.0);
    double high = std::clamp(range.share(last), 0.0, 1.0);
    if (!(high - low > 1e-5)) low = 0, high = 1;
    const double margin = 0.05 * (high - low);
    low = std::max(low - margin, 0.0), high = std::min(high + margin, 1.0);
    shape_.low = static_cast<float>(low), shape_.high = static_cast<float>(high);
    shape_.per_range = 0.5f, shape_.per_part = static_cast<float>(0.5 / (high - low));
    fill_table();
    resolved_ = follows();
    surface_ = has_surface(transfer);
}

void LightOfMoments::add_pieces(const ValueTransfer& transfer, bool per_value, double unit) {
    const ValueRange& range = range_;
    const UnitLight light(transfer, range, per_value, unit);
    std::vector<double> ends{range.lower, range.upper};
    const auto add = [&](double value) {
        if (value > range.lower && value < range.upper) ends.push_back(value);
    };
    for (const ValueColor& point : transfer.color) add(point.value);
    for (const ValueOpacity& point : transfer.opacity) add(point.value);
    if (per_value) add(range.background), add(range.background + least_measure(range));
    std::ranges::sort(ends);
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    Divider divider(light, range, pieces_);
    for (std::size_t n = 0; n + 1 < ends.size(); ++n) {
        const double from = ends[n], to = ends[n + 1];
        // Just inside: at a step of the transfer function the ends have other values.
        const double inside = 1e-9 * (to - from);
        divider.divide(from, light(from + inside), to, light(to - inside), 0);
    }
    join_pieces(pieces_);
}

void LightOfMoments::add_labels(const ValueTransfer& transfer, bool per_value, double unit) {
    const UnitLight light(transfer, range_, per_value, unit);
    const double last = static_cast<double>(range_.order.size() - 1);
    for (std::size_t n = 0; n < range_.order.size(); ++n) {
        device::LightPiece& piece = pieces_.emplace_back();
        const double at = static_cast<double>(n);
        piece.start = static_cast<float>((at - 0.5) / last);
        piece.end = static_cast<float>((at + 0.5) / last);
        const Sum sum = light(double{range_.order[n]});
        for (std::size_t c = 0; c < 4; ++c)
            piece.first[c] = piece.last[c] = static_cast<float>(sum[c]);
    }
}

void LightOfMoments::set_seen() {
    // Pieces that floats cannot hold leave gaps.
    for (std::size_t n = 0; n + 1 < pieces_.size(); ++n) pieces_[n].end = pieces_[n + 1].start;
    pieces_.front().start = 0, pieces_.back().end = 1;
    shape_.first_seen = 1, shape_.last_seen = 0;
    for (const device::LightPiece& piece : pieces_) {
        const float most = std::max(piece.first[3], piece.last[3]);
        if (!(most > 0)) continue;
        shape_.first_seen = std::min(shape_.first_seen, piece.start);
        shape_.last_seen = std::max(shape_.last_seen, piece.end);
        shape_.most = std::max(shape_.most, most);
    }
}

float LightOfMoments::value_at(double position) const {
    const device::MeanLight& t = shape_;
    const double at_low{t.position(t.low)}, at_high{t.position(t.high)};
    if (position <= at_low) return static_cast<float>(2 * position);
    if (position >= at_high) return static_cast<float>(1 - 2 * (1 - position));
    return static_cast<float>(double{t.low} + (double{t.high} - double{t.low}) *
                                                  (position - at_low) / (at_high - at_low));
}

void LightOfMoments::fill_table() {
    constexpr int kColumns = device::MeanLight::kColumns, kOctaves = device::MeanLight::kOctaves;
    const device::LightPieces pieces = mean_light().pieces;
    table_.resize(std::size_t{4} * device::MeanLight::kRows * kColumns);
    std::vector<float> value(kColumns);
    for (int n = 0; n < kColumns; ++n)
        value[static_cast<std::size_t>(n)] = value_at(double(n) / (kColumns - 1));
    vog::parallel_for(0, device::MeanLight::kRows, [&](int row) {
        const double deviation =
            row == 0 || range_.labels
                ? 0
                : std::sqrt(double{device::MeanLight::kMostVariance} * std::exp2(row - kOctaves));
        // A quarter of the deviation apart, and linear between; columns are at most 2 / kColumns apart.
        int step = 1;
        while (2 * step * 2.0 / kColumns < 0.25 * deviation) step *= 2;
        float* out = &table_[std::size_t{4} * static_cast<std::size_t>(row) * kColumns];
        const auto set = [&](int n) {
            pieces.light(value[static_cast<std::size_t>(n)], static_cast<float>(deviation),
                         out + 4 * n);
        };
        set(0);
        for (int from = 0; from < kColumns - 1; from += step) {
            const int to = std::min(from + step, kColumns - 1);
            set(to);
            const float a = value[static_cast<std::size_t>(from)];
            const float per = 1 / (value[static_cast<std::size_t>(to)] - a);
            for (int n = from + 1; n < to; ++n) {
                const float share = (value[static_cast<std::size_t>(n)] - a) * per;
                for (int c = 0; c < 4; ++c)
                    out[4 * n + c] =
                        out[4 * from + c] + share * (out[4 * to + c] - out[4 * from + c]);
            }
        }
    });
}

bool LightOfMoments::follows() const {
    // Between two columns light goes up or down, not both by more than this share of the most there is.
    constexpr double kShare = 0.02;
    double most = 0;
    for (const device::LightPiece& p : pieces_)
        most = std::max({most, double{p.first[3]}, double{p.last[3]}});
    std::size_t n = 0;
    for (int column = 0; column + 1 < device::MeanLight::kColumns; ++column) {
        const float to = value_at(double(column + 1) / (device::MeanLight::kColumns - 1));
        const float from = value_at(double(column) / (device::MeanLight::kColumns - 1));
        while (n + 1 < pieces_.size() && pieces_[n].end <= from) ++n;
        Sum before{}, first{}, last{};
        std::array<double, 4> path{};
        bool begun = false;
        const auto visit = [&](const Sum& light) {
            for (std::size_t c = 0; c < 4 && begun; ++c) path[c] += std::abs(light[c] - before[c]);
            if (!begun) first = light;
            begun = true, before = last = light;
        };
        for (std::size_t m = n; m < pieces_.size() && pieces_[m].start < to; ++m) {
            const device::LightPiece& p = pieces_[m];
            const Sum a{p.first[0], p.first[1], p.first[2], p.first[3]};
            const Sum b{p.last[0], p.last[1], p.last[2], p.last[3]};
            const double width = double{p.end} - double{p.start};
            const auto at = [&](float value) {
                return std::clamp((double{value} - double{p.start}) / width, 0.0, 1.0);
            };
            visit(mix(a, b, at(from))), visit(mix(a, b, at(to)));
        }
        for (std::size_t c = 0; c < 4; ++c)
            if (path[c] - std::abs(last[c] - first[c]) > kShare * most) return false;
    }
    return true;
}

}  // namespace vog::by_value
