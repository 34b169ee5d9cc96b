// points_files.cpp: particles by the extension of their file.
#include "io/points_files.h"

namespace vog {

Points read_points(const std::filesystem::path& file, const PointReadOptions& options) {
    return read_points_text(file, options);
}

void write_points(const std::filesystem::path& file, const Points& points) {
    validate(points);
    write_points_text(file, points);
}

}  // namespace vog
