// bind_volume.cpp: Volume and Levels: files, NumPy arrays, pickles.
#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <set>

#include "arrays.h"
#include "data.h"
#include "vog/dense.h"
#include "vog/error.h"
#include "vog/scan_io.h"
#include "vog/volume_io.h"
#include "voxel_fields.h"

namespace vog::python {

namespace {

Vec3i index_of(const std::array<int, 3>& i) { return {i[0], i[1], i[2]}; }
py::tuple tuple_of(Vec3i v) { return py::make_tuple(v.x, v.y, v.z); }

/// Strides in elements, of an array of whole_strides().
std::array<std::ptrdiff_t, 3> strides_of(const py::array& array) {
    std::array<std::ptrdiff_t, 3> strides{};
    for (int axis = 0; axis < 3; ++axis)
        strides[static_cast<std::size_t>(axis)] = array.strides(axis) / array.itemsize();
    return strides;
}
/// The array itself, or a copy where strides or address are no multiples of the element size.
py::array whole_strides(py::array array) {
    bool whole = true;
    for (int axis = 0; axis < array.ndim(); ++axis)
        whole = whole && array.strides(axis) % array.itemsize() == 0;
    const auto address = reinterpret_cast<std::uintptr_t>(array.data());
    if (whole && address % static_cast<std::uintptr_t>(array.itemsize()) == 0) return array;
    return array.attr("copy")();
}

/// Dense densities and, optionally, active flags; keeps both arrays alive.
struct Block {
    py::array value, active;
    DenseBlock dense;
};

Block block_of(const py::handle& data, const py::object& active, Vec3i first,
               const std::string& name) {
    Block block;
    const py::array array = numbers_of(data, name);
    if (array.ndim() != 3)
        throw Error(name + ": shape " + shape_text(array) + ", expected 3 axes, (x, y, z)");
    // Any order of axes is read where it lies: float32 arrays are not copied.
    block.value = whole_strides(array.attr("astype")("float32", "K", "unsafe", false, false));
    block.dense.value = static_cast<const float*>(block.value.data());
    block.dense.stride = strides_of(block.value);
    for (int axis = 0; axis < 3; ++axis)
        block.dense.size[axis] = static_cast<std::int32_t>(
            std::min<py::ssize_t>(array.shape(axis), std::numeric_limits<std::int32_t>::max()));
    block.dense.first = first;
    if (active.is_none()) return block;
    const py::array mask = py::array::ensure(active);
    if (!mask || mask.dtype().kind() != 'b' || !mask.attr("shape").equal(array.attr("shape")))
        throw Error(name + ": active: expected a bool array of shape " + shape_text(array));
    block.active = mask;
    block.dense.active = static_cast<const std::uint8_t*>(mask.data());
    block.dense.active_stride = strides_of(mask);
    return block;
}

Affine affine_of(const py::object& voxel_size, const py::object& origin, const py::object& matrix) {
    if (!matrix.is_none()) {
        if (!voxel_size.is_none() || !origin.is_none())
            throw Error("matrix and voxel_size or origin exclude each other");
        const py::array_t<double> rows = rows_of<double>(matrix, "matrix", 4);
        if (rows.shape(0) != 4)
            throw Error("matrix: shape " + shape_text(rows) + ", expected (4, 4)");
        return affine_from_matrix(std::span<const double, 16>(rows.data(), 16));
    }
    const auto vector = [](const py::object& object, const char* what) {
        return cast_to<Vec3d>(object, what, "three numbers");
    };
    Vec3d edge{1, 1, 1}, zero;
    if (!voxel_size.is_none()) {
        const double one = PyFloat_AsDouble(voxel_size.ptr());
        const bool is_number = !PyErr_Occurred();
        PyErr_Clear();
        edge = is_number ? Vec3d{one, one, one} : vector(voxel_size, "voxel_size");
    }
    if (!origin.is_none()) zero = vector(origin, "origin");
    return affine_from_voxels(edge, zero);
}

std::shared_ptr<Volume> volume_from(const std::vector<Block>& blocks, const Affine& map,
                                    const std::string& name, const ValueRules& rules) {
    std::vector<DenseBlock> dense;
    for (const Block& block : blocks) dense.push_back(block.dense);
    ValueNotes notes;
    auto volume = std::make_shared<Volume>(
        unlocked([&] { return volume_from_dense(dense, map, name, rules, &notes); }));
    if (const std::string text = values_text(notes, name); !text.empty()) warn({text});
    return volume;
}

std::shared_ptr<Volume> from_numpy(const py::object& array, const py::object& voxel_size,
                                   const py::object& origin, const py::object& matrix,
                                   const py::object& active, const std::array<int, 3>& first,
                                   const std::string& name, bool skip_nonfinite,
                                   bool clip_negative) {
    std::vector<Block> blocks;
    blocks.push_back(block_of(array, active, index_of(first), name));
    return volume_from(blocks, affine_of(voxel_size, origin, matrix), name,
                       {skip_nonfinite, clip_negative});
}

std::shared_ptr<Volume> from_blocks(const py::iterable& pairs, const py::object& voxel_size,
                                    const py::object& origin, const py::object& matrix,
                                    bool all_active, const std::string& name, bool skip_nonfinite,
                                    bool clip_negative) {
    std::vector<Block> blocks;
    for (const py::handle pair : pairs) {
        const auto [first, array] = cast_to<std::pair<std::array<int, 3>, py::object>>(
            pair, "blocks", "pairs ((i, j, k), array)");
        py::object active = py::none();
        if (all_active)
            active = py::module_::import("numpy").attr("ones")(
                numbers_of(array, name).attr("shape"), "bool");
        blocks.push_back(block_of(array, active, index_of(first), name));
    }
    return volume_from(blocks, affine_of(voxel_size, origin, matrix), name,
                       {skip_nonfinite, clip_negative});
}

/// Volume of arrays that are read one after another and share no leaf.
std::shared_ptr<Volume> from_parts(const py::iterable& parts, const py::object& matrix,
                                   const std::string& name, bool skip_nonfinite,
                                   bool clip_negative) {
    std::shared_ptr<Volume> whole;
    for (const py::handle part : parts) {
        const auto volume = from_blocks(py::make_tuple(part), py::none(), py::none(), matrix, false,
                                        name, skip_nonfinite, clip_negative);
        if (!whole)
            whole = volume;
        else
            whole->leaves.insert(whole->leaves.end(), volume->leaves.begin(), volume->leaves.end());
    }
    if (!whole) throw Error(name + ": no active voxel, expected some above 0");
    unlocked([&] { sort_nodes(*whole); });
    return whole;
}

py::array_t<float> to_numpy(const Volume& volume, const std::optional<std::array<int, 3>>& first,
                            const std::optional<std::array<int, 3>>& shape) {
    const IndexBox box = first && shape ? IndexBox{} : active_box(volume);
    const Vec3i lower = first ? index_of(*first) : box.lower;
    const Vec3i size = shape ? index_of(*shape) : box.upper - lower + Vec3i{1, 1, 1};
    for (int axis = 0; axis < 3; ++axis)
        if (size[axis] < 1)
            throw Error("to_numpy: " + std::to_string(size[axis]) + " voxels along axis " +
                        std::to_string(axis) + ", expected at least 1");
    py::array_t<float> array({size.x, size.y, size.z});
    const std::span<float> values(array.mutable_data(), static_cast<std::size_t>(array.size()));
    unlocked([&] { copy_dense(volume, lower, size, values); });
    return array;
}

py::array_t<double> matrix_of(const Affine& map) {
    py::array_t<double> matrix({4, 4});
    auto at = matrix.mutable_unchecked<2>();
    for (int r = 0; r < 4; ++r)
        for (int c = 0; c < 4; ++c)
            at(r, c) = r == 3 ? (c == 3) : c == 3 ? map.translation[r] : map.linear(r, c);
    return matrix;
}

// ---- pickles

/// Bytes of nodes, of a trivially copyable type without pointers.
template <class Nodes>
py::bytes bytes_of(const Nodes& nodes) {
    return {reinterpret_cast<const char*>(nodes.data()),
            nodes.size() * sizeof(typename Nodes::value_type)};
}
template <class Nodes>
void set_nodes(Nodes& nodes, const py::handle& bytes) {
    constexpr std::size_t kNode = sizeof(typename Nodes::value_type);
    const auto held = bytes.cast<py::bytes>();
    const std::string_view view = held;
    if (view.size() % kNode != 0)
        throw Error("pickle of a Volume: " + std::to_string(view.size()) +
                    " bytes of nodes, expected multiples of " + std::to_string(kNode));
    nodes.resize(view.size() / kNode);
    std::memcpy(static_cast<void*>(nodes.data()), view.data(), view.size());
}

/// How a volume stands: a direction, or None where it is not known.
template <Vec3d Standing::*kDirection>
py::object direction_at(const Volume& volume) {
    const Vec3d direction = volume.standing.*kDirection;
    return direction == Vec3d{} ? py::object(py::none()) : py::cast(direction);
}
template <Vec3d Standing::*kDirection>
void set_direction_at(Volume& volume, const py::object& direction) {
    volume.standing.*kDirection =
        direction.is_none() ? Vec3d{} : normalized(direction_of(direction));
}

py::tuple volume_state(const Volume& volume) {
    return py::make_tuple(bytes_of(volume.leaves), bytes_of(volume.tiles),
                          matrix_of(volume.world_from_index), volume.name, volume.source,
                          volume.standing.up, volume.standing.front, volume.units.length,
                          volume.units.density, volume.background, volume.is_image);
}
std::shared_ptr<Volume> volume_from_state(const py::tuple& state) {
    auto volume = std::make_shared<Volume>();
    set_nodes(volume->leaves, state[0]);
    set_nodes(volume->tiles, state[1]);
    volume->world_from_index = affine_of(py::none(), py::none(), state[2]);
    volume->name = state[3].cast<std::string>();
    volume->source = state[4].cast<std::string>();
    if (state.size() > 5)  // older states have none
        volume->standing = {state[5].cast<Vec3d>(), state[6].cast<Vec3d>()};
    if (state.size() > 7)
        volume->units = {state[7].cast<std::string>(), state[8].cast<std::string>()};
    if (state.size() > 9) volume->background = state[9].cast<double>();
    if (state.size() > 10) volume->is_image = state[10].cast<bool>();
    validate(*volume);
    return volume;
}

std::string repr(const Volume& volume) {
    return "<vog.Volume '" + volume.name + "': " + std::to_string(active_voxels(volume)) +
           " active voxels in " + std::to_string(volume.leaves.size()) + " leaves and " +
           std::to_string(volume.tiles.size()) + " tiles>";
}

/// Writes volumes and fields at their voxels as grids of one file.
/// suffix  of the names of fields, before the number of the volume; empty: none
/// masks   of the volumes, written as they are
void save_with_fields(const std::filesystem::path& file, std::vector<Volume> volumes,
                      const py::object& fields, const std::string& suffix,
                      const std::vector<Volume>& masks = {}) {
    const std::vector<Lattice> lattices = lattices_of(volumes);
    std::vector<std::vector<VoxelField>> of_volume(volumes.size());
    for (std::vector<VoxelField>& field :
         voxel_fields_of(fields, volumes, lattices, volumes.size(), "save"))
        for (std::size_t v = 0; v < volumes.size(); ++v) {
            if (!suffix.empty()) field[v].name += suffix + std::to_string(v);
            of_volume[v].push_back(std::move(field[v]));
        }
    std::vector<VoxelGrids> grids;
    for (std::size_t v = 0; v < volumes.size(); ++v) grids.push_back({&volumes[v], of_volume[v]});
    for (const Volume& mask : masks) grids.push_back({&mask, {}});
    unlocked([&] { write_voxels(file, grids); });
}

/// Writes levels with grids NAME_L0, NAME_L1, ..., unless their names differ already.
void save_levels(const Levels& levels, const std::filesystem::path& file,
                 const py::object& fields) {
    std::vector<Volume> volumes = levels.volumes;
    std::vector<Volume> masks = levels.masks;
    std::set<std::string> names;
    for (const Volume& volume : volumes) names.insert(volume.name);
    for (std::size_t v = 0; v < volumes.size(); ++v) {
        if (names.size() < volumes.size()) volumes[v].name += "_L" + std::to_string(v);
        if (!masks.empty()) masks[v].name = "mask_L" + std::to_string(v);
    }
    const bool several = volumes.size() > 1;
    save_with_fields(file, std::move(volumes), fields, several ? "_L" : "", masks);
}

void bind_volume_class(py::module_& m) {
    py::class_<Volume, std::shared_ptr<Volume>> c(
        m, "Volume",
        R"(Sparse density volume of active voxels; the density outside them is 0.

The centre of voxel (i, j, k) = (x, y, z) is at matrix @ (i, j, k, 1) in world space. Densities are >= 0,
per world unit of length. Created by Volume.load, Volume.from_numpy and vog.sample_*.)");
    c.def_static(
         "load",
         [](const std::filesystem::path& file, const std::string& grid, bool level_set_to_fog,
            bool mask, bool skip_nonfinite, bool clip_negative, std::optional<double> background) {
             std::vector<std::string> notes;
             auto volume = std::make_shared<Volume>(unlocked([&] {
                 return read_volume(
                     file,
                     {grid, level_set_to_fog, mask, {skip_nonfinite, clip_negative, background}},
                     &notes);
             }));
             warn(notes);
             return volume;
         },
         py::arg("file"), py::arg("grid") = "", py::kw_only(), py::arg("level_set_to_fog") = false,
         py::arg("mask") = false, py::arg("skip_nonfinite") = false,
         py::arg("clip_negative") = false, py::arg("background") = py::none(),
         R"(Reads one grid of an OpenVDB (.vdb) or NanoVDB (.nvdb) file, or a dense image. Returns a Volume.

grid              name of the grid; '': the only scalar grid, else 'density', else the largest fog volume, with a warning that
                  names the others
level_set_to_fog  converts a level set to fog: density inside its surface
mask              reads values > 0 as 1
skip_nonfinite    leaves voxels with NaN or infinite values out: they are inactive
clip_negative     sets negative values to 0
background        value of empty space in a dense image: densities are the values above it; None: found in the values, with a
                  warning where it is not 0

The Volume has the units that a dense image states (vog.units_of).

Raises vog.Error for an unreadable file, an unknown grid, and values that are negative or not finite, unless
an option accepts them; then warns of their number.)")
        .def_static(
            "from_numpy", &from_numpy, py::arg("array"), py::arg("voxel_size") = py::none(),
            py::arg("origin") = py::none(), py::kw_only(), py::arg("matrix") = py::none(),
            py::arg("active") = py::none(), py::arg("first") = std::array<int, 3>{0, 0, 0},
            py::arg("name") = "density", py::arg("skip_nonfinite") = false,
            py::arg("clip_negative") = false,
            R"(Creates a Volume from a dense array; by default the voxels with a density > 0 are active.

array       [X, Y, Z] densities, finite and >= 0, per world unit; any real dtype and memory order; float32
            is read in place. array[i, j, k] is the voxel at x = i, y = j, z = k: pass array.T for [z, y, x]
voxel_size  edge of a voxel, world units: a number or (x, y, z); default 1
origin      world position of the centre of voxel (0, 0, 0); default (0, 0, 0)
matrix      in place of voxel_size and origin: [4, 4], world = matrix @ (i, j, k, 1)
active      [X, Y, Z] bool: active voxels; default: those with a density > 0
first       index (i, j, k) of array[0, 0, 0]; default (0, 0, 0)
skip_nonfinite  leaves voxels with NaN or infinite values out, such as missing data
clip_negative   sets negative values to 0

Raises vog.Error for another shape or dtype, and for negative or non-finite densities unless an option accepts
them; then warns of their number.

>>> volume = vog.Volume.from_numpy(np.ones((8, 4, 2)), voxel_size=0.5, origin=(1, 0, 0))
>>> volume.active_voxels, volume.mass
(64, 8.0)
>>> (volume.matrix @ (7, 0, 0, 1))[:3]
array([4.5, 0. , 0. ]))")
        .def_static(
            "from_blocks", &from_blocks, py::arg("blocks"), py::arg("voxel_size") = py::none(),
            py::arg("origin") = py::none(), py::kw_only(), py::arg("matrix") = py::none(),
            py::arg("all_active") = false, py::arg("name") = "density",
            py::arg("skip_nonfinite") = false, py::arg("clip_negative") = false,
            R"(Creates a Volume from several dense arrays, such as the patches of one AMR level.

blocks      pairs ((i, j, k), array [X, Y, Z]): index of array[0, 0, 0], and densities; where blocks
            overlap, the last one is used
all_active  True: voxels of density 0 are active too, and hide coarser levels
Other parameters as in from_numpy.

>>> patches = [((0, 0, 0), np.ones((8, 8, 8))), ((8, 0, 0), np.full((4, 8, 8), 3.0))]
>>> vog.Volume.from_blocks(patches).index_box
((0, 0, 0), (11, 7, 7)))")
        .def_static("_from_parts", &from_parts, py::arg("parts"), py::arg("matrix"),
                    py::arg("name"), py::arg("skip_nonfinite"), py::arg("clip_negative"))
        .def("to_numpy", &to_numpy, py::arg("first") = py::none(), py::arg("shape") = py::none(),
             R"(Densities as a dense float32 array [X, Y, Z], per world unit; 0 at inactive voxels.

first  index (i, j, k) of the array's first voxel; default: the lower corner of index_box
shape  (X, Y, Z) in voxels; default: up to the upper corner of index_box

>>> array = np.arange(1.0, 25).reshape(4, 3, 2)
>>> bool(np.array_equal(vog.Volume.from_numpy(array).to_numpy(), array))
True)")
        .def(
            "save",
            [](const Volume& self, const std::filesystem::path& file, bool half,
               const py::object& fields) {
                if (half && !fields.is_none())
                    throw Error("save: half and fields exclude each other");
                if (fields.is_none()) return unlocked([&] { write_vdb(file, self, half); });
                save_with_fields(file, {self}, fields, "");
            },
            py::arg("file"), py::arg("half") = false, py::kw_only(), py::arg("fields") = py::none(),
            R"(Writes an OpenVDB fog volume, and fields as further grids of the same file: .vdb with their units, .nvdb without.

half    stores values as 16-bit floats
fields  {name: field} as vog.convert takes them, of any sign; `vog convert FILE --field NAME` reads them)")
        .def_property(
            "_units",
            [](const Volume& self) {
                return py::make_tuple(self.units.length, self.units.density);
            },
            [](Volume& self, const std::pair<std::string, std::string>& units) {
                self.units = {units.first, units.second};
            })
        .def_readwrite("name", &Volume::name, "Name of the grid.")
        .def_readwrite("background", &Volume::background,
                       "Value of empty space in the file: the file's values are densities plus "
                       "this. -1000 of Hounsfield units.")
        .def_readonly("source", &Volume::source, "File that the volume was read from, or ''.")
        .def_property_readonly(
            "matrix", [](const Volume& self) { return matrix_of(self.world_from_index); },
            "[4, 4] float64: world position = matrix @ (i, j, k, 1) of a voxel's centre.")
        .def_property_readonly("active_voxels", py::overload_cast<const Volume&>(&active_voxels),
                               "Number of active voxels, including those of tiles.")
        .def_property_readonly(
            "leaves", [](const Volume& self) { return self.leaves.size(); },
            "Number of leaves: nodes of 8 x 8 x 8 voxels.")
        .def_property_readonly(
            "tiles", [](const Volume& self) { return self.tiles.size(); },
            "Number of tiles: cubes with an edge of 8, 128 or 4096 voxels of one value.")
        .def_property_readonly("voxel_volume", &voxel_volume,
                               "Volume of one voxel, world units cubed.")
        .def_property_readonly("mass", py::overload_cast<const Volume&>(&mass),
                               "Sum over the voxels of density times voxel volume.")
        .def_property_readonly(
            "index_box",
            [](const Volume& self) {
                const IndexBox box = active_box(self);
                return py::make_tuple(tuple_of(box.lower), tuple_of(box.upper));
            },
            "((i, j, k), (i, j, k)): bounding box of the active voxels, both corners inclusive.")
        .def_property_readonly(
            "box", [](const Volume& self) { return box_array(world_box(self)); },
            "[2, 3] float64: lower and upper corner in world space, padded to whole leaves.")
        .def_property(
            "up", &direction_at<&Standing::up>, &set_direction_at<&Standing::up>,
            "(x, y, z), or the name of an axis when it is set: the direction that is upright in "
            "the data, as the file says or implies; None: not known, pictures take y.")
        .def_property("front", &direction_at<&Standing::front>, &set_direction_at<&Standing::front>,
                      "(x, y, z): direction to an eye that sees the front, of scans of people; "
                      "None: not known.")
        .def_property_readonly(
            "voxel_box", [](const Volume& self) { return box_array(voxel_box(self)); },
            "[2, 3] float64: lower and upper corner of the active voxels in world space; None "
            "without one.")
        .def("__repr__", &repr)
        .def(py::pickle(&volume_state, &volume_from_state));
}

/// throws vog::Error for volumes that are neither levels nor parts, unless there are masks
/// force  true: validate() alone
void require_mesh(const Levels& levels, bool force) {
    validate(levels);
    if (force || !levels.masks.empty()) return;
    const Arrangement arrangement = unlocked([&] { return arrangement_of(levels); });
    if (!arrangement.is_mesh())
        throw Error(arrangement.text +
                    "; use one at a time, or Levels(volumes, force=True): the finest counts, or "
                    "the first if voxels are equal");
}

void bind_levels_class(py::module_& m) {
    constexpr const char* kVolume = "a Volume";
    py::class_<Levels, std::shared_ptr<Levels>>(
        m, "Levels",
        R"(Adaptive mesh (AMR): volumes of several voxel sizes, where finer ones hide coarser ones.

A list of Volumes is accepted wherever Levels are.

volumes  Volumes, in any order
masks    one Volume per volume: where its values are > 0, the level is valid and hides coarser ones;
         default: its active voxels
force    True: levels whatever their lattices; where voxels of one size overlap, the first counts

Raises vog.Error, unless there are masks or force is True, for volumes that are neither levels (voxels that
divide those of coarser levels evenly, inside their box) nor parts that do not overlap: time steps, say.)")
        .def(py::init([](const py::iterable& volumes, const py::iterable& masks, bool force) {
                 auto levels = std::make_shared<Levels>();
                 for (const py::handle volume : volumes)
                     levels->volumes.push_back(cast_to<const Volume&>(volume, "volumes", kVolume));
                 for (const py::handle mask : masks)
                     levels->masks.push_back(cast_to<const Volume&>(mask, "masks", kVolume));
                 require_mesh(*levels, force);
                 return levels;
             }),
             py::arg("volumes"), py::arg("masks") = py::tuple(), py::kw_only(),
             py::arg("force") = false)
        .def_static(
            "load",
            [](const py::object& files, const std::string& grid, const std::string& mask,
               bool level_set_to_fog, bool force, bool skip_nonfinite, bool clip_negative) {
                std::vector<std::filesystem::path> paths;
                if (py::isinstance<py::str>(files) || py::hasattr(files, "__fspath__"))
                    paths.push_back(cast_to<std::filesystem::path>(files, "files", "a path"));
                else
                    paths = cast_to<std::vector<std::filesystem::path>>(files, "files", "paths");
                std::vector<std::string> notes;
                auto levels = std::make_shared<Levels>(unlocked([&] {
                    return read_levels(
                        paths, {grid, mask, level_set_to_fog, {skip_nonfinite, clip_negative}},
                        &notes);
                }));
                warn(notes);
                require_mesh(*levels, force);
                return levels;
            },
            py::arg("files"), py::arg("grid") = "", py::arg("mask") = "", py::kw_only(),
            py::arg("level_set_to_fog") = false, py::arg("force") = false,
            py::arg("skip_nonfinite") = false, py::arg("clip_negative") = false,
            R"(Reads levels from one or several .vdb or .nvdb files. Returns Levels.

grid  name, or a pattern with * and ? for all grids that match: 'density_L*'; '': all such levels, else as in Volume.load
mask  name of the mask grids; a * stands for the match of the * in grid
level_set_to_fog  converts level sets to fog
force  True: levels whatever their lattices, as in Levels()
skip_nonfinite, clip_negative  as in Volume.load)")
        .def(
            "save", &save_levels, py::arg("file"), py::kw_only(), py::arg("fields") = py::none(),
            R"(Writes each level as a grid of one file (.vdb, .nvdb): density_L0, density_L1, ..., and masks as mask_L0, ...

fields  {name: field} as vog.convert takes them, as grids temperature_L0, ...: the command reads them by
        --field 'T=temperature_L*')")
        .def_property_readonly(
            "arrangement", [](const Levels& self) { return arrangement_of(self).text; },
            "How the volumes lie to each other, one line: levels, parts side by side, or neither.")
        .def(
            "__getitem__",
            [](const std::shared_ptr<Levels>& self, py::ssize_t i) {
                const auto n = static_cast<py::ssize_t>(self->volumes.size());
                if (i < 0) i += n;
                if (i < 0 || i >= n) throw py::index_error("level out of range");
                return std::shared_ptr<Volume>(self, &self->volumes[static_cast<std::size_t>(i)]);
            },
            py::arg("index"))
        .def("__len__", [](const Levels& self) { return self.volumes.size(); })
        .def_property_readonly(
            "box",
            [](const Levels& self) {
                Box box;
                for (const Volume& volume : self.volumes) box.include(world_box(volume));
                return box_array(box);
            },
            "[2, 3] float64: lower and upper corner in world space.")
        .def("__repr__",
             [](const Levels& self) {
                 return "<vog.Levels: " + std::to_string(self.volumes.size()) + " volumes, " +
                        std::to_string(self.masks.size()) + " masks>";
             })
        .def(py::pickle(
            [](const Levels& self) {
                py::list volumes, masks;
                for (const Volume& volume : self.volumes) volumes.append(volume_state(volume));
                for (const Volume& mask : self.masks) masks.append(volume_state(mask));
                return py::make_tuple(volumes, masks);
            },
            [](const py::tuple& state) {
                auto levels = std::make_shared<Levels>();
                for (const py::handle volume : state[0])
                    levels->volumes.push_back(*volume_from_state(volume.cast<py::tuple>()));
                for (const py::handle mask : state[1])
                    levels->masks.push_back(*volume_from_state(mask.cast<py::tuple>()));
                return levels;
            }));
}

}  // namespace

std::shared_ptr<const Levels> levels_of(const py::object& data) {
    if (py::isinstance<Levels>(data)) return data.cast<std::shared_ptr<Levels>>();
    if (!PySequence_Check(data.ptr()) || py::isinstance<py::str>(data) || py::len(data) == 0)
        return nullptr;
    auto levels = std::make_shared<Levels>();
    for (const py::handle volume : data) {
        if (!py::isinstance<Volume>(volume)) return nullptr;
        levels->volumes.push_back(volume.cast<const Volume&>());
    }
    require_mesh(*levels, false);
    return levels;
}

void refuse_data(const py::object& data, const std::string& call, const std::string& expected) {
    throw py::type_error(call + ": got " + py::type::of(data).attr("__name__").cast<std::string>() +
                         ", expected " + expected);
}

void bind_volume(py::module_& m) {
    bind_volume_class(m);
    bind_levels_class(m);
    m.def(
        "grid_names", [](const std::filesystem::path& file) { return grid_names(file); },
        py::arg("file"),
        "Names of the grids in a .vdb or .nvdb file, or of the images in another, in file order.");
    m.def(
        "_volume_head",
        [](const std::filesystem::path& file, const std::string& grid) {
            const VolumeHead head = volume_head(file, grid);
            return py::make_tuple(head.voxel_size, head.origin, head.length_unit, head.value_unit);
        },
        py::arg("file"), py::arg("grid") = "",
        "Edges of a voxel of a dense image, the first one's place, and the units of lengths and "
        "values, without its values.");
}

}  // namespace vog::python
