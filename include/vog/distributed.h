// vog/distributed.h: work of several processes on one data set: parts of volumes, adaptive meshes
// and models, collective operations of a conversion. Not in vog/vog.h: only vog-mpi uses it.
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
#include "vog/voxel_values.h"

namespace vog {

struct LevelOptions;
struct VdbOptions;

/// Collective operations between processes that convert one data set together. Every process must
/// make the same calls in the same order. The caller supplies both all-reduces, usually by MPI.
struct Collective {
    int index = 0,  ///< rank of this process, [0, count)
        count = 1;  ///< number of processes, >= 1
    /// Replaces each element by its sum over all processes, the same bytes in each process. Every
    /// process passes as many elements. Throws if a process has failed. Empty: a single process.
    std::function<void(std::span<double>)> allreduce_sum{};
    /// Replaces each element by its maximum over all processes.
    std::function<void(std::span<double>)> allreduce_max{};
    /// Sends to[p] to process p. Returns a vector from each process, in their order.
    std::function<std::vector<std::vector<float>>(const std::vector<std::vector<float>>& to)>
        exchange{};
    /// The same of bytes.
    std::function<std::vector<std::string>(const std::vector<std::string>& to)> exchange_bytes{};

    /// Whether there are other processes.
    bool several() const { return count > 1; }
    /// Whether there may be other processes.
    bool shared() const { return static_cast<bool>(allreduce_sum); }
    /// allreduce_sum; no change for a single process.
    void sum(std::span<double> values) const {
        if (allreduce_sum) allreduce_sum(values);
    }
    void sum(double& value) const { sum(std::span(&value, 1)); }
    /// allreduce_max; no change for a single process.
    void max(std::span<double> values) const {
        if (allreduce_max) allreduce_max(values);
    }
    /// Whether this is the process of rank 0.
    bool is_root() const { return index == 0; }
};
/// The operations of `collective`, or those of a single process if it is null.
const Collective& collective_or_single(const Collective* collective);

/// Part of a volume. Leaves and tiles in Morton order are cut into `count` runs with about the same
/// number of active voxels (a tile counts 512); this part is run `index`. Parts are disjoint, and
/// their union is the volume. A part may be empty if there are fewer aligned cubes than parts.
struct VolumePart {
    int index = 0,  ///< number of the part, [0, count)
        count = 1;  ///< number of parts, >= 1
    /// Edge, voxels, of the aligned cubes that no cut divides: a power of two, >= 8. Equal to the
    /// edge of uniform cells or a multiple: no cell lies in two parts.
    int align_voxels = 8;

    /// Whether the part is the volume itself.
    bool whole() const { return count == 1; }
};
/// Checks index, count and edge. throws vog::Error for one out of range
void validate(const VolumePart& part);

/// Copies a part of a volume, with the volume's name, source and transform. world_box of the result
/// is that of the part: views of the data need the box of the whole volume.
/// throws  vog::Error as validate does
[[nodiscard]] Volume part_of(const Volume& volume, const VolumePart& part);

/// Reader of parts of a volume in a file. A .vdb gives each part without reading the rest, at 100
/// bytes a leaf (a level set that becomes fog is held whole); a .nvdb is held whole.
class VolumeReader {
  public:
    /// options  as of read_volume in vog/volume_io.h
    /// throws   vog::Error as read_volume does, but only read checks the values of a .vdb
    explicit VolumeReader(const std::filesystem::path& file, const VdbOptions& options);
    explicit VolumeReader(const std::filesystem::path& file);
    ~VolumeReader();
    VolumeReader(VolumeReader&&) noexcept;
    VolumeReader& operator=(VolumeReader&&) noexcept;

    std::uint64_t active_voxels() const;     ///< active voxels of the whole grid, as stored
    std::size_t leaf_count() const;          ///< leaves of the whole grid with active voxels
    Box world_box() const;                   ///< box of the whole volume, world units
    const Affine& world_from_index() const;  ///< from indices to world units
    /// Reads a part.
    /// notes   is increased by the numbers of changed values; null: not counted
    /// throws  vog::Error for an invalid part, corrupt bytes, or values that the options refuse
    Volume read(const VolumePart& part = {}, ValueNotes* notes = nullptr);
    /// Reads the leaves and tiles for which wanted(origin, edge) is true: origin the least voxel
    /// index of a node, edge its voxels (8, 128 or 4096).
    /// throws  vog::Error as read does
    Volume read_where(const std::function<bool(Vec3i origin, std::int32_t edge)>& wanted);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

/// As arrangement_of in vog/levels.h, for volumes in files: nodes are read where volumes may
/// overlap, up to the first voxel that does.
/// throws  vog::Error as VolumeReader::read does
[[nodiscard]] Arrangement arrangement_of(std::span<VolumeReader> volumes);

/// Place of one level of an adaptive mesh, and of its mask.
struct LevelSource {
    std::filesystem::path file;  ///< .vdb or .nvdb
    std::string grid{};          ///< name of the grid, as VdbOptions::grid
    std::string mask{};          ///< name of the grid with its mask; empty: none
};
/// Lists the volumes and masks that read_levels reads, in its order.
/// notes   receives a line on the choice among the grids of the first file; null: not reported
/// throws  vog::Error as read_levels does for patterns
std::vector<LevelSource> level_sources(std::span<const std::filesystem::path> files,
                                       const LevelOptions& options,
                                       std::vector<std::string>* notes = nullptr);

/// Reads one part of an adaptive mesh. Each result holds this part of one level, as its last
/// volume, and before it the nodes of finer levels that overlap it, with values set to 0, so that
/// they mask it without adding to the optical depth T. T summed over the results of all parts is
/// the T of the mesh; so it is for the last volumes of the results as composite() leaves them.
/// Levels without a node in the part are left out.
/// volumes   levels, in any order
/// masks     none, or one for each volume (Levels::masks)
/// part      applied to each level by itself
/// notes     as in VolumeReader::read
/// beside    receives for each result the same of its level's nodes beside the part (read_beside); null: not read
/// throws    vog::Error as the readers do
std::vector<Levels> read_level_parts(std::span<VolumeReader> volumes, std::span<VolumeReader> masks,
                                     const VolumePart& part, ValueNotes* notes = nullptr,
                                     std::vector<Levels>* beside = nullptr);
/// Reads the nodes of a volume that share a face with a leaf of a part of it: differences between neighbouring voxels
/// need those of other parts. Some nodes of the part are among them.
/// throws    vog::Error as VolumeReader::read does
Volume read_beside(VolumeReader& reader, const Volume& part);

/// Part of a model: run `index` of `count` runs with about the same number of Gaussians.
struct ModelPart {
    int index = 0,  ///< number of the part, [0, count)
        count = 1;  ///< number of parts, >= 1
};
/// Reads a part of a model without reading the rest. Box and source_voxels are those of the whole.
/// throws  vog::Error as read_ply in vog/ply.h does, and for an index out of range
Gaussians read_ply(const std::filesystem::path& file, const ModelPart& part);
/// The same for a compact model (vog/vogz.h); reads only the chunks of the part.
/// throws  vog::Error as read_vogz does, and for an index out of range
Gaussians read_vogz(const std::filesystem::path& file, const ModelPart& part);
/// The same of a .ply or .vogz.
/// throws  vog::Error for another extension, and as those
Gaussians read_model(const std::filesystem::path& file, const ModelPart& part);

/// Header of the PLY file that write_ply writes, for a file written by several processes.
/// description  cutoff, origin, box, texts and fields (names, units, ranges) of the model; its Gaussians
///              are ignored
/// count        Gaussians in the whole file
/// rotated      whether rows have rotations
std::string ply_header(const Gaussians& description, std::uint64_t count, bool rotated);
/// Float32 values in a Gaussian's row: 11 with a rotation, 7 without, 6 more for each scalar field and 18 for each
/// vector field.
std::size_t ply_row_floats(bool rotated, const Fields& fields = {});
/// Rows of that file behind the header, ply_row_floats for each Gaussian.
/// first, count  range of Gaussians of this model
/// rotated       as in the header; a model without rotations gets the identity
std::vector<float> ply_rows(const Gaussians& gaussians, std::size_t first, std::size_t count,
                            bool rotated);

/// Writes the index of a model in several files: {"vog_models": ["model.0.ply", ...]}.
/// models  paths relative to the folder of the index
/// throws  vog::Error if the file cannot be written
void write_model_index(const std::filesystem::path& file, std::span<const std::string> models);
/// Reads the index of a model in several files.
/// returns  at least one path, with the folder of the index
/// throws   vog::Error for a missing file, or content of another form
std::vector<std::filesystem::path> read_model_index(const std::filesystem::path& file);

/// Views of the measured error (MomentReport::measured_error): twelve cameras around a box: the
/// `paper` view and three more at its distance; along the three axes and two diagonals of faces,
/// orthographic, where the faces of voxels line up; three at 1.5 bounding radii.
/// box  world units
std::vector<Camera> error_views(const Box& box);
inline constexpr int kErrorViewSize_px = 256;  ///< width and height of these views, pixels
/// Box that frames these views: `whole`, or, where it is more than twice as large, a box around all
/// but a thousandth of the mass. A single voxel far away would otherwise leave nothing to see.
/// volumes     of this process
/// whole       box of the data of all processes, world units
/// collective  sums over processes; null: a single process
Box error_view_box(std::span<const Volume> volumes, const Box& whole,
                   const Collective* collective = nullptr);
/// Views of that box. Where the finest level of a mesh has voxels smaller than their pixels, and fills at most half of the
/// radius, those along the three axes show its box instead.
std::vector<Camera> error_views(std::span<const Volume> volumes, const Box& whole,
                                const Collective* collective = nullptr);

/// Relative L2 of T over the error views, sqrt(sum (T - T_ref)^2 / sum T_ref^2).
struct RelativeError {
    double worst = -1;  ///< largest of the views
    double mean = -1;   ///< over all pixels of all views
};
/// Part of a model's error that says something: `target` times its ratio to the target, or to the error of the voxels
/// interpolated linearly if that is larger; in the worst view or over all, whichever is larger. Voxels are
/// boxes or samples of a smooth field; the distance between the two readings says how far the data know T. A
/// search for `target` looks for this.
/// finest  Gaussians of the finest cut; up to kSmallCount are no cost, and the worst view counts
double error_beyond_interpolation(const RelativeError& error, const RelativeError& interpolation,
                                  double target, std::size_t finest);

/// Finds the smallest number of Gaussians, to 5 %, whose error is at most `target`, by false
/// position on log(error) over log(count). convert_moments searches in the same way.
/// finest           Gaussians of the finest cut, the result where no budget meets the target
/// error_of_budget  converts with a budget and measures; called a dozen times at most, each call
///                  within the target with a smaller budget than the ones before. Where processes
///                  search together it must return the same number on each.
std::size_t smallest_budget(double target, std::size_t finest,
                            const std::function<double(std::size_t budget)>& error_of_budget);

}  // namespace vog
