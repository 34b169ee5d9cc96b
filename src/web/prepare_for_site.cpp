// prepare_for_site.cpp: models as sites have them, and the coarse ones that their pages are made from.
#include <algorithm>
#include <span>
#include <vector>

#include "io/site/tree/subtree_message.h"
#include "vog/camera.h"
#include "vog/distributed.h"
#include "vog/export_html.h"
#include "vog/lod.h"

namespace vog {

namespace {

/// Removes Gaussians without density, which nodes do not stand for.
/// returns  whether there were any
bool drop_empty(Gaussians& model) {
    if (std::ranges::all_of(model.density, [](float d) { return d > 0; })) return false;
    std::vector<std::size_t> kept;
    for (std::size_t n = 0; n < model.size(); ++n)
        if (model.density[n] > 0) kept.push_back(n);
    Gaussians rest = select(model, kept);
    rest.source_voxels = model.source_voxels;
    rest.summary = model.summary;
    model = std::move(rest);
    return true;
}

/// Box that views of a model in parts frame.
Box box_of_parts(const Gaussians& part, const Collective& processes) {
    // An empty box has its lower corner at +infinity and its upper one at -infinity, which change no extreme of others.
    const Box own = view_box(part);
    double ends[6] = {-own.lower.x, -own.lower.y, -own.lower.z,
                      own.upper.x,  own.upper.y,  own.upper.z};
    processes.max(ends);
    return {{-ends[0], -ends[1], -ends[2]}, {ends[3], ends[4], ends[5]}};
}

/// Moves the parts of a model to process 0.
void gather_parts(Gaussians& part, const Collective& processes) {
    double rotated = part.axis_aligned() ? 0 : 1;
    processes.max(std::span(&rotated, 1));
    if (rotated > 0 && part.axis_aligned()) part.rotation.resize(part.size());
    std::vector<std::string> to(static_cast<std::size_t>(processes.count));
    if (!processes.is_root()) {
        to.front() = site::message_of(part);
        part = select(part, {});
    }
    for (const std::string& message : processes.exchange_bytes(to))
        site::append_message(part, message);
}

}  // namespace

HtmlModel prepare_for_site(const std::string& name, Gaussians& model, Hierarchy& hierarchy,
                           const HierarchyOptions& options, const Collective* processes) {
    if (drop_empty(model)) hierarchy = {};
    if (hierarchy.empty()) hierarchy = build_hierarchy(model, options);
    constexpr int kSize = 256;
    const bool several = processes && processes->several();
    const Box box = several ? box_of_parts(model, *processes) : view_box(model);
    Gaussians coarse =
        ViewCut(model, hierarchy).choose(frame_of(orbit_view(box), kSize, kSize), {1, false});
    if (several) gather_parts(coarse, *processes);
    coarse.box = box;
    coarse.source = model.source;
    return {name, {std::move(coarse)}};
}

}  // namespace vog
