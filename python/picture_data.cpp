// picture_data.cpp: scenes of models, particles and voxels with a shown field.
#include "picture_data.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "arrays.h"
#include "data.h"
#include "sampled_fields.h"
#include "vog/cells.h"
#include "vog/convert_cells.h"
#include "vog/convert_points.h"
#include "vog/error.h"
#include "vog/lod.h"
#include "voxel_fields.h"

namespace vog::python {

namespace {

/// A field at voxels, or of a vector field the part that a name asks for.
SampledField shown_part(std::vector<VoxelField> values, const std::string& name,
                        const std::vector<Volume>& volumes) {
    if (values.front().is_vector()) {
        const std::string& vector = values.front().name;
        const std::string part = name.size() > vector.size() ? name.substr(vector.size() + 1) : "";
        if (part != "x" && part != "y" && part != "z" && part != "magnitude")
            throw Error("no scalar field '" + name + "' in fields, expected '" + vector +
                        ".x', .y, .z or .magnitude");
        for (std::size_t n = 0; n < values.size(); ++n)
            values[n] = component_of(std::move(values[n]), part, volumes[n]);
    } else if (!name.empty() && values.front().name != name) {
        throw Error("no scalar field '" + name + "' in fields");
    }
    return {values.front().name, values.front().unit, false, std::move(values)};
}

/// Whether a call's fields have one of this name, or the vector field that it is a part of.
bool has_field(const py::object& fields, const std::string& name) {
    if (!py::isinstance<py::dict>(fields) || name.empty()) return false;
    const std::string vector = name.substr(0, name.rfind('.'));
    return fields.contains(name) || fields.contains(vector);
}
/// Whether a name, or none, is that of the data's own values.
bool is_own(const std::string& name, const std::vector<Volume>& volumes) {
    return name.empty() || name == "density" || name == volumes.front().name;
}

/// Parts of voxels that do not hide each other, with the scalar field that is shown.
VoxelSource parts_by_value(const py::object& data, const py::object& fields,
                           PictureRequest& request) {
    const std::string& name = request.field;
    const bool given = has_field(fields, name);
    SampledFields sampled = sampled_fields(
        data, given ? py::object(one_field(fields, name, "render")) : py::none(), "render");
    if (!given && !is_own(name, sampled.volumes))
        (void)one_field(fields, name, "render");  // throws
    VoxelSource source;
    // The data's own values stand behind a given field.
    source.fields.push_back(
        shown_part(std::move(sampled.values.front()), given ? name : "", sampled.volumes));
    if (!name.empty()) request.field = source.fields.front().name;
    auto set = std::make_shared<VolumeSet>();
    set->volumes = std::move(sampled.volumes);
    source.volumes = std::move(set);
    return source;
}

/// All voxels, with the field of a map.
VoxelSource voxels_of(const py::object& data, const py::object& fields,
                      const PictureRequest& request) {
    auto set = std::make_shared<VolumeSet>();
    if (py::isinstance<Volume>(data)) {
        set->volumes.push_back(data.cast<const Volume&>());
    } else {
        static_cast<Levels&>(*set) = *levels_of(data);
        set->overlap = Overlap::hide;
    }
    VoxelSource source;
    const std::string& name = request.field;
    if (shows_field(request) && !has_field(fields, name) && is_own(name, set->volumes)) {
        SampledField& field = source.fields.emplace_back(SampledField{name, "", false, {}});
        for (const Volume& volume : set->volumes)
            field.values.push_back(measure_field(volume, name));
    } else if (shows_field(request)) {
        auto values = voxel_fields_of(one_field(fields, name, "render"), set->volumes,
                                      lattices_of(set->volumes), set->volumes.size(), "render");
        const VoxelField& first = values.front().front();
        source.fields.push_back({first.name, first.unit, first.is_vector(), {}});
        source.fields.front().values = std::move(values.front());
    }
    source.volumes = std::move(set);
    return source;
}

/// throws  vog::Error unless a model has a scalar field to show where the request names none
void require_scalar(const Gaussians& model, const PictureRequest& request) {
    if (!is_by_value(request.show) || !request.field.empty() || scalar_to_show(model.fields))
        return;
    throw Error("no field named, the model has " + scalar_names(model.fields) +
                " (convert(volume, fields=...) makes them)");
}

ModelSource model_of(const py::object& data, const PictureRequest& request) {
    std::shared_ptr<Gaussians> model;
    if (py::isinstance<Points>(data)) {
        if (shows_field(request))
            throw Error("a field of particles, expected a model or voxels: convert() them");
        const auto& points = data.cast<const Points&>();
        model = unlocked([&] { return std::make_shared<Gaussians>(convert_points(points)); });
    } else {
        model = data.cast<std::shared_ptr<Gaussians>>();
        require_scalar(*model, request);
    }
    if (!request.options.pixel_error || is_by_value(request.show)) return {model, nullptr};
    return unlocked([&] {  // sorts its model
        auto sorted = std::make_shared<Gaussians>(*model);
        auto hierarchy = std::make_shared<const Hierarchy>(build_hierarchy(*sorted));
        return ModelSource{std::move(sorted), std::move(hierarchy)};
    });
}

}  // namespace

bool is_gaussians(const py::object& data) {
    return py::isinstance<Gaussians>(data) || py::isinstance<Points>(data);
}

std::shared_ptr<const Surface> surface_of(const py::object& data) {
    if (!py::isinstance<py::tuple>(data) || py::len(data) != 2 ||
        !py::isinstance<py::array>(data[py::int_(0)]))
        return nullptr;
    const auto points = vector_of<Vec3d, double>(data[py::int_(0)], "points");
    const py::array corners = numbers_of(data[py::int_(1)], "triangles");
    if (corners.ndim() != 2 || corners.shape(1) != 3 || corners.shape(0) == 0)
        throw Error("triangles: shape " + shape_text(corners) +
                    ", expected [N, 3] numbers of points, at least one triangle");
    if (corners.dtype().kind() != 'i' && corners.dtype().kind() != 'u')
        throw Error("triangles: numbers with a point, expected whole numbers of points");
    const py::array_t<std::int64_t, py::array::c_style | py::array::forcecast> rows(corners);
    Surface surface{{points.begin(), points.end()}, {}, {}};
    const auto count = static_cast<std::int64_t>(surface.point.size());
    for (py::ssize_t n = 0; n < rows.shape(0); ++n) {
        auto& triangle = surface.triangle.emplace_back();
        for (py::ssize_t c = 0; c < 3; ++c) {
            const std::int64_t at = rows.at(n, c);
            if (at < 0 || at >= count)
                throw Error("triangles: row " + std::to_string(n) + " has point " +
                            std::to_string(at) + ", expected 0 to " + std::to_string(count - 1));
            const Vec3d& point = surface.point[static_cast<std::size_t>(at)];
            if (!std::isfinite(length(point)))
                throw Error("points: row " + std::to_string(at) +
                            " is not finite, and a triangle has it");
            triangle[static_cast<std::size_t>(c)] = static_cast<std::uint32_t>(at);
        }
    }
    return std::make_shared<const Surface>(std::move(surface));
}

void require_drawable(const py::object& data, const py::object& fields) {
    if (surface_of(data)) {
        if (!fields.is_none()) throw Error("render: fields: of voxels, a surface has none");
        return;
    }
    const bool cells = py::isinstance<Cells>(data);
    if (!is_gaussians(data) && !cells && !py::isinstance<Volume>(data) && !levels_of(data))
        refuse_data(data, "render",
                    "Gaussians, a Volume, Levels, a list of Volumes, Cells or Points");
    if ((is_gaussians(data) || cells) && !fields.is_none())
        throw Error(std::string("render: fields: of voxels, ") +
                    (cells ? "cells have their own" : "a model has its own"));
}

Scene scene_of_cells(const py::object& data) {
    const auto cells = data.cast<std::shared_ptr<Cells>>();
    CellNotes notes;
    Scene scene = unlocked([&] { return scene_of(std::shared_ptr<const Cells>(cells), &notes); });
    if (const std::string text = notes_text(notes, *cells); !text.empty()) warn({text});
    return scene;
}

Scene scene_of_data(const py::object& data, const py::object& fields, PictureRequest& request) {
    const bool gaussians = is_gaussians(data);
    if (auto surface = surface_of(data)) return scene_of(std::move(surface));
    if (py::isinstance<Cells>(data)) return scene_of_cells(data);
    if (is_field_map(request.show) && request.field.empty())
        throw Error(std::string("show '") + word_of(request.show) +
                    "': expected field, the name of one");
    Scene scene;
    if (gaussians)
        scene.sources.push_back(model_of(data, request));
    else if (is_by_value(request.show))
        scene.sources.push_back(parts_by_value(data, fields, request));
    else
        scene.sources.push_back(voxels_of(data, fields, request));
    if (py::isinstance<Points>(data)) {
        scene.subject = subject_of(*scene.model().model);
        scene.column = "number per area";
    } else {
        scene.subject = subject_to_view(data, "render");
    }
    return scene;
}

}  // namespace vog::python
