// SPDX-License-Identifier: Apache-2.0
#include "baselines/openvdb/brick_codes.h"

#include <cmath>
#include <limits>
#include <type_traits>

namespace controlspace {

namespace {

// The last of some ascending numbers that is at most `x`, which the first one is.
std::size_t last_up_to(std::span<const double> ascending, double x) {
    return static_cast<std::size_t>(std::ranges::upper_bound(ascending, x) - ascending.begin() - 1);
}

bool is_length(double h) { return h > 0 && std::isfinite(h); }

std::vector<double> range_of(std::span<const Metric> metrics) {
    const auto [shortest, longest] = std::ranges::minmax(metrics, {}, &Metric::xx);
    return {shortest.xx, longest.xx};
}

double factor_between(double a, double b) { return std::max(a / b, b / a); }

}  // namespace

template <class M>
BrickCodes<M>::BrickCodes(std::span<const Metric> metrics) {
    if constexpr (!std::is_same_v<M, Metric>) StoredMetrics<M>{metrics};
}

template <class M>
void BrickCodes<M>::write(std::uint8_t /*kind*/, std::span<const Metric> vertices,
                          std::byte* brick) {
    for (const Metric& m : vertices) {
        const Item item(m);
        std::memcpy(brick, &item, sizeof item);
        brick += sizeof item;
    }
}

template <class M>
bool BrickCodes<M>::is_sound(std::uint8_t /*kind*/, const std::byte* brick, std::size_t vertices) {
    for (std::uint32_t i = 0; i < vertices; ++i) {
        const Metric m = at(brick, i);
        if (!is_length(m.xx + m.yy + m.zz) || !is_positive_definite(m)) return false;
    }
    return true;
}

// Of the first lengths, the largest factor with which the last is not beyond the longest.
LinearCodes::LinearCodes(double shortest, double longest, double allowed)
    : shortest_(shortest), longest_(longest), allowed_(allowed) {
    const auto fill = [&](double factor) {
        fine_[0] = 1;
        for (std::size_t i = 1; i < fine_steps; ++i) fine_[i] = fine_[i - 1] * factor;
        const double coarse = fine_.back() * factor;
        coarse_[0] = shortest;
        for (std::size_t i = 1; i < fine_steps; ++i) coarse_[i] = coarse_[i - 1] * coarse;
    };
    double low = 1, high = std::max(1.0, longest / shortest);
    for (double middle; middle = low + (high - low) / 2, low < middle && middle < high;) {
        fill(middle);
        (coarse_.back() <= longest ? low : high) = middle;
    }
    fill(low);
    // The largest share spans all lengths in 8 bits.
    constexpr double shares_ratio = 1.08;
    shares_.back() = (longest / shortest - 1) / 255;
    for (std::size_t i = shares - 1; i-- > 0;) shares_[i] = shares_[i + 1] / shares_ratio;
}

std::uint32_t LinearCodes::first_up_to(double h) const {
    const std::size_t part = last_up_to(coarse_, std::max(h, shortest_));
    const std::size_t fine = last_up_to(fine_, std::max(1.0, h / coarse_[part]));
    return static_cast<std::uint32_t>(part * fine_steps + fine);
}

double LinearCodes::encode(std::uint8_t kind, std::span<const Metric> vertices,
                           std::byte* brick) const {
    double rounding = 1;
    if (kind == floats) {
        for (std::size_t i = 0; i < vertices.size(); ++i) {
            const auto h = static_cast<float>(vertices[i].xx);
            std::memcpy(brick + header(kind) + i * sizeof h, &h, sizeof h);
        }
        return rounding;
    }
    const auto [least, most] = std::ranges::minmax(vertices, {}, &Metric::xx);
    const auto first = static_cast<std::uint16_t>(first_up_to(least.xx));
    std::memcpy(brick, &first, sizeof first);
    const double last_code = kind == bytes ? 255 : 255 * words_a_byte;
    const double base = coarse_[first / fine_steps] * fine_[first % fine_steps];
    const auto share = std::ranges::lower_bound(shares_, (most.xx / base - 1) / 255);
    brick[2] = static_cast<std::byte>(std::min<std::ptrdiff_t>(share - shares_.begin(), 255));
    const Scale scale = scale_of(kind, brick);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const double h = vertices[i].xx;
        const double exact = scale.scale > 0 ? (h - scale.base) / scale.scale : 0;
        // The larger of two lengths is the nearer one, as a factor, from their geometric mean on.
        double code = std::clamp(std::floor(exact), 0.0, last_code);
        const auto off = [&](double c) {
            return factor_between(scale.base + scale.scale * c, h);
        };
        if (code < last_code && off(code + 1) < off(code)) ++code;
        rounding = std::max(rounding, off(code));
        if (kind == bytes) {
            brick[header(kind) + i] = static_cast<std::byte>(code);
        } else {
            const auto word = static_cast<std::uint16_t>(code);
            std::memcpy(brick + header(kind) + i * sizeof word, &word, sizeof word);
        }
    }
    return rounding;
}

std::uint8_t LinearCodes::kind_of(std::span<const Metric> vertices) const {
    std::array<std::byte, 1024> brick;
    for (const std::uint8_t kind : {bytes, words}) {
        if (encode(kind, vertices, brick.data()) <= allowed_) return kind;
    }
    return floats;
}

void LinearCodes::write(std::uint8_t kind, std::span<const Metric> vertices,
                        std::byte* brick) const {
    encode(kind, vertices, brick);
}

bool LinearCodes::is_sound(std::uint8_t kind, const std::byte* brick, std::size_t vertices) const {
    if (kind == floats) {
        for (std::uint32_t i = 0; i < vertices; ++i) {
            if (!is_length(code<float>(brick, i))) return false;
        }
        return true;
    }
    std::uint16_t first;
    std::memcpy(&first, brick, sizeof first);
    return first / fine_steps < coarse_.size();
}

namespace {

double half_step(const std::vector<double>& range) {
    return rounding_of(Precision::log8, true, range[0], range[1]);
}
double half_step_of_words() { return std::sqrt(Packing<StoredLength<std::uint16_t>>::step); }

}  // namespace

BrickCodes<StoredLength<std::uint8_t>>::BrickCodes(std::span<const Metric> metrics)
    : BrickCodes(range_of(metrics)) {}
BrickCodes<StoredLength<std::uint8_t>>::BrickCodes(const std::vector<double>& range)
    : LinearCodes(range[0], range[1], half_step(range)) {}
BrickCodes<StoredLength<std::uint16_t>>::BrickCodes(std::span<const Metric> metrics)
    : BrickCodes(range_of(metrics)) {}
BrickCodes<StoredLength<std::uint16_t>>::BrickCodes(const std::vector<double>& range)
    : LinearCodes(range[0], range[1], half_step_of_words()) {}

template class BrickCodes<StoredMetric<float>>;
template class BrickCodes<Metric>;
template class BrickCodes<StoredLength<float>>;
template class BrickCodes<StoredLength<double>>;

}  // namespace controlspace
