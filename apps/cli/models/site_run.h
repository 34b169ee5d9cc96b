// site_run.h: models into a site's folder, which browsers load in parts.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "models/model_inputs.h"
#include "vog/distributed.h"
#include "vog/export_html.h"
#include "vog/site.h"

namespace vog::cli {

/// Fineness of a site's numbers.
/// precise  those of a page in place of a compact file's
VogzPrecision site_precision(const RoundingArguments& arguments, bool precise);

/// A site's report, and the size of its page.
struct WrittenSite {
    SiteReport chunks;
    HtmlReport page;
    HtmlOptions options;
};
/// throws vog::Error for an input that is, or is of, the site that would be written
void refuse_own_folder(const std::vector<std::string>& inputs, const std::string& folder);
/// Writes models one after another: a time step is written before the next is read, and nothing before the first model's page
/// is known to be right.
/// read       read(n) reads model n of `count`
/// options    options(first) of the page, from the first model
/// processes  write the site together: read(n) then gives this one's part, and page and report are of process 0; null: one
WrittenSite write_site(const std::string& folder, const VogzPrecision& precision, std::size_t count,
                       const std::function<InputModel(std::size_t)>& read,
                       const std::function<HtmlOptions(const HtmlModel&)>& options, Stages& stages,
                       const Collective* processes = nullptr);
/// Prints the report of a site in words.
/// in_words  false: not printed
/// returns   the report of --json
nlohmann::ordered_json report_site(const std::string& folder, bool in_words,
                                   const WrittenSite& site, const Stages& stages,
                                   const std::vector<std::string>& notes);

}  // namespace vog::cli
