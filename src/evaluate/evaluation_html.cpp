// evaluation_html.cpp: index.html: the report as one self-contained page without scripts.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <string_view>
#include <utility>

#include "core/atomic_file.h"
#include "core/html_text.h"
#include "evaluate/evaluation_report.h"
#include "evaluate/paper_figures.h"
#include "evaluate/svg_plot.h"
#include "vog/error.h"
#include "vog/text.h"

namespace vog::evaluation {

namespace fs = std::filesystem;

namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light; --ink: #1d2329; --soft: #5b6670; --rule: #d9dee3; --paper: #f7f3ea; }
* { box-sizing: border-box; }
body { margin: 0; background: #fff; color: var(--ink);
       font: 16px/1.55 system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", sans-serif; }
main { max-width: 1280px; margin: 0 auto; padding: 2.2rem 1.2rem 4rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .8rem; letter-spacing: -.01em; }
h2 { font-size: 1.25rem; line-height: 1.3; margin: 2.8rem 0 .3rem; }
p { margin: .3rem 0 .8rem; max-width: 46rem; }
.facts { color: var(--soft); font-size: .94rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-size: .86rem; font-variant-numeric: tabular-nums;
        line-height: 1.35; }
th, td { padding: .42rem .6rem; text-align: right; vertical-align: bottom; white-space: nowrap; }
th { font-weight: 600; color: var(--soft); white-space: normal; min-width: 4.4em; }
th:first-child, td:first-child { text-align: left; padding-left: 0; position: sticky; left: 0;
                                 background: #fff; }
thead tr:last-child th { border-bottom: 1.5px solid var(--ink); }
tbody td { border-bottom: 1px solid var(--rule); }
tr.heading td { font-weight: 600; padding-top: 1rem; }
.theirs { background: var(--paper); }
.note { font-size: .86rem; color: var(--soft); }
.plots { display: grid; grid-template-columns: repeat(auto-fit, minmax(min(100%, 440px), 1fr)); gap: 1.6rem;
         margin-top: 1rem; }
svg.plot { width: 100%; height: auto; font: 12px system-ui, sans-serif; }
svg.plot text { fill: #3d4650; } svg.plot .title { font-size: 14px; font-weight: 600; fill: #1d2329; }
svg.plot .label { fill: #5b6670; } svg.plot .grid { stroke: #e6e9ec; } svg.plot .axis { stroke: #1d2329; }
svg.plot .series { fill: none; stroke-width: 2; }
h3 { font-size: 1rem; margin: 1.6rem 0 .4rem; }
h3 span { font-weight: 400; color: var(--soft); }
.strip { display: grid; gap: .5rem; grid-template-columns: repeat(7, 1fr); }
figure { margin: 0; } figcaption { font-size: .8rem; line-height: 1.35; color: var(--soft); padding-top: .25rem; }
.picture { display: block; width: 100%; height: auto; background-size: 100% 100%; border-radius: 3px; }
.scale { display: flex; align-items: center; gap: .6rem; font-size: .86rem; color: var(--soft);
         font-variant-numeric: tabular-nums; }
.scale i { flex: 0 1 16rem; height: .8rem; border-radius: 2px; }
@media (max-width: 760px) {
  main { padding: 1.3rem .9rem 3rem; } h1 { font-size: 1.5rem; }
  td:first-child { white-space: normal; min-width: 9.5em; } tr.heading td { white-space: nowrap; }
  .strip { grid-template-columns: repeat(3, 1fr); } .pairs .model { grid-column: 2; }
}
)";

std::string read_bytes(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream bytes;
    bytes << in.rdbuf();
    return bytes.str();
}

std::string table_html(const ReportTable& table) {
    const std::size_t ours = table.columns.size() - table.paper_columns;
    const auto theirs = [&](std::size_t n) { return n >= ours ? " class=\"theirs\"" : ""; };
    std::string out = fmt::format("<h2>{}</h2>\n", escaped(table.title));
    if (!table.about.empty()) out += fmt::format("<p>{}</p>\n", escaped(table.about));
    out += "<div class=\"scroll\"><table><thead>\n";
    if (table.paper_columns)
        out += fmt::format(
            "<tr><th colspan=\"{}\"></th><th colspan=\"{}\" class=\"theirs\">the "
            "paper's figures*</th></tr>\n",
            ours, table.paper_columns);
    out += "<tr>";
    for (std::size_t n = 0; n < table.columns.size(); ++n)
        out += fmt::format("<th{}>{}</th>", theirs(n), escaped(table.columns[n]));
    out += "</tr></thead>\n<tbody>\n";
    for (const std::vector<std::string>& cells : table.rows) {
        if (cells.size() == 1) {
            out += fmt::format("<tr class=\"heading\"><td colspan=\"{}\">{}</td></tr>\n",
                               table.columns.size(), escaped(cells[0]));
            continue;
        }
        out += "<tr>";
        for (std::size_t n = 0; n < cells.size(); ++n)
            out += fmt::format("<td{}>{}</td>", theirs(n), escaped(cells[n]));
        out += "</tr>\n";
    }
    out += "</tbody></table></div>\n";
    if (table.paper_columns) out += fmt::format("<p class=\"note\">* {}.</p>\n", kPaperHardware);
    return out;
}

/// Steps along the x axis of the paper's two plots, with their labels ('|': line break).
struct PlotStep {
    const char *step, *category;
};
constexpr PlotStep kPlotSteps[] = {
    {"lod1", "LOD 1|dense 2³"}, {"lod2", "LOD 2|4³"},     {"lod3", "LOD 3|8³"},
    {"lod4", "LOD 4|strict"},   {"lod5", "LOD 5|single"}, {"sigma1", "σ = 1"},
    {"sigma2", "σ = 2"},        {"sigma3", "σ = 3"},
};

/// One of the paper's plots: a value over its levels of detail and box extents.
template <class Value, class PaperValue>
Plot step_plot(const Evaluation& evaluation, const char* title, const char* y_label, bool log_y,
               const Value& value, const PaperValue& paper_value) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    Plot plot{title, "", y_label, {}, false, log_y, {}, true};
    for (const PlotStep& step : kPlotSteps) plot.categories.push_back(step.category);
    PlotSeries theirs{"the paper (RTX 4090 Laptop)", {}, true};
    for (const std::string& series : series_of(evaluation)) {
        if (!is_paper_series(series)) continue;
        PlotSeries ours{series_title(series), {}, false};
        for (std::size_t n = 0; n < std::size(kPlotSteps); ++n) {
            if (std::string_view(kPlotSteps[n].step) == "sigma1")
                ours.points.push_back({kNone, 0, ""});
            const EvaluationRow* row = find_row(evaluation, series, kPlotSteps[n].step);
            const ViewResult* view = row ? find_view(*row, "paper") : nullptr;
            const double y = view ? value(*view) : kNone;
            ours.points.push_back({double(n), y, fmt::format("{:.2f}", y)});
        }
        plot.series.push_back(std::move(ours));
    }
    for (std::size_t n = 0; n < std::size(kPlotSteps); ++n)
        if (const PaperFigures* figures = paper_figures(evaluation, kPlotSteps[n].step)) {
            if (std::string_view(kPlotSteps[n].step) == "sigma1")
                theirs.points.push_back({kNone, 0, ""});
            const double y = paper_value(*figures);
            theirs.points.push_back({double(n), y, fmt::format("{:.2f}", y)});
        }
    if (!theirs.points.empty()) plot.series.push_back(std::move(theirs));
    return plot;
}

/// Quality over a cost, for all rows except those of the box extents.
template <class Cost>
Plot rate_plot(const Evaluation& evaluation, const char* title, const char* x_label,
               const Cost& cost) {
    Plot plot{title, x_label, "PSNR of V, dB", {}, true, false, {}, true};
    for (const std::string& name : series_of(evaluation)) {
        PlotSeries series{series_title(name), {}, false};
        for (const EvaluationRow& row : evaluation.rows) {
            const ViewResult* view = find_view(row, "paper");
            if (row.series != name || row.aabb_sigma > 0 || !view) continue;
            series.points.push_back(
                {cost(row), view->psnr_v_db,
                 fmt::format("{}: {} Gaussians, {}, {} dB", step_title(row.step),
                             count_text(row.gaussians), bytes_text(row.bytes),
                             decibel_text(view->psnr_v_db))});
        }
        std::stable_sort(series.points.begin(), series.points.end(),
                         [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
        plot.series.push_back(std::move(series));
    }
    return plot;
}

std::string plots_html(const Evaluation& evaluation) {
    const Plot plots[] = {
        step_plot(
            evaluation, "Quality over the levels of detail", "PSNR of V, dB", false,
            [](const ViewResult& view) { return view.psnr_v_db; },
            [](const PaperFigures& figures) { return figures.psnr_db; }),
        step_plot(
            evaluation, "Speed over the levels of detail", "frames per second", true,
            [](const ViewResult& view) { return frames_per_second(view.render); },
            [](const PaperFigures& figures) { return figures.frames_per_second; }),
        rate_plot(evaluation, "Quality over Gaussians", "Gaussians",
                  [](const EvaluationRow& row) { return static_cast<double>(row.gaussians); }),
        rate_plot(evaluation, "Quality over bytes", "bytes of the PLY file",
                  [](const EvaluationRow& row) { return static_cast<double>(row.bytes); }),
    };
    std::string out =
        "<h2>Plots</h2>\n<p>All plots are from the view <i>paper</i>. The first two repeat the "
        "paper's "
        "plots over levels of detail and box extents; the others show quality over the size of the "
        "model. PSNR is of V = 1 - exp(-T) as a grey picture.</p>\n<div "
        "class=\"plots\">\n";
    for (const Plot& plot : plots)
        if (!plot.series.empty()) out += svg(plot);
    return out + "</div>\n";
}

std::string figure_html(const fs::path& picture, const std::string& kind,
                        const std::string& caption) {
    if (!fs::exists(picture)) return "";
    return fmt::format(
        "<figure class=\"{}\"><img class=\"picture\" alt=\"{}\" "
        "src=\"data:image/png;base64,{}\"><figcaption>{}</figcaption></figure>\n",
        kind, escaped(caption), base64(read_bytes(picture)), escaped(caption));
}

/// Style of the reference pictures, which every strip shows: stored once, as backgrounds.
std::string reference_style(const Evaluation& evaluation, const fs::path& pictures) {
    std::string out;
    for (const char* view : kPictureViews) {
        const fs::path picture = pictures / picture_name(nullptr, view, false);
        if (fs::exists(picture))
            out += fmt::format(
                ".reference-{} {{ aspect-ratio: {} / {}; background-image: "
                "url(data:image/png;base64,{}); }}\n",
                view, evaluation.width, evaluation.height, base64(read_bytes(picture)));
    }
    return out;
}

/// Pictures of one step from one view: the reference, then each series' model.
/// differences  adds the difference map of each model
std::string strip_html(const Evaluation& evaluation, const std::string& step,
                       const std::string& view, bool differences, const fs::path& pictures) {
    std::string label, out;
    for (const std::string& series : series_of(evaluation)) {
        const EvaluationRow* row = find_row(evaluation, series, step);
        const ViewResult* result = row ? find_view(*row, view) : nullptr;
        if (!result) continue;
        label = row->label;
        out += figure_html(
            pictures / picture_name(row, view, false), "model",
            fmt::format("{}, {} dB", series_title(series), decibel_text(result->psnr_v_db)));
        if (!differences) continue;
        out += figure_html(pictures / picture_name(row, view, true), "difference",
                           fmt::format("difference, bias of T {:.3f}", result->bias));
    }
    if (out.empty()) return "";
    return fmt::format(
               "<h3>{} <span>{}</span></h3>\n<div class=\"strip{}\">\n"
               "<figure><div class=\"picture reference-{}\" role=\"img\" "
               "aria-label=\"reference\"></div><figcaption>reference</figcaption></figure>\n",
               escaped(step_title(step)), escaped(label), differences ? " pairs" : "", view) +
           out + "</div>\n";
}

std::string gallery_html(const Evaluation& evaluation, const fs::path& pictures) {
    // Colour scale of the difference maps, as a gradient of nine of its colours.
    const TransferFunction colors = named_transfer_function("coolwarm");
    std::string stops;
    for (int n = 0; n <= 8; ++n) {
        const Rgba c = color_at(colors, static_cast<float>(n) / 8);
        stops += fmt::format(", rgb({:.0f} {:.0f} {:.0f})", 255 * c.r, 255 * c.g, 255 * c.b);
    }
    std::string out = fmt::format(
        "<h2>Pictures</h2>\n<p>Difference maps show V of the model minus that of the "
        "reference, on one scale for all rows:</p>\n<p class=\"scale\">−{0:.0f}/255 <i "
        "style=\"background: linear-gradient(to "
        "right{1})\"></i> +{0:.0f}/255</p>\n",
        kMapLimit, stops);
    for (const std::string& step : steps_of(evaluation))
        out += strip_html(evaluation, step, "paper", true, pictures);
    out +=
        "<h2>Pictures from inside</h2>\n<p>The eye lies half way between the centre and the face "
        "of "
        "the bounding box and looks at the centre, with a field of view of 60°.</p>\n";
    for (const std::string& step : steps_of(evaluation))
        if (!step.starts_with("sigma"))
            out += strip_html(evaluation, step, "inside", false, pictures);
    return out;
}

}  // namespace

void write_report(const fs::path& file, const Evaluation& evaluation, const fs::path& pictures) {
    std::string page = fmt::format(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<meta "
        "name=\"viewport\" "
        "content=\"width=device-width, initial-scale=1\">\n<title>{0}: evaluation</title>\n"
        "<style>{1}{2}</style></head>\n<body><main>\n<h1>Gaussians against voxels: {0}</h1>\n"
        "<div class=\"facts\">\n",
        escaped(evaluation.title), kStyle, reference_style(evaluation, pictures));
    for (const std::string& fact : report_facts(evaluation))
        page += fmt::format("<p>{}</p>\n", escaped(fact));
    page += "</div>\n";
    page += plots_html(evaluation);
    for (const ReportTable& table : report_tables(evaluation)) page += table_html(table);
    page += gallery_html(evaluation, pictures);
    page += "</main></body></html>\n";
    write_file(file, [&](std::ofstream& out) { out << page; });
}

}  // namespace vog::evaluation
