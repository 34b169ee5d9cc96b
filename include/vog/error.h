// vog/error.h: the exception type for bad inputs, files and devices.
#pragma once

#include <stdexcept>
#include <string>

namespace vog {

/// Exception for every failure a user can cause: a bad file, an option out of range, an absent
/// device. The text of what() is one line with the failure, its place, the value found and the
/// values that would be valid: `smoke.vdb: no grid named 'density' (it has: temperature, flame)`.
class Error : public std::runtime_error {
  public:
    /// message  one line; may contain raw names and bytes from files: what() is
    ///          printable(message)
    explicit Error(const std::string& message);
};

}  // namespace vog
