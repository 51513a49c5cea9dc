#include "controlspace/controlspace.h"

#include <fmt/format.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "c/handle.h"
#include "c/option_text.h"
#include "controlspace/baselines/catalogue.h"
#include "controlspace/space/control_space_file.h"
#include "controlspace/version.h"

namespace {

using namespace controlspace;

// What the caller of this thread may ask for: the one thing that outlives a call.
thread_local std::string last_error;

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

std::vector<PointSource> sources_in(const cspace_sources* given) {
    require(given, "sources");
    if (given->size < sizeof(cspace_sources)) {
        throw InputError(fmt::format("sources->size is {}: give sizeof(cspace_sources), {}",
                                     given->size, sizeof(cspace_sources)));
    }
    std::vector<PointSource> sources;
    if (given->n == 0) return sources;
    require(given->positions, "positions");
    if (given->lengths == nullptr) require(given->metrics, "metrics");
    if (given->lengths != nullptr && given->metrics != nullptr) {
        throw InputError("sources have lengths and metrics: give one of them");
    }
    sources.reserve(given->n);
    for (std::size_t i = 0; i < given->n; ++i) {
        sources.push_back({point_at(given->positions, i),
                           given->lengths != nullptr ? Metric::isotropic(given->lengths[i])
                                                     : metric_at(given->metrics, i),
                           given->growths != nullptr ? given->growths[i] : 0});
    }
    return sources;
}

const CatalogueEntry& entry_named(std::string_view name) {
    const CatalogueEntry* entry = find_entry(structures(), name);
    if (entry != nullptr) return *entry;
    throw InputError(fmt::format("there is no structure {}: cspace_structure lists them", name));
}

}  // namespace

namespace controlspace {

cspace_status fail(cspace_status status, const char* what) noexcept {
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

cspace_status cspace_create(const char* structure, const double* domain, const char* options,
                            cspace** space) {
    return guarded([&] {
        require(space, "space");
        *space = nullptr;
        require(structure, "structure");
        require(domain, "domain");
        const SpaceOptions given = options_from_text({point_at(domain, 0), point_at(domain, 1)},
                                                     options == nullptr ? "" : options);
        auto builder = entry_named(structure).make(given);
        auto built = builder->build();
        *space = new cspace{std::move(builder), std::move(built)};
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
    return guarded([&] { change(space, [&](auto& builder) { builder.grade({.ratio = ratio}); }); });
}

cspace_status cspace_adapt_sources(cspace* space, const cspace_sources* sources, double ratio,
                                   double target, double* reached) {
    return guarded([&] {
        const std::vector<PointSource> all = sources_in(sources);
        AdaptationReport report;
        change(space, [&](auto& builder) {
            report = builder.adapt({all, nullptr, ratio, target});
        });
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
        *space = new cspace{std::move(saved.builder), std::move(saved.space)};
    });
}
