// SPDX-License-Identifier: Apache-2.0
#include "baselines/openvdb/brick_codes.h"

#include <cmath>
#include <limits>
#include <type_traits>

namespace controlspace {

namespace {

// The last of some ascending numbers that is at most `x`, which the first one is.
std::size_t last_up_to(std::span<const float> ascending, double x) {
    return static_cast<std::size_t>(std::ranges::upper_bound(ascending, x) - ascending.begin() - 1);
}

bool is_length(double h) { return h > 0 && std::isfinite(h); }

// Throws InputError where floats do not hold the lengths.
std::vector<double> range_of(std::span<const Metric> metrics) {
    const auto [shortest, longest] = std::ranges::minmax(metrics, {}, &Metric::xx);
    const std::array ends{shortest, longest};
    [[maybe_unused]] const StoredMetrics<StoredLength<std::uint8_t>> held(ends);
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
        double fine = 1, coarse = shortest, ratio = 1;
        for (float& power : fine_) {
            power = static_cast<float>(fine);
            fine *= factor;
        }
        ratio = fine;
        for (float& length : coarse_) {
            length = static_cast<float>(coarse);
            coarse *= ratio;
        }
        return coarse;
    };
    double low = 1, high = std::max(1.0, longest / shortest);
    for (double middle; middle = low + (high - low) / 2, low < middle && middle < high;) {
        (fill(middle) <= longest ? low : high) = middle;
    }
    fill(low);
    // None is longer than the lengths that are to begin with it.
    for (float& length : coarse_) length = std::nextafter(length, 0.0F);
    // The largest share spans all lengths in 8 bits.
    double share = (longest / double{coarse_.front()} - 1) / 255 / fine_shares.back();
    for (std::size_t i = shares_.size(); i-- > 0; share /= 2) shares_[i] = share;
}

std::uint16_t LinearCodes::first_up_to(double h) const {
    const std::size_t part = last_up_to(coarse_, std::max<double>(h, coarse_.front()));
    std::size_t first = part * fine_steps + last_up_to(fine_, std::max(1.0, h / coarse_[part]));
    // The product of two floats may be longer by rounding.
    while (first > 0 && first_length(first) > h) --first;
    return static_cast<std::uint16_t>(first);
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
    const std::uint16_t first = first_up_to(least.xx);
    std::memcpy(brick, &first, sizeof first);
    const double last_code = kind == bytes ? 255 : 65535;
    const double needed = (most.xx / first_length(first) - 1) / 255;
    std::size_t share = 0;
    while (share + 1 < shares && share_of(share) < needed) ++share;
    brick[2] = static_cast<std::byte>(share);
    const Scale scale = scale_of(kind, brick);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const double h = vertices[i].xx;
        const double exact = scale.scale > 0 ? (h - scale.base) / scale.scale : 0;
        // The larger of two lengths is the nearer one, as a factor, from their geometric mean on.
        double code = std::clamp(std::floor(exact), 0.0, last_code);
        const auto off = [&](double c) { return factor_between(scale.base + scale.scale * c, h); };
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

bool LinearCodes::is_sound(std::uint8_t kind, const std::byte* brick, std::size_t vertices) {
    if (kind != floats) return true;
    for (std::uint32_t i = 0; i < vertices; ++i) {
        if (!is_length(at<float>(brick, i))) return false;
    }
    return true;
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
