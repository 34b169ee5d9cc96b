// ply_fields.h: fields of a model as properties of a PLY file, described in comment lines (docs/formats.md).
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

#include "io/ply/ply_header.h"
#include "vog/fields.h"

namespace vog::ply {

/// Header lines `comment field KIND NAME LOWER UPPER [UNIT]`, one a field; KIND scalar, measure (the scalar field
/// that is the density itself) or vector.
std::string field_comments(const Fields& fields);
/// Fields that the comments describe, for no Gaussians.
/// throws  vog::Error for a malformed line, and as check_descriptions does
Fields described_fields(const std::filesystem::path& file, const Header& header);
/// Checks that the vertices of a file in vog's layout have every property of these fields.
/// throws  vog::Error naming the first that is missing
void require_columns(const std::filesystem::path& file, const Header& header, const Fields& fields);

}  // namespace vog::ply
