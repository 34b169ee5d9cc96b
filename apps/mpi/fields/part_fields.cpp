// part_fields.cpp: names, kinds and ranges of fields that all ranks share.
#include "fields/part_fields.h"

#include <algorithm>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "conversion/field_conversion.h"
#include "conversion/volume_fields.h"
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

/// Names, units and kinds of fields, which ranks without voxels learn from the others.
void describe(std::span<const std::vector<VoxelField>> own, Fields& fields, const Ranks& ranks) {
    nlohmann::json mine = nlohmann::json::array();
    for (const std::vector<VoxelField>& field : own)
        mine.push_back({{"name", field.front().name},
                        {"unit", field.front().unit},
                        {"vector", field.front().is_vector()},
                        {"background", field.front().background},
                        {"measure", std::ranges::all_of(field, cli::without_values)}});
    for (const std::string& text : ranks.gather(cli::json_line(mine))) {
        if (!fields.empty()) continue;
        for (const nlohmann::json& one : nlohmann::json::parse(text)) {
            const auto set = [&](auto& to) { to.name = one["name"], to.unit = one["unit"]; };
            if (one["vector"]) {
                set(fields.vector.emplace_back());
                continue;
            }
            ScalarField& field = fields.scalar.emplace_back();
            set(field), field.is_measure = one["measure"];
            if (field.is_measure) field.background = one["background"];
        }
    }
}

/// Sums of all ranks; texts of the lowest that has any.
FieldCoverage over_ranks(FieldCoverage part, const Ranks& ranks) {
    double sums[4] = {part.mass, part.covered_mass, part.voxels, part.covered_voxels};
    ranks.sum(sums);
    for (std::string* text : {&part.grid, &part.volume}) {
        std::vector<std::string> all = ranks.gather(*text);
        std::erase(all, std::string());
        *text = all.empty() ? std::string() : all.front();
    }
    return {part.grid, part.volume, sums[0], sums[1], sums[2], sums[3]};
}

/// Leaves and tiles, which division changes.
double node_count(const std::vector<Volume>& volumes) {
    std::size_t count = 0;
    for (const Volume& volume : volumes) count += volume.leaves.size() + volume.tiles.size();
    return static_cast<double>(count);
}

/// Range of a field over all ranks.
struct Range {
    double lower = std::numeric_limits<double>::infinity(), upper = -lower;
};

/// Gives a field of one input the range of all ranks, and reports it.
Range share_range(std::vector<VoxelField>& field, const Ranks& ranks) {
    Range range;
    for (const VoxelField& one : field)
        range = {std::min(range.lower, one.lower), std::max(range.upper, one.upper)};
    range = {ranks.min(range.lower), ranks.max(range.upper)};
    for (VoxelField& one : field) one.lower = range.lower, one.upper = range.upper;
    return range;
}

}  // namespace

PartFields read_part_fields(const cli::ConvertArguments& arguments,
                            std::span<std::vector<Volume>* const> volumes, const Ranks& ranks) {
    const cli::FieldTexts texts = cli::field_texts(arguments, own_name(volumes, ranks));
    PartFields all;
    std::map<std::string, Range> ranges;
    for (std::vector<Volume>* const own : volumes) {
        std::erase_if(*own, [](const Volume& volume) { return volume.empty(); });
        std::vector<std::string> none;  // the coverage is known on all ranks together
        std::vector<FieldCoverage> coverage;
        std::vector<std::vector<VoxelField>>& fields = all.values.emplace_back();
        const double nodes = node_count(*own);
        if (!own->empty()) fields = cli::read_volume_fields(texts, *own, none, &coverage);
        all.divided.push_back(ranks.max(node_count(*own) != nodes ? 1 : 0) > 0);
        if (all.described.empty()) describe(fields, all.described, ranks);
        fields.resize(static_cast<std::size_t>(ranks.max(double(fields.size()))));
        coverage.resize(fields.size());
        for (std::size_t f = 0; f < fields.size(); ++f) {
            const Range range = share_range(fields[f], ranks);
            std::vector<std::string> names =
                ranks.gather(fields[f].empty() ? std::string() : fields[f].front().name);
            std::erase(names, std::string());
            Range& joined = ranges[names.front()];
            joined = {std::min(joined.lower, range.lower), std::max(joined.upper, range.upper)};
            ValueCounts own_counts;
            for (const VoxelField& field : fields[f]) own_counts.add(field.counts);
            ranks.sum(own_counts.weights());
            const ValueSpread spread = own_counts.spread();
            const auto [place, first] = all.spreads.try_emplace(names.front(), spread);
            if (!first && place->second != spread) place->second = {};  // as joined models have it
            const FieldCoverage whole = over_ranks(coverage[f], ranks);
            if (whole.voxels == 0) continue;  // the volumes' own values
            if (std::string note = coverage_note(whole); !note.empty())
                all.notes.push_back(std::move(note));
        }
        all.carried.push_back(carried_fields(*own, fields, &ranks.collective()));
    }
    const auto set_range = [&](auto& field) {
        field.lower = ranges[field.name].lower, field.upper = ranges[field.name].upper;
    };
    std::ranges::for_each(all.described.scalar, set_range);
    std::ranges::for_each(all.described.vector, set_range);
    return all;
}

void add_part_fields(const PartFields& fields, std::span<const std::optional<UniformCells>> cells,
                     std::span<std::vector<Volume>* const> volumes,
                     const std::optional<Box>& period, SharedModel& model) {
    for (std::size_t n = 0; n < volumes.size(); ++n)
        if (!volumes[n]->empty())
            add_fields(model.inputs[n], *volumes[n], fields.values[n],
                       {.cells = fields.divided[n] ? std::nullopt : cells[n], .periodic = period});
    model.description.fields = fields.described;
    const auto set_spread = [&](Fields& of) {
        for (ScalarField& field : of.scalar) field.spread = fields.spreads.at(field.name);
    };
    set_spread(model.description.fields);
    for (Gaussians& input : model.inputs) set_spread(input.fields);
}

}  // namespace vog::mpi
