// SPDX-License-Identifier: Apache-2.0
// What parallel codes do in place of an exchange of sources, to compare with: metrics are graded
// from leaf to leaf over faces, those of other ranks' leaves are copies (ghosts) that are exchanged
// until nothing changes.
//   mpirun -n RANKS mpi_sweeps SOURCES.csv
// Every rank has the graph of the whole tree, which only makes this simpler: it sweeps its own
// leaves alone.
#define OMPI_SKIP_MPICXX 1
#define MPICH_SKIP_MPICXX 1
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <variant>
#include <vector>

#include "controlspace/error.h"
#include "controlspace/gradation/law.h"
#include "controlspace/io/read_sources.h"
#include "controlspace/measure/reference.h"
#include "controlspace/space/catalogue.h"
#include "measure/stopwatch.h"
#include "mpi/distributed_space.h"
#include "mpi/exchange.h"

using namespace controlspace;

namespace {

/// A value of a leaf that another rank has a copy of.
struct Ghost {
    std::uint64_t node;
    double length;
};

void sweep(Ranks& ranks, const std::vector<PointSource>& sources) {
    constexpr double ratio = 1.25;
    DistributedOptions options;
    options.space.domain = {Point::Constant(-1), Point::Constant(1)};
    const DistributedSpace owners(
        MPI_COMM_WORLD, ranks.rank() == 0 ? sources : std::vector<PointSource>(), options);

    const auto builder = find_entry(tree_catalogue(), "K_oL")->make(options.space);
    builder->insert(sources);
    const ControlNodes nodes =
        dynamic_cast<HasControlNodes&>(*builder).control_nodes(Neighbourhood::faces);
    const auto& graph = std::get<NodeGraph>(nodes.graph);
    const std::vector<Point>& positions = graph.positions;
    std::vector<int> owner(positions.size());
    std::vector<double> length(positions.size());
    for (std::size_t i = 0; i < length.size(); ++i) {
        owner[i] = owners.owner_of(positions[i]);
        length[i] = nodes.metrics[i].xx;
    }

    const Stopwatch time;
    std::vector<std::size_t> own;
    for (std::size_t i = 0; i < owner.size(); ++i) {
        if (owner[i] == ranks.rank()) own.push_back(i);
    }
    const auto lower = [&](std::size_t i) {
        double least = length[i];
        graph.for_each_neighbour(static_cast<NodeIndex>(i), [&](NodeIndex j) {
            least = std::min(least, cone_limit(length[j], ratio, positions[i] - positions[j]));
        });
        return least;
    };
    int rounds = 0;
    const std::uint64_t bytes_before = ranks.bytes();
    for (bool changes = true; changes; ++rounds) {
        const std::vector<double> before = length;
        for (bool is_lowered = true; is_lowered;) {  // own leaves, to and fro
            is_lowered = false;
            for (int direction = 0; direction < 2; ++direction) {
                for (const std::size_t i : own) {
                    const double least = lower(i);
                    is_lowered = is_lowered || least < length[i];
                    length[i] = least;
                }
                std::ranges::reverse(own);
            }
        }
        std::vector<std::vector<Ghost>> to(static_cast<std::size_t>(ranks.size()));
        for (const std::size_t i : own) {
            if (length[i] == before[i] && rounds > 0) continue;
            std::vector<int> sent;
            graph.for_each_neighbour(static_cast<NodeIndex>(i), [&](NodeIndex j) {
                const int other = owner[j];
                if (other == ranks.rank() || std::ranges::count(sent, other) > 0) return;
                sent.push_back(other);
                to[static_cast<std::size_t>(other)].push_back({i, length[i]});
            });
        }
        int has_changed = 0;
        for (const Ghost& ghost : ranks.exchange(to).values) {
            if (ghost.length < length[ghost.node]) has_changed = 1;
            length[ghost.node] = ghost.length;
        }
        changes = ranks.reduced(has_changed, MPI_MAX) != 0;
    }
    const double cpu = ranks.reduced(time.processor_seconds(), MPI_MAX);
    const double bytes = static_cast<double>(ranks.reduced(ranks.bytes() - bytes_before, MPI_MAX));

    const auto exact = exact_reference(sources, ratio, largest_metric(options.space));
    std::vector<Metric> field(positions.size());
    exact->sample(positions, field);
    double factor = 1;
    for (const std::size_t i : own) factor = std::max(factor, length[i] / field[i].xx);
    factor = ranks.reduced(factor, MPI_MAX);
    if (ranks.rank() == 0) {
        fmt::print(
            "{{\"ranks\": {}, \"leaves\": {}, \"rounds\": {}, \"cpu_s\": {:.3f}, "
            "\"bytes_sent\": {:.0f}, \"longest_by\": {:.4f}}}\n",
            ranks.size(), positions.size(), rounds, cpu, bytes, factor);
    }
}

}  // namespace

int main(int argc, char** argv) {
    MPI_Init(&argc, &argv);
    try {
        if (argc != 2) throw InputError("name a .csv of sources");
        Ranks ranks(MPI_COMM_WORLD);
        sweep(ranks, read_sources(argv[1]));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "mpi_sweeps: %s\n", error.what());
        MPI_Abort(MPI_COMM_WORLD, 2);
    }
    MPI_Finalize();
    return 0;
}
