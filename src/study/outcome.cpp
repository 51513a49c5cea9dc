// SPDX-License-Identifier: Apache-2.0
#include "study/outcome.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "controlspace/metric/nonconformity.h"
#include "controlspace/study/parameter.h"
#include "study/grouped.h"

namespace controlspace {
namespace {

using Rows = std::vector<const Row*>;

constexpr const char* access_key = "t_access_ns_random";
constexpr double rounding = 1e-6;  // of factors

/// The largest factor between lengths at any probe, coarse or fine; infinite where it is not known.
double factor_of(const Row& row) {
    const double coarse = row.number("within_max"), fine = row.number("within_fine_max");
    return std::isnan(coarse + fine) ? std::numeric_limits<double>::infinity()
                                     : std::max(coarse, fine);
}

/// The largest δ at any probe.
double delta_of(const Row& row) {
    return std::max(row.number("delta_R_max"), row.number("delta_R_fine_max"));
}

/// Whether lengths differ by more, along a single direction, than δ allows for lengths: of tensors.
bool shows_tensors(const Row* row) {
    return factor_of(*row) > largest_factor_within(delta_of(*row)) * (1 + 1e-4);
}

/// A requested accuracy: lengths within a factor, and δ.
struct Asked {
    double factor = Outcome{}.factor;
    double delta = std::numeric_limits<double>::infinity();

    auto operator<=>(const Asked&) const = default;
    bool is_met(const Row& row) const {
        return factor_of(row) <= factor * (1 + rounding) &&
               !(delta_of(row) > delta * (1 + rounding));
    }
};

/// Those with the smallest number, but for a share of `tolerance`.
template <class Number>
Rows least(const Rows& rows, const Number& number, double tolerance = 0) {
    const double smallest =
        number(**std::ranges::min_element(rows, {}, [&](const Row* row) { return number(*row); }));
    Rows found = rows;
    std::erase_if(found, [&](const Row* row) { return number(*row) > smallest * (1 + tolerance); });
    return found;
}

std::string counted_rows(std::size_t within, std::size_t all) {
    return within == all ? fmt::format("{} of {} rows", all == 1 ? "the one" : "all", all)
                         : fmt::format("{} of {} rows", within, all);
}

/// "K_V, tau 0.5 (0.41 MB, 19.0 ns per query, lengths within 1.08x)", several with "and".
std::string named(const Rows& rows, const StudyRows& columns) {
    constexpr std::size_t most = 4;
    std::string text;
    for (std::size_t i = 0; i < std::min(rows.size(), most); ++i) {
        const Row& row = *rows[i];
        if (i > 0) text += i + 1 == rows.size() ? " and " : ", ";
        text +=
            fmt::format("{} ({:.3g} MB, {:.1f} ns per query, lengths within {:.3f}x)",
                        method_label(row.setting, columns.parameters),
                        row.number("bytes_total") * 1e-6, row.number(access_key), factor_of(row));
    }
    if (rows.size() > most) text += fmt::format(" and {} more", rows.size() - most);
    return text;
}

/// Trees are adapted to the exact field, not to another reference.
bool follows_exact_field(const Rows& rows) {
    return rows.front()->setting.reference == &exact_reference_kind();
}

/// Where no row is within the factor.
std::string nearest(const Rows& measured, double factor, bool is_asked, const StudyRows& columns) {
    Rows finite = measured;
    std::erase_if(finite, [](const Row* row) {
        return !row->is_ranked() || !std::isfinite(factor_of(*row));
    });
    const std::string found =
        finite.empty()
            ? "All errors are infinite, or rows were stopped"
            : fmt::format("Closest: {}", named(least(finite, factor_of, rounding), columns));
    if (is_asked) return found + "; the remarks of the rows say what would help.";
    if (!follows_exact_field(measured)) return found + ".";
    return fmt::format("{}; --within {:.4g} adapts trees to it.", found, factor);
}

/// A sentence on the rows that limits stopped, which are not ranked.
void add_stopped(Outcome& o, const Rows& measured, const StudyRows& columns) {
    std::string text;
    for (const Row* row : measured) {
        if (row->is_ranked()) continue;
        text += fmt::format("{}{} ({})", text.empty() ? "" : "; ",
                            method_label(row->setting, columns.parameters), row->text("stopped"));
    }
    if (!text.empty()) o.sentences.push_back(fmt::format("Not ranked: {}.", text));
}

/// Of `timed`: those whose quartiles of the access time overlap with those of the smallest median;
/// empty where not all of them were timed in turns.
Rows fastest_of(const Rows& timed) {
    const auto in_batch = [](const Row* row) { return row->number("access_batch"); };
    if (std::ranges::any_of(
            timed, [&](const Row* row) { return in_batch(row) != in_batch(timed.front()); })) {
        return {};
    }
    const std::string key = access_key;
    const Row* fastest =
        *std::ranges::min_element(timed, {}, [&](const Row* row) { return row->number(key); });
    Rows found = timed;
    std::erase_if(found, [&](const Row* row) {
        return row->number(key + "_q1") > fastest->number(key + "_q3");
    });
    return found;
}

/// Of the rows of a work that were measured, of `rows`.
Outcome outcome_of(const std::string& work, const Rows& measured, const Asked& asked, bool is_asked,
                   std::span<const Row> rows, const StudyRows& columns) {
    const auto indices = [&](const Rows& of) {
        std::vector<std::size_t> found;
        for (const Row* row : of) found.push_back(static_cast<std::size_t>(row - rows.data()));
        return found;
    };
    const double factor = asked.factor;
    Outcome o{.work = work, .factor = factor, .is_asked = is_asked, .measured = measured.size()};
    Rows within = measured;
    std::erase_if(within, [&](const Row* row) { return !row->is_ranked() || !asked.is_met(*row); });
    o.within = indices(within);
    std::string error = fmt::format("within {:.4g}x of the reference's at all probes{}", factor,
                                    is_asked ? "" : " (by default)");
    if (factor > largest_factor_within(asked.delta) * (1 + rounding)) {
        error += fmt::format(", and δ <= {:.4g}", asked.delta);
    }
    if (within.empty()) {
        o.sentences = {fmt::format("No structure has lengths {}.", error),
                       nearest(measured, factor, is_asked, columns)};
        add_stopped(o, measured, columns);
        return o;
    }
    const Rows smallest = least(within, [](const Row& row) { return row.number("bytes_total"); });
    Rows fastest = fastest_of(within);
    std::ranges::stable_sort(fastest, {}, [](const Row* row) { return row->number(access_key); });
    const Rows accurate = least(within, factor_of, rounding);
    o.smallest = indices(smallest);
    o.fastest = indices(fastest);
    o.most_accurate = indices(accurate);
    o.sentences = {
        fmt::format("Lengths {}: {}.", error, counted_rows(within.size(), measured.size())),
        fmt::format("Smallest: {}.", named(smallest, columns)),
        fastest.empty()
            ? "Fastest: no statement, since the rows were not timed in turns."
            : fmt::format("Fastest: {}{}.", fastest.size() > 1 ? "indistinguishable between " : "",
                          named(fastest, columns)),
        fmt::format("Most accurate: {}.", named(accurate, columns))};
    const bool has_trees =
        std::ranges::any_of(measured, [](const Row* row) { return row->number("tree_nodes") > 0; });
    if (!is_asked && has_trees && follows_exact_field(measured)) {
        o.sentences.push_back(fmt::format(
            "No tree was adapted: --within {:.4g} makes trees for this error, often smaller ones.",
            factor));
    }
    add_stopped(o, measured, columns);
    return o;
}

}  // namespace

std::vector<Outcome> outcomes(std::span<const Row> rows, const StudyRows& columns) {
    std::vector<Outcome> all;
    for (auto& [work, members] : grouped(
             rows, [&](const Row& row) { return work_label(row.setting, columns.parameters); })) {
        Rows measured = members;
        std::erase_if(measured, [](const Row* row) { return !row->is_measured(); });
        if (measured.empty()) continue;
        const bool has_tensors = std::ranges::any_of(measured, shows_tensors);
        std::set<Asked> targets;
        for (const Row* row : members) {
            const Case& c = row->setting;
            if (!c.target_delta) continue;
            const double delta = *c.target_delta;
            if (c.within) {
                targets.insert({.factor = *c.within});
            } else {
                targets.insert(
                    {has_tensors ? largest_factor_along(delta) : largest_factor_within(delta),
                     delta});
            }
        }
        const bool is_asked = !targets.empty();
        if (!is_asked) targets.insert(Asked());
        for (const Asked& target : targets) {
            all.push_back(outcome_of(work, measured, target, is_asked, rows, columns));
        }
    }
    return all;
}

std::string outcome_text(std::span<const Row> rows, const StudyRows& columns) {
    const std::vector<Outcome> all = outcomes(rows, columns);
    std::string text;
    for (const Outcome& outcome : all) {
        text += "\nWhich structure to take";
        if (all.front().work != all.back().work) text.append(": ").append(outcome.work);
        text += '\n';
        for (const std::string& sentence : outcome.sentences) text.append(sentence).append("\n");
    }
    return text;
}

Json to_json(const Outcome& outcome) {
    return {{"work", outcome.work},          {"factor", outcome.factor},
            {"asked", outcome.is_asked},     {"measured", outcome.measured},
            {"within", outcome.within},      {"smallest", outcome.smallest},
            {"fastest", outcome.fastest},    {"most_accurate", outcome.most_accurate},
            {"sentences", outcome.sentences}};
}

}  // namespace controlspace
