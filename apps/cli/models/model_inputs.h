// model_inputs.h: inputs of vog page, pack, export and convert as models.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "files/inputs.h"
#include "options/output_options.h"
#include "terminal/terminal.h"
#include "vog/linear.h"
#include "vog/lod.h"

namespace vog::cli {

/// A model, and where its hierarchy comes from.
struct InputModel {
    std::string name;
    Gaussians model;
    Hierarchy hierarchy{};  ///< of its file; empty: built
    std::optional<Affine>
        index_from_world{};  ///< lattice of the model's cells; none: the box of the means is divided
};

/// Models of files, the first one of a site; all volumes, or all particles, converted to one model.
class ModelInputs {
  public:
    /// arguments, stages  must outlive this
    /// throws             vog::Error for inputs of several kinds
    ModelInputs(const ModelArguments& arguments, Stages& stages);

    FileKind kind() const { return kind_; }
    std::size_t count() const { return kind_ == FileKind::model ? arguments_.inputs.size() : 1; }
    /// Model n, with at most --budget Gaussians.
    /// with_hierarchy  whether the hierarchy of its file is read
    InputModel read(std::size_t n, bool with_hierarchy);
    /// Levels of detail of model n, the model first.
    /// most  number of levels
    std::vector<Gaussians> levels(std::size_t n, std::size_t most);
    /// All models as one.
    Gaussians sum();
    /// Notes on the inputs, printed already.
    std::vector<std::string>& notes() { return notes_; }

  private:
    std::vector<Gaussians> convert_volumes(std::size_t most, std::optional<Affine>* lattice);
    Gaussians convert_particles();
    void note_conversion(const Gaussians& model) const;

    const ModelArguments& arguments_;
    Stages& stages_;
    FileKind kind_;
    std::vector<std::string> notes_;
};

/// Name of a model for people: that of a site's model, else its file's without folder and extension.
std::string model_name(const std::string& file);

}  // namespace vog::cli
