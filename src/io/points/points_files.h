// points_files.h: readers and writers of each particle format, behind read_points and write_points.
#pragma once

#include "vog/points.h"

namespace vog::point_files {

Points read_points_text(const std::filesystem::path& file, const PointReadOptions& options);
void write_points_text(const std::filesystem::path& file, const Points& points);

Points read_points_vdb(const std::filesystem::path& file, const PointReadOptions& options);
void write_points_vdb(const std::filesystem::path& file, const Points& points);

}  // namespace vog::point_files
