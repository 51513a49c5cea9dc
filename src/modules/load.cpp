// SPDX-License-Identifier: Apache-2.0
#include "modules/load.h"

#include <dlfcn.h>
#include <link.h>

#include <filesystem>

#include "controlspace/version.h"
#include "refuse.h"

namespace controlspace {
namespace {

namespace fs = std::filesystem;

/// The folder of the modules lies in the same place relative to the program or the shared library
/// that this is linked into, in the build folder and where it is installed.
fs::path modules_folder() {
    static const char anchor = 0;
    Dl_info info;
    link_map* own = nullptr;
    ::dladdr1(&anchor, &info, reinterpret_cast<void**>(&own), RTLD_DL_LINKMAP);
    const bool is_program = own == nullptr || own->l_name[0] == 0;
    if (!is_program) return fs::canonical(own->l_name).parent_path() / "controlspace";
    return fs::read_symlink("/proc/self/exe").parent_path() / CONTROLSPACE_MODULES;
}

fs::path module_file(const std::string& name) {
    return (modules_folder() / (name + ".so")).lexically_normal();
}

void* open_module(const std::string& name) {
    const fs::path file = module_file(name);
    if (!fs::exists(file)) {
        refuse_at(file, "no such file: controlspace is built or installed without {}", name);
    }
    void* module = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (module == nullptr) refuse("cannot be loaded: {}", ::dlerror());
    return module;
}

}  // namespace

void load_module(const std::string& name) { open_module(name); }

void load_module_of(std::string_view structure) {
    if (structure.starts_with("openvdb")) load_module("openvdb");
}

const void* module_table_of(const std::string& name) {
    void* function = ::dlsym(open_module(name), "controlspace_module");
    const void* table = function ? reinterpret_cast<const void* (*)()>(function)() : nullptr;
    // Every table begins with its version.
    if (table == nullptr || *static_cast<const std::string_view*>(table) != version()) {
        refuse_at(module_file(name), "its version is not {}", version());
    }
    return table;
}

}  // namespace controlspace
