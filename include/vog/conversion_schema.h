// vog/conversion_schema.h: Options of conversions as front ends offer them: options and keywords.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "vog/convert_fields.h"
#include "vog/convert_paper.h"
#include "vog/convert_points.h"
#include "vog/request_schema.h"

namespace vog {

/// Options of conversions of all data by all methods, as front ends get them.
struct ConversionOptions {
    std::string method = "moments";  ///< or paper
    MomentOptions moments;  ///< particles and cells use its cut, axis_aligned and measure, too
    int lod = 0;            ///< level of detail, 1 to 5; 0: none
    std::optional<double> mass_threshold{};  ///< none: the default of the data
    std::string strategy = "smart", amplitude = "mean";
    PaperOptions paper;      ///< the rest of it
    PointOptions particles;  ///< value, radius, neighbours, smoothing
    std::string joint_field{};
    int joint_steps = kJointSteps;
};

/// Values of an option: an interval, "[0.5, 2]" or "(0, inf)", or words where there are no others, "mean mass"; empty: any.
struct OptionValues {
    std::string text;
    bool whole = false;  ///< numbers without a fraction

    bool fit(const std::string& word) const;
    std::vector<std::string> words() const;  ///< empty: others, too
    std::string expected() const;            ///< "in [0.5, 2]", "mean or mass"; empty: any
};

/// An option of conversions. Names of options in texts stand between backquotes, as in RequestMember.
struct ConversionOption {
    std::string key;  ///< "mass_threshold"
    /// Conversions that it changes: moments and paper (of voxels), particles and paper-particles, cells, models.
    std::string of;
    /// Place of its value; none: a front end reads it in its own way.
    std::variant<std::monostate, bool*, int*, std::size_t*, float*, double*, std::string*,
                 std::optional<double>*> (*value)(ConversionOptions&);
    std::string values;  ///< as OptionValues::text
    std::string text;    ///< meaning, unit, default
    bool rare = true;    ///< few conversions need it
};

/// All options but the method, in the order of a help.
std::span<const ConversionOption> conversion_schema();
OptionValues values_of(const ConversionOption& option);
/// Empty: none, or one of the data, which the text states.
std::string default_text(const ConversionOption& option);
/// Rules between them, and their conversions in place of quantities.
std::span<const OptionRule> conversion_rules();

/// throws  vog::Error for a value out of range: "convert: spread 3, expected in [0.5, 2]"
/// stated  keys of the options that are stated, none of which may have the value that stands for none
void check_values(const ConversionOptions& options, std::span<const std::string> stated = {});
/// throws  vog::Error for a stated option that changes nothing of a conversion
/// conversion  one of ConversionOption::of
void require_effects(const ConversionOptions& options, const std::string& conversion,
                     std::span<const std::string> stated);

/// Options of a conversion of voxels or particles. A level of detail takes the place of other choices of cells, which
/// require_effects refuses beside it.
/// throws  vog::Error for an unknown level of detail
MomentOptions moment_options(const ConversionOptions& options);
PaperOptions paper_options(const ConversionOptions& options);
PointOptions point_options(const ConversionOptions& options);

}  // namespace vog
