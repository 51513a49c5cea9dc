#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/metric/metric.h"

namespace controlspace {

/// Some tensors of a file of sources are not positive definite, and nothing else about it is wrong:
/// for those who want to know how many.
class IndefiniteTensors : public InputError {
public:
    /// `metrics` are those of all sources, `indefinite` the numbers of those that are not positive
    /// definite, from 1 and ascending; their places in `metrics` hold anything.
    IndefiniteTensors(const std::string& what, std::vector<Metric> metrics,
                      std::vector<std::size_t> indefinite)
        : InputError(what),
          tensors_(std::make_shared<Tensors>(std::move(metrics), std::move(indefinite))) {}

    const std::vector<std::size_t>& indefinite() const { return tensors_->second; }

    /// Metrics of the other sources.
    std::vector<Metric> definite() const {
        const auto& [metrics, indefinite] = *tensors_;
        std::vector<Metric> definite;
        auto next = indefinite.begin();
        for (std::size_t i = 0; i < metrics.size(); ++i) {
            if (next != indefinite.end() && *next == i + 1) {
                ++next;
            } else {
                definite.push_back(metrics[i]);
            }
        }
        return definite;
    }

private:
    using Tensors = std::pair<std::vector<Metric>, std::vector<std::size_t>>;
    std::shared_ptr<const Tensors> tensors_;  // so that a copy of the exception throws nothing
};

}  // namespace controlspace
