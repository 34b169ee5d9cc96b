// views.cpp: cameras of a turn, scales that its pictures share, and names of files.
#include "pictures/views.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "files/sequence.h"
#include "terminal/terminal.h"
#include "vog/error.h"

namespace vog::cli {

namespace fs = std::filesystem;

namespace {

/// Place of "%d" or "%04d" in the name of a file.
struct NumberPlace {
    std::size_t at = std::string::npos, end = 0;
    int digits = 0;
};
NumberPlace number_place(const std::string& text) {
    NumberPlace place{text.find('%')};
    if (place.at == std::string::npos) return place;
    place.end = place.at + 1;
    while (place.end < text.size() && std::isdigit(static_cast<unsigned char>(text[place.end])))
        place.digits = std::min(10 * place.digits + (text[place.end++] - '0'), 99);
    const bool valid = place.end < text.size() && text[place.end] == 'd' && place.digits <= 9;
    if (!valid || text.find('%', place.end) != std::string::npos) return {};
    ++place.end;
    return place;
}

/// Rotation by Rodrigues' formula; axis of unit length.
Vec3d rotated(Vec3d v, Vec3d axis, double angle_rad) {
    const double c = std::cos(angle_rad), s = std::sin(angle_rad);
    return c * v + s * cross(axis, v) + ((1 - c) * dot(axis, v)) * axis;
}

/// Eye and up turned about the point looked at.
Camera turned(const Camera& camera, Vec3d axis, double angle_rad) {
    Camera result = camera;
    result.eye = camera.look_at + rotated(camera.eye - camera.look_at, axis, angle_rad);
    result.up = rotated(camera.up, axis, angle_rad);
    return result;
}

/// Cameras of a turn from its first.
std::vector<Camera> turn_of(const Camera& first, Vec3d up, int count) {
    std::vector<Camera> cameras;
    for (int n = 0; n < count; ++n)
        cameras.push_back(turned(first, up, 2 * std::numbers::pi * n / count));
    return cameras;
}

/// Whether no option sets how large the data appear.
bool is_fitted(const GivenOptions& command, const Camera& camera) {
    if (command.has_any({"--camera", "--eye"})) return false;
    if (command.value("--view") == "paper") return false;
    return !command.has(camera.orthographic() ? "--width" : "--distance");
}

/// The first camera, as far (or as wide) as the farthest fitted one of the turn.
Camera fitted_to_turn(const Camera& first, Vec3d up, int count, const Subject& subject,
                      double aspect) {
    Camera result = first;
    double farthest = 0;
    for (const Camera& camera : turn_of(result, up, count)) {
        const Camera fit = fitted(camera, subject, aspect, false);
        farthest = std::max(farthest, length(fit.eye - fit.look_at));
        result.orthographic_width = std::max(result.orthographic_width, fit.orthographic_width);
    }
    if (!first.orthographic())
        result.eye = result.look_at + farthest * normalized(first.eye - first.look_at);
    return result;
}

/// Axis of the turn: --up, or upwards in the picture of --camera.
Vec3d turn_axis(const RenderArguments& arguments, const GivenOptions& command, const Camera& camera,
                const Subject& subject) {
    return normalized(command.has("--camera") || keeps_stored(arguments.view, command)
                          ? camera.up
                          : up_of(arguments.view, subject));
}

/// Creates the folder of an output that is one.
void create_folder(const std::string& output) {
    if (output.empty() || !is_sequence(output)) return;
    std::error_code code;
    fs::create_directories(output, code);
    if (std::error_code ignored; !fs::is_directory(output, ignored))
        throw Error(fmt::format("{}: cannot create this folder: {}", output, code.message()));
}

}  // namespace

bool is_numbered(const std::string& output) {
    return number_place(fs::path(output).filename().string()).at != std::string::npos;
}

std::vector<std::string> numbered_outputs(const std::string& output, int count,
                                          const std::string& extension) {
    const fs::path path(output);
    const std::string name = is_sequence(output) ? "%04d" + extension : path.filename().string();
    const fs::path folder = is_sequence(output) ? path : path.parent_path();
    const NumberPlace place = number_place(name);
    std::vector<std::string> outputs;
    for (int n = 1; n <= count; ++n)
        outputs.push_back(output.empty() || place.at == std::string::npos
                              ? output
                              : (folder / fmt::format("{}{:0{}}{}", name.substr(0, place.at), n,
                                                      place.digits, name.substr(place.end)))
                                    .string());
    return outputs;
}

Camera first_camera(const RenderArguments& arguments, const GivenOptions& command,
                    const Subject& subject) {
    return camera_from(arguments.view, command, arguments.subject.value_or(subject),
                       arguments.request,
                       double(arguments.request.width) / arguments.request.height);
}

std::vector<RenderedPicture> render_views(const RenderArguments& arguments,
                                          const GivenOptions& command, const Subject& subject,
                                          const DrawView& draw) {
    const double aspect = double(arguments.request.width) / arguments.request.height;
    const Subject shown =
        framed(arguments.view, arguments.subject.value_or(subject), arguments.request);
    const bool stored = keeps_stored(arguments.view, command);
    Camera first = first_camera(arguments, command, subject);
    std::vector<Camera> cameras{first};
    std::vector<std::string> outputs{arguments.output}, depths{arguments.depth_output},
        values{arguments.values_output};
    if (const int count = arguments.turntable) {
        const Vec3d up = turn_axis(arguments, command, first, shown);
        if (!stored && is_fitted(command, first)) {
            // About the middle of the data where no option states a point.
            const Vec3d towards = first.look_at - first.eye;
            if (!command.has("--look-at"))
                first.look_at = orbit_view(shown, {.distance_radii = 1}).look_at;
            first.eye = first.look_at - towards;
            first = fitted_to_turn(first, up, count, shown, aspect);
        }
        cameras = turn_of(first, up, count);
        for (const std::string& output :
             {arguments.output, arguments.depth_output, arguments.values_output})
            create_folder(output);
        outputs = numbered_outputs(arguments.output, count, ".png");
        depths = numbered_outputs(arguments.depth_output, count, ".exr");
        values = numbered_outputs(arguments.values_output, count, ".npy");
        if (const auto& part = arguments.turn_part) {
            const auto keep = [&](auto& all) {
                all.erase(all.begin() + part->second, all.end());
                all.erase(all.begin(), all.begin() + part->first);
            };
            keep(cameras), keep(outputs), keep(depths), keep(values);
        }
    }
    RenderArguments one = arguments;
    std::vector<RenderedPicture> pictures;
    for (std::size_t n = 0; n < cameras.size(); ++n) {
        one.output = outputs[n];
        one.depth_output = depths[n];
        one.values_output = values[n];
        std::optional<RenderedPicture> picture = draw(one, cameras[n]);
        if (!picture) continue;
        if (n == 0 && cameras.size() > 1) one.shared = picture->scales;
        pictures.push_back(std::move(*picture));
    }
    return pictures;
}

void save_picture(const RenderArguments& arguments, const Image& picture,
                  const std::string& record) {
    if (arguments.take_picture)
        arguments.take_picture(picture);
    else
        write_image(arguments.output, picture, record);
}

}  // namespace vog::cli
