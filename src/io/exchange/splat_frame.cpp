// splat_frame.cpp: turns between upright directions, and the text that states a frame.
#include "io/exchange/splat_frame.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>

#include "vog/error.h"
#include "vog/text.h"

namespace vog::exchange {

namespace {

struct Frame {
    double scale = 1;
    Vec3d center, up;
};

/// Cuts `word` and the numbers behind it off a text; whether they are there.
bool take(std::string_view& text, std::string_view word, std::initializer_list<double*> values) {
    if (!text.starts_with(word)) return false;
    text.remove_prefix(word.size());
    const auto skip_blanks = [&] {
        text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
    };
    for (double* value : values) {
        skip_blanks();
        const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), *value);
        if (code != std::errc{} || !std::isfinite(*value)) return false;
        text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    }
    skip_blanks();
    return true;
}

Frame frame_of_text(std::string_view text) {
    Frame frame;
    auto& [scale, c, u] = frame;
    std::string_view left = text;
    if (!take(left, "scale", {&scale}) || !take(left, "center", {&c.x, &c.y, &c.z}) ||
        !take(left, "up", {&u.x, &u.y, &u.z}) || !left.empty() || !(scale > 0))
        throw Error(fmt::format("{} '{}', expected 'scale S center X Y Z up X Y Z' with S > 0",
                                kFrameKey, printable(text)));
    return frame;
}

}  // namespace

Mat3 turn_of(Vec3d up, Upright upright) {
    const double size = length(up);
    if (!(size > 0) || !std::isfinite(size))
        throw Error(fmt::format("up {},{},{}: expected a direction, not 0", up.x, up.y, up.z));
    const Vec3d u = (1 / size) * up;
    constexpr Mat3 about_x{{Vec3d{1, 0, 0}, Vec3d{0, -1, 0}, Vec3d{0, 0, -1}}};
    // Rodrigues' formula for the axis u x y: exact zeros and ones where u is an axis.
    Mat3 turn = about_x;
    constexpr double kOpposite = 1e-12;
    if (1 + u.y > kOpposite) {
        const Vec3d v = cross(u, Vec3d{0, 1, 0});
        const Mat3 across{{Vec3d{0, -v.z, v.y}, Vec3d{v.z, 0, -v.x}, Vec3d{-v.y, v.x, 0}}};
        const Mat3 square = across * across;
        turn = {};
        for (int r = 0; r < 3; ++r)
            for (int c = 0; c < 3; ++c) turn(r, c) += across(r, c) + square(r, c) / (1 + u.y);
    }
    return upright == Upright::y ? turn : about_x * turn;
}

Quat product_of(Quat a, Quat b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
            a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

Splats turned(const Splats& splats, const Mat3& turn) {
    Splats out = splats;
    const Quat turn_quat = quat_from_matrix(turn);
    for (Vec3f& mean : out.mean) mean = vec_cast<float>(turn * vec_cast<double>(mean));
    for (Quat& rotation : out.rotation) rotation = product_of(turn_quat, rotation);
    return out;
}

std::string frame_text(const Splats& splats, Vec3d up) {
    const Vec3d c = splats.world_center;
    return fmt::format("scale {} center {} {} {} up {} {} {}", splats.world_scale, c.x, c.y, c.z,
                       up.x, up.y, up.z);
}

void restore_frame(Gaussians& model, std::string_view text, Upright upright) {
    if (text.empty()) return;
    const Frame frame = frame_of_text(text);
    const Mat3 back = transpose(turn_of(frame.up, upright));
    const Quat back_quat = quat_from_matrix(back);
    // The file's unit box, of an origin that no part of a model changes.
    const Vec3d reach{frame.scale, frame.scale, frame.scale};
    if (frame.center != Vec3d{})
        model.origin = model_origin({frame.center - reach, frame.center + reach});
    const auto scale = static_cast<float>(frame.scale);
    for (std::size_t i = 0; i < model.size(); ++i) {
        const Vec3d from_center = frame.scale * (back * vec_cast<double>(model.mean[i]));
        model.mean[i] = vec_cast<float>(frame.center - model.origin + from_center);
        model.scale[i] = scale * model.scale[i];
        model.density[i] /= scale;
        if (!model.axis_aligned()) model.rotation[i] = product_of(back_quat, model.rotation[i]);
    }
}

}  // namespace vog::exchange
