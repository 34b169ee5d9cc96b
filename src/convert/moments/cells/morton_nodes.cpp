// morton_nodes.cpp: leaves and tiles sorted by the Morton code of their origins.
#include "convert/moments/cells/morton_nodes.h"

#include <tbb/parallel_sort.h>

#include "core/parallel.h"

namespace vog::moments {

std::vector<MortonNode> morton_nodes(const Volume& volume) {
    std::vector<MortonNode> nodes;
    nodes.reserve(volume.leaves.size() + volume.tiles.size());
    for (std::size_t n = 0; n < volume.leaves.size(); ++n) {
        check_interrupt();
        nodes.push_back({volume.leaves[n].origin, kLeafEdge, static_cast<std::uint32_t>(n), false});
    }
    for (std::size_t n = 0; n < volume.tiles.size(); ++n)
        nodes.push_back(
            {volume.tiles[n].origin, volume.tiles[n].edge, static_cast<std::uint32_t>(n), true});
    tbb::parallel_sort(nodes.begin(), nodes.end(), [](const MortonNode& a, const MortonNode& b) {
        return morton_less(a.origin, b.origin);
    });
    return nodes;
}

}  // namespace vog::moments
