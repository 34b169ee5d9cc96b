// view_cut.cpp: Cut through a hierarchy for one view: a top-down sweep, level by level, that decides
// which nodes to draw, skip or divide, then a copy of the result. Both read memory in runs.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "data/fields/field_arrays.h"
#include "vog/error.h"
#include "vog/lod.h"

namespace vog {

namespace {

/// Members of a node that the sweep reads, contiguous in memory.
struct Bound {
    Vec3f center;
    float radius = 0, error = 0;
    std::uint32_t first_node = 0, first_leaf = 0;
    std::uint8_t node_count = 0, leaf_count = 0;
};
static_assert(sizeof(Bound) == 32);

enum class Fate { skip, draw, divide };

/// One camera, and the four sides of its picture as planes, normals inwards: through the eye, or for
/// parallel rays at a distance from it.
class View {
  public:
    View(const CameraFrame& frame, const CutOptions& options)
        : eye_(frame.eye),
          forward_(frame.forward),
          pixels_(frame.pixels_per_unit),
          orthographic_(frame.orthographic),
          pixel_error_(options.pixel_error),
          skip_unseen_(options.skip_unseen) {
        const double side_x = 0.5 * frame.width / frame.pixels_per_unit;
        const double side_y = 0.5 * frame.height / frame.pixels_per_unit;
        if (orthographic_) {
            side_ = {-frame.right, frame.right, -frame.up, frame.up};
            margin_ = {side_x, side_x, side_y, side_y};
            return;
        }
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
            for (std::size_t n = 0; n < 4; ++n)
                if (dot(side_[n], p) + margin_[n] + radius < 0) return Fate::skip;
        }
        if (orthographic_) return node.error * pixels_ < pixel_error_ ? Fate::draw : Fate::divide;
        // A ball around the eye has no size in pixels.
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
    std::array<double, 4> margin_{};
    double pixels_;
    bool orthographic_;
    double pixel_error_;
    bool skip_unseen_;
};

/// Nodes or leaves first ... last - 1.
struct Run {
    std::uint32_t first, last;
};

/// Appends a run, or extends the last one if it is adjacent.
void add_run(std::vector<Run>& runs, std::uint32_t first, std::uint32_t last) {
    if (first == last) return;
    if (!runs.empty() && runs.back().last == first)
        runs.back().last = last;
    else
        runs.push_back({first, last});
}

/// Runs of the indices below `all` in none of the runs first[n] ... first[n] + count[n] - 1.
std::vector<Run> not_in_runs(std::size_t all, const std::vector<std::uint32_t>& first,
                             const std::vector<std::uint8_t>& count) {
    std::vector<bool> contained(all);
    for (std::size_t n = 0; n < first.size(); ++n)
        std::fill_n(contained.begin() + first[n], count[n], true);
    std::vector<Run> runs;
    for (std::size_t i = 0; i < all; ++i)
        if (!contained[i])
            add_run(runs, static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(i + 1));
    return runs;
}

/// Nodes of one level that one task tests, and the result.
struct Task {
    std::vector<Run> nodes;
    std::vector<Run> drawn, leaves;  ///< to draw
    std::vector<Run> children;       ///< nodes of the next level to test

    void clear() {
        for (std::vector<Run>* runs : {&nodes, &drawn, &leaves, &children}) runs->clear();
    }
};

/// Nodes a task: enough to pay for a task, few enough to balance the load.
constexpr std::uint32_t kOfTask = 1 << 12;

/// A run to draw, and its position in the result.
struct Placed {
    bool nodes;  ///< of nodes; false: of Gaussians of the model
    Run run;
    std::size_t slot;
};

template <class T>
void copy_run(const BigVector<T>& from, const Run& run, BigVector<T>& to, std::size_t slot) {
    std::copy(from.begin() + run.first, from.begin() + run.last,
              to.begin() + static_cast<std::ptrdiff_t>(slot));
}

void copy_run(const Gaussians& from, const Run& run, Gaussians& to, std::size_t slot) {
    copy_run(from.mean, run, to.mean, slot);
    copy_run(from.scale, run, to.scale, slot);
    copy_run(from.density, run, to.density, slot);
    each_array([&](const auto& array, auto& copy) { copy_run(array, run, copy, slot); },
               from.fields, to.fields);
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
    std::vector<Run> roots, loose;  ///< nodes and leaves without a parent
    std::vector<Task> tasks;        ///< of all levels, coarsest first
    std::size_t task_count = 0;
    std::vector<Run> level, leaves;
    std::vector<Placed> placed;
    Gaussians chosen;
    CutReport report;

    Task& next_task() {
        if (task_count == tasks.size()) tasks.emplace_back();
        Task& task = tasks[task_count++];
        task.clear();
        return task;
    }
    void split_level();
    void test_nodes(const View& view, Task& task) const;
    void sweep(const View& view);
    void place();
    void gather();
};

/// Splits the level into tasks, which depend on its runs alone, not on the number of threads.
void ViewCut::State::split_level() {
    std::uint32_t room = 0;
    for (Run run : level)
        while (run.first < run.last) {
            if (room == 0) {
                next_task();
                room = kOfTask;
            }
            const std::uint32_t size = std::min(room, run.last - run.first);
            tasks[task_count - 1].nodes.push_back({run.first, run.first + size});
            run.first += size;
            room -= size;
        }
}

void ViewCut::State::test_nodes(const View& view, Task& task) const {
    for (const Run& run : task.nodes)
        for (std::uint32_t n = run.first; n < run.last; ++n) {
            const Bound& node = bounds[n];
            const Fate fate = view.fate(node);
            if (fate == Fate::skip) continue;
            if (fate == Fate::draw) {
                add_run(task.drawn, n, n + 1);
                continue;
            }
            add_run(task.children, node.first_node, node.first_node + node.node_count);
            add_run(task.leaves, node.first_leaf, node.first_leaf + node.leaf_count);
        }
}

/// Tests nodes from the roots down; each level is the children of the nodes divided above it.
void ViewCut::State::sweep(const View& view) {
    task_count = 0;
    report = {};
    level = roots;
    while (!level.empty()) {
        const std::size_t first = task_count;
        split_level();
        vog::parallel_for(first, task_count, [&](std::size_t n) { test_nodes(view, tasks[n]); });
        level.clear();
        for (std::size_t n = first; n < task_count; ++n) {
            for (const Run& run : tasks[n].nodes) report.visited += run.last - run.first;
            for (const Run& run : tasks[n].children) add_run(level, run.first, run.last);
        }
    }
}

/// Assigns positions: nodes in the order of the sweep, then leaves in the model's order, so that
/// skipped Gaussians do not change the order of the others.
void ViewCut::State::place() {
    placed.clear();
    leaves = loose;
    for (std::size_t n = 0; n < task_count; ++n) {
        for (const Run& run : tasks[n].drawn) {
            placed.push_back({true, run, report.nodes});
            report.nodes += run.last - run.first;
        }
        leaves.insert(leaves.end(), tasks[n].leaves.begin(), tasks[n].leaves.end());
    }
    // Leaves of a single tree are in order already.
    const auto before = [](const Run& a, const Run& b) { return a.first < b.first; };
    if (!std::is_sorted(leaves.begin(), leaves.end(), before))
        std::sort(leaves.begin(), leaves.end(), before);
    for (const Run& run : leaves) {
        placed.push_back({false, run, report.drawn()});
        report.leaves += run.last - run.first;
    }
}

/// Copies the nodes and Gaussians of the cut.
void ViewCut::State::gather() {
    chosen.mean.resize(report.drawn());
    chosen.scale.resize(report.drawn());
    chosen.density.resize(report.drawn());
    const bool aligned = model->axis_aligned() && hierarchy->nodes.axis_aligned();
    chosen.rotation.resize(aligned ? 0 : report.drawn());
    each_array([&](auto& array) { array.resize(report.drawn()); }, chosen.fields);
    vog::parallel_for(std::size_t{0}, placed.size(), [&](std::size_t n) {
        const Placed& one = placed[n];
        copy_run(one.nodes ? hierarchy->nodes : *model, one.run, chosen, one.slot);
    });
}

ViewCut::ViewCut(const Gaussians& model, const Hierarchy& hierarchy, double cutoff)
    : state_(std::make_unique<State>()) {
    validate(hierarchy, model, model.source.empty() ? "model" : model.source);
    // Supports of a larger cutoff are wider; those of a smaller one still lie in the same balls.
    const double wider = std::max(1.0, cutoff / double{model.cutoff});
    state_->model = &model;
    state_->hierarchy = &hierarchy;
    state_->chosen.cutoff = model.cutoff;
    state_->chosen.origin = model.origin;
    state_->chosen.fields = empty_fields(model.fields);
    state_->roots = not_in_runs(hierarchy.size(), hierarchy.first_node, hierarchy.node_count);
    state_->loose = not_in_runs(model.size(), hierarchy.first_leaf, hierarchy.leaf_count);
    state_->bounds.resize(hierarchy.size());
    for (std::size_t n = 0; n < hierarchy.size(); ++n)
        state_->bounds[n] = {
            hierarchy.nodes.mean[n], static_cast<float>(hierarchy.radius[n] * wider),
            hierarchy.error[n],      hierarchy.first_node[n],
            hierarchy.first_leaf[n], hierarchy.node_count[n],
            hierarchy.leaf_count[n]};
}
ViewCut::~ViewCut() = default;
ViewCut::ViewCut(ViewCut&&) noexcept = default;
ViewCut& ViewCut::operator=(ViewCut&&) noexcept = default;

const Gaussians& ViewCut::choose(const CameraFrame& frame, const CutOptions& options) {
    if (!(options.pixel_error >= 0))
        throw Error(fmt::format("pixel error {}, expected a number >= 0", options.pixel_error));
    State& s = *state_;
    const View view(relative_to(frame, s.model->origin), options);
    s.sweep(view);
    s.place();
    if (s.report.leaves == s.model->size()) return *s.model;
    s.gather();
    return s.chosen;
}

const CutReport& ViewCut::report() const { return state_->report; }

}  // namespace vog
