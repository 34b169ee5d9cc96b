// given_options.cpp: options of CLI11 by their names.
#include "options/parser/given_options.h"

#include <algorithm>
#include <CLI/CLI.hpp>

namespace vog::cli {

bool GivenOptions::has(const std::string& name) const {
    const CLI::Option* option = command_->get_option_no_throw(name);
    return option && option->count() > 0;
}

bool GivenOptions::has_any(std::initializer_list<const char*> names) const {
    return std::ranges::any_of(names, [&](const char* name) { return has(name); });
}

std::vector<std::string> GivenOptions::values(const std::string& name) const {
    return has(name) ? command_->get_option(name)->results() : std::vector<std::string>{};
}

std::optional<std::string> GivenOptions::value(const std::string& name) const {
    const CLI::Option* option = command_->get_option_no_throw(name);
    if (!option) return {};
    if (option->count()) return option->results().front();
    return option->get_default_str().empty() ? "-" : option->get_default_str();
}

std::vector<std::string> GivenOptions::names(const std::string& group) const {
    std::vector<std::string> all;
    for (const CLI::Option* option : command_->get_options())
        if (option->count() && (group.empty() || option->get_group() == group))
            all.push_back(option->get_name());
    return all;
}

std::string GivenOptions::command() const { return command_->get_name(); }

std::string GivenOptions::program() const {
    const CLI::App* program = command_->get_parent();
    return program ? program->get_name() : "";
}

void GivenOptions::state(const std::string& name, const std::vector<std::string>& values) {
    CLI::Option& option = *command_->get_option(name);
    for (const std::string& value : values) option.add_result(value);
    option.run_callback();
}

}  // namespace vog::cli
