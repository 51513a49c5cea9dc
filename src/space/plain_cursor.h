// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "controlspace/space/control_space.h"

namespace controlspace {

/// A cursor without memory, of a class whose functions are called directly if it is final.
template <class Space>
class PlainCursor final : public Cursor {
public:
    explicit PlainCursor(const Space& space) : space_(space) {}

    Metric metric_at(const Point& x) override { return space_.metric_at(x); }
    double length_at(const Point& x) override { return space_.length_at(x); }

private:
    const Space& space_;
};

}  // namespace controlspace
