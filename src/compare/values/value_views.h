// value_views.h: errors of a model's pictures by value over views around the data.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "compare/error_views.h"
#include "render/by_value/volume_image.h"
#include "vog/value_transfer.h"
#include "vog/volume_picture.h"
#include "vog/voxel_field.h"

namespace vog::comparison {

/// Errors of one model's pictures by value.
struct ValueErrors {
    RelativeError relative_l2;
    /// [views][pixels] summed over functions; of pixels that are not compared that of the one beside them that is
    std::vector<std::vector<float>> square;
};

/// Pictures of the data by value from several directions, under the functions of compare/values/value_functions.h, and
/// the errors of models against them: relative L2 of premultiplied colour and alpha,
/// sqrt(sum |c - c_ref|^2 / sum |c_ref|^2) over pixels, or a fifth of them (ErrorViews::takes_fifth), and functions.
class ValueViews {
  public:
    /// Pictures of voxels, constant in each.
    /// volumes  one, or the parts of a mesh
    /// field    [volumes] a scalar field; must not be constant
    /// views    of their T: the same cameras; the radius of what they show is twelve unit distances
    /// throws   vog::Error for a constant field
    /// memory   1 MB a picture, three for each camera
    ValueViews(std::span<const Volume> volumes, std::span<const VoxelField> field,
               const ErrorViews& views);
    /// model  with the field, by its name
    ValueErrors errors(const Gaussians& model) const;
    RelativeError relative_l2(const Gaussians& model) const { return errors(model).relative_l2; }
    /// Squared error attributed to each Gaussian [N] (compare/error_shares.h).
    /// errors  of the same model
    std::vector<float> error_of_each_gaussian(const Gaussians& model,
                                              const ValueErrors& errors) const;

  private:
    /// Calls take(view, function, picture) for the model's pictures.
    template <class Take>
    void for_each_picture(const Gaussians& model, const Take& take) const;

    /// Calls visit(column, row, place) for the pixels that are compared.
    template <class Visit>
    void for_each_pixel(const Visit& visit) const;

    std::string field_;
    bool fifth_;
    std::vector<ValueTransfer> functions_;
    std::vector<Camera> cameras_;
    std::vector<std::vector<VolumeImage>> reference_;  ///< [views][functions]
};

}  // namespace vog::comparison
