#pragma once

#include <cstdint>
#include <memory>

#include "controlspace/geometry/box.h"
#include "controlspace/metric/stored_metric.h"
#include "controlspace/space/control_space.h"
#include "space/state.h"

namespace controlspace {

// A frozen tree saves its nodes, what kind of values its leaves have, and the metrics, as doubles;
// all else follows from these.

/// How a frozen tree interpolates; as files have it.
enum class FrozenKind : std::uint8_t { leaves, quadratic, vertices };

/// The frozen tree that was saved: the same bits in the same memory. Throws InputError where what
/// is read is not sound.
std::unique_ptr<ControlSpace> load_frozen(const Box& domain, Precision precision,
                                          const StateReader& state);

}  // namespace controlspace
