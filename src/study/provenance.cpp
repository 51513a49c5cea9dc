// SPDX-License-Identifier: Apache-2.0
#include "controlspace/study/provenance.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "study/build_info.h"

namespace controlspace {
namespace {

std::string cpu_model() {
    std::ifstream file("/proc/cpuinfo");
    std::string line;
    while (std::getline(file, line)) {
        const std::size_t colon = line.find(": ");
        if (line.rfind("model name", 0) == 0 && colon != std::string::npos) {
            return line.substr(colon + 2);
        }
    }
    return "unknown";
}

}  // namespace

Provenance current_provenance() {
    Provenance p;
    p.version = build_info.version;
    p.commit = build_info.commit;
    p.dirty = build_info.dirty;
    p.compiler = build_info.compiler;
    p.flags = build_info.flags;
    p.cpu = cpu_model();
    p.cores = std::thread::hardware_concurrency();
    p.threads = tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
    p.date = fmt::format(
        "{:%Y-%m-%dT%H:%M:%SZ}",
        fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
    return p;
}

std::string version_text(const Provenance& p) {
    return fmt::format("{} (commit {}{})", p.version, p.commit.substr(0, 12),
                       p.dirty ? ", modified" : "");
}

}  // namespace controlspace
