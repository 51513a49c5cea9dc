#pragma once

#include <span>

#include "cones/nearby_cones.h"
#include "controlspace/geometry/box.h"
#include "space/goal_field.h"

namespace controlspace {

/// The field of a goal in one box after another, for one thread.
class NearbyField {
public:
    explicit NearbyField(const GoalField& field) : field_(field) {}

    /// From now on all is asked in this box, at some tens of places or only a few. Answers do not
    /// depend on the boxes before.
    void enter(const Box& box, bool at_many_places) {
        box_ = box;
        memory_.hint = 0;
        is_gathered_ = !at_many_places;
        are_few_ = false;
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
        is_gathered_ = true;
        are_few_ = field_.cones().gather(box_, gathered_, memory_);
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
