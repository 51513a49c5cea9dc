#pragma once

#include <functional>
#include <vector>

#include "study/case.h"

namespace controlspace {

/// How a study reads files of formats that it knows nothing of itself (.vdb); each may be empty.
struct FileReaders {
    /// Sources of kind `file` whose name ends in .vdb.
    std::function<std::vector<PointSource>(const SourcesChoice&)> vdb_sources;
    /// A field of kind `file`.
    std::function<AnalyticField(const FieldChoice&)> vdb_field;
};

/// Whether sources of that choice come out of a .vdb file.
inline bool is_vdb(const SourcesChoice& s) {
    return s.kind == SourcesKind::file && s.file.extension() == ".vdb";
}

}  // namespace controlspace
