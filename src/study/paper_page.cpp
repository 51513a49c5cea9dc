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

/// The claims of one verdict; a table without rows if there are none.
TextTable claims_table(std::span<const JudgedClaim> claims, ClaimVerdict verdict,
                       std::string heading) {
    TextTable table{std::move(heading),
                    "Holds: number of settings of the sphere at which our numbers bear it out, "
                    "and the paper's own. It stands if ours do at every setting.",
                    {{"conclusion", Align::left},
                     {"holds"},
                     {"in the paper"},
                     {"numbers, ours", Align::left},
                     {"compared", Align::left},
                     {"more in", Align::left}},
                    {}};
    for (const JudgedClaim& judged : claims) {
        if (judged.verdict != verdict) continue;
        const auto share = [](std::size_t part, std::size_t all) {
            return all == 0 ? std::string("–") : fmt::format("{} of {}", part, all);
        };
        table.rows.push_back(
            {std::string(judged.claim->sentence), share(judged.holds, judged.settings),
             share(judged.paper_holds, judged.paper_settings),
             judged.settings == 0 ? "" : fmt::format("{}: {}", judged.place, judged.numbers),
             std::string(judged.claim->measure), std::string(judged.claim->shown_by)});
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

std::string paper_headline(const PaperEvidence& evidence) {
    const std::vector<JudgedClaim> claims = judge_claims(evidence);
    const auto claims_that = [&](ClaimVerdict verdict) {
        return std::count_if(claims.begin(), claims.end(),
                             [&](const JudgedClaim& c) { return c.verdict == verdict; });
    };
    std::vector<CellVerdict> cells = judge(evidence, PaperTable::size);
    const auto more = judge(evidence, PaperTable::delta_r);
    cells.insert(cells.end(), more.begin(), more.end());
    const auto cells_that = [&](Verdict verdict) {
        return std::count_if(cells.begin(), cells.end(),
                             [&](const CellVerdict& cell) { return cell.verdict == verdict; });
    };
    return fmt::format(
        "Of the conclusions that the paper's tables suggest {} stand and {} do not. Of the {} "
        "cells of Tables 1 and 4 {} are equal to the printed digit, {} differ "
        "for a reason that an experiment shows, {} differ and are not explained.",
        claims_that(ClaimVerdict::stands), claims_that(ClaimVerdict::does_not_stand), cells.size(),
        cells_that(Verdict::equal), cells_that(Verdict::explained),
        cells_that(Verdict::unexplained));
}

std::vector<TextTable> paper_summary_tables(const PaperEvidence& evidence) {
    const std::vector<JudgedClaim> claims = judge_claims(evidence);
    std::vector<TextTable> tables;
    const auto add_claims = [&](ClaimVerdict verdict, std::string heading) {
        TextTable table = claims_table(claims, verdict, std::move(heading));
        if (!table.rows.empty()) tables.push_back(std::move(table));
    };
    add_claims(ClaimVerdict::stands, "Conclusions that stand");
    add_claims(ClaimVerdict::does_not_stand, "Conclusions that do not stand");
    add_claims(ClaimVerdict::not_measured, "Conclusions that were not measured");
    tables.push_back(rank_table(evidence));
    tables.push_back(counts_table(evidence));
    tables.push_back(open_table(evidence));
    return tables;
}

std::vector<TextTable> paper_detail_tables(const PaperEvidence& evidence) {
    std::vector<TextTable> tables = paper_experiments(evidence);
    for (const PaperTable t : paper_tables) {
        TextTable& table = tables.emplace_back(cells_table(std::string(title(t)), ""));
        for (const CellVerdict& judged : judge(evidence, t)) {
            table.rows.push_back(cells_row(t, judged));
        }
    }
    return tables;
}

std::string paper_summary(const PaperEvidence& evidence, TableStyle style) {
    std::string text = paper_headline(evidence) + '\n';
    for (const TextTable& table : paper_summary_tables(evidence)) {
        text += '\n' + render(table, style);
    }
    return text;
}

std::string paper_page(const PaperEvidence& evidence, std::span<const std::string> origins) {
    std::string text =
        "# The paper, cell by cell\n\n"
        "Jurczyk & Głut, \"Tree-based control space structures for discrete metric sources in 3D "
        "meshing\", Tables 1-4, beside rows that were run in the same way.\n\n";
    for (const std::string& origin : origins) text += fmt::format("- {}\n", origin);
    text += fmt::format("\n{}", paper_summary(evidence, TableStyle::markdown));
    for (const TextTable& table : paper_detail_tables(evidence)) {
        text += fmt::format("\n{}", render(table, TableStyle::markdown));
    }
    return text;
}

}  // namespace controlspace
