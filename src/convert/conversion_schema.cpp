// conversion_schema.cpp: Table of the options of conversions: keys, texts, values, and what each changes.
#include "vog/conversion_schema.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <iterator>
#include <sstream>
#include <type_traits>

#include "convert/particles/nearest_neighbours.h"
#include "render/picture/request/request_effects.h"
#include "vog/distributed.h"
#include "vog/error.h"

namespace vog {

namespace {

#define VOG_OPTION(path) \
    [](ConversionOptions& o) -> decltype(ConversionOption::value(o)) { return &o.path; }
#define VOG_OWN [](ConversionOptions& o) -> decltype(ConversionOption::value(o)) { return {}; }

std::vector<ConversionOption> moment_entries() {
    return {
        {"error", "moments particles cells", VOG_OPTION(moments.error), "(0, 1)",
         fmt::format(
             "Find the smallest model with at most this error: relative L2 of optical depth T "
             "against the voxels, in the worst of {} views. The search ends where voxels "
             "interpolated linearly have the same error. Default for volumes: {}, but at most one "
             "Gaussian to {} voxels ({} of small data). With `joint_field` the error is that of "
             "volume pictures under three transfer functions. Particles become one Gaussian each "
             "unless `error`, `budget`, `block` or `lod` is given",
             error_views(Box{}).size(), kDefaultError, kVoxelsPerGaussian, kSmallCount),
         false},
        {"budget", "moments particles cells models", VOG_OPTION(moments.budget), "[1, inf)",
         "Find the best model with at most this many Gaussians", false},
        {"block", "moments particles", VOG_OPTION(moments.block_voxels), "1 2 4 8 16 32 64 128",
         "One Gaussian per occupied cube of this edge, voxels: uniform cells", false},
        {"lod", "moments paper particles", VOG_OPTION(lod), "[1, 5]",
         "Level of detail, 1 (finest) to 5 (coarsest). moments: uniform cells with edges of 2, 4, "
         "8, 16, 32 voxels. paper: dense blocks with edges of 2, 4, 8, 8, 8 voxels, and for sparse "
         "leaves `strategy=smart` (1-3), strict (4), single (5)",
         false},
        {"soft_steps", "moments", VOG_OPTION(moments.soft_steps), "[0, 1000]",
         fmt::format(
             "Steps of expectation-maximisation (EM) from hard cells, where a voxel counts for one "
             "Gaussian, to soft cells, where it is divided among several. 0: hard cells, fast, but "
             "uniform ones show a grid of dots along the axes. Default: {} for `budget`, {} for "
             "`error`. Uniform cells overlap by half a cell; above 2 voxels up to {} steps follow, "
             "fewer for more than 4 million voxels. vog-mpi: uniform cells are hard",
             kSoftSteps, kSearchSoftSteps, kSoftSteps)},
        {"refine_seconds", "moments", VOG_OPTION(moments.refine_seconds), "[0, 1e6]",
         "Refine for up to this many seconds: Gaussians are split where pictures have the largest "
         "error, with `joint_field` volume pictures, and as many merged elsewhere. The result "
         "depends on the machine's speed",
         false},
        {"spread", "moments", VOG_OPTION(moments.spread), "[0.5, 2]",
         "Factor on every standard deviation, at constant mass"},
        {"mass_threshold", "moments particles", VOG_OPTION(mass_threshold), "[0, 1)",
         fmt::format("Drop the cells of least mass, up to this fraction of the total mass. "
                     "Default: {:.4f} for volumes, {} for particles",
                     MomentOptions{}.mass_threshold, PointOptions{}.mass_threshold)},
        {"axis_aligned", "moments particles", VOG_OPTION(moments.axis_aligned), "",
         "Gaussians without rotation: 28 bytes each in the file, not 44"},
        {"measure", "moments particles cells", VOG_OPTION(moments.measure), "",
         "Measure the errors of T and of fields with `budget`, `block` and `lod`, too"},
        {"joint_field", "moments", VOG_OPTION(joint_field), "",
         "Fit the Gaussians to pictures of one field, by steps of expectation-maximisation in the "
         "joint space of position and value: volume (the volume's own values), the name of a field "
         "that they carry, or none. T is then less exact; the report says by how much. `error` and "
         "`refine_seconds` then judge volume pictures. Default: volume of dense images, with an "
         "error by value of about 0.1; else none",
         false},
        {"joint_steps", "moments", VOG_OPTION(joint_steps), "[1, 1000]",
         "Steps of `joint_field`; more make narrow bands of values better and T worse"},
    };
}

std::vector<ConversionOption> paper_entries() {
    return {
        {"strategy", "paper", VOG_OPTION(strategy), "smart strict single variance neighbours tree",
         "Grouping of voxels. For sparse leaves (8^3 nodes with inactive voxels): smart (2^3 "
         "blocks, pairs, single voxels), strict (2^3 blocks, single voxels), single (one Gaussian "
         "per leaf). For all leaves: variance (split until values are uniform), neighbours "
         "(similar adjacent leaves joined), tree (one Gaussian per tree node)"},
        {"dense_block", "paper", VOG_OPTION(paper.dense_block), "2 4 8",
         "Edge of a block in dense leaves (all 8^3 voxels active), voxels"},
        {"amplitude", "paper", VOG_OPTION(amplitude), "mean mass",
         "Peak density of a Gaussian: mean, the mean density of its voxels, as the paper (loses "
         "about a third of the mass); mass, the peak that conserves mass"},
        // The cutoff sqrt(-2 ln kappa) lies within (0, 8].
        {"kappa", "paper paper-particles", VOG_OPTION(paper.kappa), "[1.3e-14, 1)",
         "Truncate kernels where they have fallen to this fraction of their peak: at sqrt(-2 ln "
         "kappa) standard deviations"},
        {"opacity_threshold", "paper", VOG_OPTION(paper.opacity_threshold), "[0, inf)",
         "Drop groups of voxels whose mean density is at or below this; 0 drops empty groups only"},
        {"variance_threshold", "paper", VOG_OPTION(paper.variance_threshold), "[0, inf)",
         "`strategy=variance`: split groups whose variance of values exceeds this fraction of the "
         "volume's"},
        {"similarity", "paper", VOG_OPTION(paper.similarity), "[0, 1]",
         "`strategy=neighbours`: join leaves whose mean densities differ by at most this fraction"},
        {"tree_depth", "paper", VOG_OPTION(paper.tree_depth), "1 2 3",
         "`strategy=tree`: level of the nodes, 1 (4096^3 voxels), 2 (128^3) or 3 (8^3)"},
        {"minimum_radius", "paper", VOG_OPTION(paper.minimum_radius_voxels), "[0, 1e6]",
         "Smallest radius of a Gaussian, voxels; a single voxel has 0.5"},
    };
}

std::vector<ConversionOption> particle_entries() {
    return {
        {"value", "particles paper-particles", VOG_OPTION(particles.value), "",
         "Mass of a particle's Gaussian: count (1 each), speed, or an attribute of the file by "
         "name. Default: count; with `method` paper: speed",
         false},
        {"radius", "particles paper-particles", VOG_OPTION(particles.radius), "(0, inf)",
         "Standard deviation of a particle's Gaussian, world units. Default: by `smoothing`, else "
         "half the distance to the nearest neighbour number `neighbours`. By `method` paper its "
         "radius, sqrt(2) standard deviations; default: half the edge of a voxel that holds one "
         "particle on average",
         false},
        {"neighbours", "particles", VOG_OPTION(particles.neighbours),
         fmt::format("[1, {}]", particles::kMostNeighbours),
         "Rank of the neighbour that sets the radius of a particle's Gaussian: the nearest is 1",
         false},
        {"smoothing", "particles", VOG_OWN, "",
         "Radii at which the particles' kernels end: the name of an attribute, or an array [N]. "
         "Default: SmoothingLength and the like where the particles have it. The Gaussians have "
         "the variance of cubic splines",
         false},
        {"periodic", "moments particles", VOG_OWN, "",
         "Periodic box: its edge, three edges from 0, or two corners, world units; or the box that "
         "the snapshot states, or the domain of a mesh. What leaves through a face enters through "
         "the opposite one, neighbours are found across faces, and pictures show the box alone",
         false},
    };
}

/// A value in a word; empty: none.
std::string word_of(const ConversionOption& option, ConversionOptions options) {
    return std::visit(
        [](const auto& place) -> std::string {
            if constexpr (!std::is_pointer_v<std::remove_cvref_t<decltype(place)>>)
                return {};
            else if constexpr (requires { place->has_value(); })
                return *place ? fmt::format("{}", **place) : "";
            else
                return fmt::format("{}", *place);
        },
        option.value(options));
}

}  // namespace

bool OptionValues::fit(const std::string& word) const {
    const std::vector<std::string> all = words();
    if (text.empty() || !all.empty()) return text.empty() || std::ranges::count(all, word) > 0;
    if (whole && word.find_first_not_of("-0123456789") != word.npos) return false;
    char* end = nullptr;
    const double number = std::strtod(word.c_str(), &end);
    const double least = std::strtod(text.c_str() + 1, nullptr),
                 most = std::strtod(text.c_str() + text.find(',') + 1, nullptr);
    return end != word.c_str() && *end == 0 &&
           (text.front() == '[' ? number >= least : number > least) &&
           (text.back() == ']' ? number <= most : number < most);
}

std::vector<std::string> OptionValues::words() const {
    if (text.starts_with('[') || text.starts_with('(')) return {};
    std::istringstream in(text);
    return {std::istream_iterator<std::string>(in), {}};
}

std::string OptionValues::expected() const {
    if (const std::vector<std::string> all = words(); !all.empty())
        return fmt::format("{} or {}", fmt::join(all.begin(), all.end() - 1, ", "), all.back());
    if (text.empty()) return "";
    const std::string number = whole ? "a whole number, " : "";
    if (!text.ends_with("inf)")) return number + "in " + text;
    return number + (text.front() == '[' ? "at least " : "above ") +
           text.substr(1, text.find(',') - 1);
}

std::span<const ConversionOption> conversion_schema() {
    static const std::vector<ConversionOption> all = [] {
        std::vector<ConversionOption> joined = moment_entries();
        for (const auto& more : {paper_entries(), particle_entries()})
            joined.insert(joined.end(), more.begin(), more.end());
        return joined;
    }();
    return all;
}

std::span<const OptionRule> conversion_rules() {
    static const std::vector<OptionRule> all = {
        {"budget error lod", "block", "-"},
        {"error lod", "budget", "-"},
        {"lod", "error", "-"},
        {"measure", "block budget lod", "*", "moments particles"},
        {"measure", "budget", "*", "cells"},
        {"joint_steps", "joint_field", "*"},
        {"spread", "joint_field", "-"},
        {"mass_threshold axis_aligned", "block budget error lod", "*", "particles"},
        {"neighbours smoothing", "radius", "-", "particles"},
        {"strategy dense_block", "lod", "-", "paper"},
        {"dense_block", "strategy", "smart strict single"},
        {"variance_threshold", "strategy", "variance"},
        {"similarity", "strategy", "neighbours"},
        {"tree_depth", "strategy", "tree"},
    };
    return all;
}

OptionValues values_of(const ConversionOption& option) {
    ConversionOptions options;
    const auto place = option.value(options);
    return {option.values,
            std::holds_alternative<int*>(place) || std::holds_alternative<std::size_t*>(place)};
}

std::string default_text(const ConversionOption& option) {
    static const std::string none[] = {"0", "-1", "false", "auto"};
    const std::string word = option.key == "value" ? "" : word_of(option, {});
    return std::ranges::count(none, word) ? "" : word;
}

void check_values(const ConversionOptions& options, std::span<const std::string> stated) {
    for (const ConversionOption& one : conversion_schema()) {
        const std::string word = word_of(one, options);
        if (word.empty() || (word == word_of(one, {}) && !std::ranges::count(stated, one.key)))
            continue;
        if (const OptionValues values = values_of(one); !values.fit(word))
            throw Error(
                fmt::format("convert: {} {}, expected {}", one.key, word, values.expected()));
    }
}

void require_effects(const ConversionOptions& options, const std::string& conversion,
                     std::span<const std::string> stated) try {
    const auto is_stated = [&](const std::string& key) {
        return std::ranges::count(stated, key) > 0;
    };
    require_rules(conversion_rules(), conversion, is_stated, [&](const std::string& key) {
        return word_of(*std::ranges::find(conversion_schema(), key, &ConversionOption::key),
                       options);
    });
} catch (const RequestError& error) {
    throw Error(fmt::format("convert: {}", error.what()));
}

MomentOptions moment_options(const ConversionOptions& options) {
    MomentOptions moments = options.moments;
    if (options.lod) moments.block_voxels = moment_lod(options.lod).block_voxels;
    if (options.mass_threshold) moments.mass_threshold = *options.mass_threshold;
    return moments;
}

PaperOptions paper_options(const ConversionOptions& options) {
    PaperOptions paper = options.paper;
    paper.strategy = strategy_from_name(options.strategy);
    paper.amplitude = options.amplitude == "mass" ? Amplitude::mass : Amplitude::mean;
    if (!options.lod) return paper;
    const PaperOptions lod = paper_lod(options.lod);
    paper.strategy = lod.strategy, paper.dense_block = lod.dense_block;
    return paper;
}

PointOptions point_options(const ConversionOptions& options) {
    PointOptions points = options.particles;
    const MomentOptions moments = moment_options(options);
    points.block_voxels = moments.block_voxels;
    points.budget = moments.budget, points.error = moments.error;
    if (options.mass_threshold) points.mass_threshold = *options.mass_threshold;
    points.axis_aligned = moments.axis_aligned, points.measure = moments.measure;
    return points;
}

}  // namespace vog
