// SPDX-License-Identifier: Apache-2.0
// A model's function with a wrong signature does not compile: with WRONG, one writes lengths where
// metrics are wanted.
#include "leaf_gradients.h"

#ifdef WRONG
using Varied = double;
#else
using Varied = Metric;
#endif

class Halved final : public LeafMetrics<KdNode> {
public:
    static constexpr ModelTraits model_traits{.order = 0};

    explicit Halved(const SpaceOptions& options) : LeafMetrics<KdNode>(options, model_traits) {}
    std::unique_ptr<LeafModel<KdNode>> clone() const override {
        return std::make_unique<Halved>(*this);
    }
    void vary(std::span<const LeafIndex>, std::span<const Point>,
              std::span<Varied> values) const override {
        for (Varied& value : values) value = 0.5 * value;
    }
};
