// vog/scene.h: Data of pictures: models, voxels with their fields, cells, or surfaces, shared and unchanged while pictures are made.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "vog/cells.h"
#include "vog/gaussians.h"
#include "vog/levels.h"
#include "vog/lod.h"
#include "vog/subject.h"
#include "vog/surface.h"
#include "vog/voxel_field.h"

namespace vog {

struct Collective;

/// Model, with levels of detail.
struct ModelSource {
    std::shared_ptr<const Gaussians> model;
    std::shared_ptr<const Hierarchy> hierarchy{};  ///< the model's; null or empty: none
    /// Cells, drawn in place of the model, which has a Gaussian for each (scene_of in vog/convert_cells.h); null: the model is
    std::shared_ptr<const CellSource> cells{};
};

/// Field at the voxels of a source.
struct SampledField {
    std::string name, unit;          ///< the same in all processes; unit may be empty
    bool is_vector = false;          ///< whether it has three components
    std::vector<VoxelField> values;  ///< [volumes]; one without values: the volumes' own
};

/// Voxels: volumes that add up, or levels of a mesh. Volumes and maxima are drawn of parts that do not hide each other
/// (visible_parts).
struct VoxelSource {
    std::shared_ptr<const VolumeSet> volumes;
    std::vector<SampledField> fields;
    // For several processes that share them (Scene::collective).
    bool overlap = true;  ///< whether volumes may overlap those of other processes
    /// [volumes] voxels next to this process's, on the same lattice, for light by gradients; or none
    std::vector<Volume> beside{};
    std::vector<VoxelField> beside_field{};  ///< [beside]
};

/// Triangles, which layers of volume pictures draw (PictureRequest::layers).
struct SurfaceSource {
    std::shared_ptr<const Surface> surface;
};

using Source = std::variant<ModelSource, VoxelSource, SurfaceSource>;

/// Data of a picture.
struct Scene {
    std::vector<Source>
        sources;  ///< at least one, all of one kind; depths, columns, means and deviations are of their sum,
                  ///< other quantities are of one source
    Subject subject{};                      ///< part that views frame, with the units of the data
    std::string name{};                     ///< "smoke.vdb", for messages; may be empty
    std::string column = "column density";  ///< name of columns; "number per area" for particles
    /// Data of each layer of the request (PictureRequest::layers), those of hidden ones without sources; `sources` are then those of the
    /// first visible one that is no surface.
    std::vector<Scene> layers{};
    /// Processes that hold parts of the data and draw the same pictures, which are complete on the root. Null: one process.
    const Collective* collective = nullptr;

    bool has_voxels() const { return std::holds_alternative<VoxelSource>(sources.front()); }
    bool has_cells() const {
        const auto* model = std::get_if<ModelSource>(&sources.front());
        return model && model->cells;
    }
    bool has_surface() const { return std::holds_alternative<SurfaceSource>(sources.front()); }
    const ModelSource& model() const { return std::get<ModelSource>(sources.front()); }
    const VoxelSource& voxels() const { return std::get<VoxelSource>(sources.front()); }
    const Surface& surface() const { return *std::get<SurfaceSource>(sources.front()).surface; }
};

/// Scene of a model, or of volumes with their own values as their field.
Scene scene_of(Gaussians model);
Scene scene_of(Volume volume);
Scene scene_of(std::shared_ptr<const Gaussians> model,
               std::shared_ptr<const Hierarchy> hierarchy = nullptr);
Scene scene_of(std::shared_ptr<const VolumeSet> volumes);
/// Scene of triangles, for a layer.
Scene scene_of(std::shared_ptr<const Surface> surface);
/// Scene of the layers of a picture, which frames all of them.
/// layers  at least one with sources that is no surface
Scene scene_of_layers(std::vector<Scene> layers);

}  // namespace vog
