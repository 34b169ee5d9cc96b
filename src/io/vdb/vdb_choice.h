// vdb_choice.h: choice of a grid by name, the same for .vdb and .nvdb files.
#pragma once

#include <fmt/ranges.h>

#include <string>
#include <vector>

#include "io/byte_source.h"
#include "vog/error.h"

namespace vog::vdb {

/// Values of a grid, in the order in which grids are chosen without a name.
enum class ValueKind { numbers, switches, others };  ///< switches: bool and mask grids, 0 and 1

/// Grid of this name, "density[1]" where several have one; without a name the only one of numbers, else of switches,
/// else the one named density.
/// entries  with `name`, for display and of one grid each, and `plain_name`
/// kind_of  ValueKind of an entry
/// throws vog::Error if there is none or more than one, with the names of the file's grids
template <class Entry, class Kind>
const Entry& chosen_of(const std::vector<Entry>& entries, const std::string& file,
                       const std::string& requested, const Kind& kind_of) {
    if (entries.empty()) throw Error(fmt::format("{}: no grids", file));
    const std::string name = grid_name(requested);
    std::vector<std::string> names;
    std::vector<const Entry*> exact, plain, numbers, switches;
    for (const Entry& entry : entries) {
        names.push_back(entry.name);
        if (entry.name == name) exact.push_back(&entry);
        if (entry.plain_name == name) plain.push_back(&entry);
        if (kind_of(entry) == ValueKind::numbers) numbers.push_back(&entry);
        if (kind_of(entry) == ValueKind::switches) switches.push_back(&entry);
    }
    const std::string list = fmt::format("it has: {}", fmt::join(names, ", "));
    if (!name.empty()) {
        for (const auto& found : {exact, plain})
            if (found.size() == 1) return *found.front();
        throw Error(fmt::format("{}: {} named '{}' ({})", file,
                                plain.empty() ? "no grid" : "several grids", name, list));
    }
    std::vector<const Entry*>& scalar = numbers.empty() ? switches : numbers;
    const std::size_t count = scalar.size();
    if (count == 0)
        throw Error(
            fmt::format("{}: no scalar grid ({}); vector grids are read when named", file, list));
    if (count > 1)
        std::erase_if(scalar, [](const Entry* entry) { return entry->plain_name != "density"; });
    if (scalar.size() == 1) return *scalar.front();
    throw Error(
        fmt::format("{}: {} scalar grids, expected one, or one named 'density', or a name ({})",
                    file, count, list));
}

}  // namespace vog::vdb
