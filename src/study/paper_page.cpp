#include "study/paper_page.h"

#include <fmt/format.h>

#include <algorithm>

#include "study/names.h"
#include "study/paper_claims.h"
#include "study/paper_experiments.h"
#include "study/paper_verdicts.h"

namespace controlspace {
namespace {

constexpr Verdict verdicts[] = {Verdict::equal, Verdict::explained, Verdict::not_comparable,
                                Verdict::unexplained, Verdict::failed};

TextTable claims_table(const PaperEvidence& evidence) {
    TextTable table{"What stands, what does not",
                    "Each conclusion is a comparison of numbers, made at every setting measured; "
                    "it stands if it holds at all of them.",
                    {{"conclusion", Align::left},
                     {"measured", Align::left},
                     {"settings"},
                     {"in the paper"},
                     {"compared", Align::left},
                     {"numbers", Align::left}},
                    {}};
    for (const JudgedClaim& judged : judge_claims(evidence)) {
        const auto share = [](std::size_t part, std::size_t all) {
            return all == 0 ? std::string("–") : fmt::format("{} of {}", part, all);
        };
        table.rows.push_back(
            {std::string(judged.claim->sentence), std::string(to_string(judged.verdict)),
             share(judged.holds, judged.settings), share(judged.paper_holds, judged.paper_settings),
             std::string(judged.claim->measure),
             judged.settings == 0 ? "" : fmt::format("{}: {}", judged.place, judged.numbers)});
    }
    return table;
}

TextTable counts_table(const PaperEvidence& evidence) {
    TextTable table{"Verdicts on the paper's cells",
                    "Equal: to the printed digit. Explained: differs, and an experiment shows why.",
                    {{"table", Align::left}},
                    {}};
    for (const Verdict v : verdicts) table.columns.push_back({std::string(to_string(v))});
    table.columns.push_back({"not measured"});
    for (const PaperTable t : paper_tables) {
        const auto judged = judge(evidence, t);
        auto& row = table.rows.emplace_back(std::vector{std::string(title(t))});
        for (const Verdict v : verdicts) {
            row.push_back(fmt::format(
                "{}", std::count_if(judged.begin(), judged.end(),
                                    [&](const CellVerdict& cell) { return cell.verdict == v; })));
        }
        row.push_back(fmt::format("{}", paper_rows().size() - judged.size()));
    }
    return table;
}

TextTable cells_table(std::string heading, std::string note) {
    return {std::move(heading),
            std::move(note),
            {{"structure", Align::left},
             {"split", Align::left},
             {"ρ"},
             {"τ"},
             {"ours"},
             {"paper"},
             {"verdict", Align::left},
             {"why", Align::left}},
            {}};
}

std::vector<std::string> cells_row(PaperTable table, const CellVerdict& judged) {
    const PaperRow& paper = *judged.cell.paper;
    const auto& measures = judged.cell.ours->measures;
    const bool is_time = table == PaperTable::creation || table == PaperTable::access;
    const int digits = is_time ? 3 : 2;
    return {paper.structure,
            std::string(paper.split ? name_of(*paper.split) : ""),
            fmt::format("{}", paper.rho),
            fmt::format("{}", paper.tau),
            measures ? fmt::format("{:.{}f}", value(table, *measures), digits) : "–",
            fmt::format("{:.2f}", value(table, paper)),
            std::string(to_string(judged.verdict)),
            judged.reason};
}

/// The cells that nobody may overlook.
TextTable open_table(const PaperEvidence& evidence) {
    auto table = cells_table("Cells that differ and are not explained",
                             "With what was tried, and what it gave.");
    table.columns.insert(table.columns.begin(), {"table", Align::left});
    for (const PaperTable t : paper_tables) {
        for (const CellVerdict& judged : judge(evidence, t)) {
            if (judged.verdict != Verdict::unexplained && judged.verdict != Verdict::failed) {
                continue;
            }
            auto row = cells_row(t, judged);
            row.insert(row.begin(), std::string(title(t).substr(0, title(t).find(':'))));
            table.rows.push_back(std::move(row));
        }
    }
    if (table.rows.empty()) table.note = "None.";
    return table;
}

}  // namespace

std::string paper_summary(const PaperEvidence& evidence, TableStyle style) {
    return fmt::format("{}\n{}\n{}", render(claims_table(evidence), style),
                       render(counts_table(evidence), style), render(open_table(evidence), style));
}

std::string paper_page(const PaperEvidence& evidence, std::span<const std::string> origins) {
    std::string text =
        "# The paper, cell by cell\n\n"
        "Jurczyk & Głut, \"Tree-based control space structures for discrete metric sources in 3D "
        "meshing\", Tables 1-4, beside rows that were run in the same way.\n\n";
    for (const std::string& origin : origins) text += fmt::format("- {}\n", origin);
    text += fmt::format("\n{}", paper_summary(evidence, TableStyle::markdown));
    const auto add = [&](const TextTable& table) {
        text += fmt::format("\n{}", render(table, TableStyle::markdown));
    };
    add(rank_table(evidence));
    for (const TextTable& table : paper_experiments(evidence)) add(table);
    for (const PaperTable t : paper_tables) {
        TextTable table = cells_table(std::string(title(t)), "");
        for (const CellVerdict& judged : judge(evidence, t)) {
            table.rows.push_back(cells_row(t, judged));
        }
        add(table);
    }
    return text;
}

}  // namespace controlspace
