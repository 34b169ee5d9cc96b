// site_run.cpp: models into a site, and its page.
#include "models/site_run.h"

namespace vog::cli {

VogzPrecision site_precision(const CompactArguments& arguments, bool precise) {
    VogzPrecision precision = precise ? kPagePrecision : VogzPrecision{};
    if (arguments.step > 0) precision.step = arguments.step;
    if (arguments.field_step > 0) precision.field_step = arguments.field_step;
    return precision;
}

WrittenSite write_site(const std::string& folder, const VogzPrecision& precision, std::size_t count,
                       const std::function<SiteInput(std::size_t)>& read,
                       const std::function<HtmlOptions(const HtmlModel&)>& options,
                       Stages& stages) {
    WrittenSite written;
    std::optional<SiteWriter> site;
    std::vector<HtmlModel> entries;
    for (std::size_t n = 0; n < count; ++n) {
        SiteInput input = read(n);
        entries.push_back(stages.run("hierarchy", [&] {
            return prepare_for_site(input.name, input.model, input.hierarchy,
                                    {input.index_from_world});
        }));
        if (!site) {
            written.options = options(entries.front());
            require_page(entries, written.options);
            site.emplace(folder, precision);
        }
        stages.run("chunks", [&] { site->add(input.name, input.model, input.hierarchy); });
    }
    written.chunks = stages.run("manifest", [&] { return site->finish(written.options.steps); });
    written.page =
        stages.run("page", [&] { return write_site_page(folder, entries, written.options); });
    return written;
}

}  // namespace vog::cli
