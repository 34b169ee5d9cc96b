// picture_frame.cpp: box outline with ticks, and scale bar, over a picture.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "data/image_checks.h"
#include "shade/annotation/bitmap_font.h"
#include "shade/annotation/ticks.h"
#include "vog/quantity.h"

namespace vog {

using namespace shading;

namespace {

/// Place in an image, pixels; centres are whole numbers.
struct Place {
    double x = 0, y = 0;
};
Place operator+(Place a, Place b) { return {a.x + b.x, a.y + b.y}; }
Place operator-(Place a, Place b) { return {a.x - b.x, a.y - b.y}; }
Place operator*(double s, Place a) { return {s * a.x, s * a.y}; }
double dot(Place a, Place b) { return a.x * b.x + a.y * b.y; }
double length(Place a) { return std::hypot(a.x, a.y); }

class FrameDrawing {
  public:
    FrameDrawing(Image& image, const PictureFrame& frame, const Rgba& ink)
        : image_(image),
          frame_(frame),
          rays_(frame_of(frame.camera, image.width, image.height)),
          ink_(ink),
          scale_(text_scale(image.height)) {}

    void draw_axes() {
        std::optional<Edge> labelled[3];
        for (int axis = 0; axis < 3; ++axis)
            for (int n = 0; n < 4; ++n) {
                const Edge edge = edge_of(axis, n & 1, n >> 1);
                draw_segment(edge.from, edge.to, edge.faces_seen == 0 ? 0.35f : 0.9f);
                if (edge.faces_seen == 1 && (!labelled[axis] || edge.lower_than(*labelled[axis])))
                    labelled[axis] = edge;
            }
        // Names find places among the numbers of all axes.
        for (int axis = 0; axis < 3; ++axis)
            if (labelled[axis] && !draw_ticks(axis, *labelled[axis])) labelled[axis].reset();
        for (int axis = 0; axis < 3; ++axis)
            if (labelled[axis]) draw_name(axis, *labelled[axis]);
    }

    void draw_scale_bar() {
        const double depth = vog::length(frame_.camera.look_at - frame_.camera.eye);
        const double pixels = rays_.pixels_at(depth);
        const double most = 0.25 * image_.width / pixels;
        const double power = std::pow(10, std::floor(std::log10(most)));
        const double bar = power * (most >= 5 * power ? 5 : most >= 2 * power ? 2 : 1);
        const int gap = 6 * scale_, thick = 2 * scale_;
        const std::string text = with_unit(tick_text(bar), frame_.length_unit);
        const double width = std::max(bar * pixels, double(text_width(text, scale_))),
                     height = thick + (kGlyphHeight + 1) * scale_;
        // Lower left, else the corner that the coordinates leave.
        Place least{};
        for (const int corner : {3, 2, 1, 0, 3}) {
            least = {corner & 1 ? double(gap) : image_.width - gap - width,
                     corner & 2 ? image_.height - gap - height : double(gap)};
            if (is_free({least, least + Place{width, height}})) break;
        }
        const double y = least.y + height - 0.5 * thick;
        draw_line({least.x, y}, {least.x + bar * pixels, y}, thick, 1);
        draw_text(image_, static_cast<int>(least.x), static_cast<int>(least.y), text, ink_,
                  {scale_});
    }

  private:
    /// Edge of the box, and where it lies in the image.
    struct Edge {
        Vec3d from, to;
        int faces_seen = 0;  ///< of the two that meet here: one at the outline, none behind the box
        Place begin, end;
        Place middle() const { return 0.5 * (begin + end); }
        /// Further down in the image, or to the left where edges are upright.
        bool lower_than(const Edge& other) const {
            const Place along = end - begin;
            return std::abs(along.x) > std::abs(along.y) ? middle().y > other.middle().y
                                                         : middle().x < other.middle().x;
        }
    };

    Edge edge_of(int axis, int u, int v) const {
        const int across[2] = {(axis + 1) % 3, (axis + 2) % 3}, side[2] = {u, v};
        Edge edge;
        edge.from = edge.to = frame_.box.lower;
        edge.to[axis] = frame_.box.upper[axis];
        for (const int n : {0, 1}) {
            const double at = side[n] ? frame_.box.upper[across[n]] : frame_.box.lower[across[n]];
            edge.from[across[n]] = edge.to[across[n]] = at;
            const double towards =
                rays_.orthographic ? -rays_.forward[across[n]] : rays_.eye[across[n]] - at;
            edge.faces_seen += side[n] ? towards > 0 : towards < 0;
        }
        edge.begin = place_of(edge.from), edge.end = place_of(edge.to);
        return edge;
    }
    double depth_of(Vec3d point) const { return vog::dot(point - rays_.eye, rays_.forward); }
    Place place_of(Vec3d point) const {
        const Vec3d at = point - rays_.eye;
        const double pixels = rays_.pixels_at(depth_of(point));
        return {0.5 * (image_.width - 1) + pixels * vog::dot(at, rays_.right),
                0.5 * (image_.height - 1) - pixels * vog::dot(at, rays_.up)};
    }

    void draw_segment(Vec3d from, Vec3d to, float alpha) {
        // The part in front of a pinhole camera.
        const double least = 1e-3 * frame_.box.radius();
        double a = depth_of(from), b = depth_of(to);
        if (!rays_.orthographic) {
            if (a < least && b < least) return;
            if (a < least) from = to + ((b - least) / (b - a)) * (from - to);
            if (b < least) to = from + ((a - least) / (a - b)) * (to - from);
        }
        draw_line(place_of(from), place_of(to), 0.75 * scale_, alpha);
    }

    /// A line with soft edges.
    void draw_line(Place from, Place to, double width, float alpha) {
        const Place along = to - from;
        const double reach = 0.5 * width + 1, all = dot(along, along);
        const auto least = [&](double a, double b, int size) {
            return static_cast<int>(
                std::clamp(std::floor(std::min(a, b) - reach), 0.0, double(size)));
        };
        const auto most = [&](double a, double b, int size) {
            return static_cast<int>(
                std::clamp(std::ceil(std::max(a, b) + reach), -1.0, size - 1.0));
        };
        for (int y = least(from.y, to.y, image_.height); y <= most(from.y, to.y, image_.height);
             ++y)
            for (int x = least(from.x, to.x, image_.width); x <= most(from.x, to.x, image_.width);
                 ++x) {
                const Place at = Place{double(x), double(y)} - from;
                const double t = all > 0 ? std::clamp(dot(at, along) / all, 0.0, 1.0) : 0;
                const double outside = length(at - t * along) - 0.5 * width;
                if (const auto cover = static_cast<float>(std::clamp(0.5 - outside, 0.0, 1.0));
                    cover > 0)
                    blend(image_.at(x, y), cover * alpha);
            }
    }
    void blend(Rgba& pixel, float alpha) const {
        const float all = alpha + pixel.a * (1 - alpha);
        for (float Rgba::*channel : {&Rgba::r, &Rgba::g, &Rgba::b})
            pixel.*channel = (alpha * ink_.*channel + (1 - alpha) * pixel.a * pixel.*channel) / all;
        pixel.a = all;
    }

    /// A rectangle in the image.
    struct Area {
        Place least, most;
    };
    /// Whether an area lies within the image's edges, a glyph's gap from all texts that are there.
    bool is_free(const Area& area) const {
        return area.least.x >= 1 && area.least.y >= 1 && area.most.x <= image_.width - 1 &&
               area.most.y <= image_.height - 1 &&
               std::ranges::none_of(texts_,
                                    [&](const Area& other) { return are_near(area, other); });
    }
    bool are_near(const Area& a, const Area& b) const {
        const double gap = 3.0 * scale_;
        return a.least.x < b.most.x + gap && b.least.x < a.most.x + gap &&
               a.least.y < b.most.y + gap && b.least.y < a.most.y + gap;
    }
    /// Of a text beside a point, on the side of `out`.
    Area area_of(const std::string& text, Place at, Place out) const {
        const Place half{0.5 * text_width(text, scale_), 0.5 * kGlyphHeight * scale_};
        const Place middle =
            at + (std::abs(out.x) * half.x + std::abs(out.y) * half.y + 2.0 * scale_) * out;
        return {middle - half, middle + half};
    }
    /// Draws a text unless it would be cut, or lie upon another one.
    bool draw_free(const std::string& text, const Area& area) {
        if (!is_free(area)) return false;
        draw_text(image_, static_cast<int>(std::lround(area.least.x)),
                  static_cast<int>(std::lround(area.least.y)), text, ink_, {scale_});
        texts_.push_back(area);
        return true;
    }

    /// Direction away from the middle of the box, across an edge.
    Place out_of(const Edge& edge) const {
        const Place along = edge.end - edge.begin;
        const Place out = (1 / length(along)) * Place{-along.y, along.x};
        return (dot(out, edge.middle() - place_of(frame_.box.center())) < 0 ? -1.0 : 1.0) * out;
    }
    Place tick_end(const Edge& edge, int axis, double value) const {
        Vec3d point = edge.from;
        point[axis] = value;
        return place_of(point) + (3.0 * scale_) * out_of(edge);
    }

    /// The most ticks whose numbers do not touch; false: the edge is too short for any.
    bool draw_ticks(int axis, const Edge& edge) {
        if (!(length(edge.end - edge.begin) > 4 * kGlyphHeight * scale_) ||
            depth_of(edge.from) <= 0 || depth_of(edge.to) <= 0)
            return false;
        const Place out = out_of(edge);
        std::vector<Tick> ticks;
        std::vector<Area> areas;
        for (const double gap : {0.16, 0.25, 0.35, 0.5}) {
            AxisTicks along = axis_ticks(edge.from[axis], edge.to[axis], gap);
            ticks = std::move(along.ticks), origin_[axis] = std::move(along.origin);
            areas.clear();
            bool touch = false;
            for (const auto& [value, text] : ticks) {
                areas.push_back(area_of(text, tick_end(edge, axis, value), out));
                if (areas.size() > 1) touch = touch || are_near(areas.back(), areas.end()[-2]);
            }
            if (!touch) break;
        }
        for (std::size_t n = 0; n < ticks.size(); ++n) {
            const Place end = tick_end(edge, axis, ticks[n].value);
            draw_line(end - (3.0 * scale_) * out, end, 0.75 * scale_, 0.9f);
            draw_free(ticks[n].text, areas[n]);
        }
        return true;
    }
    /// Beside the edge's middle, where numbers are beyond them; else among them, or beyond an end.
    void draw_name(int axis, const Edge& edge) {
        const std::string name =
            with_unit(std::string(1, "xyz"[axis]) + origin_[axis], frame_.length_unit);
        const Place out = out_of(edge);
        constexpr int kSteps = 16, kNear = 5, kFar = 60;
        for (int step = 0; step <= kSteps; ++step) {
            const double t = 0.5 + (step & 1 ? -1.0 : 1.0) * ((step + 1) / 2) / kSteps;
            const Place at = edge.begin + t * (edge.end - edge.begin);
            for (int away = kNear; away <= (step == 0 ? kFar : kNear); away += 2)
                if (draw_free(name, area_of(name, at + double(away * scale_) * out, out))) return;
        }
        const Place along = (1 / length(edge.end - edge.begin)) * (edge.end - edge.begin);
        Area ends[] = {area_of(name, edge.end + double(kNear * scale_) * along, along),
                       area_of(name, edge.begin - double(kNear * scale_) * along, -1.0 * along)};
        for (Area& end : ends) {  // beside the edge's end where it is near the side of the picture
            const double inwards = std::max(0.0, scale_ - end.least.x) -
                                   std::max(0.0, end.most.x - image_.width + scale_);
            end.least.x += inwards, end.most.x += inwards;
        }
        if (!draw_free(name, ends[0])) draw_free(name, ends[1]);
    }

    Image& image_;
    const PictureFrame& frame_;
    CameraFrame rays_;
    Rgba ink_;
    int scale_;
    std::vector<Area> texts_{};  ///< that are drawn
    std::string origin_[3];      ///< behind the names of axes
};

}  // namespace

void draw_frame(Image& picture, const PictureFrame& frame, const Rgba& background) {
    require_valid("frame", picture);
    require_glyphs("unit of length", frame.length_unit);
    FrameDrawing drawing(picture, frame, ink_on(background));
    if (frame.axes && !frame.box.empty()) drawing.draw_axes();
    if (frame.scale_bar) drawing.draw_scale_bar();
}

std::optional<SideTicks> side_ticks(const Camera& camera, int width, int height,
                                    const std::string& unit) {
    if (!camera.orthographic()) return {};
    const CameraFrame frame = frame_of(camera, width, height);
    SideTicks sides;
    const auto set = [&](const Vec3d& direction, int pixels, SideTicks::Side& side) {
        for (int axis = 0; axis < 3; ++axis) {
            if (std::abs(direction[axis]) < 1 - 1e-9) continue;
            const double half = 0.5 * pixels / frame.pixels_per_unit * direction[axis];
            side = {frame.eye[axis] - half, frame.eye[axis] + half,
                    with_unit(std::string(1, "xyz"[axis]), unit)};
            return true;
        }
        return false;
    };
    if (!set(frame.right, width, sides.across) || !set(frame.up, height, sides.up)) return {};
    return sides;
}

}  // namespace vog
