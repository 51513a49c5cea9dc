// SPDX-License-Identifier: Apache-2.0
#include "controlspace/baselines/catalogue.h"

#include <stdexcept>
#include <vector>

#include "baselines/add_structures.h"
#include "baselines/rows.h"
#ifdef CONTROLSPACE_OPENVDB
#include "baselines/openvdb/catalogue.h"
#endif

namespace controlspace {

namespace {

struct AddedRows {
    std::vector<CatalogueEntry> rows;
    bool listed = false;
};
AddedRows& added_rows() {
    static AddedRows added;
    return added;
}

}  // namespace

void add_structures(std::span<const CatalogueEntry> rows) {
    AddedRows& added = added_rows();
    if (added.listed) throw std::logic_error("add_structures: after the first use of structures()");
    added.rows.insert(added.rows.end(), rows.begin(), rows.end());
}

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
        add(added_rows().rows);
        added_rows().listed = true;
        return rows;
    }();
    return all;
}

}  // namespace controlspace
