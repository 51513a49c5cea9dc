#include "app/readers.h"

#ifdef CONTROLSPACE_OPENVDB
#include "export/read_vdb_field.h"
#include "export/read_vdb_sources.h"
#endif

namespace controlspace {

FileReaders file_readers() {
    FileReaders readers;
#ifdef CONTROLSPACE_OPENVDB
    readers.sources[".vdb"] = [](const SourcesChoice& choice) {
        return read_vdb_sources(choice.file, choice.surface);
    };
    readers.vdb_field = [](const FieldChoice& choice) {
        return read_vdb_field(choice.file, choice.vdb);
    };
#endif
    return readers;
}

}  // namespace controlspace
