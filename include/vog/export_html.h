// vog/export_html.h: export of models as one HTML page: their data and a WebGL2 viewer.
// The page needs no server, no network and no other file (docs/web.md).
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "vog/camera.h"
#include "vog/gaussians.h"
#include "vog/lod.h"
#include "vog/quantity.h"
#include "vog/shade.h"
#include "vog/value_transfer.h"
#include "vog/vogz.h"
#include "vog/volume_picture.h"

namespace vog {

struct Collective;
struct PictureRequest;
struct ResolvedPicture;

/// Model of a page. With several, the page shows one and has a switch between them.
struct HtmlModel {
    std::string name;               ///< label in the switch
    std::vector<Gaussians> levels;  ///< levels of detail for the slider, at least 1, finest first
};

/// Fineness of a page's numbers, at which rims of opaque surfaces are a few of 255 from the splat renderer's.
inline constexpr VogzPrecision kPagePrecision{1.0 / 1440, 1.0 / 8192};

/// Largest number of clip planes beside a box.
inline constexpr std::size_t kMostHtmlPlanes = 10;

/// Quantity that a page shows first; its reader can select every other that the models have.
struct HtmlQuantity {
    std::string show = "T";  ///< T, column, mean, deviation, volume or maximum
    /// Field of mean, deviation, volume and maximum, as field_choice reads it; empty: the first one, of
    /// volume and maximum the density where the model has it.
    std::string field{};
    /// Scale of column, mean, deviation or maximum, linear or logarithmic; none: of the first view.
    std::optional<ColorScale> scale{};
    ScaleFit fit =
        ScaleFit::automatic;  ///< fit of a scale of the first view; symmetric counts as linear
    /// Transfer function of volume; none: HtmlOptions::tf over the field's range.
    std::optional<ValueTransfer> transfer{};
    VolumeLook look{};  ///< light of volume, and the clip of all quantities
    std::optional<int>
        slabs;  ///< depth slabs of volume, 1 to 1024; nothing: kVolumeSlabs, with light kLitSlabs
    int maximum_slabs = kMaximumSlabs;  ///< depth slabs of maximum, 1 to 1024
};

/// Options of write_html.
struct HtmlOptions {
    std::string title = "vog";       ///< title of the page, plain text
    std::string description{};       ///< text below the title, plain text, any number of lines
    std::optional<Camera> camera{};  ///< first view; none: the paper view of the first model
    /// Factor on density, > 0; none: for each model the auto_extinction of its first view.
    std::optional<double> extinction{};
    TransferFunction tf = named_transfer_function(kDefaultMap);  ///< first colours
    ShadeOptions shading{};                                      ///< background and blend
    HtmlQuantity quantity{};
    /// All numbers four times as fine, for 4 bytes more a Gaussian: the rims of opaque surfaces differ by
    /// 2 of 255 from the splat renderer's, else by up to 10 (docs/web.md).
    bool precise = false;
    /// Whether the models are steps in time: the page plays them, with one extinction and scale for all.
    bool steps = false;
    /// Use black or white, by the dark or light mode of the reader's system, as the background.
    bool system_background = false;
};

/// First quantity of a page or a window from a request, without a transfer function of values.
/// throws  RequestError (vog/picture.h) for a symmetric scale, a logarithmic one of values that are not above 0, and more than
///         kMostHtmlPlanes planes
HtmlQuantity html_quantity(const PictureRequest& request);
/// Quantity, colours, view and extinction of a request, with the defaults of pictures of a page's first model.
/// volume  receives the picture of show volume, with its defaults; null: not wanted
/// throws  as html_quantity and resolve() do
HtmlOptions html_options(const PictureRequest& request, const Gaussians& model,
                         ResolvedPicture* volume = nullptr);

/// Sizes and settings of a page written.
struct HtmlReport {
    std::size_t bytes = 0;         ///< size of the file, bytes
    std::size_t viewer_bytes = 0;  ///< size of the file without the models, bytes
    std::size_t gaussians = 0;     ///< Gaussians in the finest levels of all models
    double extinction = 1;         ///< extinction of the first model, factor on density, > 0
};

/// Writes one page with all models, beside the file, renamed when whole. Each level is a compact model
/// (vog/vogz.h) of the step 1/1440, and of field steps of 1/8192: 13 bytes a Gaussian and 7 a scalar field.
/// HtmlOptions::precise divides them by 4 and by 2.
/// Gaussians of density 0 are left out.
/// throws  vog::Error for no model, a model without levels, an invalid model or one too large for a
///         browser, a quantity that the first model lacks, an unusable camera, transfer function or extinction,
///         an unwritable file
HtmlReport write_html(const std::filesystem::path& file, std::span<const HtmlModel> models,
                      const HtmlOptions& options = {});

/// Prepares a model for SiteWriter::add: removes Gaussians without density, and builds its hierarchy where it has none.
/// hierarchy  of this model; empty: built with `options`, which sorts the model
/// processes  have a part of the model each (SiteWriter); null: a single process
/// returns    the model for write_site_page: a cut as fine as the pixels of a small picture, from which the page has its first
///            extinction, ranges and histograms; of several processes whole on process 0, elsewhere empty
HtmlModel prepare_for_site(const std::string& name, Gaussians& model, Hierarchy& hierarchy,
                           const HierarchyOptions& options = {},
                           const Collective* processes = nullptr);

/// Checks a page's first models and options before anything is written.
/// throws  vog::Error as write_html
void require_page(std::span<const HtmlModel> models, const HtmlOptions& options);

/// Writes the page of a site (vog/site.h), `folder`/index.html: the same viewer, which loads the models' chunks from the folder as
/// views need them; and page.json, with which <vog-view> begins.
/// models   in the order of the site's, of prepare_for_site
/// throws   vog::Error as write_html
HtmlReport write_site_page(const std::filesystem::path& folder, std::span<const HtmlModel> models,
                           const HtmlOptions& options = {});

/// View, extinction and ranges of a model with which <vog-view> begins, for VogzOptions::page: JSON.
/// model  of prepare_for_site
std::string page_of_file(const HtmlModel& model);

/// Address from which a page loads its models.
struct HtmlSource {
    /// Address of a site's folder or of a compact file: absolute, https or http, or relative to the page.
    std::string url;
    bool file = false;  ///< a compact file, read by ranges of bytes, in place of a folder
};

/// Models of a site or of a compact file for write_streaming_page.
/// path    a site, or a .vogz with levels, packed by deflate
/// throws  vog::Error for another file, or one that is malformed
std::vector<HtmlModel> models_to_stream(const std::filesystem::path& path);

/// Writes only a page, for models at another address, with a security policy that lets it read from no other origin.
/// models  of models_to_stream
/// throws  vog::Error as write_html, and for an address of another scheme, with a user, or with characters that addresses
///         write encoded
HtmlReport write_streaming_page(const std::filesystem::path& file,
                                std::span<const HtmlModel> models, const HtmlSource& source,
                                const HtmlOptions& options = {});

/// Text of vog-view.js, an ES module that defines the element <vog-view> (docs/web_element.md).
std::string view_module();

}  // namespace vog
