// SPDX-License-Identifier: Apache-2.0
#include "controlspace/sources/sampled_surfaces.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "refuse.h"

namespace controlspace {

namespace {

void require_few(double samples, double h, double rho) {
    if (!(samples <= most_samples)) {
        refuse("h = {} and rho = {} make {:.2g} sources, more than {:.0g}: give a larger rho", h,
               rho, samples, most_samples);
    }
}

template <class Sampling>
void require_lengths(const Sampling& s) {
    require_length("h", s.h);
    require_length("s_a", s.s_a);
    require_length("s_n", s.s_n);
    require_length("rho", s.rho);
    require_length("h * s_a", s.h * s.s_a);
    require_length("h * s_a * s_n", s.h * s.s_a * s.s_n);
    require_length("h * rho", s.h * s.rho);
}

// -1, -1 + step, ... 1: the last step is the shorter one.
std::vector<double> steps_across(double step) {
    constexpr double rounding = 1e-9;  // a last step this short is none
    const auto n = static_cast<std::size_t>(std::max(1.0, std::ceil(2 / step - rounding)));
    std::vector<double> values(n + 1);
    for (std::size_t i = 0; i < n; ++i) values[i] = -1 + static_cast<double>(i) * step;
    values[n] = 1;
    return values;
}

}  // namespace

std::vector<PointSource> sample_sphere(const SphereSampling& s) {
    require_lengths(s);
    require_length("radius", s.radius);
    require_coordinates("centre", s.centre);
    constexpr double quarter = std::numbers::pi / 2;
    const double a = quarter * s.radius / (s.h * s.rho);
    require_few(16 / std::numbers::pi * a * a, s.h, s.rho);

    std::vector<PointSource> sources;
    const double along = s.h * s.s_a;
    const auto add = [&](double x, double y, double z) {
        const Vector normal(x, y, z);
        sources.push_back(
            {s.centre + s.radius * normal, layer_metric(normal, along * s.s_n, along)});
    };
    const auto add_quadrants = [&](double sine, double cosine, double z) {
        for (const double x : {sine, -sine}) {
            for (const double y : {cosine, -cosine}) add(x, y, z);
        }
    };

    const auto n = 1 + static_cast<int>(a);
    const double latitude_step = quarter / n;
    for (int j = 0; j < n; ++j) {
        add_quadrants(std::sin(j * latitude_step), std::cos(j * latitude_step), 0);
    }
    for (int i = 1; i < n; ++i) {
        const double c = std::cos(i * latitude_step);
        const double z = std::sin(i * latitude_step);
        const auto n_i = 1 + static_cast<int>(c * a);
        const double step = quarter / n_i;
        for (int j = 0; j < n_i; ++j) {
            add_quadrants(c * std::sin(j * step), c * std::cos(j * step), z);
            add_quadrants(c * std::sin(j * step), c * std::cos(j * step), -z);
        }
    }
    add(0, 0, 1);
    add(0, 0, -1);
    return sources;
}

std::vector<PointSource> sample_planes(const PlanesSampling& s) {
    require_lengths(s);
    if (!(std::abs(s.slope) <= 0.8)) {
        refuse("slope = {}: give one from -0.8 to 0.8, so that the plane stays in [-1,1]^3",
               s.slope);
    }
    const double spacing = s.h * s.rho;
    const double stretch = std::sqrt(1 + s.slope * s.slope);  // |dS/du| of the second plane
    require_few((2 / spacing + 1) * (2 * (1 + stretch) / spacing + 2), s.h, s.rho);

    std::vector<PointSource> sources;
    const double along = s.h * s.s_a;
    const double across = along * s.s_n;
    const std::vector<double> rows = steps_across(spacing);
    const Metric first = layer_metric(Vector::UnitX(), across, along);
    for (const double v : rows) {
        for (const double u : rows) sources.push_back({{-0.5, u, v}, first});
    }
    const Metric second = layer_metric(Vector(s.slope, -1, 0) / stretch, across, along);
    const std::vector<double> columns = steps_across(spacing / stretch);
    for (const double v : rows) {
        for (const double u : columns) sources.push_back({{u, -0.2 + s.slope * u, v}, second});
    }
    return sources;
}

}  // namespace controlspace
