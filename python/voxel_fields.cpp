// voxel_fields.cpp: arrays, volumes and grids as fields at the voxels of a volume.
#include "voxel_fields.h"

#include <algorithm>
#include <array>
#include <limits>

#include "arrays.h"
#include "data.h"
#include "vog/error.h"
#include "vog/fields.h"

namespace vog::python {

namespace {

constexpr const char* kExpected =
    "an array [X, Y, Z] or [X, Y, Z, 3], a pair ((i, j, k), array), a list of them, a Volume or "
    "the name of a grid in the volume's file";

/// A field as it is given, of one level.
struct GivenField {
    std::string name, unit, label;  ///< label: "convert: fields: temperature"
    py::object value;
};

bool is_index(const py::handle& object) {
    return py::isinstance<py::tuple>(object) && py::len(object) == 3;
}
/// ((i, j, k), array)
bool is_pair(const py::handle& object) {
    return py::isinstance<py::tuple>(object) && py::len(object) == 2 &&
           is_index(object.cast<py::tuple>()[0]);
}

/// Arrays with their first voxels; keeps them alive.
struct Arrays {
    std::vector<py::array> kept;
    FieldValues values;
};

void add_block(const GivenField& given, const std::array<int, 3>& first, const py::handle& data,
               Arrays& arrays) {
    const py::array numbers = numbers_of(data, given.label);
    const bool vectors = numbers.ndim() == 4 && numbers.shape(3) == 3;
    if (numbers.ndim() != 3 && !vectors)
        throw Error(given.label + ": shape " + shape_text(numbers) +
                    ", expected (X, Y, Z) or (X, Y, Z, 3)");
    const int components = vectors ? 3 : 1;
    if (!arrays.kept.empty() && arrays.values.components != components)
        throw Error(given.label + ": arrays of scalars and of vectors, expected one kind");
    arrays.values.components = components;
    // Any order of axes is read where it lies, if its strides are whole floats.
    py::array values = numbers.attr("astype")("float32", "K", "unsafe", false, false);
    for (py::ssize_t axis = 0; axis < values.ndim(); ++axis)
        if (values.strides(axis) % static_cast<py::ssize_t>(sizeof(float)) != 0) {
            values = values.attr("copy")();
            break;
        }
    FieldBlock block;
    block.value = static_cast<const float*>(values.data());
    block.first = {first[0], first[1], first[2]};
    for (int axis = 0; axis < values.ndim(); ++axis) {
        block.stride[static_cast<std::size_t>(axis)] =
            values.strides(axis) / static_cast<py::ssize_t>(sizeof(float));
        if (axis < 3)
            block.size[axis] = static_cast<std::int32_t>(std::min<py::ssize_t>(
                values.shape(axis), std::numeric_limits<std::int32_t>::max()));
    }
    arrays.values.blocks.push_back(block);
    arrays.kept.push_back(std::move(values));
}

Arrays arrays_of(const GivenField& given, const Affine& world_from_index) {
    Arrays arrays;
    arrays.values.name = given.name;
    arrays.values.unit = given.unit;
    arrays.values.world_from_index = world_from_index;
    const auto add_pair = [&](const py::handle& pair) {
        const auto [first, array] = cast_to<std::pair<std::array<int, 3>, py::object>>(
            pair, given.label, "a pair ((i, j, k), array)");
        add_block(given, first, array, arrays);
    };
    if (is_pair(given.value)) {
        add_pair(given.value);
    } else if (py::isinstance<py::list>(given.value) && py::len(given.value) > 0 &&
               is_pair(given.value.cast<py::list>()[0])) {
        for (const py::handle pair : given.value) add_pair(pair);
    } else if (py::isinstance<py::array>(given.value) || py::hasattr(given.value, "__array__")) {
        add_block(given, {0, 0, 0}, given.value, arrays);
    } else {
        throw py::type_error(given.label + ": got " +
                             py::type::of(given.value).attr("__name__").cast<std::string>() +
                             ", expected " + kExpected);
    }
    return arrays;
}

/// Samples one field at one volume.
/// level  lattice of arrays
VoxelField sampled(const GivenField& given, const Affine& level, Volume& volume,
                   std::vector<VoxelField>& others, std::vector<std::string>& notes) {
    if (py::isinstance<Volume>(given.value)) {
        const auto& other = given.value.cast<const Volume&>();
        VoxelField field =
            unlocked([&] { return sample_field(other, given.name, volume, others, &notes); });
        field.unit = given.unit;
        return field;
    }
    if (py::isinstance<py::str>(given.value)) {
        if (volume.source.empty())
            throw Error(given.label + ": the grid '" + given.value.cast<std::string>() +
                        "' of a volume that no file has, expected an array or a Volume");
        const FieldSource source{volume.source, given.value.cast<std::string>(), given.name,
                                 given.unit};
        return unlocked([&] { return read_field(source, volume, others, &notes); });
    }
    const Arrays arrays = arrays_of(given, level);
    return unlocked([&] { return sample_field(arrays.values, volume, others, &notes); });
}

/// The value of a field at one of several levels.
py::object at_level(const py::object& value, std::size_t level, std::size_t count,
                    const std::string& label) {
    if (count == 1 || py::isinstance<py::str>(value)) return value;
    if (!py::isinstance<py::list>(value) && !py::isinstance<py::tuple>(value) &&
        !py::isinstance<Levels>(value))
        throw py::type_error(label + ": got " +
                             py::type::of(value).attr("__name__").cast<std::string>() +
                             ", expected a list with one of each level");
    const auto list = py::list(value);
    if (list.size() != count)
        throw Error(label + ": " + std::to_string(list.size()) + " values for " +
                    std::to_string(count) + " levels, expected one for each");
    return list[level];
}

/// The fields of a mapping; None: none.
std::vector<GivenField> given_fields(const py::object& fields, const std::string& call) {
    std::vector<GivenField> given;
    if (fields.is_none()) return given;
    if (!py::isinstance<py::dict>(fields))
        throw py::type_error(call + ": fields: expected a dict of names and arrays");
    for (const auto& [name, object] : fields.cast<py::dict>()) {
        GivenField& field = given.emplace_back();
        field.name = cast_to<std::string>(name, call + ": fields", "names");
        field.label = call + ": fields: " + field.name;
        field.value = py::reinterpret_borrow<py::object>(object);
        if (!py::isinstance<py::dict>(object)) continue;
        const auto parts = object.cast<py::dict>();
        for (const auto& [key, _] : parts)
            if (!py::str(key).equal(py::str("value")) && !py::str(key).equal(py::str("unit")))
                throw Error(field.label + ": unknown " + py::repr(key).cast<std::string>() +
                            ", expected value and unit");
        if (!parts.contains("value")) throw Error(field.label + ": value: missing");
        field.value = parts["value"];
        if (parts.contains("unit"))
            field.unit = cast_to<std::string>(parts["unit"], field.label + ": unit", "a text");
    }
    return given;
}

}  // namespace

std::vector<Lattice> lattices_of(const std::vector<Volume>& volumes) {
    std::vector<Lattice> lattices;
    for (const Volume& volume : volumes)
        lattices.push_back({volume.world_from_index, lattices.size()});
    return lattices;
}

std::vector<std::vector<VoxelField>> voxel_fields_of(const py::object& fields,
                                                     std::vector<Volume>& volumes,
                                                     const std::vector<Lattice>& lattices,
                                                     std::size_t count, const std::string& call) {
    std::vector<std::vector<VoxelField>> all;
    const std::vector<GivenField> given = given_fields(fields, call);
    std::vector<std::string> notes;
    all.resize(given.size());
    for (std::size_t v = 0; v < volumes.size(); ++v) {
        // One volume at a time: its tiles are divided for all fields.
        std::vector<VoxelField> sampled_here;
        for (GivenField field : given) {
            field.value = at_level(field.value, lattices[v].level, count, field.label);
            sampled_here.push_back(
                sampled(field, lattices[v].world_from_index, volumes[v], sampled_here, notes));
        }
        for (std::size_t f = 0; f < all.size(); ++f) all[f].push_back(std::move(sampled_here[f]));
    }
    warn(notes);
    return all;
}

}  // namespace vog::python
