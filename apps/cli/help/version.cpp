// version.cpp: the facts that the build system states.
#include "help/version.h"

#include <fmt/core.h>

#include "commit.h"

namespace vog::cli {

const char* version_number() { return VOG_VERSION; }
const char* commit_text() { return VOG_COMMIT; }
const char* build_type() { return VOG_BUILD_TYPE; }

std::string version_text(const std::string& program) {
    return fmt::format("{} {} (commit {}, {})", program, version_number(), commit_text(),
                       build_type());
}

}  // namespace vog::cli
