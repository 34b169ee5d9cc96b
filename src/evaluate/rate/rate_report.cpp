// rate_report.cpp: bytes and errors as JSON, CSV and Markdown.
#include "evaluate/rate/rate_report.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "evaluate/evaluation_report.h"
#include "vog/evaluate.h"
#include "vog/text.h"

namespace vog::evaluation {

namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json views_of(const std::vector<double>& psnr) {
    Json json;
    for (std::size_t n = 0; n < psnr.size(); ++n) json[kValueViews[n]] = number(psnr[n]);
    return json;
}

Json to_json(const RateDistortion& results) {
    Json json{{"format", "vog rate distortion 1"},
              {"title", results.title},
              {"active_voxels", results.active_voxels},
              {"width", results.width},
              {"height", results.height},
              {"max_loss_db", results.max_loss_db},
              {"functions", results.functions},
              {"absent", results.absent},
              {"rows", Json::array()}};
    for (const RateRow& row : results.rows) {
        Json entry{{"series", row.series},
                   {"step", row.step},
                   {"file", row.file},
                   {"bytes", row.bytes},
                   {"side_bytes", row.side_bytes},
                   {"gaussians", row.gaussians},
                   {"tolerance", row.tolerance},
                   {"mass_ratio", row.mass_ratio},
                   {"psnr_v_db", views_of(row.psnr_v_db)}};
        for (std::size_t f = 0; f < row.psnr_rgb_db.size(); ++f)
            entry["psnr_rgb_db"][results.functions[f]] = views_of(row.psnr_rgb_db[f]);
        entry["voxels"] = {{"relative_l2", row.voxels.relative_l2},
                           {"psnr_db", number(row.voxels.psnr_db)},
                           {"mean", row.voxels.mean},
                           {"worst", row.voxels.worst}};
        json["rows"].push_back(std::move(entry));
    }
    return json;
}

/// Text in a field of a table with commas.
std::string quoted(const std::string& text) {
    std::string out;
    for (const char c : text) {
        if (c == '"') out += c;
        out += c;
    }
    return fmt::format("\"{}\"", out);
}

std::string csv_of(const RateDistortion& results) {
    std::string out =
        "series,step,file,bytes,side_bytes,gaussians,tolerance,mass_ratio,V mean dB,V worst dB";
    for (const char* view : kValueViews) out += fmt::format(",V {} dB", view);
    for (const std::string& function : results.functions)
        out += fmt::format(",{},{}", quoted(function + " mean dB"), quoted(function + " worst dB"));
    out += ",voxels relative L2,voxels PSNR dB,voxels worst\n";
    for (const RateRow& row : results.rows) {
        out += fmt::format("{},{},{},{},{},{},{},{},{},{}", quoted(row.series), quoted(row.step),
                           row.file, row.bytes, row.side_bytes, row.gaussians, row.tolerance,
                           row.mass_ratio, *rate_figure(row, RateFigure::v_mean),
                           *rate_figure(row, RateFigure::v_worst));
        for (const double psnr : row.psnr_v_db) out += fmt::format(",{}", psnr);
        for (std::size_t f = 0; f < results.functions.size(); ++f)
            for (const RateFigure figure : {RateFigure::rgb_mean, RateFigure::rgb_worst}) {
                const std::optional<double> value = rate_figure(row, figure, f);
                out += value ? fmt::format(",{}", *value) : ",";
            }
        out += fmt::format(",{},{},{}\n", row.voxels.relative_l2, row.voxels.psnr_db,
                           row.voxels.worst);
    }
    return out;
}

/// Bytes of each series at some figures; the least are bold.
std::string equal_error_table(const RateDistortion& results, const std::string& title,
                              RateFigure figure, std::size_t function,
                              const std::vector<double>& decibels) {
    std::string out = fmt::format("\n| {} |", title), rule = "\n|:---|";
    for (const double db : decibels) {
        out += fmt::format(" {} dB |", db);
        rule += "---:|";
    }
    out += rule + "\n";
    std::vector<double> least(decibels.size(), HUGE_VAL);
    const std::vector<std::string> names = rate_series(results);
    for (const std::string& name : names)
        for (std::size_t n = 0; n < decibels.size(); ++n)
            least[n] =
                std::min(least[n],
                         bytes_at(results, name, figure, decibels[n], function).value_or(HUGE_VAL));
    for (const std::string& name : names) {
        std::string cells;
        bool any = false;
        for (std::size_t n = 0; n < decibels.size(); ++n) {
            const std::optional<double> bytes =
                bytes_at(results, name, figure, decibels[n], function);
            any = any || bytes;
            const char* const bold = bytes && *bytes == least[n] ? "**" : "";
            cells += fmt::format(" {}{}{} |", bold, rate_bytes_text(bytes), bold);
        }
        if (any) out += fmt::format("| {} |{}\n", name, cells);
    }
    return out;
}

std::string all_rows(const RateDistortion& results) {
    std::string out = "\n| file | | bytes | of them beside | V, dB: mean | worst | paper | axes |";
    std::string rule = "\n|:---|:---|---:|---:|---:|---:|---:|---:|";
    for (const std::string& function : results.functions) {
        out += fmt::format(" {}: mean | worst |", function);
        rule += "---:|---:|";
    }
    out += " voxels: L2 | PSNR, dB |" + rule + "---:|---:|\n";
    for (const RateRow& row : results.rows) {
        out += fmt::format("| {} | {} | {} | {} |", row.series, row.step, count_text(row.bytes),
                           row.side_bytes ? count_text(row.side_bytes) : "");
        for (const RateFigure figure :
             {RateFigure::v_mean, RateFigure::v_worst, RateFigure::v_paper, RateFigure::v_axes})
            out += fmt::format(" {} |", decibel_text(*rate_figure(row, figure)));
        for (std::size_t f = 0; f < results.functions.size(); ++f)
            for (const RateFigure figure : {RateFigure::rgb_mean, RateFigure::rgb_worst}) {
                const std::optional<double> value = rate_figure(row, figure, f);
                out += fmt::format(" {} |", value ? decibel_text(*value) : "");
            }
        out += fmt::format(" {:.4f} | {} |\n", row.voxels.relative_l2,
                           decibel_text(row.voxels.psnr_db));
    }
    return out;
}

std::string markdown_of(const RateDistortion& results) {
    std::string out = fmt::format(
        "# Bytes and error of {}\n\n"
        "{} active voxels. {}×{} pixels from `paper` and both directions of the three axes. Models "
        "lose at most {} dB of V by "
        "rounding. Every file was read back; T of voxels by the reference renderer.\n",
        results.title, count_text(results.active_voxels), results.width, results.height,
        results.max_loss_db);
    for (const std::string& absent : results.absent) out += fmt::format("\n{}.\n", absent);
    out += "\n## Bytes at equal error\n";
    const std::vector<double> v{36, 40, 43, 46, 48, 51, 54}, rgb{30, 34, 38, 42, 46},
        voxels{20, 25, 30, 35, 40, 50};
    out += equal_error_table(results, "V, mean of the views", RateFigure::v_mean, 0, v);
    out += equal_error_table(results, "V, mean along the axes", RateFigure::v_axes, 0, v);
    out += equal_error_table(results, "V, worst view", RateFigure::v_worst, 0, v);
    for (std::size_t f = 0; f < results.functions.size(); ++f)
        out += equal_error_table(
            results, fmt::format("by value, {}, mean of the views", results.functions[f]),
            RateFigure::rgb_mean, f, rgb);
    out += equal_error_table(results, "PSNR of voxels", RateFigure::voxels, 0, voxels);
    out += "\n## Plots\n\n";
    for (const RatePlot& plot : rate_plots(results))
        out += fmt::format("![{}]({})\n", plot.file, plot.file);
    return out + "\n## Files\n" + all_rows(results);
}

}  // namespace

std::string rate_bytes_text(const std::optional<double>& bytes) {
    if (!bytes) return "–";
    if (*bytes < 99.95e3) return fmt::format("{:.1f} kB", *bytes / 1e3);
    if (*bytes < 999.5e3) return fmt::format("{:.0f} kB", *bytes / 1e3);
    return fmt::format("{:.2f} MB", *bytes / 1e6);
}

void write_rate_report(const std::filesystem::path& folder, const RateDistortion& results) {
    const auto write = [&](const std::string& name, const std::string& text) {
        write_file(folder / name, [&](std::ofstream& out) { out << text; });
    };
    write("rate_distortion.json", to_json(results).dump(1) + "\n");
    write("rate_distortion.csv", csv_of(results));
    write("rate_distortion.md", markdown_of(results));
    for (const RatePlot& plot : rate_plots(results)) write(plot.file, plot.svg);
}

}  // namespace vog::evaluation
