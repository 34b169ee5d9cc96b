// sampled_fields.cpp: fields of Python calls at the voxels of their data.
#include "sampled_fields.h"

#include <algorithm>
#include <string>

#include "vog/convert_labels.h"
#include "vog/error.h"
#include "voxel_fields.h"

namespace vog::python {

SampledFields sampled_fields(const py::object& data, const py::object& fields, const char* call) {
    SampledFields sampled;
    if (no_fields(fields)) return sampled;
    std::vector<Lattice> lattices;
    std::size_t count = 1;
    if (py::isinstance<Volume>(data)) {
        sampled.volumes.push_back(data.cast<const Volume&>());
        lattices = lattices_of(sampled.volumes);
    } else {
        const auto levels = levels_of(data);
        count = levels->volumes.size();
        sampled.volumes = unlocked([&] {
            // Parts keep the source of their level: its number, meanwhile.
            Levels numbered = *levels;
            for (std::size_t n = 0; n < count; ++n) numbered.volumes[n].source = std::to_string(n);
            return composite(numbered).parts;
        });
        for (Volume& part : sampled.volumes) {
            const Volume& level = levels->volumes[std::stoul(part.source)];
            lattices.push_back({level.world_from_index, std::stoul(part.source)});
            part.source = level.source;
        }
    }
    if (!fields.is_none())
        sampled.values = voxel_fields_of(fields, sampled.volumes, lattices, count, call);
    const std::string& first = sampled.volumes.front().name;
    const auto same = [&](const Volume& volume) { return volume.name == first; };
    const std::string own =
        !first.empty() && std::ranges::all_of(sampled.volumes, same) ? first : "density";
    const auto named = [&](const auto& field) { return field.front().name == own; };
    if (std::ranges::none_of(sampled.values, named)) {
        std::vector<VoxelField>& values = sampled.values.emplace_back();
        for (const Volume& volume : sampled.volumes) values.push_back(measure_field(volume, own));
    }
    return sampled;
}

std::vector<LabelledPart> labelled_parts(const py::object& data, const py::object& labels,
                                         const char* call) {
    const py::dict field(py::arg("label") = labels);
    const SampledFields sampled = sampled_fields(data, field, call);
    const Volume& whole = sampled.volumes.front();
    const VoxelField& label = sampled.values.front().front();
    if (label.is_vector())
        throw Error(std::string(call) + ": labels are vectors, expected whole numbers");
    std::vector<LabelledVolume> divided = unlocked([&] { return divide_by_labels(whole, label); });
    std::vector<LabelledPart> parts;
    for (LabelledVolume& part : divided) {
        const double share = double(active_voxels(part.volume)) / double(active_voxels(whole));
        if (!(mass(part.volume) > 0)) continue;
        Volume numbers = part.volume;
        numbers.background = 0;
        for (Leaf& leaf : numbers.leaves)
            for (int n = 0; n < kLeafVoxels; ++n)
                if (leaf.active(n)) leaf.set(n, static_cast<float>(part.label));
        for (Tile& tile : numbers.tiles) tile.value = static_cast<float>(part.label);
        parts.push_back({py::cast(std::move(part.volume)), py::cast(std::move(numbers)), share});
    }
    if (parts.empty()) throw Error(std::string(call) + ": a volume without mass");
    return parts;
}

py::dict one_field(const py::object& fields, const std::string& name, const std::string& call) {
    if (fields.is_none())
        throw Error(call + ": no field '" + name + "' with the volume, expected fields={'" + name +
                    "': array}, its values at the voxels");
    if (!py::isinstance<py::dict>(fields))
        throw Error(call + ": fields: expected {'" + name + "': array}, the field at the voxels");
    py::dict one;
    std::string names;
    for (const auto& [key, value] : fields.cast<py::dict>()) {
        const auto text = py::str(key).cast<std::string>();
        if (text == name || name.starts_with(text + ".")) one[key] = value;
        names += (names.empty() ? "" : ", ") + text;
    }
    if (one.empty())
        throw Error(call + ": no field '" + name + "' in fields, expected one of " + names);
    return one;
}

}  // namespace vog::python
