// SPDX-License-Identifier: Apache-2.0
#include "scenes/oracle.h"

#include <algorithm>
#include <cmath>

namespace controlspace {
namespace {

Real determinant(const Tensor& a) {
    return a[0] * (a[4] * a[8] - a[5] * a[7]) - a[1] * (a[3] * a[8] - a[5] * a[6]) +
           a[2] * (a[3] * a[7] - a[4] * a[6]);
}

Tensor inverse(const Tensor& a) {
    const Real d = determinant(a);
    return {(a[4] * a[8] - a[5] * a[7]) / d, (a[2] * a[7] - a[1] * a[8]) / d,
            (a[1] * a[5] - a[2] * a[4]) / d, (a[5] * a[6] - a[3] * a[8]) / d,
            (a[0] * a[8] - a[2] * a[6]) / d, (a[2] * a[3] - a[0] * a[5]) / d,
            (a[3] * a[7] - a[4] * a[6]) / d, (a[1] * a[6] - a[0] * a[7]) / d,
            (a[0] * a[4] - a[1] * a[3]) / d};
}

// L of a = L L^T.
Tensor cholesky(const Tensor& a) {
    Tensor l{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            Real sum = a[3 * i + j];
            for (std::size_t k = 0; k < j; ++k) sum -= l[3 * i + k] * l[3 * j + k];
            l[3 * i + j] = i == j ? std::sqrt(sum) : sum / l[3 * j + j];
        }
    }
    return l;
}

Tensor product(const Tensor& a, const Tensor& b) {
    Tensor c{};
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) {
            for (std::size_t k = 0; k < 3; ++k) c[3 * i + j] += a[3 * i + k] * b[3 * k + j];
        }
    }
    return c;
}

Tensor transposed(const Tensor& a) {
    return {a[0], a[3], a[6], a[1], a[4], a[7], a[2], a[5], a[8]};
}

struct Eigenframe {
    std::array<Real, 3> values;
    Tensor vectors;  // in columns
};

// Of a symmetric matrix, by Jacobi's rotations.
Eigenframe eigenframe(Tensor a) {
    Tensor vectors{1, 0, 0, 0, 1, 0, 0, 0, 1};
    for (int sweep = 0; sweep < 40; ++sweep) {
        const Real rest = std::abs(a[1]) + std::abs(a[2]) + std::abs(a[5]);
        if (rest <= 1e-21L * (std::abs(a[0]) + std::abs(a[4]) + std::abs(a[8]))) break;
        for (std::size_t p = 0; p < 2; ++p) {
            for (std::size_t q = p + 1; q < 3; ++q) {
                if (a[3 * p + q] == 0) continue;
                const Real angle = std::atan2(2 * a[3 * p + q], a[4 * q] - a[4 * p]) / 2;
                Tensor r{1, 0, 0, 0, 1, 0, 0, 0, 1};
                r[4 * p] = r[4 * q] = std::cos(angle);
                r[3 * p + q] = std::sin(angle);
                r[3 * q + p] = -std::sin(angle);
                a = product(transposed(r), product(a, r));
                vectors = product(vectors, r);
            }
        }
    }
    return {{a[0], a[4], a[8]}, vectors};
}

// As of both: A^2 -> L Q min(D, 1) Q^T L^T, where B^2 = L L^T and L^-1 A^2 L^-T = Q D Q^T.
Tensor cut_square(const Tensor& square, const Tensor& by) {
    const Tensor l = cholesky(product(by, by));
    const Tensor to_unit = inverse(l);
    const auto [values, q] = eigenframe(product(to_unit, product(square, transposed(to_unit))));
    Tensor shortened{};
    for (std::size_t i = 0; i < 3; ++i) shortened[4 * i] = std::min(values[i], Real{1});
    const Tensor lq = product(l, q);
    return product(lq, product(shortened, transposed(lq)));
}

}  // namespace

Tensor tensor(const Metric& m) { return {m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz}; }

bool oracle_is_positive_definite(const Metric& m) {
    const Tensor a = tensor(m);
    return a[0] > 0 && a[0] * a[4] - a[1] * a[3] > 0 && determinant(a) > 0;
}

Real oracle_factor(const PointSource& source, double g, const Point& p) {
    const Tensor m = inverse(tensor(source.metric));
    std::array<Real, 3> v{};
    for (int a = 0; a < 3; ++a) {
        v[static_cast<std::size_t>(a)] = static_cast<Real>(p[a]) - source.position[a];
    }
    Real sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Real w = m[3 * i] * v[0] + m[3 * i + 1] * v[1] + m[3 * i + 2] * v[2];
        sum += w * w;
    }
    return 1 + ((source.growth != 0 ? source.growth : g) - Real{1}) * std::sqrt(sum);
}

Real oracle_excess(const Metric& m, const Metric& limit) {
    const Tensor to_unit = inverse(cholesky(tensor(limit)));
    return std::ranges::max(
        eigenframe(product(to_unit, product(tensor(m), transposed(to_unit)))).values);
}

Real oracle_log_volume(const Metric& m) { return std::log(determinant(tensor(m))); }

Real oracle_log_volume_in_turn(std::span<const PointSource> sources, double g,
                               const Metric& largest, const Point& p) {
    const auto in_turn = [&](auto first, auto last) {
        Tensor square = product(tensor(largest), tensor(largest));
        for (; first != last; ++first) {
            Tensor cone = tensor(first->metric);
            for (Real& entry : cone) entry *= oracle_factor(*first, g, p);
            square = cut_square(square, cone);
        }
        return std::log(determinant(square)) / 2;
    };
    return std::max(in_turn(sources.begin(), sources.end()),
                    in_turn(sources.rbegin(), sources.rend()));
}

Real oracle_length(std::span<const PointSource> sources, double g, double largest, const Point& p) {
    Real least = largest;
    for (const PointSource& source : sources) {
        least = std::min(least, source.metric.xx * oracle_factor(source, g, p));
    }
    return least;
}

}  // namespace controlspace
