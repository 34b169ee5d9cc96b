// site_run.cpp: models into a site, and its page.
#include "models/site_run.h"

#include <fmt/core.h>

#include "terminal/terminal.h"
#include "vog/error.h"
#include "vog/memory.h"

namespace vog::cli {

VogzPrecision site_precision(const RoundingArguments& arguments, bool precise) {
    VogzPrecision precision = precise ? kPagePrecision : VogzPrecision{};
    if (arguments.step > 0) precision.step = arguments.step;
    if (arguments.field_step > 0) precision.field_step = arguments.field_step;
    return precision;
}

void refuse_own_folder(const std::vector<std::string>& inputs, const std::string& folder) {
    std::error_code code;
    for (const std::string& input : inputs)
        if (const auto site = find_site(input);
            site && std::filesystem::equivalent(site->folder, folder, code))
            throw Error(fmt::format("{} is an input and would be overwritten", folder));
}

WrittenSite write_site(const std::string& folder, const VogzPrecision& precision, std::size_t count,
                       const std::function<InputModel(std::size_t)>& read,
                       const std::function<HtmlOptions(const HtmlModel&)>& options, Stages& stages,
                       const Collective* processes) {
    const bool is_root = !processes || processes->is_root();
    WrittenSite written;
    std::optional<SiteWriter> site;
    std::vector<HtmlModel> entries;
    for (std::size_t n = 0; n < count; ++n) {
        InputModel input = read(n);
        const HierarchyOptions nodes{input.index_from_world};
        entries.push_back(stages.run("hierarchy", [&] {
            return prepare_for_site(input.name, input.model, input.hierarchy, nodes, processes);
        }));
        if (!site) {
            if (is_root) {
                written.options = options(entries.front());
                require_page(entries, written.options);
            }
            site.emplace(folder, precision, processes);
        }
        stages.run("chunks", [&] {
            site->add(input.name, input.model, input.hierarchy,
                      [&](Gaussians& model) { return build_hierarchy(model, nodes); });
        });
    }
    written.chunks = stages.run("manifest", [&] { return site->finish(written.options.steps); });
    if (is_root)
        written.page =
            stages.run("page", [&] { return write_site_page(folder, entries, written.options); });
    return written;
}

nlohmann::ordered_json report_site(const std::string& folder, bool in_words,
                                   const WrittenSite& site, const Stages& stages,
                                   const std::vector<std::string>& notes) {
    const SiteReport& report = site.chunks;
    const std::size_t page_bytes = site.page.bytes;
    if (in_words) {
        print_line(fmt::format(
            "{}: {} Gaussians in {} chunks, {}{}{}", folder, count_text(report.gaussians),
            count_text(report.chunks), bytes_text(report.bytes),
            report.kept ? fmt::format(", {} chunks there already", count_text(report.kept)) : "",
            report.removed ? fmt::format(", {} old files removed", count_text(report.removed))
                           : ""));
        print_line(fmt::format("{}: first picture after {}; vog serve {} shows it here", folder,
                               bytes_text(page_bytes + report.root_bytes), folder));
    }
    nlohmann::ordered_json json = {
        {"output", folder},      {"gaussians", report.gaussians},   {"chunks", report.chunks},
        {"bytes", report.bytes}, {"root_bytes", report.root_bytes}, {"page_bytes", page_bytes},
        {"kept", report.kept},   {"removed", report.removed}};
    json["ms"] = nlohmann::ordered_json::object();
    for (const auto& [name, ms] : stages.times())  // a model each
        json["ms"][name] = json["ms"].value(name, 0.0) + ms;
    json["peak_memory"] = peak_memory();
    if (!notes.empty()) json["notes"] = notes;
    return json;
}

}  // namespace vog::cli
