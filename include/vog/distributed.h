// vog/distributed.h: one data set shared out among processes: parts of volumes, levels and models,
// and the collective operations of a conversion. Not in vog/vog.h: vog-mpi is its user.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/levels.h"
#include "vog/volume.h"

namespace vog {

struct LevelOptions;
struct VdbOptions;

/// Collective operations between processes that convert one data set together. Every process must
/// make the same calls in the same order. The caller supplies both all-reduces, usually by MPI.
struct Collective {
    int index = 0, count = 1;  ///< rank of this process, number of processes
    /// Sums element by element over all processes: each gets the same bytes. Throws where one of
    /// them has failed. Empty: one process.
    std::function<void(std::span<double>)> allreduce_sum{};
    /// Largest element by element, likewise.
    std::function<void(std::span<double>)> allreduce_max{};

    bool shared() const { return static_cast<bool>(allreduce_sum); }
    void sum(std::span<double> values) const {
        if (allreduce_sum) allreduce_sum(values);
    }
    void sum(double& value) const { sum(std::span(&value, 1)); }
    void max(std::span<double> values) const {
        if (allreduce_max) allreduce_max(values);
    }
    bool is_root() const { return index == 0; }
};
/// `collective`, or a single process where it is null.
const Collective& collective_or_single(const Collective* collective);

/// One of `count` parts: leaves and tiles in Morton order are cut into runs of about as many active
/// voxels (a tile counts as a leaf), and this is run `index`. Parts are disjoint, together the
/// whole, and may be empty: where there are fewer cubes than parts.
struct VolumePart {
    int index = 0, count = 1;
    int align_voxels = 8;  ///< runs begin where aligned cubes of this edge do; a power of two, >= 8

    bool whole() const { return count == 1; }
};
/// throws vog::Error for a count below 1, an index outside, an edge that is no power of two
void validate(const VolumePart& part);

/// A part of a volume, with its name, source and transform. Its box is its own: views of the whole
/// are taken of the whole's. throws vog::Error as validate() does
[[nodiscard]] Volume part_of(const Volume& volume, const VolumePart& part);

/// A volume in a file, whose parts are read as asked: of a .vdb without the rest; a .nvdb is held
/// whole.
class VolumeReader {
  public:
    /// throws vog::Error as VdbReader and read_nvdb do
    explicit VolumeReader(const std::filesystem::path& file, const VdbOptions& options);
    explicit VolumeReader(const std::filesystem::path& file);
    ~VolumeReader();
    VolumeReader(VolumeReader&&) noexcept;
    VolumeReader& operator=(VolumeReader&&) noexcept;

    std::uint64_t active_voxels() const;  ///< of the whole, as stored
    std::size_t leaf_count() const;       ///< of the whole: those with active voxels
    Box world_box() const;                ///< of the whole
    const Affine& world_from_index() const;
    /// Negative values found are added to `negative`. throws vog::Error as VdbReader does
    Volume read(const VolumePart& part = {}, std::uint64_t* negative = nullptr);
    Volume read_where(const std::function<bool(Vec3i origin, std::int32_t edge)>& wanted);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// A volume that read_levels reads, and its mask.
struct LevelSource {
    std::filesystem::path file;
    std::string grid{};  ///< as VdbOptions::grid
    std::string mask{};  ///< empty: none
};
/// What read_levels reads, in its order. throws as it does for patterns and names
std::vector<LevelSource> level_sources(std::span<const std::filesystem::path> files,
                                       const LevelOptions& options);

/// Of every level this part of its leaves, the last volume of a Levels; before it what of finer
/// levels lies over it, all values 0: it hides and adds nothing. So the T of the results, for all
/// parts, is the T of the levels; so is what composite() leaves of their last volumes. Levels
/// without a leaf in the part are left out.
/// volumes  in any order, as Levels has them
/// masks    none, or one for each volume
/// throws   vog::Error as the readers do
std::vector<Levels> read_level_parts(std::span<VolumeReader> volumes, std::span<VolumeReader> masks,
                                     const VolumePart& part, std::uint64_t* negative = nullptr);

/// One of `count` runs of about as many Gaussians: this is run `index`.
struct ModelPart {
    int index = 0, count = 1;
};
/// A part of a model: the rest of the body is not read. Box and source voxels are the whole's.
/// throws vog::Error as read_ply does, and for an index outside
Gaussians read_ply(const std::filesystem::path& file, const ModelPart& part);

/// What write_ply writes, for those who write one file together: the header of a model of `count`
/// Gaussians that this one describes, and the rows behind it, Gaussian by Gaussian.
std::string ply_header(const Gaussians& description, std::uint64_t count, bool rotated);
std::vector<float> ply_rows(const Gaussians& gaussians, std::size_t first, std::size_t count,
                            bool rotated);

/// A model in several files: {"vog_models": ["model.0.ply", ...]}, beside the index or below it.
void write_model_index(const std::filesystem::path& file, std::span<const std::string> models);
/// throws vog::Error for a missing file, anything else than such an index
std::vector<std::filesystem::path> read_model_index(const std::filesystem::path& file);

/// The views that measured errors are of, as MomentReport has it; 256^2 pixels.
std::vector<Camera> error_views(const Box& box);
inline constexpr int kErrorViewSize_px = 256;

}  // namespace vog
