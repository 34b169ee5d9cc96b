// picture_defaults.cpp: default view, field, label and scale of a picture.
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <tuple>

#include "data/views/mass_lattice.h"
#include "render/splat/splat.h"
#include "shade/annotation/ticks.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/picture.h"
#include "vog/text.h"

namespace vog {

namespace {

/// The part that a clip leaves; all of it where nothing stays, or a point.
Subject clipped(Subject subject, const Clipping& clip) {
    constexpr double kLeast = 1e-9;  // radius of the part, as a share of that of the box
    if (clip.empty()) return subject;
    std::vector<Vec3d> hull = subject.content.hull;
    // In one order, and each once: ranks have the points of each other's parts.
    std::ranges::sort(hull, {}, [](Vec3d p) { return std::tuple(p.x, p.y, p.z); });
    const auto again = std::ranges::unique(hull);
    hull.erase(again.begin(), again.end());
    const auto cut = [&](Vec3d normal, double offset) {
        const auto above = [&](Vec3d p) { return dot(p, normal) - offset; };
        std::vector<Vec3d> kept;
        std::ranges::copy_if(hull, std::back_inserter(kept),
                             [&](Vec3d p) { return above(p) >= 0; });
        if (kept.empty() || kept.size() == hull.size()) return std::swap(hull, kept);
        Box box;
        for (const Vec3d& p : hull) box.include(p);
        // Where the plane meets the hull its corners lie between two points of it.
        for (std::size_t n = 0, inside = kept.size(); n < inside; ++n)
            for (const Vec3d& out : hull)
                if (const double high = above(kept[n]), low = above(out); low < 0)
                    kept.push_back(kept[n] + (high / (high - low)) * (out - kept[n]));
        hull = views::hull_points(box.radius(), [&](Vec3d d) {
            return std::ranges::max(kept, {}, [&](Vec3d p) { return dot(p, d); });
        });
    };
    for (const ClipPlane& plane : clip.planes) cut(plane.normal, plane.offset);
    for (int axis = 0; clip.box && axis < 3; ++axis) {
        Vec3d along;
        along[axis] = 1;
        cut(along, clip.box->lower[axis]), cut(-along, -clip.box->upper[axis]);
    }
    Box left;
    for (const Vec3d& p : hull) left.include(p);
    if (!left.empty() && left.radius() > kLeast * subject.box.radius())
        subject.content.hull = std::move(hull);
    return subject;
}

/// The box that axes outline, with room for the coordinates around it.
Subject with_axes(Subject subject) {
    const Box box = outline_of(subject);
    if (box.empty()) return subject;
    std::size_t glyphs = 0;
    for (int axis = 0; axis < 3; ++axis)
        if (box.lower[axis] < box.upper[axis])
            for (const shading::Tick& tick :
                 shading::axis_ticks(box.lower[axis], box.upper[axis], 0.16).ticks)
                glyphs = std::max(glyphs, tick.text.size());
    // Text is 1/36 of the picture's height, a glyph 6/7 of that wide; a tick and its gaps are one and a half glyphs.
    const double text = (static_cast<double>(glyphs) + 1.5) * 6 / 7 / 36;
    const double room = std::clamp(1 / (1 - 2 * text), 1.2, 1.6);
    const Vec3d half = (0.5 * room) * (box.upper - box.lower);
    subject.content.hull = Subject(Box{box.center() - half, box.center() + half}).content.hull;
    return subject;
}

}  // namespace

Camera default_view(const Subject& subject, int width, int height) {
    const double aspect = width > 0 && height > 0 ? double(width) / height : 1;
    return orbit_view(subject, first_orbit(subject), aspect);
}

Box outline_of(const Subject& subject) {
    return subject.content.voxels.empty() ? subject.box : subject.content.voxels;
}

Subject shown_by(const PictureRequest& request, const Subject& subject) {
    if (request.marks.axes) return with_axes(subject);
    return clipped(subject, request.options.clip);
}

double default_extinction(const Gaussians& model) {
    constexpr int kSize = 256;
    const Box box = view_box(model);
    return auto_extinction(render_splat(model, fitted(paper_view(box), box), kSize, kSize));
}

const ScalarField* scalar_to_show(const Fields& fields, const std::string& name) {
    if (!name.empty()) return fields.find_scalar(name);
    const auto measure = std::ranges::find(fields.scalar, true, &ScalarField::is_measure);
    if (measure != fields.scalar.end()) return &*measure;
    return fields.scalar.size() == 1 ? &fields.scalar.front() : nullptr;
}

const ScalarField* scalar_to_begin_with(const Fields& fields) {
    const ScalarField* field = scalar_to_show(fields);
    return field || fields.scalar.empty() ? field : &fields.scalar.front();
}

std::string scalar_names(const Fields& fields) {
    std::string names;
    for (const ScalarField& field : fields.scalar)
        names += (names.empty() ? "" : ", ") + printable(field.name);
    return names.empty() ? "none" : names;
}

ValueData value_data(const Scene& scene, const std::string& field) {
    ValueData data;
    if (scene.has_voxels()) {
        const VoxelSource& source = scene.voxels();
        const auto found = std::ranges::find(source.fields, field, &SampledField::name);
        data = value_data(source.volumes->volumes, found->values, scene.subject.box);
        data.content = scene.subject.content.hull_box();
    } else {
        data = value_data(*scene.model().model, *scene.model().model->fields.find_scalar(field));
    }
    data.box = scene.subject.box;
    if (!scene.collective || !scene.collective->several()) return data;
    const bool none = scene.has_voxels() && scene.voxels().volumes->volumes.empty();
    constexpr double kNone = -std::numeric_limits<double>::infinity();
    double most[5] = {none ? kNone : -data.lower, none ? kNone : data.upper,
                      data.is_measure ? 1.0 : 0.0, data.counts.empty() ? 0.0 : 1.0,
                      none ? kNone : data.background};
    scene.collective->max(most);
    scene.collective->sum(data.mass);
    data.lower = -most[0], data.upper = most[1];
    data.is_measure = most[2] > 0;
    data.background = most[4];
    if (!(most[3] > 0)) return data;
    scene.collective->sum(data.counts.weights());
    data.spread = data.counts.spread();
    return data;
}

VoxelField component_of(VoxelField field, const std::string& part, const Volume& volume) {
    const std::size_t axis = part == "magnitude" ? 0 : static_cast<std::size_t>(part[0] - 'x');
    VoxelValues values = std::move(field.component[axis]);
    if (part == "magnitude") {
        const auto add = [](float& x, float y, float z) { x = std::hypot(x, y, z); };
        const VoxelValues &y = field.component[1], &z = field.component[2];
        for (std::size_t l = 0; l < values.leaf.size(); ++l)
            for (std::size_t n = 0; n < kLeafVoxels; ++n)
                add(values.leaf[l][n], y.leaf[l][n], z.leaf[l][n]);
        for (std::size_t t = 0; t < values.tile.size(); ++t)
            add(values.tile[t], y.tile[t], z.tile[t]);
    }
    float lower = HUGE_VALF, upper = -HUGE_VALF;
    const auto include = [&](float value) {
        lower = std::min(lower, value), upper = std::max(upper, value);
    };
    for (std::size_t l = 0; l < values.leaf.size(); ++l)
        for (int n = 0; n < kLeafVoxels; ++n)
            if (volume.leaves[l].active(n)) include(values.leaf[l][static_cast<std::size_t>(n)]);
    std::ranges::for_each(values.tile, include);
    field.lower = double{lower}, field.upper = double{upper};
    field.counts = value_counts(volume, values);
    field.component.assign(1, std::move(values));
    field.name += "." + part;
    return field;
}

namespace {
constexpr std::array<const char*, 7> kShowWords = {"T",      "column",  "mean", "deviation",
                                                   "volume", "maximum", "slice"};
}

std::span<const char* const> show_words() { return kShowWords; }
const char* word_of(Show show) { return kShowWords[static_cast<std::size_t>(show)]; }

Show show_named(std::string_view word) {
    std::string words;
    for (std::size_t n = 0; n < kShowWords.size(); ++n) {
        if (word == kShowWords[n]) return static_cast<Show>(n);
        words += fmt::format("{}'{}'",
                             n == 0                      ? ""
                             : n + 1 < kShowWords.size() ? ", "
                                                         : " or ",
                             kShowWords[n]);
    }
    throw Error(fmt::format("show '{}', expected {}", word, words));
}

std::string quantity_label(Show show, const std::string& field, const std::string& unit) {
    std::string label = show == Show::depth    ? "optical depth T"
                        : show == Show::column ? "column density"
                                               : field;
    if (show == Show::deviation || show == Show::maximum)
        label = fmt::format("{} of {}", word_of(show), field);
    return with_unit(label, unit);
}

ColoredMap colored_map(const FieldMaps& maps, Show show, ScaleFit fit,
                       const std::optional<ColorScale>& fixed, double least_column) {
    if (show == Show::column) {
        DepthImage column(maps.width, maps.height);
        column.depth = maps.column;
        return {visible_values(maps, maps.column, 0),
                fixed ? *fixed : automatic_scale({&column, 1}, fit)};
    }
    const std::vector<float>& shown = show == Show::mean ? maps.mean : maps.deviation;
    return {visible_values(maps, shown, least_column),
            fixed ? *fixed : fitted_scale(values_for_scale(maps, shown), fit)};
}

}  // namespace vog
