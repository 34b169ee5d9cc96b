// request_effects.h: Options without effect, by rules between them and by renderers.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>

#include "vog/picture.h"
#include "vog/request_schema.h"

namespace vog {

/// Refuses options by rules.
/// of         what the rules are for: a quantity, a conversion
/// is_stated  whether an option is stated
/// value_of   its value; empty: none
/// throws     RequestError for an option without effect
void require_rules(std::span<const OptionRule> rules, const std::string& of,
                   const std::function<bool(const std::string&)>& is_stated,
                   const std::function<std::string(const std::string&)>& value_of);

/// throws  RequestError for a member that changes nothing of what this renderer draws of this data
void require_renderer_effects(const PictureRequest& request, Renderer renderer,
                              std::optional<RenderInput> input);

/// throws  RequestError for members of a layer that its kind has not
void require_layer_effects(const Layer& layer, bool is_surface);

/// throws  RequestError for linear interpolation where no layer is interpolated
void require_interpolation(const ResolvedPicture& picture);

/// Scale that a request's range states, or its points at values: those of a mean, a maximum, a volume and a slice are values of the
/// field, those of other quantities are shares. Nothing: open.
/// throws  RequestError for points at values beside a range or a scale, and a table of labels for numbers that are none
std::optional<ColorScale> stated_scale(const PictureRequest& request);

}  // namespace vog
