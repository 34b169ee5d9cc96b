// scene_inputs.h: the scene of a picture from input files.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "pictures/divided_volumes.h"
#include "pictures/drawing_options.h"
#include "vog/distributed.h"
#include "vog/picture.h"

namespace vog::cli {

/// Hooks for rendering by several MPI ranks; the defaults are a single process.
struct RenderRanks {
    /// Reads this rank's part of models, with the box of the whole.
    std::function<Gaussians(const std::vector<std::string>&, const ValueRules&)> load_models{};
    /// Reads this rank's part of particles, one Gaussian each.
    std::function<Gaussians(const DrawingArguments&, std::vector<std::string>& notes)>
        load_points{};
    /// Reads this rank's part of volumes, and the voxels beside it if wanted.
    std::function<DividedVolumes(const DrawingArguments&, const VolumeInputOptions&, bool beside)>
        load_volumes{};
    Collective collective{};  ///< operations between the ranks
    bool is_root = true;      ///< the rank that shades, writes and reports
    /// Inputs of a sequence that this rank renders alone: one flag per input. Empty: all of them.
    std::function<std::vector<bool>(const std::vector<std::string>&)> assigned{};
    /// One text per rank, on every rank. Empty: a single process.
    std::function<std::vector<std::string>(const std::string&)> allgather{};

    /// Whether several ranks hold parts of one input.
    bool divided() const { return collective.count > 1; }
};

/// Scene of the inputs, with the facts that reports give.
struct SceneInputs {
    Scene scene;
    FileKind kind = FileKind::model;
    std::string primitives_text;  ///< "20,000 Gaussians", "1,000 voxels in 3 levels"
    std::uint64_t gaussians = 0, active_voxels = 0;
    std::vector<std::string> notes;     ///< printed already
    std::optional<SiteCutReport> site;  ///< sum over the sites read for a view
    std::string field;                  ///< as a request names it; empty: none, or of a model

    /// Sets primitives_text. levels of a mesh; 0: none
    void set_primitives_text(std::size_t levels);
};

/// View of data for which sites are read; empty: they are read whole.
using ViewOfSites = std::function<SiteView(const Subject&)>;

/// Reads the inputs with the field that the request shows.
/// request  with its renderer
/// throws   vog::Error for inputs that cannot be read or lack the field; UsageError for options without effect
SceneInputs load_scene(const DrawingArguments& arguments, const PictureRequest& request,
                       const RenderRanks& ranks, const ViewOfSites& view = {});

/// The scalar field of this name, else the model's density, else its only scalar field.
/// input  file, for messages
/// throws vog::Error naming the fields there are, and how to make one
const ScalarField& scalar_field_of(const Fields& fields, const std::string& name,
                                   const std::string& input, Show show);

/// Reads the data of each visible layer, whose field the request then names.
SceneInputs load_layers(const DrawingArguments& arguments, PictureRequest& request,
                        const RenderRanks& ranks, const ViewOfSites& view = {});

// For parts on several ranks (divided_scene.cpp).

/// Reads the field of a text: "temperature", or "velocity.x" of a vector field; of volumes and maxima as one scalar field.
/// coverage  of a part of volumes, as read_volume_fields has it; null: whole volumes
std::vector<VoxelField> read_shown_field(const DrawingArguments& arguments,
                                         const PictureRequest& request,
                                         std::vector<Volume>& volumes,
                                         std::vector<std::string>& notes,
                                         std::vector<FieldCoverage>* coverage = nullptr);
/// Whether a volume's values below 0 may be a field: every active voxel then counts alike.
bool may_be_signed(const VolumeInputOptions& options);
std::string signed_note(const std::string& input, double lower, double upper);
/// throws  UsageError and vog::Error where several ranks hold parts of inputs whose pictures do not add
void require_addable(const PictureRequest& request, FileKind kind);
void require_addable_layers(const DrawingArguments& arguments, const PictureRequest& request);
/// This rank's part of volumes as a scene.
void load_divided(const DrawingArguments& arguments, const PictureRequest& request,
                  const RenderRanks& ranks, SceneInputs& inputs);

}  // namespace vog::cli
