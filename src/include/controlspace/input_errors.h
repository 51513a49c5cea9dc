// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "controlspace/error.h"

namespace controlspace {

// Input errors that a program can act on; their text says the same to a user.

/// One of the sources, places or metrics given cannot be used.
class IndexedError : public InputError {
public:
    IndexedError(std::size_t index, const std::string& what) : InputError(what), index_(index) {}
    /// Which one, from 0.
    std::size_t index() const noexcept { return index_; }

private:
    std::size_t index_;
};

/// A structure would outgrow its cap, SpaceOptions::max_bytes.
class MemoryLimitError : public InputError {
public:
    MemoryLimitError(std::size_t bytes, const std::string& what)
        : InputError(what), bytes_(bytes) {}
    /// What it needs to go on, gradation included; later steps may need more.
    std::size_t bytes() const noexcept { return bytes_; }

private:
    std::size_t bytes_;
};

/// What ended the growth of a tree, or the search for the voxels of a grid, before its end.
enum class GrowthStop { none, leaves, time, memory };

/// A tree reached its SpaceOptions::growth limit of time or memory before it was finished.
class GrowthStopped : public InputError {
public:
    GrowthStopped(GrowthStop stop, std::size_t leaves, const std::string& what)
        : InputError(what), stop_(stop), leaves_(leaves) {}
    GrowthStop stop() const noexcept { return stop_; }
    /// Number of leaves then.
    std::size_t leaves() const noexcept { return leaves_; }

private:
    GrowthStop stop_;
    std::size_t leaves_;
};

/// No structure has this name; what() lists those there are.
class UnknownStructure : public InputError {
public:
    using InputError::InputError;
};

}  // namespace controlspace
