#pragma once

#include <memory>
#include <span>

#include "controlspace/geometry/box.h"
#include "controlspace/space/detail/goal_field.h"

namespace controlspace {

/// Evaluates the field of a goal in one box after another, on one thread: a copy for each.
class NearbyField {
public:
    explicit NearbyField(const GoalField& field);
    NearbyField(const NearbyField& other);
    ~NearbyField();
    NearbyField& operator=(const NearbyField&) = delete;

    /// Points of the following calls lie in this box: some tens of them, or only a few. Results do
    /// not depend on the boxes before.
    void enter(const Box& box, bool at_many_points);

    void evaluate(std::span<const Point> x, std::span<Metric> out);
    /// The same, or longer by a factor less than the one returned, where that is quicker.
    double evaluate_roughly(std::span<const Point> x, std::span<Metric> out);
    /// The same at any point, which best is near to the one before.
    Metric at(const Point& x);

    /// Bounds of the lengths in the box (GoalField::has_ranges).
    struct Range {
        double least, most;
    };
    Range range();

private:
    struct Search;
    std::unique_ptr<Search> search_;
};

}  // namespace controlspace
