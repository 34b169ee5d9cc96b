// own_values.cpp: names, kinds and ranges of fields that all ranks share.
#include "fields/own_values.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "fields/field_conversion.h"
#include "fields/volume_fields.h"
#include "vog/convert_fields.h"

namespace vog::mpi {

namespace {

/// cli::own_name of the volumes of all ranks.
std::string own_name(std::span<std::vector<Volume>* const> volumes, const Ranks& ranks) {
    std::string all;
    const auto include = [&](const std::string& name) {
        if (!name.empty()) all = all.empty() || all == name ? name : "density";
    };
    for (const std::vector<Volume>* one : volumes) include(cli::own_name(*one));
    for (const std::string& name : ranks.gather(std::exchange(all, {}))) include(name);
    return all;
}

/// Name, unit and kind of a field, which ranks without voxels learn from the others.
void describe(const VoxelField* field, Fields& fields, const Ranks& ranks) {
    const nlohmann::json mine = field ? nlohmann::json{{"name", field->name},
                                                       {"unit", field->unit},
                                                       {"vector", field->is_vector()},
                                                       {"measure", cli::without_values(*field)}}
                                      : nlohmann::json();
    for (const std::string& text : ranks.gather(cli::json_line(mine))) {
        const nlohmann::json one = nlohmann::json::parse(text);
        if (one.is_null() || !fields.empty()) continue;
        const auto set = [&](auto& to) { to.name = one["name"], to.unit = one["unit"]; };
        if (one["vector"])
            set(fields.vector.emplace_back());
        else
            set(fields.scalar.emplace_back()), fields.scalar.back().is_measure = one["measure"];
    }
}

}  // namespace

void add_own_values(const cli::ConvertArguments& arguments,
                    std::span<const std::optional<UniformCells>> cells,
                    std::span<std::vector<Volume>* const> volumes, SharedModel& model,
                    const Ranks& ranks) {
    const cli::FieldTexts texts = cli::field_texts(arguments, own_name(volumes, ranks));
    constexpr double kNone = std::numeric_limits<double>::infinity();
    double lower = kNone, upper = -kNone;
    for (std::size_t n = 0; n < volumes.size(); ++n) {
        std::vector<Volume>& own = *volumes[n];
        std::erase_if(own, [](const Volume& volume) { return volume.empty(); });
        std::vector<std::string> notes;  // the measure covers itself
        std::vector<std::vector<VoxelField>> fields;
        if (!own.empty()) fields = cli::read_volume_fields(texts, own, notes);
        double least = kNone, most = -kNone;
        if (!fields.empty())
            for (const VoxelField& field : fields.front())
                least = std::min(least, field.lower), most = std::max(most, field.upper);
        least = ranks.min(least), most = ranks.max(most);
        if (!fields.empty())
            for (VoxelField& field : fields.front()) field.lower = least, field.upper = most;
        lower = std::min(lower, least), upper = std::max(upper, most);
        if (!fields.empty()) add_fields(model.inputs[n], own, fields, {cells[n]});
        Fields& described = model.description.fields;
        if (described.empty())
            describe(fields.empty() ? nullptr : &fields.front().front(), described, ranks);
    }
    for (ScalarField& field : model.description.fields.scalar)
        field.lower = lower, field.upper = upper;
    for (VectorField& field : model.description.fields.vector)
        field.lower = lower, field.upper = upper;
}

}  // namespace vog::mpi
