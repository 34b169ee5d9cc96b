// grid_choice.cpp: the grid that is most likely meant, and its note.
#include "io/grid_choice.h"

#include <algorithm>
#include <cctype>

#include "vog/text.h"

namespace vog {

namespace {

/// Pattern of names that all differ only in a number at their end; empty: they are not levels.
std::string common_pattern(std::span<const std::string> names) {
    if (names.size() < 2) return {};
    std::size_t same = names.front().size();
    for (const std::string& name : names) {
        const auto [a, b] = std::ranges::mismatch(names.front(), name);
        same = std::min(same, static_cast<std::size_t>(a - names.front().begin()));
    }
    std::string start = names.front().substr(0, same);
    // Numbers of several digits may begin alike: density_L10 and density_L11.
    while (!start.empty() && std::isdigit(static_cast<unsigned char>(start.back())))
        start.pop_back();
    if (start.empty()) return {};
    const bool numbers = std::ranges::all_of(names, [&](const std::string& name) {
        return name.size() > start.size() &&
               std::all_of(name.begin() + static_cast<std::ptrdiff_t>(start.size()), name.end(),
                           [](unsigned char letter) { return std::isdigit(letter); });
    });
    return numbers ? start + "*" : "";
}

}  // namespace

std::string level_pattern(const std::vector<std::string>& names) {
    if (std::string all = common_pattern(names); !all.empty()) return all;
    std::vector<std::string> densities;
    for (const std::string& name : names)
        if (name.starts_with("density")) densities.push_back(name);
    return common_pattern(densities);
}

std::string levels_note(const std::string& file, const std::string& pattern) {
    return printable(fmt::format(
        "{}: reading the grids '{}' as levels of one mesh; --grid chooses one", file, pattern));
}

std::string listed(std::span<const std::string> names) {
    constexpr std::size_t kMost = 8;
    if (names.size() <= kMost) return fmt::format("{}", fmt::join(names, ", "));
    return fmt::format("{}, ..., {}", fmt::join(names.first(kMost - 1), ", "), names.back());
}

LikelyGrid likely_grid(const std::string& file, std::span<const std::string> names,
                       const std::function<double(std::size_t)>& size_of, bool refuse,
                       std::string_view preferred) {
    if (names.size() == 1) return {};
    std::vector<double> size;
    for (std::size_t n = 0; n < names.size(); ++n) size.push_back(size_of(n));
    const auto is_preferred = [&](std::size_t n) {
        return size[n] > 0 && names[n].substr(0, names[n].find('[')) == preferred;
    };
    std::size_t best = 0;
    for (std::size_t n = 1; n < names.size(); ++n)
        if (is_preferred(n) == is_preferred(best) ? size[n] > size[best] : is_preferred(n))
            best = n;
    std::vector<std::string> others(names.begin(), names.end());
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(best));
    if (names[best] == "density" && is_preferred(best)) return {best, {}};
    if (refuse)
        throw Error(fmt::format("{}: {} grids; choose one with --grid (it has: {})", file,
                                names.size(), listed(names)));
    const bool equal = std::ranges::count(size, size[best]) == std::ssize(size);
    return {best, printable(fmt::format(
                      "{}: reading '{}', {} of {} grids; --grid chooses another: {}", file,
                      names[best], equal || is_preferred(best) ? "one" : "the largest",
                      names.size(), listed(others)))};
}

}  // namespace vog
