// points_files.h: the kinds of files that particles come in; vog/points.h chooses by extension.
#pragma once

#include "vog/points.h"

namespace vog::point_files {

Points read_points_text(const std::filesystem::path& file, const PointReadOptions& options);
void write_points_text(const std::filesystem::path& file, const Points& points);

Points read_points_vdb(const std::filesystem::path& file, const PointReadOptions& options);
void write_points_vdb(const std::filesystem::path& file, const Points& points);

}  // namespace vog::point_files
