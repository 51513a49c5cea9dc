#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "study/paper_evidence.h"

namespace controlspace {

/// What a claim may speak of: one structure at one setting, ours or the paper's.
struct ClaimEntry {
    std::string structure;
    std::optional<SplitRule> split;
    double memory = 0;    ///< MB; ours: really taken
    double creation = 0;  ///< s
    double access = 0;    ///< µs
    double delta_r = 0;   ///< largest
    /// Largest δ_R with the deepest limit that was tried, if any other was.
    std::optional<double> delta_r_deep = {};
};

/// Whether a claim holds at one setting, and the numbers that decide it.
struct ClaimOutcome {
    bool holds;
    std::string numbers;
};

/// A conclusion that the paper's tables suggest.
struct Claim {
    std::string_view sentence;
    std::string_view measure;   ///< what is compared
    std::string_view shown_by;  ///< experiment or table with more
    /// At one setting; none where an entry that it needs is missing.
    std::optional<ClaimOutcome> (*test)(std::span<const ClaimEntry>);
};

std::span<const Claim> paper_claims();

enum class ClaimVerdict { stands, does_not_stand, not_measured };

/// A claim over all settings.
struct JudgedClaim {
    const Claim* claim;
    ClaimVerdict verdict;      ///< stands where it holds at every setting measured
    std::size_t holds = 0;     ///< number of settings, of ours
    std::size_t settings = 0;  ///< that were measured
    std::size_t paper_holds = 0;
    std::size_t paper_settings = 0;  ///< of those settings the ones at which the paper's tables say
    std::string place;               ///< the setting that `numbers` are of
    std::string numbers;             ///< first setting where it fails; else first setting
};

/// All claims, each at every setting that has rows run as published.
std::vector<JudgedClaim> judge_claims(const PaperEvidence& evidence);

}  // namespace controlspace
