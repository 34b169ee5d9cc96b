// usage_error.h: error of a command line, which ends a command with exit code 2.
#pragma once

#include <stdexcept>

namespace vog::cli {

/// Options that are wrong, whatever the files hold; the message names them.
struct UsageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

}  // namespace vog::cli
