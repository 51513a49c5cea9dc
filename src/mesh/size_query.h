// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <mutex>

#include "controlspace/geometry/box.h"
#include "controlspace/space/control_space.h"

namespace controlspace {

/// A domain moved to the origin and scaled to a longest edge of 1: tolerances of meshers are
/// absolute.
struct UnitFrame {
    explicit UnitFrame(const Box& box) : domain(box), scale(box.edges().maxCoeff()) {}

    /// Edges of the domain in the frame.
    Vector edges() const { return domain.edges() / scale; }
    /// The place that is (x, y, z) in the frame; in the domain for all places in the frame's box.
    Point to_domain(double x, double y, double z) const {
        const Point p = domain.low + scale * Vector(x, y, z);
        return nearest_in(domain, p);
    }

    Point from_domain(const Point& p) const { return (p - domain.low) / scale; }

    Box domain;
    double scale;
};

/// Whether lengths, in ascending order, differ by more than the rounding that blending leaves in
/// isotropic metrics, and enough to matter to a mesh.
inline bool lengths_differ(const std::array<double, 3>& lengths) {
    return lengths[2] > 1.01 * lengths[0];
}

/// Throws InputError unless `m`, a field's answer at `p`, is positive definite.
void require_metric(const Metric& m, const Point& p);

/// The size function of a mesher, in a frame: the smallest length that a field requests at a place,
/// times a factor. Several threads may call it, and it never throws, as meshers do not expect that:
/// the first exception, that of the field or InputError where the field is not positive definite,
/// is kept for later. From then on all sizes are large, so that the mesher is done soon.
class SizeQuery {
public:
    /// The field must outlive this.
    SizeQuery(const ControlSpace& field, const UnitFrame& frame, double factor);

    double operator()(double x, double y, double z) noexcept;

    /// Throws the exception that was kept, if there is one.
    void rethrow_failure() const;

    std::size_t count() const { return count_; }
    /// Time spent in the field, of all threads together, from a sample of the queries.
    double seconds() const { return 1e-9 * static_cast<double>(nanoseconds_); }
    /// Whether lengths differed by direction somewhere.
    bool anisotropic() const { return anisotropic_; }

private:
    double scaled_length(double x, double y, double z) noexcept;
    double smallest_length(const Point& p);

    const ThreadCursor field_;
    const UnitFrame frame_;
    const double factor_;
    const std::int64_t clock_cost_;
    std::atomic<std::size_t> count_ = 0;
    std::atomic<std::int64_t> nanoseconds_ = 0;
    std::atomic<bool> anisotropic_ = false;
    std::atomic<bool> failed_ = false;
    std::mutex mutex_;
    std::exception_ptr failure_;
};

}  // namespace controlspace
