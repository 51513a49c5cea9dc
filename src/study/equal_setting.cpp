// SPDX-License-Identifier: Apache-2.0
#include "study/equal_setting.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "controlspace/error.h"

namespace controlspace {
namespace {

constexpr double mb = 1e6;

/// The requested δ_R or memory, in the measures of a trial.
struct Goal {
    bool in_delta;
    double value;

    explicit Goal(const Case& c)
        : in_delta(c.equal_delta.has_value()),
          value(in_delta ? *c.equal_delta : *c.equal_memory * mb) {}
    double aimed(const Trial& t) const { return in_delta ? t.delta : t.bytes; }
    bool is_kept(const Trial& t) const { return aimed(t) <= value; }
    /// Voxels as fine as the goal requires, or finer than it allows.
    bool is_passed(const Trial& t) const { return is_kept(t) == in_delta; }
    bool is_better(const Trial& a, const Trial& b) const {
        if (is_kept(a) != is_kept(b)) return is_kept(a);
        if (!is_kept(a)) return aimed(a) < aimed(b);
        return in_delta ? a.bytes < b.bytes : a.bytes > b.bytes;
    }
};

/// All trials of one case, whose voxels alone vary, and the error that ended them.
struct Trials {
    std::vector<EqualSetting> tried;
    std::string refusal;
};

/// Voxels of `too_many_bytes` end the search.
Trials halve_and_bisect(const Case& c, const Goal& goal, double coarsest, double too_many_bytes,
                        const std::function<Trial(const Case&)>& attempt) {
    constexpr int most_halvings = 16;
    constexpr int bisections = 5;
    Trials trials;
    auto& tried = trials.tried;
    // Whether voxels of this length pass the goal, or exceed the memory.
    const auto is_passed = [&](double length) {
        Case setting = c;
        setting.voxel = length;
        try {
            tried.push_back({setting, attempt(setting)});
        } catch (const InputError& error) {
            if (tried.empty()) throw;
            trials.refusal = error.what();
            return true;
        }
        const Trial& trial = tried.back().trial;
        return goal.is_passed(trial) || trial.bytes >= too_many_bytes;
    };
    const auto is_same_as_before = [&] {
        const double now = goal.aimed(tried.back().trial);
        const double before = goal.aimed(tried[tried.size() - 2].trial);
        return std::max(now, before) < 1.05 * std::min(now, before);
    };
    double fine = coarsest;
    std::optional<double> coarse;  // not passed yet
    int in_vain = 0;
    for (int i = 0; !is_passed(fine); ++i, fine /= 2) {
        in_vain = coarse && is_same_as_before() ? in_vain + 1 : 0;
        if (i == most_halvings || in_vain == 2) return trials;
        coarse = fine;
    }
    for (int i = 0; coarse && i < bisections; ++i) {
        const double middle = std::sqrt(*coarse * fine);
        (is_passed(middle) ? fine : *coarse) = middle;
    }
    return trials;
}

std::string shortfall(const Goal& goal, const Trial& trial, const std::string& refusal) {
    std::string text =
        goal.in_delta ? fmt::format("delta_R of {:.4g} is out of reach: the smallest is {:.4g}",
                                    goal.value, trial.delta)
                      : fmt::format("no such grid fits into {:.4g} MB: the smallest has {:.4g} MB",
                                    goal.value / mb, trial.bytes / mb);
    if (!refusal.empty()) text += fmt::format(" ({})", refusal);
    return text;
}

}  // namespace

EqualSetting find_equal_setting(const Case& c, const CatalogueEntry& entry, double longest_edge,
                                const std::function<Trial(const Case&)>& attempt) {
    const Goal goal(c);
    std::optional<EqualSetting> best;
    std::string refusal;
    const auto search = [&](const Case& variant, double coarsest, double too_many_bytes) {
        Trials trials = halve_and_bisect(variant, goal, coarsest, too_many_bytes, attempt);
        refusal = trials.refusal;
        for (EqualSetting& found : trials.tried) {
            if (!best || goal.is_better(found.trial, best->trial)) best = std::move(found);
        }
    };
    search(c, longest_edge / 4, std::numeric_limits<double>::infinity());
    if (goal.in_delta && goal.is_kept(best->trial) && entry.has<Pruning>() && !c.prune_delta) {
        // Pruned voxels err more, as a rule: hardly larger ones will do, and must save memory.
        Case pruned = c;
        pruned.prune_delta = 0.5 * goal.value;
        search(pruned, 2 * *best->setting.voxel, best->trial.bytes);
    }
    if (!goal.is_kept(best->trial)) best->shortfall = shortfall(goal, best->trial, refusal);
    return *best;
}

}  // namespace controlspace
