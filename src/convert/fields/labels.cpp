// labels.cpp: a volume divided by the labels at its voxels.
#include <fmt/core.h>

#include <cmath>
#include <map>

#include "vog/convert_labels.h"
#include "vog/error.h"

namespace vog {

namespace {

/// Volumes by label, each with the volume's name, source and place.
class Parts {
  public:
    explicit Parts(const Volume& whole) : whole_(whole) {}
    /// throws  vog::Error for a value that is no label
    Volume& of(float value) {
        if (!(std::abs(value) < 0x1p24f) || value != std::floor(value))
            throw Error(fmt::format(
                "labels: value {}, expected whole numbers up to 2^24 on the volume's lattice",
                value));
        const auto label = static_cast<std::int64_t>(value);
        const auto found = parts_.find(label);
        if (found != parts_.end()) return found->second;
        if (parts_.size() == kMostLabels)
            throw Error(fmt::format("labels: more than {} of them", kMostLabels));
        Volume part = whole_;
        part.leaves.clear(), part.tiles.clear();
        return parts_.emplace(label, std::move(part)).first->second;
    }
    std::vector<LabelledVolume> take() {
        std::vector<LabelledVolume> all;
        for (auto& [label, part] : parts_) all.push_back({label, std::move(part)});
        return all;
    }

  private:
    const Volume& whole_;
    std::map<std::int64_t, Volume> parts_;
};

}  // namespace

std::vector<LabelledVolume> divide_by_labels(const Volume& volume, const VoxelField& labels) {
    Parts parts(volume);
    const VoxelValues& values = labels.component.front();
    // The volume's own values: without a copy.
    const bool own = values.leaf.empty() && values.tile.empty();
    for (std::size_t l = 0; l < volume.leaves.size(); ++l) {
        const Leaf& leaf = volume.leaves[l];
        std::map<float, Leaf> of_label;
        for (int n = 0; n < kLeafVoxels; ++n) {
            if (!leaf.active(n)) continue;
            const auto offset = static_cast<std::size_t>(n);
            const float label = own ? leaf.value[offset] : values.leaf[l][offset];
            Leaf& to = of_label.try_emplace(label).first->second;
            to.origin = leaf.origin;
            to.set(n, leaf.value[offset]);
        }
        for (auto& [label, part] : of_label) parts.of(label).leaves.push_back(std::move(part));
    }
    for (std::size_t t = 0; t < volume.tiles.size(); ++t)
        parts.of(own ? volume.tiles[t].value : values.tile[t]).tiles.push_back(volume.tiles[t]);
    return parts.take();
}

}  // namespace vog
