// points_files.cpp: choice of the particle format by extension.
#include "io/points/points_files.h"

namespace vog {

using namespace point_files;

namespace {

bool is_vdb(const std::filesystem::path& file) {
    const std::string extension = file.extension().string();
    return extension == ".vdb" || extension == ".VDB";
}

}  // namespace

Points read_points(const std::filesystem::path& file, const PointReadOptions& options) {
    return is_vdb(file) ? read_points_vdb(file, options) : read_points_text(file, options);
}

void write_points(const std::filesystem::path& file, const Points& points) {
    validate(points);
    is_vdb(file) ? write_points_vdb(file, points) : write_points_text(file, points);
}

}  // namespace vog
