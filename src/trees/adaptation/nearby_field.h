// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "controlspace/geometry/box.h"
#include "controlspace/trees/cell_model.h"
#include "space/goal_field.h"

namespace controlspace {

/// Evaluates the field of a goal in one box after another, on one thread: a copy for each.
///
/// `enter` has to be called before anything is evaluated. A copy has not entered a box, whatever
/// the original has: what is gathered in a box belongs to one object.
class NearbyField {
public:
    explicit NearbyField(const GoalField& field);
    NearbyField(const NearbyField& other);
    ~NearbyField();
    NearbyField& operator=(const NearbyField&) = delete;

    /// Points of the following calls lie in this box: some tens of them, or only a few. Results do
    /// not depend on the boxes before.
    void enter(const Box& box, bool at_many_points);

    /// Tensors without an order: to a hundredth of the target.
    void evaluate(std::span<const Point> x, std::span<Metric> out);
    /// By which cones, where that takes long: all, once for places that are `shared` by leaves;
    /// all; or, of more than few tensors without an order, mostly those that are `close` to the
    /// ones which matter nearby. Others may shorten the field: where all are asked, which is at one
    /// of some places, and do so, all are at the next places too.
    enum class Cones { shared, all, close };
    /// How near a quick evaluation is to the field.
    struct Accuracy {
        enum class Kind {
            exact,           ///< as `evaluate`
            at_most_longer,  ///< the field, or longer by less than `factor`
            estimate         ///< off by a tenth of the target: of more than few tensors without an
                             ///< order
        };
        Kind kind = Kind::exact;
        double factor = 1;
    };
    /// The same where that is quick; otherwise what is quicker.
    Accuracy evaluate_roughly(std::span<const Point> x, Cones cones, std::span<Metric> out);
    /// The same at one place, exactly, and the sources that make it so (ConeField::governing). In
    /// turn and of isotropic sources, without the continuous field.
    Metric governed(const Point& x, double tolerance, std::vector<std::uint32_t>& sources);
    /// The same, exactly, at any point, shared, which best is near to the one before.
    Metric at(const Point& x);

    /// Compares lengths that are trilinear in the box with the field (GoalField::has_ranges): a
    /// place where they are beyond the target; one where they could not be shown to be within it,
    /// which is not certain to be beyond; or nothing, if they are within it everywhere.
    struct Doubt {
        Point where;
        bool is_certain;
    };
    std::optional<Doubt> doubt_of(const std::array<double, 8>& at_corners);

    /// Bounds of the lengths in the box (GoalField::has_ranges).
    struct Range {
        double least, most;
    };
    Range range();

private:
    friend void evaluate_shared(const GoalField&, std::span<const CellBox>, std::size_t,
                                std::size_t);
    struct Search;
    std::unique_ptr<Search> search_;
};

/// Where the field takes long: evaluates it at places `from` to `to - 1` of leaves (LeafPlaces),
/// each place once and on behalf of one leaf, starting from what is known in that leaf. On all of
/// TBB's threads; the answers do not depend on their number.
void evaluate_shared(const GoalField& field, std::span<const CellBox> cells, std::size_t from,
                     std::size_t to);

}  // namespace controlspace
