// site_run.h: models into a site's folder, which browsers load in parts.
#pragma once

#include <optional>
#include <string>

#include "models/compact_options.h"
#include "shared/terminal.h"
#include "vog/export_html.h"
#include "vog/linear.h"
#include "vog/site.h"

namespace vog::cli {

/// Fineness of a site's numbers.
/// precise  those of a page in place of a compact file's
VogzPrecision site_precision(const CompactArguments& arguments, bool precise);

/// A model, and where its hierarchy comes from.
struct SiteInput {
    std::string name;
    Gaussians model;
    Hierarchy hierarchy{};  ///< of its file; empty: built
    std::optional<Affine>
        index_from_world{};  ///< lattice of the model's cells; none: the box of the means is divided
};
/// Writes a model's chunks. Gaussians without density are left out.
/// returns  the model for the page: a cut as fine as the pixels of a small picture
HtmlModel add_to_site(SiteWriter& site, SiteInput input, Stages& stages);

}  // namespace vog::cli
