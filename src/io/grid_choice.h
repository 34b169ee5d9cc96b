// grid_choice.h: choice among the grids of a file, the same for all readers of volumes and particles.
#pragma once

#include <fmt/ranges.h>

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/byte_source.h"
#include "vog/error.h"
#include "vog/volume_io.h"

namespace vog {

/// Values of a grid, in the order in which grids are chosen without a name.
enum class ValueKind { numbers, switches, others };  ///< switches: bool and mask grids, 0 and 1

/// Grid that is most likely meant where none is named.
struct LikelyGrid {
    std::size_t index = 0;
    std::string
        note{};  ///< which one it is, and the others, one line; empty: the only one, or the preferred one
};

/// Choice where no grid is named: the only one, else the preferred one, else the largest, of equal ones the first.
/// Grids of size 0 only if there is no other.
/// names      for display, of one grid each: "density[1]"; at least one
/// size_of    active voxels or particles of a grid; 0: nothing that can be drawn. Called for several grids only
/// preferred  name without the number
/// refuse     throw vog::Error with the names where the largest would be chosen: the result is a number
LikelyGrid likely_grid(const std::string& file, std::span<const std::string> names,
                       const std::function<double(std::size_t)>& size_of, bool refuse,
                       std::string_view preferred = "density");

/// Note that all grids of a pattern are taken.
std::string levels_note(const std::string& file, const std::string& pattern);

/// Names for a message; of more than eight the first seven and the last.
std::string listed(std::span<const std::string> names);

/// A requested grid.
struct GridRequest {
    std::string name{};   ///< empty: likely_grid
    bool refuse = false;  ///< as of likely_grid
    bool levels = false;  ///< names of which level_pattern makes one are no choice: all are taken
};
/// Result of a request without a name.
struct DefaultGrid {
    std::string name{},  ///< name or pattern
        note{};          ///< as LikelyGrid::note
};

/// Grid of this name, "density[1]" where several have one; without a name likely_grid of those of numbers, else of switches.
/// answer   receives the result of a request without a name; null: not needed
/// entries  with `name`, for display and of one grid each, and `plain_name`
/// kind_of  ValueKind of an entry
/// size_of  as of likely_grid, of an entry
/// throws vog::Error if there is none of the name or more than one, with the names of the file's grids
template <class Entry, class Kind, class Size>
const Entry& chosen_of(const std::vector<Entry>& entries, const std::string& file,
                       const GridRequest& request, DefaultGrid* answer, const Kind& kind_of,
                       const Size& size_of) {
    if (entries.empty()) throw Error(fmt::format("{}: no grids", file));
    const std::string name = grid_name(request.name);
    std::vector<std::string> names;
    std::vector<const Entry*> exact, plain, numbers, switches;
    for (const Entry& entry : entries) {
        names.push_back(entry.name);
        if (entry.name == name) exact.push_back(&entry);
        if (entry.plain_name == name) plain.push_back(&entry);
        if (kind_of(entry) == ValueKind::numbers) numbers.push_back(&entry);
        if (kind_of(entry) == ValueKind::switches) switches.push_back(&entry);
    }
    if (!name.empty()) {
        for (const auto& found : {exact, plain})
            if (found.size() == 1) return *found.front();
        throw Error(fmt::format("{}: {} named '{}' (it has: {})", file,
                                plain.empty() ? "no grid" : "several grids", name, listed(names)));
    }
    const std::vector<const Entry*>& scalar = numbers.empty() ? switches : numbers;
    if (scalar.empty())
        throw Error(fmt::format("{}: no scalar grid (it has: {}); vector grids are read when named",
                                file, listed(names)));
    names.clear();
    for (const Entry* entry : scalar) names.push_back(entry->name);
    if (const std::string pattern = request.levels ? level_pattern(names) : ""; !pattern.empty()) {
        if (answer) *answer = {pattern, levels_note(file, pattern)};
        return *scalar.front();
    }
    const LikelyGrid likely = likely_grid(
        file, names, [&](std::size_t n) { return size_of(*scalar[n]); }, request.refuse);
    if (answer) *answer = {names[likely.index], likely.note};
    return *scalar[likely.index];
}

}  // namespace vog
