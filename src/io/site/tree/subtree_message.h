// subtree_message.h: Gaussians and trees of chunks as bytes, between the processes of one run.
#pragma once

#include <string>

#include "io/site/tree/subtree.h"
#include "vog/gaussians.h"

namespace vog::site {

/// Arrays of a model.
std::string message_of(const Gaussians& model);
/// Appends the arrays of a message, which has the same fields; a message of no bytes has none.
/// throws  vog::Error for a message that is cut short
void append_message(Gaussians& model, const std::string& message);

std::string message_of(const Subtree& tree);
/// like    model of the same origin, cutoff and fields
/// throws  vog::Error for a message that is cut short
Subtree subtree_of(const std::string& message, const Gaussians& like);

}  // namespace vog::site
