// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <random>

namespace controlspace {

/// Numbers drawn uniformly from [0, 1); the same for the same seed on every machine, which the
/// standard promises of its engines but not of its distributions.
class RandomFractions {
public:
    explicit RandomFractions(std::uint64_t seed) : engine_(seed) {}

    /// A multiple of 2^-53.
    double operator()() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

private:
    std::mt19937_64 engine_;
};

}  // namespace controlspace
