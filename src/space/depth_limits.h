#pragma once

namespace controlspace {

// The deepest levels that trees may be given, the root being 0: past them a double has no number
// left between the faces of any box.
inline constexpr int deepest_kd_level = 200;
inline constexpr int deepest_octree_level = 60;

}  // namespace controlspace
