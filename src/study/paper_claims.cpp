#include "study/paper_claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "study/names.h"
#include "study/rank_correlation.h"

namespace controlspace {
namespace {

using Entries = std::span<const ClaimEntry>;
using Outcome = std::optional<ClaimOutcome>;

const ClaimEntry* find(Entries entries, std::string_view structure,
                       std::optional<SplitRule> split = {}) {
    const auto found = std::find_if(entries.begin(), entries.end(), [&](const ClaimEntry& e) {
        return e.structure == structure && e.split == split;
    });
    return found == entries.end() ? nullptr : &*found;
}

std::string label(const ClaimEntry& e) {
    return e.split ? fmt::format("{} {}", e.structure, name_of(*e.split)) : e.structure;
}

/// "K_oLB 19.4 MB, K_oL 16.4 MB".
std::string pair_text(const ClaimEntry& a, const ClaimEntry& b, double ClaimEntry::*measure,
                      std::string_view unit) {
    return fmt::format("{} {:.3g}{}, {} {:.3g}{}", label(a), a.*measure, unit, label(b), b.*measure,
                       unit);
}

Outcome all_rounder(Entries all) {
    std::vector<ClaimEntry> entries;
    std::copy_if(all.begin(), all.end(), std::back_inserter(entries),
                 [](const ClaimEntry& e) { return e.split != SplitRule::metric; });
    // Among a few only, a good rank says little.
    if (entries.size() < 9) return std::nullopt;
    std::vector<double> means(entries.size());
    for (const auto measure :
         {&ClaimEntry::memory, &ClaimEntry::creation, &ClaimEntry::access, &ClaimEntry::delta_r}) {
        std::vector<double> values;
        for (const ClaimEntry& e : entries) values.push_back(e.*measure);
        const std::vector<double> ranks = average_ranks(values);
        for (std::size_t i = 0; i < ranks.size(); ++i) means[i] += ranks[i] / 4;
    }
    std::vector<std::size_t> order(entries.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t i, std::size_t j) { return means[i] < means[j]; });
    const auto text = [&](std::size_t place) {
        return fmt::format("{} {:.2f}", label(entries[order[place]]), means[order[place]]);
    };
    const bool good = std::any_of(order.begin(), order.begin() + 3,
                                  [&](std::size_t i) { return entries[i].structure == "K_L"; });
    return ClaimOutcome{good, fmt::format("mean ranks: {}, {}, {}", text(0), text(1), text(2))};
}

Outcome interpolation(Entries entries) {
    Outcome outcome;
    for (const SplitRule split : {SplitRule::middle, SplitRule::golden}) {
        const ClaimEntry* constant = find(entries, "K_L", split);
        const ClaimEntry* quadratic = find(entries, "K_Li", split);
        if (constant == nullptr || quadratic == nullptr) return std::nullopt;
        if (!outcome) outcome = ClaimOutcome{true, ""};
        outcome->holds = outcome->holds && quadratic->delta_r < constant->delta_r &&
                         quadratic->access > constant->access;
        if (!outcome->numbers.empty()) outcome->numbers += "; ";
        outcome->numbers += pair_text(*quadratic, *constant, &ClaimEntry::delta_r, "") + "; " +
                            pair_text(*quadratic, *constant, &ClaimEntry::access, " µs");
    }
    return outcome;
}

Outcome vertices(const ClaimEntry* vertex, const ClaimEntry* leaf) {
    if (vertex == nullptr || leaf == nullptr) return std::nullopt;
    return ClaimOutcome{vertex->delta_r < leaf->delta_r && vertex->memory > leaf->memory &&
                            vertex->creation > leaf->creation,
                        pair_text(*vertex, *leaf, &ClaimEntry::delta_r, "") + "; " +
                            pair_text(*vertex, *leaf, &ClaimEntry::memory, " MB") + "; " +
                            pair_text(*vertex, *leaf, &ClaimEntry::creation, " s")};
}

Outcome kd_vertices(Entries entries) {
    return vertices(find(entries, "K_V", SplitRule::middle),
                    find(entries, "K_L", SplitRule::middle));
}

Outcome fastest_octree(Entries entries) {
    const ClaimEntry* octree = find(entries, "K_oL");
    if (octree == nullptr || entries.size() < 2) return std::nullopt;
    const ClaimEntry* other = nullptr;
    for (const ClaimEntry& e : entries) {
        if (&e != octree && (other == nullptr || e.access < other->access)) other = &e;
    }
    return ClaimOutcome{octree->access < other->access,
                        pair_text(*octree, *other, &ClaimEntry::access, " µs")};
}

Outcome poor_slabs(Entries entries) {
    const ClaimEntry* middle = find(entries, "K_L", SplitRule::middle);
    const ClaimEntry* slabs = find(entries, "K_L", SplitRule::metric);
    if (middle == nullptr || slabs == nullptr) return std::nullopt;
    return ClaimOutcome{slabs->delta_r > 2 * middle->delta_r,
                        pair_text(*slabs, *middle, &ClaimEntry::delta_r, "")};
}

Outcome poor_deep_slabs(Entries entries) {
    const ClaimEntry* middle = find(entries, "K_L", SplitRule::middle);
    const ClaimEntry* slabs = find(entries, "K_L", SplitRule::metric);
    if (middle == nullptr || slabs == nullptr || !slabs->delta_r_deep) return std::nullopt;
    return ClaimOutcome{
        *slabs->delta_r_deep > 2 * middle->delta_r,
        fmt::format("K_L s_M {:.3g} at the paper's depth, {:.3g} at the deepest; K_L s_L {:.3g}",
                    slabs->delta_r, *slabs->delta_r_deep, middle->delta_r)};
}

Outcome poor_octree_vertices(Entries entries) {
    const ClaimEntry* octree = find(entries, "K_oV");
    const ClaimEntry* kd = find(entries, "K_V", SplitRule::middle);
    if (octree == nullptr || kd == nullptr) return std::nullopt;
    return ClaimOutcome{octree->delta_r > kd->delta_r,
                        pair_text(*octree, *kd, &ClaimEntry::delta_r, "")};
}

Outcome dear_balance(Entries entries) {
    const ClaimEntry* balanced = find(entries, "K_oLB");
    const ClaimEntry* plain = find(entries, "K_oL");
    if (balanced == nullptr || plain == nullptr) return std::nullopt;
    return ClaimOutcome{balanced->memory > 2 * plain->memory,
                        pair_text(*balanced, *plain, &ClaimEntry::memory, " MB")};
}

Outcome harmful_balance(Entries entries) {
    const ClaimEntry* balanced = find(entries, "K_oLB");
    const ClaimEntry* plain = find(entries, "K_oL");
    if (balanced == nullptr || plain == nullptr) return std::nullopt;
    return ClaimOutcome{balanced->delta_r > plain->delta_r,
                        pair_text(*balanced, *plain, &ClaimEntry::delta_r, "")};
}

constexpr Claim claims[] = {
    {"K_L is a good all-rounder.",
     "mean rank in memory, creation, access and delta_R among the best three of nine, s_M left out",
     "Tables 1-4", all_rounder},
    {"Interpolation buys accuracy for time.",
     "K_Li against K_L, with s_L and with s_G: smaller delta_R, longer access", "Tables 3 and 4",
     interpolation},
    {"Values at vertices buy accuracy for memory and creation time.",
     "K_V against K_L, with s_L: smaller delta_R, more MB, more s", "Tables 1, 2 and 4",
     kd_vertices},
    {"The plain octree is the fastest to read.", "access time of K_oL against all others",
     "Table 3", fastest_octree},
    {"The split s_M is poor.", "delta_R of K_L: more than twice that of s_L", "Table 4",
     poor_slabs},
    {"The split s_M is poor at any depth.", "the same, at the deepest limit tried",
     "experiment: the depth limit of s_M", poor_deep_slabs},
    {"The octree with values at vertices is bad.", "delta_R of K_oV above that of K_V s_L",
     "experiment: shared vertices", poor_octree_vertices},
    {"Balancing ruins memory.", "K_oLB: more than twice the MB of K_oL", "experiment: balance",
     dear_balance},
    {"Balancing ruins accuracy.", "delta_R of K_oLB above that of K_oL", "experiment: balance",
     harmful_balance},
};

/// Ours and the paper's entries at one setting.
struct SettingEntries {
    double rho;
    double tau;
    std::vector<ClaimEntry> ours;
    std::vector<ClaimEntry> paper;
};

ClaimEntry entry_of(const PaperEvidence& evidence, const Row& row) {
    const Measures& m = *row.measures;
    ClaimEntry e{row.setting.structure,
                 row.setting.split,
                 static_cast<double>(m.footprint.bytes_total()) / 1e6,
                 value(PaperTable::creation, m),
                 value(PaperTable::access, m),
                 m.accuracy.max,
                 {}};
    const auto depths = evidence.other_depths(row.setting);
    if (!depths.empty()) e.delta_r_deep = depths.back()->measures->accuracy.max;
    return e;
}

std::vector<SettingEntries> entries_by_setting(const PaperEvidence& evidence) {
    std::vector<SettingEntries> settings;
    for (const auto& [row, paper] : evidence.cells()) {
        if (!row->measures) continue;
        auto at = std::find_if(settings.begin(), settings.end(), [&, p = paper](const auto& s) {
            return s.rho == p->rho && s.tau == p->tau;
        });
        if (at == settings.end()) at = settings.insert(at, {paper->rho, paper->tau, {}, {}});
        at->ours.push_back(entry_of(evidence, *row));
        at->paper.push_back({paper->structure,
                             paper->split,
                             paper->size_mb,
                             paper->creation_s,
                             paper->access_us,
                             paper->delta_r_max,
                             {}});
    }
    return settings;
}

JudgedClaim judged(const Claim& claim, const std::vector<SettingEntries>& settings) {
    JudgedClaim result{&claim, ClaimVerdict::not_measured, 0, 0, 0, 0, "", ""};
    bool failed = false;
    for (const SettingEntries& setting : settings) {
        const auto ours = claim.test(setting.ours);
        if (!ours) continue;
        ++result.settings;
        result.holds += ours->holds ? 1 : 0;
        if (result.settings == 1 || (!ours->holds && !failed)) {
            result.place = fmt::format("ρ {} τ {}", setting.rho, setting.tau);
            result.numbers = ours->numbers;
        }
        failed = failed || !ours->holds;
        if (const auto paper = claim.test(setting.paper)) {
            ++result.paper_settings;
            result.paper_holds += paper->holds ? 1 : 0;
        }
    }
    if (result.settings > 0) {
        result.verdict = failed ? ClaimVerdict::does_not_stand : ClaimVerdict::stands;
    }
    return result;
}

}  // namespace

std::span<const Claim> paper_claims() { return claims; }

std::vector<JudgedClaim> judge_claims(const PaperEvidence& evidence) {
    const auto settings = entries_by_setting(evidence);
    std::vector<JudgedClaim> judged_claims;
    for (const Claim& claim : claims) judged_claims.push_back(judged(claim, settings));
    return judged_claims;
}

}  // namespace controlspace
