// evaluation_markdown.cpp: results.md: the report's tables in Markdown.
#include <fmt/core.h>

#include <fstream>

#include "core/atomic_file.h"
#include "evaluate/evaluation_report.h"
#include "evaluate/paper_figures.h"
#include "vog/error.h"

namespace vog::evaluation {

namespace {

std::string table_text(const ReportTable& table) {
    std::string out = fmt::format("\n## {}\n\n", table.title);
    if (!table.about.empty()) out += table.about + "\n\n";
    const std::size_t ours = table.columns.size() - table.paper_columns;
    std::string rule = "|";
    for (std::size_t n = 0; n < table.columns.size(); ++n) {
        out += fmt::format("| {}{} ", n < ours ? "" : "paper: ", table.columns[n]);
        rule += n == 0 ? ":---|" : "---:|";
    }
    out += "|\n" + rule + "\n";
    for (const std::vector<std::string>& cells : table.rows) {
        for (std::size_t n = 0; n < table.columns.size(); ++n) {
            const std::string cell = n < cells.size() ? cells[n] : "";
            out += cells.size() == 1 && n == 0 ? fmt::format("| **{}** ", cell)
                                               : fmt::format("| {} ", cell);
        }
        out += "|\n";
    }
    if (table.paper_columns) out += fmt::format("\nThe paper's figures were {}.\n", kPaperHardware);
    return out;
}

}  // namespace

void write_markdown(const std::filesystem::path& file, const Evaluation& evaluation) {
    std::string text = fmt::format("# Evaluation of {}\n\n", evaluation.title);
    for (const std::string& fact : report_facts(evaluation)) text += fmt::format("- {}\n", fact);
    for (const ReportTable& table : report_tables(evaluation)) text += table_text(table);
    write_file(file, [&](std::ofstream& out) { out << text; });
}

}  // namespace vog::evaluation
