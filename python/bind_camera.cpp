// bind_camera.cpp: Camera, and views that frame data.
#include "arrays.h"
#include "data.h"
#include "vog/camera.h"
#include "vog/error.h"

namespace vog::python {

namespace {

Camera make_camera(const Vec3d& eye, const Vec3d& look_at, const Vec3d& up, double fov_degrees) {
    const Camera camera{eye, look_at, up, fov_degrees};
    (void)frame_of(camera, 1, 1);  // throws for a degenerate camera
    return camera;
}

py::tuple state_of(const Camera& camera) {
    return py::make_tuple(camera.eye, camera.look_at, camera.up, camera.fov_degrees);
}

std::string repr(const Camera& camera) {
    return "vog.Camera" + py::repr(state_of(camera)).cast<std::string>();
}

}  // namespace

Box box_to_view(const py::object& data, const std::string& call) {
    if (py::isinstance<Gaussians>(data)) return view_box(data.cast<const Gaussians&>());
    if (py::isinstance<Volume>(data)) return world_box(data.cast<const Volume&>());
    if (py::isinstance<Points>(data)) return bounds(data.cast<const Points&>());
    if (py::isinstance<py::array>(data)) return box_of(data);
    if (const auto levels = levels_of(data)) {
        Box box;
        for (const Volume& volume : levels->volumes) box.include(world_box(volume));
        return box;
    }
    refuse_data(data, call, "Gaussians, a Volume, Levels, Points or corners [2, 3]");
}

void bind_camera(py::module_& m) {
    py::class_<Camera>(m, "Camera", R"(Pinhole camera in world space.

eye          position (x, y, z), world units
look_at      point (x, y, z) at the centre of the picture; default the origin
up           direction (x, y, z) that points up in the picture; default y
fov_degrees  full vertical field of view, degrees, (0, 180)

Raises vog.Error where eye and look_at coincide, or up is parallel to the view direction.)")
        .def(py::init(&make_camera), py::arg("eye"), py::arg("look_at") = Vec3d{},
             py::arg("up") = Vec3d{0, 1, 0}, py::arg("fov_degrees") = kPaperFovDegrees)
        .def_static(
            "paper_view",
            [](const py::object& data) { return paper_view(box_to_view(data, "paper_view")); },
            py::arg("data"),
            R"(The standard view of docs/evaluation.md: azimuth 0.6 rad, elevation 0.35 rad, distance 3 bounding
radii, half the field of view atan(0.35). Returns a Camera.

data  Gaussians, a Volume, Levels, Points, or corners [2, 3] of a box in world space)")
        .def_static(
            "orbit",
            [](const py::object& data, double azimuth, double elevation, double distance,
               double fov_degrees) {
                return orbit_view(box_to_view(data, "orbit"), azimuth, elevation, distance,
                                  fov_degrees);
            },
            py::arg("data"), py::arg("azimuth") = kPaperAzimuthRad,
            py::arg("elevation") = kPaperElevationRad, py::arg("distance") = kPaperDistanceRadii,
            py::arg("fov_degrees") = kPaperFovDegrees,
            R"(A view of the data's bounding box from a sphere around it, with y up. Returns a Camera.

data         Gaussians, a Volume, Levels, Points, or corners [2, 3] of a box in world space
azimuth      angle of the eye about the y axis, from x towards z, radians
elevation    angle of the eye above the xz plane, radians
distance     from the box's centre, in bounding radii (half the box's diagonal)
fov_degrees  full vertical field of view, degrees)")
        .def_static(
            "load", [](const std::filesystem::path& file) { return read_camera(file); },
            py::arg("file"), "Reads a camera from JSON, as `vog render --save-camera` writes it.")
        .def(
            "save",
            [](const Camera& self, const std::filesystem::path& file) { write_camera(file, self); },
            py::arg("file"), "Writes the camera as JSON, for `vog render --camera`.")
        .def_readwrite("eye", &Camera::eye, "Position (x, y, z), world units.")
        .def_readwrite("look_at", &Camera::look_at,
                       "Point (x, y, z) at the centre of the picture, world units.")
        .def_readwrite("up", &Camera::up, "Direction (x, y, z) that points up in the picture.")
        .def_readwrite("fov_degrees", &Camera::fov_degrees, "Full vertical field of view, degrees.")
        .def("__eq__",
             [](const Camera& self, const py::object& other) {
                 return py::isinstance<Camera>(other) &&
                        state_of(self).equal(state_of(other.cast<const Camera&>()));
             })
        .def("__repr__", &repr)
        .def(py::pickle(&state_of, [](const py::tuple& s) {
            return make_camera(s[0].cast<Vec3d>(), s[1].cast<Vec3d>(), s[2].cast<Vec3d>(),
                               s[3].cast<double>());
        }));
}

}  // namespace vog::python
