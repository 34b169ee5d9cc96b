// given_options.h: options that a command line states, for runs that ask which.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace vog::cli {

/// Options of a parsed command by their names: "--size".
class GivenOptions {
  public:
    /// command  must outlive this
    explicit GivenOptions(CLI::App& command) : command_(&command) {}

    /// Whether an option is stated; false for those that the command lacks.
    bool has(const std::string& name) const;
    bool has_any(std::initializer_list<const char*> names) const;
    /// Values of an option that is stated, in words; empty: it is not.
    std::vector<std::string> values(const std::string& name) const;
    /// Value of an option, the default where it is not stated; "-": without one. None: the command lacks it.
    std::optional<std::string> value(const std::string& name) const;
    /// Names of the options that are stated, in the order of the help.
    /// group  of the help; empty: all
    std::vector<std::string> names(const std::string& group = {}) const;
    std::string command() const;  ///< "render"
    std::string program() const;  ///< "vog" or "vog-mpi"

    /// States an option, as if the command line did.
    void state(const std::string& name, const std::vector<std::string>& values);

  private:
    CLI::App* command_;
};

}  // namespace vog::cli
