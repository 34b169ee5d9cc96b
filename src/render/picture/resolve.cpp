// resolve.cpp: every default of a picture, from its scene.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "render/picture/request/request_effects.h"
#include "render/picture/slice_plane.h"
#include "shade/values/label_table.h"
#include "shade/values/unit_range.h"
#include "vog/distributed.h"
#include "vog/error.h"
#include "vog/picture.h"
#include "vog/text.h"
#include "vog/units.h"

namespace vog {

namespace {

/// A message about the scene's data.
Error about(const Scene& scene, const std::string& what) {
    return Error(scene.name.empty() ? what : scene.name + ": " + what);
}

/// Fields of a scene by name and unit, without numbers where they are at voxels.
Fields names_of(const Scene& scene) {
    if (!scene.has_voxels()) return scene.model().model->fields;
    Fields names;
    const auto add = [](auto& to, const SampledField& field) {
        auto& one = to.emplace_back();
        one.name = field.name, one.unit = field.unit;
    };
    for (const SampledField& field : scene.voxels().fields)
        field.is_vector ? add(names.vector, field) : add(names.scalar, field);
    return names;
}

FieldChoice field_of(const PictureRequest& request, const Scene& scene, const Fields& fields) {
    if (!request.field.empty()) {
        FieldChoice choice;
        try {
            choice = field_choice(request.field, fields);
        } catch (const Error& error) {
            const std::string text = error.what();
            // What a model's message goes on with: conversions that would carry the field.
            throw about(scene,
                        scene.has_cells() ? text.substr(0, text.find("; vog convert")) : text);
        }
        if (is_by_value(request.show) && choice.part != FieldPart::value)
            throw about(scene, fmt::format("'{}' is a vector field, show '{}' is of scalar fields",
                                           printable(choice.field), word_of(request.show)));
        return choice;
    }
    if (is_field_map(request.show))
        throw about(scene, fmt::format("show '{}' needs a field, the data have {}",
                                       word_of(request.show), scalar_names(fields)));
    if (const ScalarField* field =
            scene.has_voxels() ? scalar_to_begin_with(fields) : scalar_to_show(fields))
        return {field->name, FieldPart::value};
    throw about(scene, fmt::format("show '{}' needs one scalar field, the data have {}",
                                   word_of(request.show), scalar_names(fields)));
}

std::string unit_of(const Fields& fields, const std::string& field) {
    if (const ScalarField* scalar = fields.find_scalar(field)) return scalar->unit;
    const VectorField* vector = fields.find_vector(field);
    return vector ? vector->unit : "";
}

/// Factor from the unit that the data state to the requested one; 1 where one of the two is not known.
double factor_between(const std::string& stated, const std::string& requested) {
    if (stated.empty() || requested.empty()) return 1;
    if (const std::optional<double> factor = unit_factor(stated, requested)) return *factor;
    throw RequestError(
        "units",
        fmt::format(" {}: the data are in {}, expected a unit that it converts to, or none",
                    requested, stated));
}

/// Name and background of the density on a slice.
/// returns  its unit
std::string name_density(ResolvedPicture& picture, const Scene& scene) {
    const std::string per_area = " per area", &column = scene.column;
    picture.name = column.ends_with(per_area)
                       ? column.substr(0, column.size() - per_area.size()) + " per volume"
                       : "density";
    std::string unit = scene.subject.content.units.density;
    double ends[2] = {0, 0};  // minus the least, and the largest background
    const auto take = [&](const std::string& name, const std::string& of_field, double background) {
        ends[0] = -background, ends[1] = background;
        if (!name.empty()) picture.name = name;
        if (!of_field.empty()) unit = of_field;
    };
    if (!scene.has_voxels()) {
        const ScalarField* field = scalar_to_show(scene.model().model->fields);
        if (field && field->is_measure) take(field->name, field->unit, field->background);
    } else if (const auto& volumes = scene.voxels().volumes->volumes; !volumes.empty()) {
        const std::string& name = volumes.front().name;  // those of levels differ
        take(name == volumes.back().name ? name : "", "", volumes.front().background);
    }
    if (scene.collective && scene.collective->several()) scene.collective->max(ends);
    picture.background = -ends[0] < 0 ? -ends[0] : ends[1];
    return unit;
}

/// Magnitudes of gradients that are percentages, in the field's unit.
void state_magnitudes(ResolvedPicture& picture, const Scene& scene) {
    TransferRequest& transfer = picture.request.transfer;
    if (!std::exchange(transfer.gradient_of_steepest, false)) return;
    const bool several = scene.collective && scene.collective->several();
    const double steepest = several ? 0 : steepest_gradient(scene, picture.field.field);
    if (!(steepest > 0))
        throw RequestError("gradient_opacity",
                           several ? ": several processes need magnitudes, not percentages"
                           : scene.has_cells() ? ": cells need magnitudes, not percentages"
                                               : ": the field has no gradient");
    for (GradientOpacity& point : transfer.gradient) point.magnitude *= steepest;
}

/// Colour and opacity of a volume, and the request that states them.
void choose_light(ResolvedPicture& picture, const Scene& scene) {
    TransferRequest& transfer = picture.request.transfer;
    if (picture.request.fit != ScaleFit::automatic)
        transfer.log = picture.request.fit == ScaleFit::log;
    const VolumeLook& look = picture.request.look;
    if (has_gradient(transfer) && (look.shadows || look.occlusion) &&
        (scene.has_cells() ||
         (scene.has_voxels() && scene.collective && scene.collective->several())))
        throw RequestError("gradient_opacity",
                           scene.has_cells()
                               ? ": cells cast no shadows under it; convert them to a model"
                               : ": voxels of several processes cast no shadows under it; use one");
    state_magnitudes(picture, scene);
    const bool stated = transfer.window || !transfer.bands.empty();
    try {
        picture.chosen = choose_transfer(transfer, value_data(scene, picture.field.field));
    } catch (const RequestError&) {
        throw;
    } catch (const Error& error) {
        throw about(scene, error.what());
    }
    transfer.unit_distance = picture.chosen.transfer.unit_distance;
    if (stated || transfer.points.at_values) return;
    const ColorScale& scale = picture.chosen.scale;
    transfer.range.emplace(scale.low, scale.high);
    transfer.log = scale.kind == ColorScale::Kind::log;
    picture.request.fit = *transfer.log ? ScaleFit::log : ScaleFit::linear;
}

/// The request of one layer. Voxels of labels and those on planes are not interpolated.
PictureRequest request_of(const Layer& layer, const PictureRequest& whole, const Scene& data) {
    PictureRequest request = whole;
    request.layers.clear(), request.renderer.reset();
    if (data.has_voxels() || data.has_cells()) request.slabs.reset();
    if (!data.has_voxels() || layer.plane || shading::is_label_table(layer.transfer.points))
        request.options.voxels = {};
    request.field = layer.field, request.transfer = layer.transfer, request.fit = layer.fit;
    return request;
}

/// Opacities of layers of one file under one range compare: those that state no unit distance have the longest of theirs.
void share_unit_distances(ResolvedPicture& picture) {
    std::vector<Layer>& layers = picture.request.layers;
    const auto shares = [&](std::size_t n) {
        return layers[n].visible && !layers[n].plane && layers[n].transfer.range &&
               picture.layers[n].chosen.unit_distance == UnitDistance::of_map;
    };
    const auto unit = [&](std::size_t n) -> double& {
        return picture.layers[n].chosen.transfer.unit_distance;
    };
    for (std::size_t n = 0; n < layers.size(); ++n)
        for (std::size_t k = 0; k < layers.size(); ++k)
            if (shares(n) && shares(k) && layers[k].input == layers[n].input &&
                layers[k].transfer.range == layers[n].transfer.range)
                layers[n].transfer.unit_distance = unit(n) = std::max(unit(n), unit(k));
}

/// Each layer as a picture of its own, and the request that states them.
void resolve_layers(ResolvedPicture& picture, const Scene& scene) {
    PictureRequest& request = picture.request;
    if (scene.layers.size() != request.layers.size())
        throw RequestError("layers", fmt::format(": {} for {} data sets", request.layers.size(),
                                                 scene.layers.size()));
    std::string names;
    std::size_t first = 0;  // with values
    for (std::size_t n = 0; n < request.layers.size(); ++n) {
        Layer& layer = request.layers[n];
        ResolvedPicture& own = picture.layers.emplace_back();
        if (!layer.visible) continue;
        const Scene& data = scene.layers[n];
        require_layer_effects(layer, data.has_surface());
        if (data.has_surface()) continue;
        own = resolve(request_of(layer, request, data), data);
        if (!layer.field.empty()) layer.field = own.field.field;
        layer.transfer = own.request.transfer, layer.fit = own.request.fit;
        if (layer.plane) {
            own.request.plane = layer.plane = resolved_plane(*layer.plane, {}, data.subject);
            own.chosen.transfer = plane_transfer(std::move(own.chosen.transfer), layer);
        }
        if (names.empty()) first = n;
        names += (names.empty() ? "" : ", ") + field_label(own.field);
    }
    share_unit_distances(picture);
    if (!names.empty())
        picture.field = picture.layers[first].field, picture.chosen = picture.layers[first].chosen;
    require_interpolation(picture);
    picture.name = "volume of " + names;
}

}  // namespace

Scene scene_of_layers(std::vector<Scene> layers) {
    Scene scene;
    for (const Scene& layer : layers) {
        if (layer.sources.empty() || layer.has_surface()) continue;
        if (scene.sources.empty()) {
            scene = layer;
            continue;
        }
        require_same_length(
            layer.subject.content.units.length,
            layer.name.empty() ? fmt::format("layer {}", &layer - layers.data()) : layer.name,
            scene.subject.content.units.length,
            scene.name.empty() ? "the layers before" : scene.name);
        scene.subject.include(layer.subject);
    }
    if (scene.sources.empty())
        throw RequestError("layers",
                           " are all hidden or surfaces, expected a visible model or volume");
    for (const Scene& layer : layers)
        if (!layer.sources.empty() && layer.has_surface()) scene.subject.include(layer.subject);
    scene.layers = std::move(layers);
    return scene;
}

Scene scene_of(std::shared_ptr<const Gaussians> model, std::shared_ptr<const Hierarchy> hierarchy) {
    Scene scene;
    scene.subject = subject_of(*model);
    scene.name = model->source;
    scene.sources.push_back(ModelSource{std::move(model), std::move(hierarchy)});
    return scene;
}

Scene scene_of(Gaussians model) {
    return scene_of(std::make_shared<const Gaussians>(std::move(model)));
}

Scene scene_of(Volume volume) {
    VolumeSet set;
    set.volumes.push_back(std::move(volume));
    return scene_of(std::make_shared<const VolumeSet>(std::move(set)));
}

Scene scene_of(std::shared_ptr<const Surface> surface) {
    Scene scene;
    Box box;
    for (const Vec3d& point : surface->point) box.include(point);
    scene.subject = Subject(box);
    scene.sources.push_back(SurfaceSource{std::move(surface)});
    return scene;
}

Scene scene_of(std::shared_ptr<const VolumeSet> volumes) {
    Scene scene;
    Box box;
    for (const Volume& volume : volumes->volumes) box.include(world_box(volume));
    scene.subject = subject_of(box, content_of(volumes->volumes, box));
    VoxelSource source{volumes, {}};
    if (!volumes->is_mesh()) {
        SampledField own;
        for (const Volume& volume : volumes->volumes) {
            own.values.push_back(measure_field(volume));
            own.name = own.values.front().name == own.values.back().name ? own.values.back().name
                                                                         : "density";
        }
        source.fields.push_back(std::move(own));
    }
    scene.sources.push_back(std::move(source));
    return scene;
}

const char* default_map(Show show) {
    return show == Show::depth || show == Show::volume ? kDefaultMap : "inferno";
}

ResolvedPicture resolve(PictureRequest request, const Scene& scene) {
    ResolvedPicture picture;
    const bool models =
        !(scene.has_voxels() || scene.has_cells()) ||
        std::ranges::any_of(scene.layers, [](const Scene& s) {
            return !s.sources.empty() && !s.has_voxels() && !s.has_cells() && !s.has_surface();
        });
    const RenderInput input = models                              ? RenderInput::gaussians
                              : scene.has_cells()                 ? RenderInput::cells
                              : scene.voxels().volumes->is_mesh() ? RenderInput::levels
                                                                  : RenderInput::volumes;
    if (!request.renderer) request.renderer = renderer_for({}, input);
    (void)renderer_for(info_of(*request.renderer).name, input);
    require_renderer_effects(request, *request.renderer, input);
    if (request.options.trace.stop_transmittance > 0 && !request.extinction)
        throw RequestError("stop_transmittance",
                           ": transmittance depends on the extinction, and 'auto' is known only "
                           "after; expected `extinction` with a number");
    if (const auto& range = request.transfer.range;
        range && request.fit == ScaleFit::log && !(range->first > 0))
        throw RequestError("range", fmt::format(" {},{}: expected values above 0 with `scale` log",
                                                range->first, range->second));
    request.options.trace.extinction = request.extinction.value_or(1);
    // Models that are fitted to values have ripples in their density.
    if (request.show == Show::slice && request.field.empty() && request.layers.empty() &&
        !scene.has_voxels() && scene.subject.content.by_value)
        if (const ScalarField* own = scalar_to_show(scene.model().model->fields))
            request.field = own->name;
    if (request.show == Show::slice && request.plane)
        request.plane = resolved_plane(*request.plane, request.thickness, scene.subject);
    if (!request.camera && request.show == Show::slice && request.plane)
        request.camera = slice_view(scene.subject, *request.plane, request.width, request.height,
                                    request.marks.axes ? kShareWithAxes : 1);
    if (!request.camera)
        request.camera =
            default_view(shown_by(request, scene.subject), request.width, request.height);
    VolumeLook& look = request.look;
    if (look.studio) {
        look.shadows = look.occlusion = true, look.studio = false;
        look.octaves = std::max(look.octaves, kStudioOctaves);
    }
    if (look.shadows && !look.light && look.lights.empty())
        look.lights = {{studio_light(*request.camera)}};
    const Show show = request.show;
    const Units& units = scene.subject.content.units;
    if (!request.layers.empty()) {
        picture.request = std::move(request);
        resolve_layers(picture, scene);
        return picture;
    }
    picture.name = show == Show::depth ? "T" : scene.column;
    std::string stated = show == Show::column ? unit_product(units.density, units.length) : "";
    if (shows_field(request)) {
        const Fields fields = names_of(scene);
        picture.field = field_of(request, scene, fields);
        const std::string label = field_label(picture.field);
        picture.name = show == Show::volume ? "volume of " + label : quantity_label(show, label);
        stated = unit_of(fields, picture.field.field);
    }
    if (show == Show::slice && request.field.empty()) stated = name_density(picture, scene);
    picture.unit = request.unit.empty() ? stated : request.unit;
    picture.factor = factor_between(stated, request.unit);
    picture.unit_is_label = stated.empty() && !request.unit.empty();
    picture.request = std::move(request);
    TransferRequest& transfer = picture.request.transfer;
    if (show == Show::slice && transfer.window) {
        const auto [center, width] = *std::exchange(transfer.window, std::nullopt);
        const ValueTransfer window = window_transfer(center, width, 1);
        transfer.range.emplace(window.color.front().value, window.color.back().value);
        transfer.points = transfer_points("gray");
    }
    if (transfer.points.points.color.empty() && !transfer.window && transfer.bands.empty())
        transfer.points = transfer_points(named_transfer_function(default_map(show)));
    (void)stated_scale(picture.request);  // checks it
    if (show == Show::volume)
        choose_light(picture, scene);
    else
        picture.colors = shading::over_unit_range(transfer.points);
    return picture;
}

ResolvedPicture recolored(ResolvedPicture picture, PictureRequest request) {
    const TransferPoints& points = request.transfer.points;
    // The range of the picture before is not that of points at values.
    if (points.at_values && request.transfer.range == picture.request.transfer.range)
        request.transfer.range.reset(), request.fit = ScaleFit::automatic;
    if (request.show != Show::volume)
        picture.colors = shading::over_unit_range(points);
    else if (points.points != picture.request.transfer.points.points ||
             request.transfer.range != picture.request.transfer.range ||
             request.transfer.gradient != picture.request.transfer.gradient ||
             request.fit != picture.request.fit)
        throw Error("the light of a volume is drawn under its transfer function: draw it again");
    picture.request = std::move(request);
    picture.factor = 1;
    return picture;
}

}  // namespace vog
