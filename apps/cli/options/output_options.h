// output_options.h: options of what is written of models: pages and sites, compact models, splats.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "options/camera_options.h"
#include "options/request_options.h"
#include "vog/export_html.h"
#include "vog/voxel_values.h"

namespace vog::cli {

inline constexpr const char* kPageGroup = "Page (.html)";

struct PageArguments {
    std::vector<std::string> names;
    std::string title, description;
    RequestWords words;  ///< quantity, colours and clip
    ViewArguments view;
    bool precise = false;                ///< whether words are finer
    bool steps = false;                  ///< whether models are steps in time
    std::optional<HtmlQuantity> chosen;  ///< of a sequence's first page
    std::optional<Subject> subject;      ///< of all models, in place of one: one camera for many
};

/// Adds --title, --description, --name, --precise, --steps, and the options of quantities and colours. Those of views
/// (add_view_options) are apart.
void add_page_options(CLI::App& command, PageArguments& arguments);

inline constexpr const char* kCompactGroup = "Compact model (.vogz)";

struct CompactArguments {
    double max_loss_db = 0;              ///< 0: none, the steps hold
    std::vector<std::string> reference;  ///< volumes that the loss is measured against
    double model_psnr_db = 0;            ///< assumed without a reference
    double step = 0, field_step = 0;     ///< 0: the defaults
    bool hierarchy = false, deflate = false;
    ValueRules values{};  ///< for the reference's voxels
};
/// Adds --max-loss, --reference, --hierarchy, --deflate and settings.
void add_compact_options(CLI::App& command, CompactArguments& arguments);

inline constexpr const char* kSplatGroup = "Splats (.ply, .spz, .glb, .usda)";

struct SplatArguments {
    std::string layout = "vog";  ///< of a .ply: vog, 3dgs or volprim
    std::string units;           ///< world or box; empty: world with volprim, else box
};
/// Adds --as and --units.
void add_splat_options(CLI::App& command, SplatArguments& arguments);

}  // namespace vog::cli
