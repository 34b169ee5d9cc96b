// divided_volumes.cpp: visible voxels of parts, and what all ranks know of a field.
#include "pictures/divided_volumes.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>
#include <utility>

#include "pictures/scene_inputs.h"
#include "terminal/terminal.h"

namespace vog::cli {

namespace {

/// Visible voxels of the last, coarsest level.
struct VisibleLevel {
    std::vector<Volume> volumes;
    bool fits = true;  ///< whether no voxel is hidden in part
};
VisibleLevel last_of(Levels levels) {
    const std::string source = levels.volumes.back().source;
    // Parts keep the source of their level: its number, meanwhile.
    for (std::size_t n = 0; n < levels.volumes.size(); ++n)
        levels.volumes[n].source = std::to_string(n);
    const std::string last = levels.volumes.back().source;
    Composite mesh = composite(levels);
    VisibleLevel visible{{}, mesh.partly_hidden == 0};
    for (Volume& volume : mesh.parts) {
        if (volume.source != last) continue;
        volume.source = source;
        visible.volumes.push_back(std::move(volume));
    }
    return visible;
}

/// The volume on the lattice of another; an empty one where there is none.
Volume on_lattice_of(const Volume& volume, std::vector<Volume>& among) {
    const auto found = std::ranges::find_if(among, [&](const Volume& one) {
        return !one.empty() && one.world_from_index == volume.world_from_index;
    });
    return found == among.end() ? Volume{} : std::exchange(*found, {});
}

}  // namespace

PartsWithField visible_volumes(DividedVolumes part) {
    PartsWithField visible;
    visible.overlap = !part.is_mesh && part.volumes > 1;
    for (std::size_t n = 0; n < part.sets.size(); ++n) {
        VisibleLevel own{{}, true}, beside;
        if (part.is_mesh)
            own = last_of(std::move(part.sets[n]));
        else
            own.volumes = std::move(part.sets[n].volumes);
        visible.overlap |= !own.fits;
        const bool any = !part.beside.empty();
        if (any && part.is_mesh) beside = last_of(std::move(part.beside[n]));
        for (std::size_t v = 0; v < own.volumes.size(); ++v) {
            if (own.volumes[v].empty()) continue;
            if (any)
                visible.beside.push_back(part.is_mesh
                                             ? on_lattice_of(own.volumes[v], beside.volumes)
                                             : std::move(part.beside[n].volumes[v]));
            visible.volumes.push_back(std::move(own.volumes[v]));
        }
    }
    return visible;
}

SharedField shared_field(const std::vector<Volume>& volumes, const std::vector<VoxelField>& fields,
                         const FieldCoverage& coverage, const RenderRanks& ranks,
                         std::vector<std::string>& notes) {
    // Ranks without voxels learn the field from the others.
    nlohmann::json mine = nlohmann::json::array();
    for (std::size_t n = 0; n < fields.size(); ++n)
        mine.push_back({{"name", fields[n].name},
                        {"unit", fields[n].unit},
                        {"vector", fields[n].is_vector()},
                        {"lower", fields[n].lower},
                        {"upper", fields[n].upper},
                        {"voxel", voxel_volume(volumes[n])},
                        {"grid", coverage.grid},
                        {"volume", coverage.volume}});
    SharedField shared{{}, {}, false, HUGE_VAL, -HUGE_VAL};
    FieldCoverage all;
    double finest = HUGE_VAL;
    bool one_name = true;
    std::string name;
    for (const std::string& text : ranks.allgather(json_line(mine)))
        for (const nlohmann::json& one : nlohmann::json::parse(text)) {
            shared.lower = std::min(shared.lower, one["lower"].get<double>());
            shared.upper = std::max(shared.upper, one["upper"].get<double>());
            const std::string its_name = one["name"];
            one_name &= name.empty() || name == its_name;
            name = its_name;
            if (!(one["voxel"] < finest)) continue;
            finest = one["voxel"];
            shared.name = one["name"], shared.unit = one["unit"];
            shared.is_vector = one["vector"];
            all.grid = one["grid"], all.volume = one["volume"];
        }
    double sums[4] = {coverage.mass, coverage.covered_mass, coverage.voxels,
                      coverage.covered_voxels};
    ranks.collective.sum(sums);
    std::tie(all.mass, all.covered_mass, all.voxels, all.covered_voxels) =
        std::tie(sums[0], sums[1], sums[2], sums[3]);
    if (all.voxels == 0) {  // the volumes' own values, as own_name
        if (!one_name) shared.name = "density";
        return shared;
    }
    if (const std::string note = coverage_note(all); !note.empty()) notes.push_back(note);
    return shared;
}

}  // namespace vog::cli
