// subject.cpp: the part of the data that a picture shows, as the hull of a few points.
#include "vog/subject.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string>

#include "data/views/mass_lattice.h"
#include "vog/dense.h"
#include "vog/distributed.h"

namespace vog {

using namespace views;

namespace {

/// Whether a lattice fits the box.
bool has_extent(const Box& box) {
    return !box.empty() && box.radius() > 0 && std::isfinite(box.radius());
}

/// Points of all processes.
std::vector<Vec3d> joined(const std::vector<Vec3d>& points, const Collective& collective) {
    if (!collective.several()) return points;
    const std::string own(reinterpret_cast<const char*>(points.data()),
                          points.size() * sizeof(Vec3d));
    std::vector<Vec3d> all;
    for (const std::string& bytes : collective.exchange_bytes(
             std::vector<std::string>(static_cast<std::size_t>(collective.count), own))) {
        const std::size_t before = all.size();
        all.resize(before + bytes.size() / sizeof(Vec3d));
        std::memcpy(all.data() + before, bytes.data(), bytes.size());
    }
    return all;
}

Box joined_box(const Box& own, const Collective& collective) {
    std::vector<Vec3d> ends;
    if (!own.empty()) ends = {own.lower, own.upper};
    Box all;
    for (const Vec3d& end : joined(ends, collective)) all.include(end);
    return all;
}

/// How the data of any process stand: those that know it agree.
Standing of_any(const Standing& own, const Collective& all) {
    std::array<double, 12> most;
    for (int axis = 0; axis < 3; ++axis) {
        const auto n = static_cast<std::size_t>(axis);
        most[n] = own.up[axis], most[n + 3] = -own.up[axis];
        most[n + 6] = own.front[axis], most[n + 9] = -own.front[axis];
    }
    all.max(most);
    const auto vector = [&](std::size_t first) {
        const auto at = [&](std::size_t n) {
            return std::max(most[first + n], 0.0) - std::max(most[first + n + 3], 0.0);
        };
        return Vec3d{at(0), at(1), at(2)};
    };
    return {vector(0), vector(6)};
}

/// Units of the data of any process, likewise.
Units of_any(const Units& own, const Collective& all) {
    constexpr std::size_t kMostLetters = 64;
    std::array<double, 2 * kMostLetters> letters{};
    std::ranges::copy(own.length.substr(0, kMostLetters), letters.begin());
    std::ranges::copy(own.density.substr(0, kMostLetters), letters.begin() + kMostLetters);
    all.max(letters);
    const auto text = [&](std::size_t first) {
        std::string letters_of;
        for (std::size_t n = first; n < first + kMostLetters && letters[n] > 0; ++n)
            letters_of += static_cast<char>(letters[n]);
        return letters_of;
    };
    return {text(0), text(kMostLetters)};
}

}  // namespace

Box voxel_box(const Volume& volume) {
    if (volume.empty()) return {};
    const IndexBox active = active_box(volume);
    const Vec3d half{0.5, 0.5, 0.5};
    return transformed(volume.world_from_index, {vec_cast<double>(active.lower) - half,
                                                 vec_cast<double>(active.upper) + half});
}

Subject subject_of(const Box& box, Content content) {
    Subject subject(box);
    if (content.hull.empty()) content.hull = std::move(subject.content.hull);
    subject.content = std::move(content);
    return subject;
}

Content content_of(std::span<const Volume> volumes, const Box& box) {
    std::vector<const Volume*> pointers;
    for (const Volume& volume : volumes) pointers.push_back(&volume);
    return content_of(pointers, box);
}

Content content_of(std::span<const Volume* const> volumes, const Box& box,
                   const Collective* collective) {
    const Collective& all = collective_or_single(collective);
    Content content;
    double step = 0;
    for (const Volume* volume : volumes) {
        content.voxels.include(voxel_box(*volume));
        step = std::max(step, longest_step(volume->world_from_index));
        if (!content.standing.known()) content.standing = volume->standing;
        if (content.units == Units{}) content.units = volume->units;
    }
    content.standing = of_any(content.standing, all);
    content.units = of_any(content.units, all);
    if (!has_extent(box)) return content;
    MassLattice lattice(box);
    for (const Volume* volume : volumes) lattice.add(*volume);
    lattice.sum_over(all);
    content.voxels = joined_box(content.voxels, all);
    content.hull = lattice.hull();
    // Gaussians of few voxels are seen beyond these.
    constexpr double kFew = 4;  // voxels
    all.max({&step, 1});
    if (!content.hull.empty() && content.voxels.radius() < kFew * step) {
        const Vec3d room = 0.2 * Vec3d{step, step, step};
        content.hull =
            Subject(Box{content.voxels.lower - room, content.voxels.upper + room}).content.hull;
    }
    return content;
}

Content content_of(const CellSource& source, const Box& box) {
    Content content{box, {}, {}, source.cells->units};
    if (!has_extent(box)) return content;
    MassLattice lattice(box);
    lattice.add(source);
    content.hull = lattice.hull();
    return content;
}

Subject joined(const Subject& part, const Collective& collective) {
    Subject all;
    all.content.standing = of_any(part.content.standing, collective);
    all.content.units = of_any(part.content.units, collective);
    all.content.hull = joined(part.content.hull, collective);
    all.content.voxels = joined_box(part.content.voxels, collective);
    all.box = joined_box(part.box, collective);
    return all;
}

Subject subject_of(const Gaussians& model, const Collective* collective) {
    const Collective& all = collective_or_single(collective);
    const Box box = view_box(model);
    double unknown = model.content.hull.empty() && model.size() > 0 ? 1 : 0;
    all.sum(unknown);
    Content content{joined_box(model.content.voxels, all),
                    {},
                    of_any(model.content.standing, all),
                    of_any(model.content.units, all),
                    model.content.by_value};
    if (unknown == 0) {
        content.hull = joined(model.content.hull, all);
    } else if (has_extent(box)) {
        MassLattice lattice(box);
        lattice.add(model);
        lattice.sum_over(all);
        content.hull = lattice.hull();
    }
    return subject_of(box, content);
}

}  // namespace vog
