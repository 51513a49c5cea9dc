#include "io/text/msh.h"

#include "fuzz/fuzzing.h"

using namespace controlspace;

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static MemoryFile file;
    answers([&] { require_valid(read_msh_sources(file.with(as_text(data, size)))); });
    return 0;
}
