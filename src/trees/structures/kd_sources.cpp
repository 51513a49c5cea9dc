#include "controlspace/space/detail/shared_builder.h"
#include "trees/source_tree.h"
#include "trees/structures/rows.h"

namespace controlspace {

CatalogueEntry kd_sources() {
    return {.id = "K_LA",
            .description = "kd-tree, up to three sources in each leaf",
            .family = "anchored",
            .construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
                require_valid(options);
                return std::make_unique<SharedBuilder<SourceTree<KdNode>>>(options);
            },
            .capabilities = {SourceLeaves(), KeptSources(), SplitRules()}};
}

}  // namespace controlspace
