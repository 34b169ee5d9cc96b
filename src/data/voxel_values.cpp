// voxel_values.cpp: Changed values in words.
#include "vog/voxel_values.h"

#include <fmt/core.h>

#include "vog/text.h"

namespace vog {

std::string values_text(const ValueNotes& notes, const std::string& where) {
    std::string text;
    const auto add = [&](std::uint64_t count, const char* what, const char* how) {
        if (count)
            text += fmt::format("{}{} {}{} {}", text.empty() ? ": " : "; ", count, what,
                                count == 1 ? "" : "s", how);
    };
    add(notes.clipped_negative, "negative value", "set to 0");
    add(notes.skipped_nonfinite, "value", "not finite, left out");
    if (const auto& first = notes.first_skipped)
        text += fmt::format(", the first at index [{}, {}, {}]", first->x, first->y, first->z);
    add(notes.inactive_nonfinite, "inactive voxel", "with a value not finite: empty space");
    if (notes.background)
        text += fmt::format("{}density is the value above the background, {:.6g}",
                            text.empty() ? ": " : "; ", *notes.background);
    return text.empty() ? text : printable(where) + text;
}

}  // namespace vog
