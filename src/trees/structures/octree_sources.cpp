#include "controlspace/space/detail/shared_builder.h"
#include "trees/source_tree.h"
#include "trees/structures/rows.h"

namespace controlspace {

CatalogueEntry octree_sources() {
    return {.id = "K_oLA",
            .description = "octree, up to three sources in each leaf",
            .family = "anchored",
            .construct = [](const SpaceOptions& options) -> std::unique_ptr<ControlSpaceBuilder> {
                require_valid(options);
                return std::make_unique<SharedBuilder<SourceTree<OctreeNode>>>(options);
            },
            .capabilities = {SourceLeaves(), KeptSources()}};
}

}  // namespace controlspace
