#include "controlspace/metric/blend.h"

namespace controlspace {

namespace {

// f(M): the function applied to the eigenvalues.
template <class Function>
Metric spectral(const Metric& m, Function f) {
    EigenFrame frame = eigen_frame(m);
    for (double& length : frame.lengths) length = f(length);
    return metric_from_frame(frame.lengths, frame.directions);
}

template <class Forward>
Metric mean(std::span<const double> weights, std::span<const Metric> metrics, Forward forward) {
    return blend_lengths(weights, [&](std::size_t i) { return spectral(metrics[i], forward); });
}

}  // namespace

Metric blend(std::span<const double> weights, std::span<const Metric> metrics, Blend scheme) {
    assert(weights.size() == metrics.size());
    switch (scheme) {
        case Blend::lengths:
            break;
        case Blend::riemannian:
            return spectral(mean(weights, metrics, [](double h) { return 1 / (h * h); }),
                            [](double r) { return 1 / std::sqrt(r); });
        case Blend::inverse:
            return spectral(mean(weights, metrics, [](double h) { return h * h; }),
                            [](double r) { return std::sqrt(r); });
        case Blend::log_euclidean:
            return spectral(mean(weights, metrics, [](double h) { return std::log(h); }),
                            [](double l) { return std::exp(l); });
    }
    return blend_lengths(weights, [&](std::size_t i) -> const Metric& { return metrics[i]; });
}

}  // namespace controlspace
