// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <exception>
#include <memory>
#include <new>
#include <optional>
#include <utility>

#include "controlspace/controlspace.h"
#include "controlspace/input_errors.h"
#include "controlspace/space/control_space.h"
#include "controlspace/space/control_space_builder.h"

struct cspace {
    cspace(std::unique_ptr<controlspace::ControlSpaceBuilder> from,
           std::unique_ptr<controlspace::ControlSpace> built, double g_r)
        : builder(std::move(from)), ratio(g_r) {
        hold(std::move(built));
    }
    void hold(std::unique_ptr<controlspace::ControlSpace> built) {
        space = std::move(built);
        cursor.emplace(*space);
    }

    std::unique_ptr<controlspace::ControlSpaceBuilder> builder;  // none if it is only read
    std::unique_ptr<controlspace::ControlSpace> space;           // what it has built last
    std::optional<controlspace::ThreadCursor> cursor;            // of that
    double ratio;                                                // g_r that it was created with
};

namespace controlspace {

constexpr std::size_t no_index = CSPACE_NO_INDEX;

/// Keeps the reason for cspace_last_error(), and what it is about for cspace_last_error_index() and
/// ..._bytes(); returns `status`.
cspace_status fail(cspace_status status, const char* what, std::size_t index = no_index,
                   std::size_t bytes = 0) noexcept;

/// Runs `action`; what it throws becomes a status.
template <class Action>
cspace_status guarded(Action&& action) noexcept {
    try {
        action();
        return CSPACE_OK;
    } catch (const IndexedError& error) {
        return fail(CSPACE_BAD_INPUT, error.what(), error.index());
    } catch (const MemoryLimitError& error) {
        return fail(CSPACE_BAD_INPUT, error.what(), no_index, error.bytes());
    } catch (const GrowthStopped&) {  // there is no other limit in C
        return fail(CSPACE_FAILURE, "stopped by the caller: the number at `stop` was set");
    } catch (const InputError& error) {
        return fail(CSPACE_BAD_INPUT, error.what());
    } catch (const std::bad_alloc&) {
        return fail(CSPACE_FAILURE, "out of memory");
    } catch (const std::exception& error) {
        return fail(CSPACE_FAILURE, error.what());
    } catch (...) {
        return fail(CSPACE_FAILURE, "unknown failure");
    }
}

/// Throws InputError for NULL.
void require(const void* argument, const char* name);

/// The control space to be read. Throws where there is none.
const ControlSpace& space_of(const cspace* handle);

inline Point point_at(const double* positions, std::size_t i) {
    return {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
}

inline Metric metric_at(const double* metrics, std::size_t i) {
    const double* m = metrics + 6 * i;
    return {m[0], m[1], m[2], m[3], m[4], m[5]};
}

}  // namespace controlspace
