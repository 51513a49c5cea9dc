// SPDX-License-Identifier: Apache-2.0
#include "controlspace/controlspace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>
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
#include "controlspace/trees/octree_pieces.h"
#include "controlspace/version.h"
#include "refuse.h"
#include "space/until_late.h"

namespace {

using namespace controlspace;

// The last error of this thread: the only state that outlives a call.
thread_local std::string last_error;
thread_local std::size_t last_index = no_index, last_bytes = 0;

// Changes what the handle holds by `edit(builder)`, and builds it again.
template <class Edit>
void change(cspace* handle, Edit&& edit) {
    require(handle, "space");
    if (!handle->builder) {
        refuse(
            "it is only read: insert, grade and adapt one of cspace_create(), or build it with "
            "takes_later_sources=1, or by controlspace build --precision as-made");
    }
    handle->cursor.reset();
    handle->space.reset();  // so that nothing has to be copied
    try {
        edit(*handle->builder);
    } catch (...) {
        handle->hold(handle->builder->build());
        throw;
    }
    handle->hold(handle->builder->build());
}

// A ratio of 0 is that of creation.
double ratio_of(const cspace* handle, double given) {
    require(handle, "space");
    return given == 0 ? handle->ratio : given;
}

// A struct of the caller, who may know fewer members than this version, or more.
template <class Struct>
Struct complete(const Struct* given, const char* name) {
    Struct own{};
    if (given->struct_size < sizeof given->struct_size) {
        refuse("struct_size of the {0} is {1}: set it to sizeof(cspace_{0})", name,
               given->struct_size);
    }
    const char* bytes = reinterpret_cast<const char*>(given);
    std::memcpy(&own, bytes, std::min(given->struct_size, sizeof own));
    for (std::size_t i = sizeof own; i < given->struct_size; ++i) {
        if (bytes[i] == 0) continue;
        refuse("the {} have a member that version {} does not know: leave it at 0", name,
               version());
    }
    return own;
}

std::vector<PointSource> sources_in(const cspace_sources* sources) {
    require(sources, "sources");
    const cspace_sources given = complete(sources, "sources");
    std::vector<PointSource> result;
    if (given.n == 0) return result;
    require(given.positions, "positions");
    if (given.lengths == nullptr) require(given.metrics, "metrics");
    if (given.lengths != nullptr && given.metrics != nullptr) {
        refuse("sources have lengths and metrics: give one of them");
    }
    result.reserve(given.n);
    for (std::size_t i = 0; i < given.n; ++i) {
        result.push_back({point_at(given.positions, i),
                          given.lengths != nullptr ? Metric::isotropic(given.lengths[i])
                                                   : metric_at(given.metrics, i),
                          given.growths != nullptr ? given.growths[i] : 0});
    }
    return result;
}

SpaceOptions space_options(const double* domain, const cspace_options& options) {
    std::string text = options.further == nullptr ? "" : options.further;
    const auto add = [&](const char* name, double value) {
        if (value != 0) text.append(fmt::format(" {}={}", name, value));
    };
    add("g_r", options.growth);
    add("max_memory", options.max_memory);
    SpaceOptions result = options_from_text({point_at(domain, 0), point_at(domain, 1)}, text);
    result.growth.stop = options.stop;
    return result;
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
    if (argument == nullptr) refuse("{} is NULL", name);
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
        *space = new cspace(std::move(builder), std::move(built), given.ratio);
    });
}

cspace_status cspace_build(const char* structure, const double* domain,
                           const cspace_sources* sources, const cspace_options* options,
                           double* reached, cspace** space) {
    return guarded([&] {
        require(space, "space");
        *space = nullptr;
        require(structure, "structure");
        require(domain, "domain");
        const std::vector<PointSource> all = sources_in(sources);
        const cspace_options given =
            options != nullptr ? complete(options, "options") : cspace_options{};
        const SpaceOptions making = space_options(domain, given);
        std::optional<double> target;
        if (given.delta != 0) target = given.delta;
        AdaptationReport report;
        const CatalogueEntry& entry = entry_named(structures(), structure);
        auto builder = make_filled_builder(entry, all, making, target, &report);
        require_in_time(making.growth);
        auto built = builder->build(to_be_read(entry, making));
        if (!making.takes_later_sources) builder.reset();
        *space = new cspace(std::move(builder), std::move(built), making.ratio);
        if (reached != nullptr) {
            *reached = target ? report.reached : std::numeric_limits<double>::quiet_NaN();
        }
    });
}

const char* cspace_structure(size_t i) {
    return i < structures().size() ? structures()[i].id.c_str() : nullptr;
}

void cspace_free(cspace* space) { delete space; }

cspace_status cspace_insert_sources(cspace* space, const cspace_sources* sources) {
    return guarded([&] {
        const std::vector<PointSource> all = sources_in(sources);
        change(space, [&](auto& builder) { builder.insert(all); });
    });
}

cspace_status cspace_insert(cspace* space, size_t n, const double* positions,
                            const double* metrics) {
    const cspace_sources sources{sizeof sources, n, positions, metrics, nullptr, nullptr};
    return cspace_insert_sources(space, &sources);
}

cspace_status cspace_insert_lengths(cspace* space, size_t n, const double* positions,
                                    const double* lengths) {
    if (n > 0 && lengths == nullptr) return guarded([] { require(nullptr, "lengths"); });
    const cspace_sources sources{sizeof sources, n, positions, nullptr, lengths, nullptr};
    return cspace_insert_sources(space, &sources);
}

cspace_status cspace_grade(cspace* space, double ratio) {
    return guarded([&] {
        const double g_r = ratio_of(space, ratio);
        change(space, [&](auto& builder) { builder.grade({.ratio = g_r}); });
    });
}

cspace_status cspace_adapt_sources(cspace* space, const cspace_sources* sources, double ratio,
                                   double target, double* reached) {
    return guarded([&] {
        const std::vector<PointSource> all = sources_in(sources);
        const double g_r = ratio_of(space, ratio);
        AdaptationReport report;
        change(space, [&](auto& builder) { report = builder.adapt({all, nullptr, g_r, target}); });
        if (reached != nullptr) *reached = report.reached;
    });
}

cspace_status cspace_adapt(cspace* space, size_t n, const double* positions, const double* metrics,
                           double ratio, double target, double* reached) {
    const cspace_sources sources{sizeof sources, n, positions, metrics, nullptr, nullptr};
    return cspace_adapt_sources(space, &sources, ratio, target, reached);
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
        const ControlSpace& field = space_of(space);
        // A builder is more than a .vdb holds.
        if (space->builder && std::filesystem::path(file).extension() != ".vdb") {
            save_control_space(file, *space->builder);
        } else {
            save_control_space(file, field);
        }
    });
}

cspace_status cspace_load(const char* file, cspace** space) {
    return guarded([&] {
        require(space, "space");
        *space = nullptr;
        require(file, "file");
        SavedControlSpace saved = open_control_space(file, structures());
        *space = new cspace(std::move(saved.builder), std::move(saved.space),
                            saved.recipe.options.ratio);
    });
}

cspace_status cspace_load_pieces(const char* index, const double* region, cspace** space) {
    return guarded([&] {
        require(space, "space");
        *space = nullptr;
        require(index, "index");
        const Box box =
            region == nullptr ? Box::everywhere() : Box{point_at(region, 0), point_at(region, 1)};
        *space =
            new cspace(nullptr, load_octree_pieces(index, structures(), box), SpaceOptions().ratio);
    });
}
