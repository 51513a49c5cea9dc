#include "controlspace/baselines/catalogue.h"

#include <vector>

#include "baselines/direct/direct.h"
#include "baselines/uniform/uniform_grid.h"
#ifdef CONTROLSPACE_OPENVDB
#include "baselines/openvdb/catalogue.h"
#endif

namespace controlspace {

std::span<const CatalogueEntry> structures() {
    static const std::vector<CatalogueEntry> all = [] {
        std::vector<CatalogueEntry> rows;
        const auto add = [&rows](const auto& more) {
            rows.insert(rows.end(), more.begin(), more.end());
        };
        add(tree_catalogue());
        add(anchored_catalogue());
        add(uniform_rows());
#ifdef CONTROLSPACE_OPENVDB
        add(openvdb_rows());
#endif
        add(direct_rows());
        return rows;
    }();
    return all;
}

}  // namespace controlspace
