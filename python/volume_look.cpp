// volume_look.cpp: transfer functions of values, light and clips of pictures, and lists of numbers, from Python.
#include "volume_look.h"

#include <tuple>

#include "arrays.h"
#include "vog/error.h"

namespace vog::python {

std::vector<double> numbers_in(const py::object& list, std::size_t count, const std::string& what) {
    const auto given =
        py::array_t<double, py::array::c_style | py::array::forcecast>(numbers_of(list, what));
    if (static_cast<std::size_t>(given.size()) != count)
        throw Error(what + ": " + std::to_string(given.size()) + " numbers, expected " +
                    std::to_string(count));
    return {given.data(), given.data() + given.size()};
}

py::iterable rows_in(const py::object& list, const std::string& what) {
    if (!py::isinstance<py::iterable>(list))
        throw py::type_error(what + ": got " + described(list) + ", expected a list of rows");
    return list;
}

TransferRequest transfer_request(const ValueArguments& a) {
    const auto label = [&](const char* name) { return std::string(a.call) + ": " + name; };
    const auto pair = [&](const py::object& given, const char* name) {
        const std::vector<double> two = numbers_in(given, 2, label(name));
        return std::pair{two[0], two[1]};
    };
    TransferRequest request;
    request.log = a.log;
    if (!a.unit_distance.is_none())
        request.unit_distance =
            cast_to<double>(a.unit_distance, label("unit_distance"), "a length > 0, world units");
    if (!a.value_range.is_none()) request.range = pair(a.value_range, a.range_name);
    if (!a.window.is_none()) request.window = pair(a.window, "window");
    if (!a.bands.is_none()) {
        for (const py::handle row : rows_in(a.bands, label("bands"))) {
            const auto [lower, upper, colour, opacity] =
                cast_to<std::tuple<double, double, py::object, double>>(
                    row, label("bands"), "rows (lower, upper, (r, g, b), opacity)");
            const std::vector<double> c = numbers_in(colour, 3, label("bands: colour"));
            request.bands.push_back({lower, upper, static_cast<float>(c[0]),
                                     static_cast<float>(c[1]), static_cast<float>(c[2]), opacity});
        }
        if (request.bands.empty()) throw Error(label("bands: no row, expected at least one"));
    }
    const bool named = py::isinstance<py::str>(a.tf);
    if (request.window || !request.bands.empty()) {
        const bool usual = named && a.tf.cast<std::string>() == kDefaultMap;
        if (request.range || request.log || !usual)
            throw Error(label(request.range ? a.range_name
                              : request.log ? "scale"
                                            : "tf") +
                        " has no effect with window and bands, which state colours and values");
        return request;
    }
    // A file may state values and a unit distance.
    if (named || py::hasattr(a.tf, "__fspath__"))
        request.points =
            transfer_points(cast_to<std::filesystem::path>(a.tf, label("tf"), "a path").string());
    else
        request.map = transfer_function_of(a.tf);
    return request;
}

VolumeLook look_of(const std::string& function, const py::object& light, const py::object& clip,
                   const py::object& clip_planes) {
    VolumeLook look;
    look.light = !light.is_none();
    if (look.light && !py::isinstance<py::str>(light)) {
        const std::vector<double> towards = numbers_in(light, 3, function + ": light");
        look.towards_light = {towards[0], towards[1], towards[2]};
        if (look.towards_light == Vec3d{})
            throw Error(function + ": light (0, 0, 0), expected 'head' or a direction");
    } else if (look.light && light.cast<std::string>() != "head") {
        throw Error(function + ": light '" + light.cast<std::string>() +
                    "', expected 'head' or a direction");
    }
    if (!clip.is_none()) {
        const std::vector<double> c = numbers_in(clip, 6, function + ": clip");
        look.clip.box = Box{{c[0], c[1], c[2]}, {c[3], c[4], c[5]}};
    }
    if (!clip_planes.is_none())
        for (const py::handle row : rows_in(clip_planes, function + ": clip_planes")) {
            const std::vector<double> p =
                numbers_in(py::reinterpret_borrow<py::object>(row), 4, function + ": clip_planes");
            look.clip.planes.push_back({{p[0], p[1], p[2]}, p[3]});
        }
    return look;
}

}  // namespace vog::python
