#include "controlspace/controlspace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "c/handle.h"
#include "c/option_text.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/space/control_space_file.h"
#include "controlspace/space/make_control_space.h"
#include "controlspace/version.h"

namespace {

using namespace controlspace;

// What the caller of this thread may ask for: the one thing that outlives a call.
thread_local std::string last_error;
thread_local std::size_t last_index = no_index, last_bytes = 0;

// Changes what the handle holds by `edit(builder)`, and builds it again.
template <class Edit>
void change(cspace* handle, Edit&& edit) {
    require(handle, "space");
    if (!handle->builder) {
        throw InputError("a compact form is only read: insert, grade and adapt before it is made");
    }
    handle->space.reset();  // so that nothing has to be copied
    try {
        edit(*handle->builder);
    } catch (...) {
        handle->space = handle->builder->build();
        throw;
    }
    handle->space = handle->builder->build();
}

// Puts `metric_of(i)` at each position.
template <class MetricOf>
std::vector<PointSource> sources_at(std::size_t n, const double* positions, MetricOf&& metric_of) {
    std::vector<PointSource> sources;
    sources.reserve(n);
    for (std::size_t i = 0; i < n; ++i) sources.push_back({point_at(positions, i), metric_of(i)});
    return sources;
}

std::vector<PointSource> sources_of(std::size_t n, const double* positions, const double* metrics) {
    if (n > 0) require(positions, "positions");
    if (n > 0) require(metrics, "metrics");
    return sources_at(n, positions, [&](std::size_t i) { return metric_at(metrics, i); });
}

// A ratio of 0 is that of creation.
double ratio_of(const cspace* handle, double given) {
    require(handle, "space");
    return given == 0 ? handle->ratio : given;
}

// The caller's options, who may know fewer members than this version, or more.
cspace_options complete(const cspace_options* given) {
    cspace_options options{};
    if (given == nullptr) return options;
    if (given->struct_size < sizeof given->struct_size) {
        throw InputError(
            fmt::format("struct_size of the options is {}: set it to sizeof(cspace_options)",
                        given->struct_size));
    }
    const char* bytes = reinterpret_cast<const char*>(given);
    std::memcpy(&options, bytes, std::min(given->struct_size, sizeof options));
    for (std::size_t i = sizeof options; i < given->struct_size; ++i) {
        if (bytes[i] == 0) continue;
        throw InputError(fmt::format(
            "options have a member that version {} does not know: leave it at 0", version()));
    }
    return options;
}

SpaceOptions space_options(const double* domain, const cspace_options& options) {
    std::string text = options.further == nullptr ? "" : options.further;
    const auto add = [&](const char* name, double value) {
        if (value != 0) text.append(fmt::format(" {}={}", name, value));
    };
    add("g_r", options.growth);
    add("max_memory", options.max_memory);
    return options_from_text({point_at(domain, 0), point_at(domain, 1)}, text);
}

template <class Sources>
void build(const char* structure, const double* domain, Sources&& sources_given,
           const cspace_options* given, double* reached, cspace** space) {
    require(space, "space");
    *space = nullptr;
    const std::vector<PointSource> sources = sources_given();
    require(structure, "structure");
    require(domain, "domain");
    const cspace_options options = complete(given);
    const SpaceOptions making = space_options(domain, options);
    std::optional<double> target;
    if (options.delta != 0) target = options.delta;
    AdaptationReport report;
    auto builder =
        make_filled_builder(entry_named(structures(), structure), sources, making, target, &report);
    auto built = builder->build();
    *space = new cspace{std::move(builder), std::move(built), making.ratio};
    if (reached != nullptr) {
        *reached = target ? report.reached : std::numeric_limits<double>::quiet_NaN();
    }
}

std::vector<PointSource> sources_with_lengths(std::size_t n, const double* positions,
                                              const double* lengths) {
    if (n > 0) require(positions, "positions");
    if (n > 0) require(lengths, "lengths");
    return sources_at(n, positions, [&](std::size_t i) { return Metric::isotropic(lengths[i]); });
}

}  // namespace

namespace controlspace {

cspace_status fail(cspace_status status, const char* what, std::size_t index,
                   std::size_t bytes) noexcept {
    last_index = index;
    last_bytes = bytes;
    try {
        last_error = what;
    } catch (...) {
        last_error.clear();
    }
    return status;
}

void require(const void* argument, const char* name) {
    if (argument == nullptr) throw InputError(fmt::format("{} is NULL", name));
}

const ControlSpace& space_of(const cspace* handle) {
    require(handle, "space");
    if (!handle->space) throw std::runtime_error("the space could not be finished: free it");
    return *handle->space;
}

}  // namespace controlspace

const char* cspace_version(void) { return version().data(); }

const char* cspace_last_error(void) { return last_error.c_str(); }

size_t cspace_last_error_index(void) { return last_index; }

size_t cspace_last_error_bytes(void) { return last_bytes; }

cspace_status cspace_create(const char* structure, const double* domain, const char* options,
                            cspace** space) {
    return guarded([&] {
        require(space, "space");
        *space = nullptr;
        require(structure, "structure");
        require(domain, "domain");
        const SpaceOptions given = options_from_text({point_at(domain, 0), point_at(domain, 1)},
                                                     options == nullptr ? "" : options);
        auto builder = entry_named(structures(), structure).make(given);
        auto built = builder->build();
        *space = new cspace{std::move(builder), std::move(built), given.ratio};
    });
}

cspace_status cspace_build(const char* structure, const double* domain, size_t n,
                           const double* positions, const double* metrics,
                           const cspace_options* options, double* reached, cspace** space) {
    return guarded([&] {
        const auto sources = [&] { return sources_of(n, positions, metrics); };
        build(structure, domain, sources, options, reached, space);
    });
}

cspace_status cspace_build_lengths(const char* structure, const double* domain, size_t n,
                                   const double* positions, const double* lengths,
                                   const cspace_options* options, double* reached, cspace** space) {
    return guarded([&] {
        const auto sources = [&] { return sources_with_lengths(n, positions, lengths); };
        build(structure, domain, sources, options, reached, space);
    });
}

const char* cspace_structure(size_t i) {
    return i < structures().size() ? structures()[i].id.c_str() : nullptr;
}

void cspace_free(cspace* space) { delete space; }

cspace_status cspace_insert(cspace* space, size_t n, const double* positions,
                            const double* metrics) {
    return guarded([&] {
        const std::vector<PointSource> sources = sources_of(n, positions, metrics);
        change(space, [&](auto& builder) { builder.insert(sources); });
    });
}

cspace_status cspace_insert_lengths(cspace* space, size_t n, const double* positions,
                                    const double* lengths) {
    return guarded([&] {
        const std::vector<PointSource> sources = sources_with_lengths(n, positions, lengths);
        change(space, [&](auto& builder) { builder.insert(sources); });
    });
}

cspace_status cspace_grade(cspace* space, double ratio) {
    return guarded([&] {
        const double g_r = ratio_of(space, ratio);
        change(space, [&](auto& builder) { builder.grade({.ratio = g_r}); });
    });
}

cspace_status cspace_adapt(cspace* space, size_t n, const double* positions, const double* metrics,
                           double ratio, double target, double* reached) {
    return guarded([&] {
        const std::vector<PointSource> sources = sources_of(n, positions, metrics);
        const double g_r = ratio_of(space, ratio);
        AdaptationReport report;
        change(space, [&](auto& builder) {
            report = builder.adapt({sources, nullptr, g_r, target});
        });
        if (reached != nullptr) *reached = report.reached;
    });
}

cspace_status cspace_domain(const cspace* space, double* domain) {
    return guarded([&] {
        require(domain, "domain");
        const Box box = space_of(space).domain();
        for (Axis a = 0; a < 3; ++a) {
            domain[a] = box.low[a];
            domain[3 + a] = box.high[a];
        }
    });
}

cspace_status cspace_save(const cspace* space, const char* file) {
    return guarded([&] {
        require(file, "file");
        if (space_of(space); space->builder) {
            save_control_space(file, *space->builder);
        } else {
            save_control_space(file, *space->space);
        }
    });
}

cspace_status cspace_load(const char* file, cspace** space) {
    return guarded([&] {
        require(space, "space");
        *space = nullptr;
        require(file, "file");
        SavedControlSpace saved = open_control_space(file, structures());
        *space = new cspace{std::move(saved.builder), std::move(saved.space),
                            saved.recipe.options.ratio};
    });
}
