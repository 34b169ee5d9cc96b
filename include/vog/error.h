// vog/error.h: the one exception type for bad inputs, files and devices.
#pragma once

#include <stdexcept>
#include <string>

namespace vog {

/// Thrown for anything a user can cause: a bad file, an option out of range, an absent device.
/// what() is one line that says what, where, got and expected:
/// `smoke.vdb: no grid named 'density' (it has: temperature, flame)`.
class Error : public std::runtime_error {
  public:
    explicit Error(const std::string& message) : std::runtime_error(message) {}
};

}  // namespace vog
