// site_run.cpp: models into a site, and coarse ones for its page.
#include "models/site_run.h"

namespace vog::cli {

VogzPrecision site_precision(const CompactArguments& arguments, bool precise) {
    VogzPrecision precision = precise ? kPagePrecision : VogzPrecision{};
    if (arguments.step > 0) precision.step = arguments.step;
    if (arguments.field_step > 0) precision.field_step = arguments.field_step;
    return precision;
}

HtmlModel add_to_site(SiteWriter& site, SiteInput input, Stages& stages) {
    return stages.run("chunks", [&] {
        return add_to_site(site, input.name, input.model, input.hierarchy,
                           {input.index_from_world});
    });
}

}  // namespace vog::cli
