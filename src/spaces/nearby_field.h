#pragma once

#include <optional>
#include <span>

#include "cones/nearby_cones.h"
#include "geometry/box.h"
#include "spaces/goal_field.h"

namespace controlspace {

/// The field of a goal in one box after another, for one thread: quick where each is near to the
/// one before.
class NearbyField {
public:
    explicit NearbyField(const GoalField& field) : field_(field) {}

    /// From now on all is asked in this box.
    void enter(const Box& box) {
        box_ = box;
        is_gathered_ = false;
    }

    void evaluate(std::span<const Point> x, std::span<Metric> out) {
        if (!is_gathered_) gather();
        if (are_few_) {
            field_.evaluate_here(x, out, cones_);
        } else {
            field_.evaluate_here(x, out, memory_);
        }
    }

    /// As GoalField has it.
    double evaluate_roughly(std::span<const Point> x, std::span<Metric> out) {
        if (!is_gathered_) gather();
        if (!are_few_) return field_.evaluate_roughly(x, out, memory_);
        field_.evaluate_here(x, out, cones_);
        return 1;
    }

    /// Bounds in the box; see GoalField.
    IsotropicCones::Range range() { return field_.range_in(box_, memory_); }

private:
    void gather() {
        // Where more cones come into question, a search among all is as quick.
        constexpr std::size_t most_cones = 256;
        is_gathered_ = true;
        are_few_ = field_.cones().gather(box_, most_cones, gathered_, memory_);
        if (are_few_) cones_.narrow(gathered_, box_);
    }

    const GoalField& field_;
    Box box_;
    ConeField::Memory memory_;
    NearbyCones gathered_, cones_;
    bool is_gathered_ = false;
    bool are_few_ = false;
};

}  // namespace controlspace
