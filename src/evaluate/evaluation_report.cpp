// evaluation_report.cpp: results of an evaluation as a table of comma-separated values.
#include "evaluate/evaluation_report.h"

#include <fmt/core.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <utility>
#include <vector>

#include "core/atomic_file.h"

namespace vog::evaluation {

namespace {

/// Figure of a view: its column, and whether the worst is the least.
struct TableFigure {
    const char* name;
    double ViewResult::*member;
    bool more_is_better;
};
constexpr TableFigure kTableFigures[] = {
    {"psnr_v_db", &ViewResult::psnr_v_db, true},
    {"psnr_v_covered_db", &ViewResult::psnr_v_covered_db, true},
    {"psnr_rgb_db", &ViewResult::psnr_rgb_db, true},
    {"ssim", &ViewResult::ssim, true},
    {"relative_l2", &ViewResult::relative_l2, false},
};

/// A text in quotes, which names of files and fields may need.
std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
    return out + "\"";
}

/// One line: columns and their cells, in which figures that a row has not are empty.
class Line {
  public:
    void text(const std::string& column, const std::string& cell) {
        columns_.push_back(quoted(column));
        cells_.push_back(quoted(cell));
    }
    template <class Number>
    void number(const std::string& column, Number cell, bool there = true) {
        columns_.push_back(quoted(column));
        cells_.push_back(there ? fmt::format("{}", cell) : "");
    }
    void spread(const std::string& column, Spread cell, bool there = true) {
        number(column + "_mean", cell.mean, there);
        number(column + "_worst", cell.worst, there);
    }
    std::string columns() const { return fmt::format("{}\n", fmt::join(columns_, ",")); }
    std::string cells() const { return fmt::format("{}\n", fmt::join(cells_, ",")); }

  private:
    std::vector<std::string> columns_, cells_;
};

Line line_of(const Evaluation& evaluation, const EvaluationRow& row) {
    const auto share = [&](std::uint64_t whole) {
        return static_cast<double>(row.gaussians) /
               static_cast<double>(std::max<std::uint64_t>(whole, 1));
    };
    Line line;
    line.text("series", row.series);
    line.text("step", row.step);
    line.text("label", row.label);
    line.text("options", row.options);
    line.number("aabb_sigma", row.aabb_sigma);
    line.number("gaussians", row.gaussians);
    line.number("share_of_active_voxels", share(evaluation.active_voxels));
    line.number("share_of_bounding_voxels", share(evaluation.bounding_voxels));
    line.number("bytes", row.bytes);
    line.number("mass_ratio", row.mass_ratio);
    line.number("convert_ms", row.convert.median_ms);
    const ViewResult& paper = row.views.front();
    line.number("render_ms", paper.render.median_ms);
    line.number("bias", paper.bias);
    for (const TableFigure& figure : kTableFigures) {
        line.number(figure.name, paper.*figure.member);
        line.spread(figure.name, vog::spread(row, figure.member, figure.more_is_better));
    }
    const bool fields = has_fields(row), values = !row.values.empty();
    for (std::size_t n = 0; n < evaluation.fields.size(); ++n)
        for (const auto& [name, member] : {std::pair{"mean_l2", &FieldResult::mean_l2},
                                           {"deviation_l2", &FieldResult::deviation_l2}})
            line.spread(evaluation.fields[n] + " " + name,
                        fields ? vog::spread(row, n, member) : Spread{}, fields);
    for (std::size_t n = 0; n < evaluation.functions.size(); ++n)
        for (const auto& [name, member] :
             {std::pair{"psnr_rgb_db", &ValueResult::psnr_rgb_db}, {"ssim", &ValueResult::ssim}})
            line.spread(evaluation.functions[n] + " " + name,
                        values ? vog::spread(row, n, member) : Spread{}, values);
    if (!evaluation.voxels) return line;
    const VoxelError voxels = row.voxels.value_or(VoxelError{});
    line.number("voxels relative_l2", voxels.relative_l2, row.voxels.has_value());
    line.number("voxels psnr_db", voxels.psnr_db, row.voxels.has_value());
    line.number("voxels mean", voxels.mean, row.voxels.has_value());
    line.number("voxels worst", voxels.worst, row.voxels.has_value());
    return line;
}

}  // namespace

bool has_fields(const EvaluationRow& row) {
    return !row.views.empty() && std::ranges::none_of(row.views, [](const ViewResult& view) {
        return view.fields.empty();
    });
}

void write_csv(const std::filesystem::path& file, const Evaluation& evaluation) {
    std::string text;
    for (const EvaluationRow& row : evaluation.rows) {
        const Line line = line_of(evaluation, row);
        text += (text.empty() ? line.columns() : "") + line.cells();
    }
    write_file(file, [&](std::ofstream& out) { out << text; });
}

}  // namespace vog::evaluation
