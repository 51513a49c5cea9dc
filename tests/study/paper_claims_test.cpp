#include "study/paper_claims.h"

#include <algorithm>
#include <catch2/catch.hpp>

#include "study/paper_rows.h"

using namespace controlspace;
using Catch::Matchers::Contains;

namespace {

constexpr auto s_l = SplitRule::middle;
constexpr auto s_g = SplitRule::golden;
constexpr auto s_m = SplitRule::metric;

const Claim& claim(std::string_view sentence) {
    for (const Claim& c : paper_claims()) {
        if (c.sentence == sentence) return c;
    }
    throw std::logic_error(std::string(sentence));
}

bool holds(std::string_view sentence, const std::vector<ClaimEntry>& entries) {
    const auto outcome = claim(sentence).test(entries);
    REQUIRE(outcome);
    return outcome->holds;
}

JudgedClaim judged(const std::vector<Row>& rows, std::string_view sentence) {
    PaperEvidence evidence;
    evidence.add(Study{}, rows);
    for (const JudgedClaim& j : judge_claims(evidence)) {
        if (j.claim->sentence == sentence) return j;
    }
    throw std::logic_error(std::string(sentence));
}

/// As the paper has it, but for K_oLB, which is `factor` times K_oL in size and δ_R.
std::vector<Row> rows_with_balance(double factor) {
    return rows_of_paper([=](Row& row) {
        if (row.setting.structure != "K_oLB") return;
        for (const PaperRow& paper : paper_rows()) {
            if (paper.structure != "K_oL" || paper.rho != row.setting.sources.rho ||
                paper.tau != row.setting.tau) {
                continue;
            }
            row.measures->accuracy.max = factor * paper.delta_r_max;
            row.measures->footprint.bytes_payload =
                static_cast<std::size_t>(factor * paper.size_mb * 1e6);
        }
    });
}

}  // namespace

TEST_CASE("each claim is true of rows that it fits, and false of others") {
    const auto balance = [](double memory, double delta) {
        return std::vector<ClaimEntry>{{"K_oL", {}, 10, 1, 1, 1},
                                       {"K_oLB", {}, memory, 1, 1, delta}};
    };
    CHECK(holds("Balancing ruins memory.", balance(21, 1)));
    CHECK_FALSE(holds("Balancing ruins memory.", balance(19, 1)));
    CHECK(holds("Balancing ruins accuracy.", balance(10, 1.1)));
    CHECK_FALSE(holds("Balancing ruins accuracy.", balance(10, 0.9)));

    const auto octree_v = [](double delta) {
        return std::vector<ClaimEntry>{{"K_V", s_l, 1, 1, 1, 0.3}, {"K_oV", {}, 1, 1, 1, delta}};
    };
    CHECK(holds("The octree with values at vertices is bad.", octree_v(1.79)));
    CHECK_FALSE(holds("The octree with values at vertices is bad.", octree_v(0.15)));

    const auto slabs = [](double delta, double deep) {
        return std::vector<ClaimEntry>{{"K_L", s_l, 1, 1, 1, 1.5},
                                       {"K_L", s_m, 1, 1, 1, delta, deep}};
    };
    CHECK(holds("The split s_M is poor.", slabs(6, 2)));
    CHECK_FALSE(holds("The split s_M is poor.", slabs(2, 6)));
    CHECK(holds("The split s_M is poor at any depth.", slabs(6, 4)));
    CHECK_FALSE(holds("The split s_M is poor at any depth.", slabs(6, 2)));

    const auto vertices = [](double memory, double creation, double delta) {
        return std::vector<ClaimEntry>{{"K_L", s_l, 10, 1, 1, 1},
                                       {"K_V", s_l, memory, creation, 1, delta}};
    };
    constexpr auto buys = "Values at vertices buy accuracy for memory and creation time.";
    CHECK(holds(buys, vertices(11, 2, 0.9)));
    CHECK_FALSE(holds(buys, vertices(9, 2, 0.9)));
    CHECK_FALSE(holds(buys, vertices(11, 0.5, 0.9)));
    CHECK_FALSE(holds(buys, vertices(11, 2, 1.1)));

    const auto quadratic = [](double access, double delta) {
        return std::vector<ClaimEntry>{{"K_L", s_l, 1, 1, 1, 1},
                                       {"K_L", s_g, 1, 1, 1, 1},
                                       {"K_Li", s_l, 1, 1, 2, 0.5},
                                       {"K_Li", s_g, 1, 1, access, delta}};
    };
    CHECK(holds("Interpolation buys accuracy for time.", quadratic(2, 0.5)));
    CHECK_FALSE(holds("Interpolation buys accuracy for time.", quadratic(0.5, 0.5)));
    CHECK_FALSE(holds("Interpolation buys accuracy for time.", quadratic(2, 1.5)));

    const auto octree = [](double access) {
        return std::vector<ClaimEntry>{{"K_oL", {}, 1, 1, access, 1}, {"K_L", s_m, 1, 1, 1, 1}};
    };
    CHECK(holds("The plain octree is the fastest to read.", octree(0.9)));
    CHECK_FALSE(holds("The plain octree is the fastest to read.", octree(1.1)));
}

TEST_CASE("an all-rounder is among the best three in mean rank, s_M left out") {
    std::vector<ClaimEntry> entries{
        {"K_L", s_l, 2, 2, 2, 2}, {"K_L", s_g, 3, 3, 3, 3},  {"K_V", s_l, 9, 9, 9, 1},
        {"K_V", s_g, 8, 8, 8, 8}, {"K_Li", s_l, 7, 7, 7, 7}, {"K_Li", s_g, 6, 6, 6, 6},
        {"K_oL", {}, 4, 4, 1, 4}, {"K_oLB", {}, 5, 5, 5, 5}, {"K_oV", {}, 10, 10, 10, 9}};
    CHECK(holds("K_L is a good all-rounder.", entries));
    entries.push_back({"K_L", s_m, 1, 1, 20, 20});
    CHECK(holds("K_L is a good all-rounder.", entries));
    entries[6] = {"K_oL", {}, 1, 1, 1, 1};
    CHECK(holds("K_L is a good all-rounder.", entries));
    entries[0] = {"K_L", s_l, 20, 20, 20, 20};
    entries[1] = {"K_L", s_g, 21, 21, 21, 21};
    CHECK_FALSE(holds("K_L is a good all-rounder.", entries));
    entries.resize(4);
    CHECK_FALSE(claim("K_L is a good all-rounder.").test(entries));
}

TEST_CASE("a claim without its rows is not measured") {
    for (const Claim& c : paper_claims()) CHECK_FALSE(c.test({}));
    const std::vector<Row> one{row_of(paper_rows().front())};
    const JudgedClaim j = judged(one, "Balancing ruins memory.");
    CHECK(j.verdict == ClaimVerdict::not_measured);
    CHECK(j.settings == 0);
    CHECK(j.numbers.empty());
}

TEST_CASE("the paper's own numbers bear out what they suggest") {
    for (const auto sentence :
         {"Balancing ruins memory.", "Balancing ruins accuracy.", "The split s_M is poor.",
          "The octree with values at vertices is bad.", "Interpolation buys accuracy for time."}) {
        const JudgedClaim j = judged(rows_of_paper(), sentence);
        CHECK(j.verdict == ClaimVerdict::stands);
        CHECK(j.settings == 6);
        CHECK(j.paper_holds == 6);
        CHECK_THAT(j.place, Contains("ρ 1 τ 1"));
    }
}

TEST_CASE("a claim stands only if it holds at every setting measured") {
    CHECK(judged(rows_with_balance(3), "Balancing ruins memory.").verdict == ClaimVerdict::stands);
    const JudgedClaim cheap = judged(rows_with_balance(1.2), "Balancing ruins memory.");
    CHECK(cheap.verdict == ClaimVerdict::does_not_stand);
    CHECK(cheap.holds == 0);
    CHECK(cheap.paper_holds == 6);
    CHECK_THAT(cheap.numbers, Contains("K_oLB 19.6 MB, K_oL 16.4 MB"));

    auto rows = rows_with_balance(3);
    for (Row& row : rows) {
        if (row.setting.structure == "K_oLB" && row.setting.tau == 0.2) {
            row.measures->footprint.bytes_payload = 1'000'000;
        }
    }
    const JudgedClaim mixed = judged(rows, "Balancing ruins memory.");
    CHECK(mixed.verdict == ClaimVerdict::does_not_stand);
    CHECK(mixed.holds == 4);
    CHECK(mixed.place == "ρ 1 τ 0.2");
    CHECK_THAT(mixed.numbers, Contains("K_oLB 1 MB"));
}

TEST_CASE("s_M at other depths counts with the deepest") {
    auto rows = rows_of_paper();
    CHECK(judged(rows, "The split s_M is poor at any depth.").verdict ==
          ClaimVerdict::not_measured);
    for (const auto& [depth, delta] : {std::pair{200, 2.0}, {100, 7.0}}) {
        for (const PaperRow& paper : paper_rows()) {
            if (paper.structure != "K_L" || paper.split != s_m) continue;
            Row deep = row_of(paper);
            deep.setting.max_depth = depth;
            deep.measures->accuracy.max = delta;
            rows.push_back(deep);
        }
    }
    const JudgedClaim j = judged(rows, "The split s_M is poor at any depth.");
    CHECK(j.verdict == ClaimVerdict::does_not_stand);
    CHECK(j.settings == 6);
    CHECK(j.paper_settings == 0);
}
