// label_parts.cpp: labels read as a field, and the volumes that they divide.
#include "conversion/label_parts.h"

#include <fmt/core.h>

#include <filesystem>

#include "conversion/volume_fields.h"
#include "vog/convert_labels.h"
#include "vog/error.h"

namespace vog::cli {

std::vector<double> divide_by_labels(ConvertArguments& arguments, LoadedVolumes& set) {
    if (set.volumes.size() != 1 || set.is_mesh())
        throw UsageError(fmt::format("--labels needs a single volume, not {}", set.volumes.size()));
    const std::string& labels = arguments.labels;
    std::error_code code;
    const std::string file = labels.substr(0, labels.rfind(':'));
    const bool names_file = std::filesystem::is_regular_file(labels, code) ||
                            std::filesystem::is_regular_file(file, code);
    const std::string text =
        "label=" + (names_file ? labels : arguments.inputs.front() + ":" + labels);
    std::vector<std::string> notes;  // read once more, with the parts
    const auto read =
        read_volume_fields({{text}, arguments.volume.grid, arguments.inputs}, set.volumes, notes);
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
