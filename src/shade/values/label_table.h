// label_table.h: tables of labels, as of a segmentation, with names and colours.
#pragma once

#include <string>

#include "vog/value_transfer.h"

namespace vog::shading {

/// Transfer function of labels: each visible one has its colour and opacity from half below to half above it.
/// text    "label name r g b a", of 3D Slicer and FreeSurfer, or ITK-SNAP's rows; # begins a comment
/// only    name of one label, which is visible; empty: those that the table shows
/// where   file with ": ", for messages
/// throws  vog::Error naming the line, and for no visible label
TransferPoints label_points(const std::string& text, const std::string& only,
                            const std::string& where);
/// Whether points are a table of labels: bands from half below a whole number to half above it.
bool is_label_table(const TransferPoints& points);

}  // namespace vog::shading
