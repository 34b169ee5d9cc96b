// cells.cpp: bounds, checks and notes of cells of any shape.
#include "vog/cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "vog/error.h"

namespace vog {

namespace {

std::string where(const Cells& cells) { return cells.source.empty() ? "cells" : cells.source; }

void check_values(const Cells& cells, const CellValues& values, bool scalar) {
    const std::size_t wanted = values.at_points ? cells.points.size() : cells.size();
    if (values.component.size() != 1 && (scalar || values.component.size() != 3))
        throw Error(fmt::format("{}: '{}' of {} components, expected {}", where(cells), values.name,
                                values.component.size(), scalar ? "1" : "1 or 3"));
    for (const BigVector<float>& component : values.component)
        if (component.size() != wanted)
            throw Error(fmt::format("{}: '{}' of {} values, expected {}, one for each {}",
                                    where(cells), values.name, component.size(), wanted,
                                    values.at_points ? "point" : "cell"));
}

}  // namespace

int corner_count(int type) {
    switch (type) {
        case 5:
            return 3;
        case 8:
        case 9:
        case 10:
            return 4;
        case 11:
        case 12:
            return 8;
        case 13:
            return 6;
        case 14:
            return 5;
        default:
            return 0;
    }
}

std::string notes_text(const CellNotes& notes, const Cells& cells) {
    std::string left, text;
    const auto add = [](std::string& to, std::uint64_t count, const char* what) {
        if (count) to += fmt::format("{}{} {}", to.empty() ? "" : ", ", count, what);
    };
    add(left, notes.flat, "flat");
    add(left, notes.nonfinite, "not finite");
    add(left, notes.others, "of other types or without a thickness");
    if (!left.empty()) text = left + " left out";
    add(text, notes.inverted, "inverted, which count as the others");
    return text.empty() ? text
                        : fmt::format("{}: of {} cells {}", where(cells), cells.size(), text);
}

Box bounds(const Cells& cells) {
    Box box;
    for (const Vec3d& point : cells.points)
        if (finite(point)) box.include(point);
    return box;
}

void validate(const Cells& cells) {
    const auto refuse = [&](const std::string& text) {
        throw Error(fmt::format("{}: {}", where(cells), text));
    };
    if (cells.type.empty()) refuse("no cells, expected one or more");
    if (cells.end.size() != cells.size())
        refuse(fmt::format("{} ends of cells, expected {}", cells.end.size(), cells.size()));
    std::uint64_t begin = 0;
    for (std::size_t n = 0; n < cells.size(); ++n) {
        const int wanted = corner_count(cells.type[n]);
        const std::uint64_t end = cells.end[n];
        if (end < begin || end > cells.corner.size() ||
            (wanted && end - begin != static_cast<std::uint64_t>(wanted)))
            refuse(fmt::format("cell {} of type {} with corners {} to {} of {}, expected {}", n,
                               cells.type[n], begin, end, cells.corner.size(), wanted));
        begin = end;
    }
    if (begin != cells.corner.size())
        refuse(fmt::format("{} corners, expected {} by the last cell", cells.corner.size(), begin));
    for (const std::uint32_t corner : cells.corner)
        if (corner >= cells.points.size())
            refuse(fmt::format("a corner at point {}, expected less than {}", corner,
                               cells.points.size()));
    if (!(cells.thickness >= 0 && std::isfinite(cells.thickness)))
        refuse(fmt::format("thickness {}, expected 0 or more", cells.thickness));
    check_values(cells, cells.density, true);
    for (const CellValues& field : cells.fields) check_values(cells, field, false);
}

}  // namespace vog
