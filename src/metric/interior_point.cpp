// SPDX-License-Identifier: Apache-2.0
#include "metric/interior_point.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "unrolled.h"

namespace controlspace {

// The method
// ----------
// Seen from H, with Z = I at the present Y: maximise log det Z under Z <= B_k = P_k^-1. Z and
// L_k >= 0 are optimal if sum L_k = Z^-1 and L_k (B_k - Z) = 0 (Boyd & Vandenberghe, Convex
// Optimization, section 8.4). For any L_k >= 0 no log det exceeds
//     -log det(sum L_k) + sum tr(L_k B_k) - 3,
// which is the duality gap, log det Z being 0. With the slack's inverse
//     S_k = (B_k - I)^-1 = (I - P_k)^-1 - I,
// a step aims at L_k (B_k - Z) = mu I, linearised and symmetrised (the direction of Helmberg,
// Rendl, Vanderbei & Wolkowicz, Kojima, Shindoh & Hara, and Monteiro):
//     D + sum sym(L_k D S_k) = I - mu sum S_k,
//     L_k changes by mu S_k - L_k + sym(L_k D S_k),
// and goes as far as B_k - Z and L_k stay positive definite. Then all tensors are looked at from
// the new Y: H F, with F F^T = Z.
//
// P_k may be singular but for rounding, where a constraint is far off, so B_k never appears. The
// gap is that of the multipliers c P_k L_k P_k in place of L_k, to first order the same: since
// tr(P_k L_k P_k B_k) = tr(P_k L_k), rounding of L_k where B_k is large counts for nothing. The
// best c makes it 3 log(sum tr(P_k L_k) / 3) - log det(sum P_k L_k P_k). On the central path
// L_k = mu S_k, so that mu = sum tr(L_k - P_k L_k) / sum tr(P_k).

namespace {

using Numbers = ConstraintNumbers;
using Factorisation = CholeskyLanes<constraint_lanes>;

// The six entries of a symmetric tensor are xx, yy, zz, xy, xz, yz.
constexpr int entries = 6;
constexpr int row[entries] = {0, 1, 2, 0, 0, 1};
constexpr int column[entries] = {0, 1, 2, 1, 2, 2};
constexpr int index(int i, int j) { return i == j ? i : i + j + 2; }

template <int e, class SymmetricTensor>
const auto& entry(const SymmetricTensor& t) {
    static_assert(e >= 0 && e < entries);
    if constexpr (e == 0) return t.xx;
    if constexpr (e == 1) return t.yy;
    if constexpr (e == 2) return t.zz;
    if constexpr (e == 3) return t.xy;
    if constexpr (e == 4) return t.xz;
    if constexpr (e == 5) return t.yz;
}

// (I - P)^-1 - I. Not by cofactors: with two small slacks they lose the determinant.
ConstraintLanes slack_inverse(const ConstraintLanes& p) {
    ConstraintLanes s =
        Factorisation({1 - p.xx, 1 - p.yy, 1 - p.zz, -p.xy, -p.xz, -p.yz}).inverse();
    s.xx -= 1;
    s.yy -= 1;
    s.zz -= 1;
    return s;
}

double greatest_eigenvalue(const Metric& t) {
    ConstraintLanes lanes;
    lanes.set(0, t);
    return greatest_eigenvalues(lanes)[0];
}

// Solves the symmetric positive definite system whose lower triangle is given.
using System = std::array<std::array<double, entries>, entries>;
Metric solve(System& a, std::array<double, entries> b) {
    std::array<double, entries> inverse_pivots{};
    for (std::size_t j = 0; j < entries; ++j) {
        inverse_pivots[j] = 1 / a[j][j];
        for (std::size_t i = j + 1; i < entries; ++i) {
            const double l = a[i][j] * inverse_pivots[j];
            for (std::size_t k = j + 1; k <= i; ++k) a[i][k] -= l * a[k][j];
            b[i] -= l * b[j];
        }
    }
    for (std::size_t j = entries; j-- > 0;) {
        b[j] *= inverse_pivots[j];
        for (std::size_t i = 0; i < j; ++i) b[i] -= a[j][i] * b[j];
    }
    return {b[0], b[1], b[2], b[3], b[4], b[5]};
}

// The D of I + mu (...) above: D + sum sym(L_k D S_k) = right_hand_side, times the basis
// e_i e_j^T + e_j e_i^T on both sides.
Metric direction(std::span<const ConstraintLanes> s, std::span<const ConstraintLanes> l,
                 const Metric& right_hand_side) {
    System system;
    unrolled<entries>([&](auto first) {
        unrolled<first + 1>([&](auto second) {
            constexpr int i = row[first];
            constexpr int j = column[first];
            constexpr int k = row[second];
            constexpr int m = column[second];
            Numbers total = Numbers::Zero();
            for (std::size_t g = 0; g < s.size(); ++g) {
                const auto both = [&](auto a, auto b) {
                    return entry<a>(l[g]) * entry<b>(s[g]) + entry<a>(s[g]) * entry<b>(l[g]);
                };
                using std::integral_constant;
                constexpr integral_constant<int, index(i, k)> ik;
                constexpr integral_constant<int, index(j, m)> jm;
                constexpr integral_constant<int, index(i, m)> im;
                constexpr integral_constant<int, index(j, k)> jk;
                if constexpr (i == j && k == m) {
                    total += entry<ik>(l[g]) * entry<ik>(s[g]);
                } else if constexpr (i == j || k == m) {
                    total += both(ik, jm);
                } else {
                    total += both(ik, jm) + both(im, jk);
                }
            }
            system[first][second] = sum(total);
        });
        system[first][first] += first < 3 ? 1 : 2;
    });
    const Metric& r = right_hand_side;
    return solve(system, {r.xx, r.yy, r.zz, 2 * r.xy, 2 * r.xz, 2 * r.yz});
}

// Whether all L + t dL are positive definite, but for rounding.
bool are_positive(std::span<const ConstraintLanes> l, double t,
                  std::span<const ConstraintLanes> change) {
    constexpr double rounding = 1e-13;
    for (std::size_t g = 0; g < l.size(); ++g) {
        const ConstraintLanes& a = l[g];
        const ConstraintLanes& b = change[g];
        const Factorisation factorisation({a.xx + t * b.xx + rounding, a.yy + t * b.yy + rounding,
                                           a.zz + t * b.zz + rounding, a.xy + t * b.xy,
                                           a.xz + t * b.xz, a.yz + t * b.yz});
        if (!(factorisation.least_pivot() > 0).all()) return false;
    }
    return true;
}

}  // namespace

InteriorPoint::InteriorPoint(std::span<const Metric> metrics, const Eigen::Matrix3d* near)
    : size_(metrics.size()), groups_((metrics.size() + constraint_lanes - 1) / constraint_lanes) {
    set_constraints(metrics, near);
    // From nothing, well inside; otherwise as far inside as the constraints were missed by.
    const double greatest = greatest_eigenvalue();
    const double room_left = near == nullptr ? 0.2 : std::clamp(std::abs(greatest - 1), 1e-6, 0.5);
    scale((1 - room_left) / greatest);
    set_multipliers();
    measure();
}

void InteriorPoint::set_constraints(std::span<const Metric> metrics, const Eigen::Matrix3d* near) {
    Groups lanes;
    for (std::size_t k = 0; k < size_; ++k) {
        lanes[k / constraint_lanes].set(static_cast<Eigen::Index>(k % constraint_lanes),
                                        metrics[k]);
    }
    const auto look_from = [&](const Eigen::Matrix3d& h) {
        factor_ = h;
        for (std::size_t g = 0; g < groups_; ++g) {
            constraints_[g] = controlspace::seen_from(h, Factorisation(lanes[g]));
        }
        constexpr Metric none{0, 0, 0, 0, 0, 0};
        for (std::size_t k = size_; k < groups_ * constraint_lanes; ++k) {
            constraints_[k / constraint_lanes].set(static_cast<Eigen::Index>(k % constraint_lanes),
                                                   none);
        }
    };
    if (near != nullptr) return look_from(*near);
    look_from(Eigen::Matrix3d::Identity());
    const Eigen::LLT<Eigen::Matrix3d> inverses(sum(used(constraints_)).matrix());
    look_from(inverses.matrixU().solve(Eigen::Matrix3d::Identity()));
}

double InteriorPoint::greatest_eigenvalue() const {
    Numbers greatest = Numbers::Zero();
    for (const ConstraintLanes& p : used(constraints_)) {
        greatest = greatest.max(greatest_eigenvalues(p));
    }
    return greatest.maxCoeff();
}

void InteriorPoint::scale(double factor) {
    factor_ *= std::sqrt(factor);
    for (std::size_t g = 0; g < groups_; ++g) constraints_[g] = scaled(constraints_[g], factor);
}

// mu S_k, such that they sum to I as nearly as they can.
void InteriorPoint::set_multipliers() {
    for (std::size_t g = 0; g < groups_; ++g) multipliers_[g] = slack_inverse(constraints_[g]);
    const double mu = 3 / trace(sum(used(multipliers_)));
    for (std::size_t g = 0; g < groups_; ++g) multipliers_[g] = scaled(multipliers_[g], mu);
}

void InteriorPoint::measure() {
    double traces = 0;
    for (std::size_t g = 0; g < groups_; ++g) {
        const Matrices w = product(constraints_[g], multipliers_[g]);
        traces += sum(w.xx + w.yy + w.zz);
        certificate_[g] = symmetric_product(w, constraints_[g]);
    }
    const double slackness = trace(sum(used(multipliers_))) - traces;
    mu_ = slackness / trace(sum(used(constraints_)));
    certificate_scale_ = 3 / traces;
    gap_ = -3 * std::log(certificate_scale_) -
           std::log(sum(used(certificate_)).matrix().determinant());
}

void InteriorPoint::solve(double tolerance) {
    constexpr int most_steps = 60;
    double centring = 0.1;
    while (gap_ > tolerance && steps_ < most_steps) {
        const double reached = advance(centring);
        centring = reached > 0.9 ? 0.02 : reached > 0.5 ? 0.1 : 0.5;
        ++steps_;
    }
}

// One step towards `centring` times the present mu. Returns the fraction that was possible.
double InteriorPoint::advance(double centring) {
    Groups s;
    for (std::size_t g = 0; g < groups_; ++g) s[g] = slack_inverse(constraints_[g]);
    const Metric of_slacks = sum(used(s));
    const double mu = centring * mu_;
    const Metric d = direction(used(s), used(multipliers_),
                               {1 - mu * of_slacks.xx, 1 - mu * of_slacks.yy, 1 - mu * of_slacks.zz,
                                -mu * of_slacks.xy, -mu * of_slacks.xz, -mu * of_slacks.yz});
    Numbers greatest = Numbers::Constant(controlspace::greatest_eigenvalue(-1 * d));
    Groups change;
    for (std::size_t g = 0; g < groups_; ++g) {
        const Matrices w = product(s[g], d);
        greatest = greatest.max(greatest_eigenvalues(w));
        const ConstraintLanes& l = multipliers_[g];
        const ConstraintLanes second = symmetric_product(w, l);
        change[g] = {mu * s[g].xx - l.xx + second.xx, mu * s[g].yy - l.yy + second.yy,
                     mu * s[g].zz - l.zz + second.zz, mu * s[g].xy - l.xy + second.xy,
                     mu * s[g].xz - l.xz + second.xz, mu * s[g].yz - l.yz + second.yz};
    }
    // Never all the way to the boundary.
    constexpr double most = 0.97;
    const double way = greatest.maxCoeff();
    const double primal = way > most ? most / way : 1;
    double dual = most;
    constexpr double certain = 0.99;
    constexpr double least = 1e-3;
    while (dual > least && !are_positive(used(multipliers_), dual / certain, used(change))) {
        dual *= 0.9;
    }
    const Triangle f(d, primal);
    factor_ = (factor_ * f.matrix()).eval();
    for (std::size_t g = 0; g < groups_; ++g) {
        constraints_[g] = seen_from(f, constraints_[g]);
        const ConstraintLanes& l = multipliers_[g];
        const ConstraintLanes& c = change[g];
        multipliers_[g] =
            seen_from(f, {l.xx + dual * c.xx, l.yy + dual * c.yy, l.zz + dual * c.zz,
                          l.xy + dual * c.xy, l.xz + dual * c.xz, l.yz + dual * c.yz});
    }
    measure();
    return std::min(primal, dual);
}

// Of more than six tensors some combination is 0. Adding it to their sum until the first weight is
// 0 leaves the sum, and so the certificate, as it is, with one tensor less.
std::uint32_t needed_multipliers(std::span<const Metric> tensors) {
    constexpr int room = static_cast<int>(InteriorPoint::room);
    using Columns = Eigen::Matrix<double, entries, Eigen::Dynamic, Eigen::ColMajor, entries, room>;
    std::array<int, InteriorPoint::room> left{};
    int count = 0;
    for (; count < static_cast<int>(tensors.size()); ++count) {
        left[static_cast<std::size_t>(count)] = count;
    }
    Columns columns(entries, count);
    for (int k = 0; k < count; ++k) {
        const Metric& l = tensors[static_cast<std::size_t>(k)];
        columns.col(k) << l.xx, l.yy, l.zz, l.xy, l.xz, l.yz;
    }
    for (; count > entries; --count) {
        // Zeros fill it up: its greatest coefficient is positive.
        Eigen::Matrix<double, room, 1> change = Eigen::Matrix<double, room, 1>::Zero();
        change.head(count) = columns.fullPivLu().kernel().col(0);
        if (change.maxCoeff() <= 0) change = -change;
        Eigen::Index last = 0;
        const double most = change.maxCoeff(&last);
        for (int k = 0; k < count; ++k) columns.col(k) *= 1 - change[k] / most;
        for (auto k = static_cast<int>(last); k + 1 < count; ++k) {
            left[static_cast<std::size_t>(k)] = left[static_cast<std::size_t>(k) + 1];
            columns.col(k) = columns.col(k + 1);
        }
        columns.conservativeResize(Eigen::NoChange, count - 1);
    }
    std::uint32_t needed = 0;
    for (int k = 0; k < count; ++k) needed |= 1u << left[static_cast<std::size_t>(k)];
    return needed;
}

}  // namespace controlspace
