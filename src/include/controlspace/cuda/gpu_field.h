// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "controlspace/geometry/point.h"
#include "controlspace/metric/metric.h"
#include "controlspace/metric/stored_metric.h"
#include "controlspace/space/control_space.h"

struct CUstream_st;  // cudaStream_t is a pointer to it

namespace controlspace {

/// A copy of an octree in the memory of a GPU, which answers there. With doubles, answers are those
/// of the octree to the bit; with floats, those of its compact form in floats. Lengths of a compact
/// form in codes are rounded to floats.
class GpuField {
public:
    /// `field`: K_oL, K_oLB or K_oV, compact or not, to be copied to CUDA's current device. Throws
    /// InputError for another structure, for codes, and where no device is there or its memory is
    /// too small.
    explicit GpuField(const ControlSpace& field, Precision precision = Precision::floats);
    ~GpuField();
    GpuField(GpuField&&) noexcept;
    GpuField& operator=(GpuField&&) noexcept;

    /// Whether all metrics are isotropic: then values are lengths, one number each; else they are
    /// the six numbers xx, yy, zz, xy, xz, yz of metrics.
    bool answers_lengths() const;

    /// Starts the answers at `count` places and returns; `x` and `out` are in the device's memory:
    /// x, y, z of each place, and the numbers of each value. Throws InputError where it cannot be
    /// started.
    void start(const double* x, std::size_t count, double* out, CUstream_st* stream) const;

    /// The same from and to the program's memory, done when it returns.
    void sample(std::span<const Point> x, std::span<Metric> out) const;
    /// Throws InputError unless answers_lengths().
    void sample_lengths(std::span<const Point> x, std::span<double> out) const;

private:
    void answer(std::span<const Point> x, void* out) const;

    struct Copy;
    std::unique_ptr<Copy> copy_;
};

}  // namespace controlspace
