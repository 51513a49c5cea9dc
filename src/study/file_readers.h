#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "study/case.h"

namespace controlspace {

/// How a study reads files of formats that it knows nothing of itself.
struct FileReaders {
    /// Sources of kind `file`, by the ending of the file's name in small letters (".vdb").
    std::map<std::string, std::function<std::vector<PointSource>(const SourcesChoice&)>> sources;
    /// A field of kind `file`; may be empty.
    std::function<AnalyticField(const FieldChoice&)> vdb_field;
};

/// Whether sources of that choice come out of a .vdb file.
inline bool is_vdb(const SourcesChoice& s) {
    return s.kind == SourcesKind::file && s.file.extension() == ".vdb";
}

}  // namespace controlspace
