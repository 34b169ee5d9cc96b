// bind_voxelize.cpp: voxelize(): models back to volumes; isosurface(): their surfaces.
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <optional>

#include "arrays.h"
#include "data.h"
#include "vog/error.h"
#include "vog/surface.h"
#include "vog/voxelize.h"

namespace vog::python {

namespace {

/// Values of a field in the box of the volume: [X, Y, Z], of a vector [X, Y, Z, 3].
py::array_t<float> dense_field(const Volume& volume, const VoxelField& field) {
    const IndexBox box = active_box(volume);
    const Vec3i size = box.upper - box.lower + Vec3i{1, 1, 1};
    const std::size_t count = field.component.size();
    std::vector<py::ssize_t> shape{size.x, size.y, size.z};
    if (count > 1) shape.push_back(static_cast<py::ssize_t>(count));
    py::array_t<float> array(shape);
    float* const to = array.mutable_data();
    unlocked([&] {
        Volume one = volume;
        std::vector<float> values(static_cast<std::size_t>(size.x) *
                                  static_cast<std::size_t>(size.y) *
                                  static_cast<std::size_t>(size.z));
        for (std::size_t c = 0; c < count; ++c) {
            for (std::size_t n = 0; n < one.leaves.size(); ++n)
                one.leaves[n].value = field.component[c].leaf[n];
            copy_dense(one, box.lower, size, values);
            for (std::size_t n = 0; n < values.size(); ++n) to[n * count + c] = values[n];
        }
    });
    return array;
}

py::object voxelized(const Gaussians& model, const std::optional<double>& voxel_size,
                     const py::object& like, bool within, bool fields, const std::string& name,
                     const std::optional<std::filesystem::path>& file, const py::object& progress) {
    if (voxel_size.has_value() != like.is_none())
        throw Error("voxelize: expected voxel_size or like, one of them");
    if (within && like.is_none()) throw Error("voxelize: within goes with like");
    const bool one = py::isinstance<Volume>(like);
    const auto levels = one || voxel_size ? nullptr : levels_of(like);
    if (!one && !levels && !voxel_size)
        refuse_data(like, "voxelize", "a Volume, Levels or a list of Volumes as like");
    VoxelizeOptions options;
    options.name = name;
    options.fields = fields;
    options.progress = progress_of(progress);
    const Affine lattice =
        voxel_size ? voxel_lattice(model, *voxel_size)
                   : lattice_like(one ? std::span(&like.cast<const Volume&>(), 1) : levels->volumes,
                                  within ? &options.extent : nullptr);
    Voxelized made = unlocked([&] { return voxelize(model, lattice, options); });
    if (file) unlocked([&] { write_voxels(*file, made.volume, made.fields); });
    py::dict arrays;
    for (const VoxelField& field : made.fields)
        arrays[py::str(field.name)] = dense_field(made.volume, field);
    py::object volume = py::cast(std::move(made.volume));
    return fields ? py::object(py::make_tuple(volume, arrays)) : volume;
}

py::tuple triangles_of(const py::object& data, double value,
                       const std::optional<double>& voxel_size) {
    Surface surface;
    if (py::isinstance<Gaussians>(data)) {
        const Gaussians& model = data.cast<const Gaussians&>();
        surface = unlocked(
            [&] { return isosurface(surface_volume(model, voxel_size.value_or(0)), value); });
    } else if (py::isinstance<Volume>(data)) {
        if (voxel_size) throw Error("isosurface: voxel_size has no effect on a Volume");
        const Volume& volume = data.cast<const Volume&>();
        surface = unlocked([&] { return isosurface(volume, value); });
    } else {
        refuse_data(data, "isosurface", "a Volume or Gaussians");
    }
    const auto rows = [](const auto& of, auto number) {
        py::array_t<decltype(number)> array({static_cast<py::ssize_t>(of.size()), py::ssize_t{3}});
        std::memcpy(array.mutable_data(), of.data(), of.size() * sizeof(of.front()));
        return array;
    };
    return py::make_tuple(rows(surface.point, double{}), rows(surface.triangle, std::uint32_t{}));
}

}  // namespace

void bind_voxelize(py::module_& m) {
    m.def("voxelize", &voxelized, py::arg("model"), py::kw_only(),
          py::arg("voxel_size") = py::none(), py::arg("like") = py::none(),
          py::arg("within") = false, py::arg("fields") = false, py::arg("name") = "density",
          py::arg("file") = py::none(), py::arg("progress") = py::none(),
          R"(Volume of a model: averages of its Gaussians over voxels, of the same mass.

model       a Gaussians object
voxel_size  edge of cubic voxels along the world's axes, world units, > 0
like        Volume whose lattice the voxels have, in place of voxel_size: size, rotation, skew and alignment; of Levels the
            finest one
within      True: only voxels in the box around the active voxels of like
fields      True: the model's fields too, means over a voxel weighted by density
name        name of the volume
file        .vdb or .nvdb to write the volume and its fields to; None: not written
progress    called with the finished fraction, [0, 1]

Returns the Volume; with fields=True a pair of it and {name: array}, float32 [X, Y, Z] or [X, Y, Z, 3] over the
volume's index_box, 0 at inactive voxels (docs/voxelize.md).

>>> volume = vog.sample_cloud(64)
>>> back = vog.voxelize(vog.convert(volume, block=4), like=volume)
>>> abs(back.mass / volume.mass - 1) < 1e-3
True)");
    m.def(
        "isosurface", &triangles_of, py::arg("data"), py::arg("value"), py::kw_only(),
        py::arg("voxel_size") = py::none(),
        R"(Surface around the voxels of a volume above a value, closed: linear between voxel centres, 0 in inactive voxels.

data        Volume, or Gaussians, which are divided into voxels first
value       in the unit of the volume, above 0; of scans above their background
voxel_size  edge of a model's voxels, world units; None: one and a half times the median standard deviation of its Gaussians, at
            least a 256th of its box's longest edge

Returns (points, triangles): float64 [P, 3], world units, and uint32 [N, 3], counter-clockwise from outside.

>>> points, triangles = vog.isosurface(vog.sample_cloud(64), 0.2)
>>> bool(triangles.max() < len(points))
True)");
}

}  // namespace vog::python
