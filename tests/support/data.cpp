// data.cpp: paths of this build, in one file, so that all other objects are the same in any folder.
#include "support/data.h"

namespace vog::test {

std::filesystem::path source_dir() { return VOG_SOURCE_DIR; }
std::string vog_command() { return VOG_COMMAND; }

}  // namespace vog::test
