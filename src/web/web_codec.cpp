// web_codec.cpp: quantisation of Gaussians to 16-bit words with bounded errors.
#include "web/web_codec.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>

#include "core/parallel.h"
#include "data/point_grid.h"
#include "vog/error.h"

namespace vog::web {

namespace {

constexpr double kMaxWord = 65535;
/// Largest chunk. Longer chunks have larger words, shorter ones more corners: the size of smoke
/// varies by 1 % between 64 and 1024.
constexpr std::uint32_t kMaxChunk = 256;

/// Indices of Gaussians with density > 0, in Morton order of their means.
std::vector<std::uint32_t> morton_order(const Gaussians& model) {
    Points means;
    std::vector<std::uint32_t> kept;
    for (std::size_t i = 0; i < model.size(); ++i) {
        if (!(model.density[i] > 0)) continue;
        means.position.push_back(vec_cast<double>(model.mean[i]));
        kept.push_back(static_cast<std::uint32_t>(i));
    }
    if (kept.empty()) return kept;
    const PointGrid grid = point_grid(means);
    std::vector<std::uint32_t> order;
    order.reserve(grid.size());
    for (const std::uint32_t n : grid.index) order.push_back(kept[n]);
    return order;
}

/// The 24 rotations that map a cube to itself.
std::vector<Quat> cube_rotations() {
    std::vector<Quat> all;
    const float r = 1 / std::numbers::sqrt2_v<float>;
    for (int a = 0; a < 4; ++a) {
        std::array<float, 4> q{};
        q[static_cast<std::size_t>(a)] = 1;
        all.push_back({q[0], q[1], q[2], q[3]});
        for (int b = a + 1; b < 4; ++b)
            for (const float sign : {r, -r}) {
                q = {};
                q[static_cast<std::size_t>(a)] = r;
                q[static_cast<std::size_t>(b)] = sign;
                all.push_back({q[0], q[1], q[2], q[3]});
            }
    }
    for (int bits = 0; bits < 8; ++bits)
        all.push_back(
            {0.5f, bits & 1 ? 0.5f : -0.5f, bits & 2 ? 0.5f : -0.5f, bits & 4 ? 0.5f : -0.5f});
    return all;
}

Quat product(Quat a, Quat b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
            a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

/// Standard deviations and rotation of a Gaussian.
struct Shape {
    Vec3d scale;
    Quat rotation;
};
/// The same ellipsoid with its axes permuted so that its rotation is the smallest.
Shape smallest_rotation(Vec3d scale, Quat q) {
    static const std::vector<Quat> kTurns = cube_rotations();
    const auto length =
        static_cast<float>(std::hypot(std::hypot(double{q.w}, q.x), std::hypot(double{q.y}, q.z)));
    q = {q.w / length, q.x / length, q.y / length, q.z / length};
    // The smallest rotation has the largest |w| of q * turn.
    const auto w_of = [&](Quat t) {
        return std::abs(q.w * t.w - q.x * t.x - q.y * t.y - q.z * t.z);
    };
    Quat best = kTurns.front();
    for (const Quat turn : kTurns)
        if (w_of(turn) > w_of(best) + 1e-6f) best = turn;
    Shape shape;
    shape.rotation = product(q, best);
    if (shape.rotation.w < 0)
        shape.rotation = {-shape.rotation.w, -shape.rotation.x, -shape.rotation.y,
                          -shape.rotation.z};
    // Column j of the turn is the old axis parallel to the new axis j.
    const Mat3 turn = matrix_from_quat(best);
    for (int j = 0; j < 3; ++j)
        for (int k = 0; k < 3; ++k)
            if (std::abs(turn(k, j)) > 0.5) shape.scale[j] = scale[k];
    return shape;
}

WebLogarithm logarithm_for(double smallest, double largest, double steps_per_unit) {
    const double finest = std::log2(1 + 1 / steps_per_unit);
    return {smallest, std::max(finest, (largest - smallest) / kMaxWord)};
}
std::uint16_t word_of(double value, double low, double step) {
    return static_cast<std::uint16_t>(std::clamp(std::round((value - low) / step), 0.0, kMaxWord));
}

/// Range of logarithms.
struct LogRange {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    void include(double value) {
        low = std::min(low, value);
        high = std::max(high, value);
    }
    WebLogarithm logarithm(double steps_per_unit) const {
        return low <= high ? logarithm_for(low, high, steps_per_unit) : WebLogarithm{};
    }
};

/// Divides the means into chunks, each with a step fine enough for its narrowest Gaussian and a box
/// that 16 bits of that step span.
void write_means(const WebShapes& sorted, double steps_per_deviation, WebLevel& level) {
    const auto step_for = [&](std::size_t n) {
        const Vec3d s = sorted.log_scale[n];
        return std::exp2(std::min({s.x, s.y, s.z})) / steps_per_deviation;
    };
    std::size_t begin = 0;
    while (begin < level.count) {
        Box box{sorted.mean[begin], sorted.mean[begin]};
        double step = step_for(begin);
        std::size_t end = begin + 1;
        for (; end < level.count && end - begin < kMaxChunk; ++end) {
            Box wider = box;
            wider.include(sorted.mean[end]);
            const double finer = std::min(step, step_for(end));
            const Vec3d size = wider.upper - wider.lower;
            // One step less, because the corner is rounded to float.
            if (std::max({size.x, size.y, size.z}) > (kMaxWord - 1) * finer) break;
            box = wider;
            step = finer;
        }
        const Vec3f corner = vec_cast<float>(box.lower);
        // Scales may be smaller than the unit by more than the range of floats.
        const float float_step =
            std::max(static_cast<float>(step), std::numeric_limits<float>::min());
        level.chunks.push_back(
            {{corner.x, corner.y, corner.z}, float_step, static_cast<std::uint32_t>(end - begin)});
        for (std::size_t n = begin; n < end; ++n)
            for (int axis = 0; axis < 3; ++axis)
                level.words[static_cast<std::size_t>(axis) * level.count + n] =
                    word_of(sorted.mean[n][axis], double{corner[axis]}, double{float_step});
        begin = end;
    }
}

}  // namespace

WebFrame web_frame(const Gaussians& model) {
    Box means;
    for (const Vec3f& mean : model.mean) means.include(vec_cast<double>(mean));
    if (means.empty()) return {};
    WebFrame frame{model.origin + means.center(), means.radius()};
    for (const Vec3f& s : model.scale)
        frame.unit = std::max({frame.unit, double{s.x}, double{s.y}, double{s.z}});
    return frame;
}

WebShapes web_shapes(const Gaussians& model, const WebFrame& frame) {
    const std::vector<std::uint32_t> order = morton_order(model);
    WebShapes sorted;
    sorted.rotated = !model.axis_aligned();
    sorted.index = order;
    const Vec3d center = frame.center - model.origin;
    sorted.mean.resize(order.size());
    sorted.log_scale.resize(order.size());
    sorted.rotation.resize(order.size());
    sorted.log_mass.resize(order.size());
    vog::parallel_for(std::size_t{0}, order.size(), [&](std::size_t n) {
        const std::size_t i = order[n];
        sorted.mean[n] = (1 / frame.unit) * (vec_cast<double>(model.mean[i]) - center);
        Shape shape{vec_cast<double>(model.scale[i]), {}};
        if (sorted.rotated) shape = smallest_rotation(shape.scale, model.rotation[i]);
        sorted.rotation[n] = shape.rotation;
        const double log_unit = std::log2(frame.unit);
        double log_volume = 0;
        for (int axis = 0; axis < 3; ++axis) {
            sorted.log_scale[n][axis] = std::log2(shape.scale[axis]) - log_unit;
            log_volume += sorted.log_scale[n][axis];
        }
        sorted.log_mass[n] = std::log2(double{model.density[i]}) + log_unit + log_volume;
    });
    return sorted;
}

WebLevel web_level(const WebShapes& sorted, const WebPrecision& precision) {
    WebLevel level;
    level.count = sorted.mean.size();
    level.rotated = sorted.rotated;
    level.rotation_words = precision.rotation_words;
    level.words.resize(level.columns() * level.count);
    write_means(sorted, precision.steps_per_deviation, level);

    LogRange scales, densities;
    for (const Vec3d s : sorted.log_scale)
        for (int axis = 0; axis < 3; ++axis) scales.include(s[axis]);
    level.scale = scales.logarithm(precision.steps_per_unit);
    std::uint16_t* column = level.words.data() + 3 * level.count;
    std::vector<double> log_density(level.count);
    for (std::size_t n = 0; n < level.count; ++n) {
        // Density from mass and rounded scales: their rounding does not change the mass.
        log_density[n] = sorted.log_mass[n];
        for (int axis = 0; axis < 3; ++axis) {
            const std::uint16_t word =
                word_of(sorted.log_scale[n][axis], level.scale.low, level.scale.step);
            column[static_cast<std::size_t>(axis) * level.count + n] = word;
            log_density[n] -= level.scale.low + level.scale.step * word;
        }
        densities.include(log_density[n]);
    }
    column += 3 * level.count;
    if (level.rotated) {
        const double step = 2 * kWebRotationLimit / precision.rotation_words;
        for (std::size_t n = 0; n < level.count; ++n) {
            const Quat q = sorted.rotation[n];
            column[n] = word_of(q.x, -kWebRotationLimit, step);
            column[level.count + n] = word_of(q.y, -kWebRotationLimit, step);
            column[2 * level.count + n] = word_of(q.z, -kWebRotationLimit, step);
        }
        column += 3 * level.count;
    }
    level.density = densities.logarithm(precision.steps_per_unit);
    for (std::size_t n = 0; n < level.count; ++n)
        column[n] = word_of(log_density[n], level.density.low, level.density.step);
    return level;
}

std::string WebLevel::compressed() const {
    static_assert(sizeof(Chunk) == 20);
    std::string bytes(chunks.size() * sizeof(Chunk), '\0');
    if (!chunks.empty()) std::memcpy(bytes.data(), chunks.data(), bytes.size());
    bytes.reserve(bytes.size() + 2 * words.size());
    for (std::size_t column = 0; column < columns(); ++column)
        for (const int shift : {0, 8})
            for (std::size_t n = 0; n < count; ++n)
                bytes += static_cast<char>(words[column * count + n] >> shift & 0xff);
    return deflated(bytes);
}

std::string deflated(const std::string& bytes) {
    uLongf size = compressBound(bytes.size());
    std::string out(size, '\0');
    if (compress2(reinterpret_cast<Bytef*>(out.data()), &size,
                  reinterpret_cast<const Bytef*>(bytes.data()), bytes.size(), 9) != Z_OK)
        throw Error("web page: zlib cannot compress");
    out.resize(size);
    return out;
}

}  // namespace vog::web
