// vdb_zip.h: .vdb files with values compressed by zip in place of blosc: slower and mostly smaller.
#pragma once

#include <filesystem>

#include "vog/volume.h"

namespace vog::vdb {

/// write_vdb of one volume, by zip. throws vog::Error as write_vdb does
void write_vdb_zip(const std::filesystem::path& file, const Volume& volume, bool half);

}  // namespace vog::vdb
