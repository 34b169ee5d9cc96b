// label_parts.cpp: labels read as a field, and the volumes that they divide.
#include "conversion/label_parts.h"

#include <fmt/core.h>

#include <filesystem>

#include "conversion/volume_fields.h"
#include "vog/convert_labels.h"
#include "vog/error.h"
#include "vog/scan_io.h"

namespace vog::cli {

std::vector<double> divide_by_labels(ConvertArguments& arguments, LoadedVolumes& set) {
    if (set.volumes.size() != 1 || set.is_mesh())
        throw UsageError(fmt::format("--labels needs a single volume, not {}", set.volumes.size()));
    const std::string& labels = arguments.labels;
    const auto is_file = [](const std::string& name) {
        std::error_code code;
        return std::filesystem::is_regular_file(name, code) || is_volume_file(name);
    };
    const bool names_file = is_file(labels) || is_file(labels.substr(0, labels.rfind(':')));
    const std::string text =
        "label=" + (names_file ? labels : arguments.inputs.front() + ":" + labels);
    std::vector<std::string> notes;  // read once more, with the parts
    std::vector<FieldCoverage> coverage;
    const auto read = read_volume_fields({{text}, arguments.volume.grid, arguments.inputs},
                                         set.volumes, notes, &coverage);
    const bool own = coverage.front().voxels == 0;  // the volume's values
    if (const std::string note = own ? "" : coverage_note(coverage.front()); !note.empty())
        set.notes.push_back(note);
    if (read.front().front().is_vector())
        throw Error(fmt::format("--labels {}: a vector field, expected whole numbers", labels));
    std::vector<LabelledVolume> parts = [&] {
        try {
            return vog::divide_by_labels(set.volumes.front(), read.front().front());
        } catch (const Error& error) {
            throw Error(fmt::format("{}: {}", labels, error.what()));
        }
    }();
    set.volumes.clear();
    set.overlap = Overlap::add;
    std::vector<double> shares;
    double all = 0;
    std::string names;
    for (LabelledVolume& part : parts) {
        shares.push_back(static_cast<double>(active_voxels(part.volume)));
        all += shares.back();
        names += fmt::format("{}{} ({} voxels)", names.empty() ? "" : ", ", part.label,
                             count_text(active_voxels(part.volume)));
        set.volumes.push_back(std::move(part.volume));
    }
    for (double& share : shares) share /= all;
    set.notes.push_back(fmt::format("{}: labels {}", labels, names));
    arguments.fields.push_back(text);
    return shares;
}

}  // namespace vog::cli
