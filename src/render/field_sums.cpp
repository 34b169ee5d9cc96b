// field_sums.cpp: Choice of a field by its name, and its sums along one ray through one Gaussian in closed
// form, double precision (docs/fields.md). Every renderer is tested against it.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "render/shown_field.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog {

namespace {

[[noreturn]] void no_such_field(const std::string& text, const Fields& fields) {
    if (fields.empty())
        throw Error(fmt::format(
            "no field '{}': the model has none; vog convert IN -o model.ply --field {} adds it",
            printable(text), printable(text)));
    std::vector<std::string> names;
    for (const std::string& name : fields.names()) names.push_back(printable(name));
    throw Error(fmt::format(
        "no field '{}' in the model, expected one of {}{}; vog convert IN -o model.ply --field "
        "NAME adds others",
        printable(text), fmt::join(names, ", "),
        fields.vector.empty() ? "" : " (of a vector field NAME.x, NAME.y or NAME.z, too)"));
}

}  // namespace

FieldChoice field_choice(const std::string& text, const Fields& fields) {
    if (fields.find_scalar(text)) return {text, FieldPart::value};
    if (fields.find_vector(text)) return {text, FieldPart::view};
    const std::size_t dot = text.rfind('.');
    if (dot == std::string::npos || dot + 2 != text.size()) no_such_field(text, fields);
    const std::string name = text.substr(0, dot);
    const char part = text.back();
    if (!fields.find_vector(name) || part < 'x' || part > 'z') no_such_field(text, fields);
    return {name, part == 'x' ? FieldPart::x : part == 'y' ? FieldPart::y : FieldPart::z};
}

FieldSums field_sums(const Gaussians& gaussians, const FieldChoice& choice, std::size_t i,
                     Vec3d origin, Vec3d direction) {
    const Vec3d along = normalized(direction);
    const Mat3 w = whitening(gaussians, i);
    const Vec3d to_mean = vec_cast<double>(gaussians.mean[i]) - (origin - gaussians.origin);
    const double k = double{gaussians.cutoff}, density = double{gaussians.density[i]};
    const device::SegmentMoments s =
        device::segment_moments(plain(w * to_mean), plain(w * along), k * k);
    if (!(s.zeroth > 0)) return {};
    const device::FieldPlane plane = field_towards(gaussians, choice, along).plane(i);
    const device::FieldMean mean =
        device::mean_along(plane, plain(s.nearest * along - to_mean), plain(along), s);
    const double column = density * s.zeroth;
    return {column, column * mean.first, column * mean.second};
}

}  // namespace vog
