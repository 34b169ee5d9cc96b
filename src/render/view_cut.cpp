// view_cut.cpp: what of a hierarchy one view draws: a scan over the nodes that jumps over what it
// draws or leaves out, then a copy of what it chose.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "parallel.h"
#include "vog/error.h"
#include "vog/hierarchy.h"

namespace vog {

namespace {

/// What the scan needs of a node, side by side.
struct Bound {
    Vec3f center;
    float radius = 0, error = 0;
    std::uint32_t end = 0, first = 0, count = 0;
};
static_assert(sizeof(Bound) == 32);

enum class Fate { skip, draw, divide };

/// One camera, and the four sides of its picture as planes through the eye, normals inwards.
class View {
  public:
    View(const CameraFrame& frame, const CutOptions& options)
        : eye_(frame.eye),
          forward_(frame.forward),
          pixels_(frame.pixels_per_unit),
          pixel_error_(options.pixel_error),
          skip_unseen_(options.skip_unseen) {
        const double side_x = 0.5 * frame.width / frame.pixels_per_unit;
        const double side_y = 0.5 * frame.height / frame.pixels_per_unit;
        side_ = {normalized(side_x * frame.forward - frame.right),
                 normalized(side_x * frame.forward + frame.right),
                 normalized(side_y * frame.forward - frame.up),
                 normalized(side_y * frame.forward + frame.up)};
    }

    Fate fate(const Bound& node) const {
        const Vec3d p = vec_cast<double>(node.center) - eye_;
        const double forward = dot(p, forward_), radius = node.radius;
        if (skip_unseen_) {
            if (forward + radius <= 0) return Fate::skip;
            for (const Vec3d& side : side_)
                if (dot(side, p) + radius < 0) return Fate::skip;
        }
        // Around the eye there are no pixels to compare with.
        const double nearest = forward - radius;
        if (!(nearest > 0)) return Fate::divide;
        // A length at depth z is pixels / z on the screen, and 1 / cos more than that towards the
        // corners of wide views.
        const double stretch = length(p) / forward;
        return node.error * pixels_ * stretch < pixel_error_ * nearest ? Fate::draw : Fate::divide;
    }

  private:
    Vec3d eye_, forward_;
    std::array<Vec3d, 4> side_;
    double pixels_, pixel_error_;
    bool skip_unseen_;
};

/// Nodes or leaves first ... last - 1, drawn.
struct Run {
    bool nodes;
    std::uint32_t first, last;
};

/// A part of the cut, in the order of leaves: of one subtree that a task scans, or of what lies
/// above and between.
struct Piece {
    std::uint32_t root = 0, end = 0;  ///< nodes of the subtree; none where end is 0
    std::vector<Run> runs;
    std::size_t visited = 0, slot = 0;

    void clear(std::uint32_t subtree, std::uint32_t subtree_end) {
        root = subtree, end = subtree_end;
        runs.clear();
        visited = 0;
    }
    void draw(bool nodes, std::uint32_t first, std::uint32_t last) {
        if (first == last) return;
        if (!runs.empty() && runs.back().nodes == nodes && runs.back().last == first)
            runs.back().last = last;
        else
            runs.push_back({nodes, first, last});
    }
};

/// Leaves of a task: large enough to be worth one, small enough to share out.
constexpr std::uint32_t kWhole = 1 << 14;

template <class T>
void copy_run(const BigVector<T>& from, const Run& run, BigVector<T>& to, std::size_t slot) {
    std::copy(from.begin() + run.first, from.begin() + run.last,
              to.begin() + static_cast<std::ptrdiff_t>(slot));
}

void copy_run(const Gaussians& from, const Run& run, Gaussians& to, std::size_t slot) {
    copy_run(from.mean, run, to.mean, slot);
    copy_run(from.scale, run, to.scale, slot);
    copy_run(from.density, run, to.density, slot);
    if (to.axis_aligned()) return;
    if (from.axis_aligned())
        std::fill_n(to.rotation.begin() + static_cast<std::ptrdiff_t>(slot), run.last - run.first,
                    Quat{});
    else
        copy_run(from.rotation, run, to.rotation, slot);
}

}  // namespace

struct ViewCut::State {
    const Gaussians* model = nullptr;
    const Hierarchy* hierarchy = nullptr;
    std::vector<Bound> bounds;
    std::vector<Piece> pieces;
    std::size_t piece_count = 0;
    Gaussians chosen;
    CutReport report;

    Piece& next_piece(std::uint32_t root, std::uint32_t end) {
        if (piece_count == pieces.size()) pieces.emplace_back();
        Piece& piece = pieces[piece_count++];
        piece.clear(root, end);
        return piece;
    }
    void divide(const View& view);
    void scan(const View& view, Piece& piece) const;
    void gather();
};

/// Judges the nodes that are too large for one task, and leaves the subtrees below to tasks.
void ViewCut::State::divide(const View& view) {
    piece_count = 0;
    next_piece(0, 0);
    std::uint32_t leaf = 0;
    // Piece by piece in the order of leaves: what is drawn here goes to the last one, unless that
    // is a task's.
    const auto draw = [&](bool nodes, std::uint32_t first, std::uint32_t last) {
        if (first == last) return;
        if (pieces[piece_count - 1].end != 0) next_piece(0, 0);
        pieces[piece_count - 1].draw(nodes, first, last);
    };
    for (std::uint32_t n = 0; n < bounds.size();) {
        const Bound& node = bounds[n];
        draw(false, leaf, node.first);
        leaf = node.first;
        Fate fate = Fate::skip;
        if (node.count <= kWhole) {
            next_piece(n, node.end);
        } else {
            ++pieces[0].visited;
            fate = view.fate(node);
            if (fate == Fate::draw) draw(true, n, n + 1);
        }
        if (fate != Fate::divide) leaf += node.count;
        n = fate == Fate::divide ? n + 1 : node.end;
    }
    draw(false, leaf, static_cast<std::uint32_t>(model->size()));
}

void ViewCut::State::scan(const View& view, Piece& piece) const {
    if (piece.end == 0) return;
    std::uint32_t leaf = bounds[piece.root].first;
    const std::uint32_t last_leaf = leaf + bounds[piece.root].count;
    for (std::uint32_t n = piece.root; n < piece.end;) {
        const Bound& node = bounds[n];
        piece.draw(false, leaf, node.first);
        leaf = node.first;
        ++piece.visited;
        const Fate fate = view.fate(node);
        if (fate == Fate::draw) piece.draw(true, n, n + 1);
        if (fate != Fate::divide) leaf += node.count;
        n = fate == Fate::divide ? n + 1 : node.end;
    }
    piece.draw(false, leaf, last_leaf);
}

/// Copies what is drawn, in order.
void ViewCut::State::gather() {
    chosen.mean.resize(report.drawn());
    chosen.scale.resize(report.drawn());
    chosen.density.resize(report.drawn());
    const bool aligned = model->axis_aligned() && hierarchy->nodes.axis_aligned();
    chosen.rotation.resize(aligned ? 0 : report.drawn());
    vog::parallel_for(std::size_t{0}, piece_count, [&](std::size_t n) {
        std::size_t slot = pieces[n].slot;
        for (const Run& run : pieces[n].runs) {
            copy_run(run.nodes ? hierarchy->nodes : *model, run, chosen, slot);
            slot += run.last - run.first;
        }
    });
}

ViewCut::ViewCut(const Gaussians& model, const Hierarchy& hierarchy)
    : state_(std::make_unique<State>()) {
    state_->model = &model;
    state_->hierarchy = &hierarchy;
    state_->chosen.cutoff = model.cutoff;
    state_->bounds.resize(hierarchy.size());
    for (std::size_t n = 0; n < hierarchy.size(); ++n)
        state_->bounds[n] = {hierarchy.nodes.mean[n], hierarchy.radius[n], hierarchy.error[n],
                             hierarchy.end[n],        hierarchy.first[n],  hierarchy.count[n]};
}
ViewCut::~ViewCut() = default;
ViewCut::ViewCut(ViewCut&&) noexcept = default;
ViewCut& ViewCut::operator=(ViewCut&&) noexcept = default;

const Gaussians& ViewCut::choose(const CameraFrame& frame, const CutOptions& options) {
    if (!(options.pixel_error >= 0))
        throw Error(fmt::format("a pixel error of {}, expected 0 or more", options.pixel_error));
    State& s = *state_;
    const View view(frame, options);
    s.divide(view);
    vog::parallel_for(std::size_t{0}, s.piece_count,
                      [&](std::size_t n) { s.scan(view, s.pieces[n]); });
    s.report = {};
    for (std::size_t n = 0; n < s.piece_count; ++n) {
        Piece& piece = s.pieces[n];
        piece.slot = s.report.drawn();
        s.report.visited += piece.visited;
        for (const Run& run : piece.runs)
            (run.nodes ? s.report.nodes : s.report.leaves) += run.last - run.first;
    }
    if (s.report.leaves == s.model->size()) return *s.model;
    s.gather();
    return s.chosen;
}

const CutReport& ViewCut::report() const { return state_->report; }

}  // namespace vog
