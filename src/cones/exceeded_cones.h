// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "cones/quadric_tree.h"
#include "controlspace/geometry/point.h"

namespace controlspace {

/// Cones that an answer exceeds: the worst ones of different directions.
class Exceeded {
public:
    struct Cone {
        double growth;  ///< of squared lengths; a little too large where eigenvalues
                        ///< are equal
        std::uint32_t member;
        Vector direction = Vector::Zero();  ///< as seen from H
    };

    explicit Exceeded(double limit) : limit_(limit) {}

    /// What is exceeded by less is of no interest. It rises with the worst cone
    /// found.
    double limit() const { return limit_; }

    void enter(const Cone& cone) {
        constexpr double like = 0.75;
        // Of dense sources thousands may be nearly as bad: after a few, only worse ones enter.
        const double share = std::min(0.9 + 0.02 * entered_++, 1.0);
        limit_ = std::max(limit_, 1 + share * (cone.growth - 1));
        const auto end = cones_.begin() + static_cast<std::ptrdiff_t>(count_);
        auto place = std::find_if(cones_.begin(), end, [&](const Cone& other) {
            const double cosine = other.direction.dot(cone.direction);
            return cosine * cosine > like;
        });
        if (place == end && count_ < cones_.size()) {
            cones_[count_++] = cone;
            return;
        }
        if (place == end) place = std::min_element(cones_.begin(), end, is_less);
        if (is_less(*place, cone)) *place = cone;
    }
    std::span<const Cone> cones() const { return {cones_.data(), count_}; }
    double worst() const {
        double worst = 0;
        for (const Cone& cone : cones()) worst = std::max(worst, cone.growth);
        return worst;
    }
    bool empty() const { return count_ == 0; }

private:
    static bool is_less(const Cone& a, const Cone& b) {
        return a.growth < b.growth || (a.growth == b.growth && a.member > b.member);
    }

    double limit_;
    int entered_ = 0;
    std::array<Cone, 4> cones_{};
    std::size_t count_ = 0;
};

/// Enters the cones that H exceeds, below the node `root`, but not below the nodes `except`.
void find_exceeded(const QuadricTree& tree, std::uint32_t root,
                   std::span<const std::uint32_t> except, const Exceeding& exceeding,
                   Exceeded& exceeded);

/// All sources of a tree whose cones one factor or another exceeds.
class AllExceeded {
public:
    /// The tree must outlive it.
    explicit AllExceeded(const QuadricTree& tree);

    /// Adds those that H exceeds.
    void add(const Exceeding& exceeding);
    /// visit(index of the source) for all found.
    template <class Visit>
    void for_each(const Visit& visit) const {
        for (std::size_t k = 0; k < tree_.indices().size(); ++k) {
            if (is_found_[k] != 0) visit(tree_.indices()[k]);
        }
    }

private:
    bool add_below(std::uint32_t number, const Exceeding& exceeding);

    const QuadricTree& tree_;
    std::vector<std::uint8_t> is_found_;   // in the tree's order
    std::vector<std::uint8_t> are_found_;  // of nodes and leaves: all sources below
};

}  // namespace controlspace
