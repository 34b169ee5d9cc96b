// data.cpp: the paths of this build, in one file, so that all others compile the same anywhere.
#include "support/data.h"

namespace vog::test {

std::filesystem::path source_dir() { return VOG_SOURCE_DIR; }
std::string vog_command() { return VOG_COMMAND; }

}  // namespace vog::test
