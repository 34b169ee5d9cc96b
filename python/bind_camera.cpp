// bind_camera.cpp: Camera, and views that frame data.
#include <optional>
#include <string>

#include "arrays.h"
#include "data.h"
#include "picture_data.h"
#include "vog/camera.h"
#include "vog/cells.h"
#include "vog/error.h"
#include "vog/picture.h"

namespace vog::python {

namespace {

Camera make_camera(const Vec3d& eye, const Vec3d& look_at, const Vec3d& up, double fov_degrees,
                   double orthographic_width) {
    const Camera camera{eye, look_at, up, fov_degrees, orthographic_width};
    (void)frame_of(camera, 1, 1);  // throws for a degenerate camera
    return camera;
}

py::tuple state_of(const Camera& camera) {
    return py::make_tuple(camera.eye, camera.look_at, camera.up, camera.fov_degrees,
                          camera.orthographic_width);
}

std::string repr(const Camera& camera) {
    return "vog.Camera" + py::repr(state_of(camera)).cast<std::string>();
}

}  // namespace

Vec3d direction_of(const py::object& up) {
    if (!py::isinstance<py::str>(up)) {
        const auto given = cast_to<Vec3d>(up, "up", "x, y, z, -x, -y, -z or (x, y, z)");
        if (given == Vec3d{}) throw Error("up (0, 0, 0), expected a direction");
        return given;
    }
    const auto name = up.cast<std::string>();
    const std::string axis = name.size() == 1 ? "+" + name : name;
    if (axis.size() != 2 || (axis[0] != '+' && axis[0] != '-') || axis[1] < 'x' || axis[1] > 'z')
        throw Error("up '" + name + "', expected x, y, z, -x, -y, -z or (x, y, z)");
    Vec3d direction;
    direction[axis[1] - 'x'] = axis[0] == '+' ? 1 : -1;
    return direction;
}

Subject subject_to_view(const py::object& data, const std::string& call) {
    if (py::isinstance<Gaussians>(data)) return subject_of(data.cast<const Gaussians&>());
    if (py::isinstance<Points>(data)) return bounds(data.cast<const Points&>());
    if (py::isinstance<py::array>(data)) return box_of(data);
    if (py::isinstance<Cells>(data)) return scene_of_cells(data).subject;
    const auto of = [](std::span<const Volume> volumes) {
        Box box;
        for (const Volume& volume : volumes) box.include(world_box(volume));
        return subject_of(box, content_of(volumes, box));
    };
    if (py::isinstance<Volume>(data)) return of({&data.cast<const Volume&>(), 1});
    if (const auto levels = levels_of(data)) return of(levels->volumes);
    refuse_data(data, call, "Gaussians, a Volume, Levels, Cells, Points or corners [2, 3]");
}

void bind_camera(py::module_& m) {
    py::class_<Camera>(m, "Camera", R"(Pinhole or orthographic camera in world space.

eye          position (x, y, z), world units
look_at      point (x, y, z) at the centre of the picture; default the origin
up           direction (x, y, z) that points up in the picture; default y
fov_degrees  full vertical field of view of a pinhole camera, degrees, (0, 180)
orthographic_width
             width of an orthographic picture, world units, > 0; 0: a pinhole camera

Raises vog.Error where eye and look_at coincide, or up is parallel to the view direction.

>>> vog.Camera(eye=(0, 0, 5), fov_degrees=30).look_at
(0.0, 0.0, 0.0))")
        .def(py::init(&make_camera), py::arg("eye"), py::arg("look_at") = Vec3d{},
             py::arg("up") = Vec3d{0, 1, 0}, py::arg("fov_degrees") = kPaperFovDegrees,
             py::arg("orthographic_width") = 0.0)
        .def_static(
            "paper_view",
            [](const py::object& data) {
                return paper_view(subject_to_view(data, "paper_view").box);
            },
            py::arg("data"),
            R"(The standard view of docs/evaluation.md: azimuth 34.38 degrees, elevation 20.05 degrees,
distance 3 bounding radii, field of view 38.58 degrees. Returns a Camera.

data  Gaussians, a Volume, Levels, Cells, Points, or corners [2, 3] of a box in world space)")
        .def_static(
            "orbit",
            [](const py::object& data, std::optional<double> azimuth,
               std::optional<double> elevation, std::optional<double> distance, double fov_degrees,
               const std::optional<py::object>& up, double roll, bool orthographic,
               std::optional<double> width, double aspect, std::optional<std::string> view,
               const std::string& frame) {
                if (frame != "content" && frame != "data")
                    throw Error("orbit: frame '" + frame + "', expected 'content' or 'data'");
                Subject subject = subject_to_view(data, "orbit");
                if (frame == "data" || view == "paper")
                    subject.content.hull = Subject(subject.box).content.hull;
                Orbit orbit = up ? Orbit{} : first_orbit(subject);
                if (up) orbit.up = direction_of(*up);
                orbit.azimuth_degrees = azimuth.value_or(orbit.azimuth_degrees);
                orbit.elevation_degrees = elevation.value_or(orbit.elevation_degrees);
                orbit.distance_radii = distance.value_or(0);
                orbit.fov_degrees = fov_degrees;
                orbit.roll_degrees = roll;
                orbit.orthographic = orthographic || width;
                orbit.width = width.value_or(0);
                if ((distance && *distance == 0) || (width && *width == 0))
                    throw Error("camera: distance or width 0, expected a positive number");
                if (view) set_view(orbit, *view);
                if (distance) orbit.distance_radii = *distance;
                return orbit_view(subject, orbit, aspect);
            },
            py::arg("data"), py::arg("azimuth") = py::none(), py::arg("elevation") = py::none(),
            py::arg("distance") = py::none(), py::arg("fov_degrees") = kPaperFovDegrees,
            py::arg("up") = py::none(), py::arg("roll") = 0.0, py::arg("orthographic") = false,
            py::arg("width") = py::none(), py::arg("aspect") = 1.0, py::arg("view") = py::none(),
            py::arg("frame") = "content",
            R"(A view of the data from a sphere around it. Returns a Camera.

data          Gaussians, a Volume, Levels, Points, or corners [2, 3] of a box in world space
azimuth       angle of the eye about the up axis, degrees; y up: from x towards z; z up: from x
              towards -y. None: 34.38, from the front of scans of people
elevation     angle of the eye above the plane across the up axis, degrees, [-90, 90]; None: 20.05, 0 of
              scans of people
distance      from the box's centre, in bounding radii (half the box's diagonal); None: the
              distance at which what the data show fills 95 % of the picture
fov_degrees   full vertical field of view, degrees
up            direction that is upright in the data: "x", "y", "z", "-x", "-y", "-z" or (x, y, z);
              azimuth and elevation are measured about it. None: as the data's file says or implies
              (Volume.up), else y
roll          angle the camera is turned clockwise about its view direction, degrees
orthographic  parallel rays in place of a pinhole
width         width of an orthographic picture, world units; None: what the data show fills 95 %. A
              width makes the camera orthographic
aspect        width / height of the picture that a fitted box shall fill
view          "+x", "-x", "+y", "-y", "+z", "-z" (from that axis) or "paper", in place of azimuth
              and elevation
frame         what a fitted picture holds: "content", the part of the data with 99.9 % of their light
              as fog, or "data", their whole box

>>> camera = vog.Camera.orbit(vog.sample_cloud(64), view="+z", up="y", orthographic=True)
>>> camera.orthographic_width > 0, camera.eye[2] > camera.look_at[2]
(True, True))")
        .def_static(
            "load", [](const std::filesystem::path& file) { return read_camera(file); },
            py::arg("file"), "Reads a camera from JSON, as Camera.save writes it.")
        .def(
            "save",
            [](const Camera& self, const std::filesystem::path& file) { write_camera(file, self); },
            py::arg("file"), "Writes the camera as JSON, for `vog render --camera`.")
        .def_readwrite("eye", &Camera::eye, "Position (x, y, z), world units.")
        .def_readwrite("look_at", &Camera::look_at,
                       "Point (x, y, z) at the centre of the picture, world units.")
        .def_readwrite("up", &Camera::up, "Direction (x, y, z) that points up in the picture.")
        .def_readwrite("fov_degrees", &Camera::fov_degrees, "Full vertical field of view, degrees.")
        .def_readwrite("orthographic_width", &Camera::orthographic_width,
                       "Width of an orthographic picture, world units; 0: a pinhole camera.")
        .def("__eq__",
             [](const Camera& self, const py::object& other) {
                 return py::isinstance<Camera>(other) &&
                        state_of(self).equal(state_of(other.cast<const Camera&>()));
             })
        .def("__repr__", &repr)
        .def(py::pickle(&state_of, [](const py::tuple& s) {
            return make_camera(s[0].cast<Vec3d>(), s[1].cast<Vec3d>(), s[2].cast<Vec3d>(),
                               s[3].cast<double>(), s[4].cast<double>());
        }));
}

}  // namespace vog::python
