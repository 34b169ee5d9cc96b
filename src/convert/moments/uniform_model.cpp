// uniform_model.cpp: --block: one Gaussian for each occupied cube of a number of voxels.
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "convert/moments/cells/leaf_cells.h"
#include "convert/moments/cells/overlapping_cells.h"
#include "convert/moments/cells/uniform_cells.h"
#include "convert/moments/mass_threshold.h"
#include "convert/moments/moment_job.h"
#include "core/parallel.h"

namespace vog::moments {

namespace {

/// Source of a volume's cells, hard or overlapping, node by node.
class CellSource {
  public:
    CellSource(const MomentJob& job, const std::vector<MortonNode>& nodes)
        : volume_(job.volume()), nodes_(nodes), edge_(job.options.block_voxels) {
        if (job.overlaps()) windows_.emplace(volume_, nodes_, edge_, job.window_period());
        shares_ = job.shares_voxels();
    }
    std::size_t chunk_count() const { return (nodes_.size() + kNodeChunk - 1) / kNodeChunk; }
    /// Calls take(node, windows, sums, center) for each cell of one chunk of nodes; windows is the node's scratch, null
    /// where cells do not share voxels.
    /// masses_only  take needs no other moments
    template <class Take>
    void for_each_cell_of_chunk(std::size_t chunk, bool masses_only, const Take& take) const {
        const std::size_t last = std::min((chunk + 1) * kNodeChunk, nodes_.size());
        OverlapScratch scratch;
        for (std::size_t n = chunk * kNodeChunk; n < last; ++n) {
            const auto of_node = [&](const MomentSums& sums, Vec3d center) {
                take(nodes_[n], shares_ ? &scratch : nullptr, sums, center);
            };
            if (windows_)
                for_each_overlapping_cell(*windows_, nodes_[n], scratch, masses_only, of_node);
            else
                for_each_cell(volume_, nodes_[n], edge_, of_node);
        }
    }

  private:
    const Volume& volume_;
    const std::vector<MortonNode>& nodes_;
    int edge_;
    std::optional<OverlappingCells> windows_;
    bool shares_ = false;
};

/// Model of hard or overlapping cells of at most a leaf's edge in two passes over the leaves:
/// masses, then Gaussians, written in place by every chunk. Beside the model it holds 4 bytes a
/// cell, where uniform_cells holds 40 and the bricks, which --memory relies on; a test holds both
/// to the same cells.
Gaussians two_pass_model(MomentJob& job) {
    const std::vector<MortonNode> nodes = morton_nodes(job.volume());
    const CellSource source(job, nodes);
    std::vector<std::vector<float>> masses(source.chunk_count());
    vog::parallel_for(std::size_t{0}, masses.size(), [&](std::size_t chunk) {
        source.for_each_cell_of_chunk(
            chunk, true,
            [&](const MortonNode&, const OverlapScratch*, const MomentSums& sums, Vec3d) {
                masses[chunk].push_back(static_cast<float>(sums.mass));
            });
    });
    MassThreshold threshold;
    for (const auto& part : masses)
        for (const float mass : part) threshold.add(mass);
    threshold.sum_over(job.collective());
    const float least = threshold.least_mass(job.options.mass_threshold);
    threshold.write_to(job.report, job.data_mass);
    job.least_mass = double{least};

    std::vector<std::size_t> first(masses.size() + 1);
    for (std::size_t chunk = 0; chunk < masses.size(); ++chunk) {
        const auto is_kept = [&](float mass) { return mass >= least; };
        first[chunk + 1] = first[chunk] + static_cast<std::size_t>(std::count_if(
                                              masses[chunk].begin(), masses[chunk].end(), is_kept));
        masses[chunk] = std::vector<float>();  // {} would keep its memory
    }
    Gaussians model;
    model.origin = job.origin();
    resize(model, first.back(), job.options.axis_aligned);
    const MomentFrame frame = job.frame(job.volume().world_from_index);
    if (job.receiver) job.receiver->begin(model.size());
    vog::parallel_for(std::size_t{0}, masses.size(), [&](std::size_t chunk) {
        std::size_t i = first[chunk];
        const CellSink sink = job.receiver ? job.receiver->sink_of_chunk() : CellSink{};
        source.for_each_cell_of_chunk(chunk, false,
                                      [&](const MortonNode& node, const OverlapScratch* windows,
                                          const MomentSums& sums, Vec3d center) {
                                          if (static_cast<float>(sums.mass) < least) return;
                                          if (sink) sink({node, windows, sums, center}, i);
                                          Moments moments = moments_of(sums);
                                          moments.mean = moments.mean + center;
                                          set_gaussian(model, i++, moments, frame);
                                      });
    });
    job.clock.end_stage("cells", 1);
    return model;
}

/// Edge from which on soft cells are widened, voxels. In a constant field soft steps end at a
/// deviation of 0.357 of the edge for cells of 8 voxels, at 0.386 for 4, whose voxels' own variance
/// counts for more: ripples of 5 % and 2.4 % along the axes. Widened by 1.05: 2.7 %.
constexpr int kWidenedEdge = 8;
void widen(PackedCells& cells) {
    constexpr double kFactor = 1.05;
    vog::parallel_for(std::size_t{0}, cells.size(), [&](std::size_t n) {
        Moments cell = cells[n];
        for (double& c : cell.covariance) c *= kFactor * kFactor;
        cells.set(n, cell);
    });
}

}  // namespace

Gaussians uniform_model(MomentJob& job) {
    const int block = job.options.block_voxels;
    if (job.has_fine_cells()) return two_pass_model(job);
    const std::vector<LatticeField> fields = job.fields();
    FieldCells cells;
    for (const LatticeField& field : fields)
        cells.push_back(job.overlaps() ? overlapping_cells(field, block, job.options.periodic)
                                       : uniform_cells(field, block));
    job.clock.end_stage("cells", 0.3);
    FieldEmSolver em(fields, job.options.refine_seconds > 0, job.options.periodic);
    em.run(cells, job.soft_steps());
    if (job.overlaps() && job.soft_steps() > 0 && block >= kWidenedEdge)
        for (PackedCells& field : cells) widen(field);
    job.clock.end_stage("soften", 0.9);
    return final_model(job, fields, em, std::move(cells));
}

}  // namespace vog::moments
