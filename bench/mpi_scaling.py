# SPDX-License-Identifier: Apache-2.0
"""Runs controlspace-mpi on 1, 2 and 4 ranks, and writes scaling.json, summary.md: see bench/mpi."""
import json
import os
import subprocess
import sys
import tempfile

import numpy as np

program, count, folder = os.path.abspath(sys.argv[1]), int(sys.argv[2]), sys.argv[3]
sweeps = os.path.join(os.path.dirname(program), "mpi_sweeps")
RANKS = (1, 2, 4)
INSERTED = "K_oL, inserted"
BOUNDS = 73  # of an octant at most: its parts, or their centres, and those of what is cut into them
KINDS = {INSERTED: ["--structures", "K_oL", "--target-delta", "0"],
         "K_oL, adapted to 1.2x": ["--structures", "K_oL", "--within", "1.2"]}
# Of layers: the share of the sources, and how the tree is made.
OF_LAYERS = {INSERTED: (10, KINDS[INSERTED]),
             "K_oV, adapted to 1.2x": (100, ["--structures", "K_oV", "--within", "1.2"])}


def write_sources(n, path, is_layered=False):
    """On a bumpy sphere, about as far apart as the lengths ask for, three times denser on one side; layers are four
    times shorter across, along the radius."""
    random = np.random.default_rng(1)
    x = random.normal(size=(n, 3))
    x /= np.linalg.norm(x, axis=1)[:, None]
    radius = x.copy()
    x *= (0.8 + 0.05 * np.sin(9 * x[:, 0]) * np.cos(7 * x[:, 1]))[:, None]
    lengths = 4 / np.sqrt(n) * (1 + 0.5 * x[:, 2])
    columns, names = [x, lengths], "x,y,z,h"
    if is_layered:
        shorter = -0.75 * lengths[:, None] * radius
        names = "x,y,z,m_xx,m_yy,m_zz,m_xy,m_xz,m_yz"
        columns = [x, lengths[:, None] + shorter * radius] + [
            (shorter[:, a] * radius[:, b])[:, None] for a, b in ((0, 1), (0, 2), (1, 2))]
    np.savetxt(path, np.column_stack(columns), delimiter=",", header=names, comments="", fmt="%.9g")


def by_ranks(ranks, *command):
    environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    return subprocess.run(["mpirun", "--oversubscribe", "-n", str(ranks), *command], check=True,
                          env=environment, stdout=subprocess.PIPE).stdout


def run(ranks, path, options):
    return json.loads(by_ranks(ranks, program, "build", path, *options, "--domain", "-1", "1", "-1",
                               "1", "-1", "1", "--max-memory", "16"))


def row(kind, law, ranks, n, reports):
    most = {key: max(r[key] for r in reports) for key in reports[0]}
    return {"kind": kind, "law": law, "ranks": ranks, "sources": n,
            "octants": reports[0]["octants_of_all"], "cpu_s": most["cpu_s"],
            "peak_bytes": most["peak_bytes"], "held": max(r["owned"] + r["received"] for r in reports),
            "received": most["received"], "leaves": sum(r["leaves"] for r in reports),
            "bytes_sent": most["bytes_sent"], "messages_sent": most["messages_sent"]}


def table(rows):
    lines = ["| structure | sources | ranks | CPU s | of 1 rank | peak MB | of 1 rank | sources held | "
             "MB sent | messages |", "|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|"]
    for r in rows:
        one = next(o for o in rows if o["kind"] == r["kind"] and o["ranks"] == 1)
        lines.append(
            f"| {r['kind']} | {r['sources']} | {r['ranks']} | {r['cpu_s']:.2f} "
            f"| {r['cpu_s'] / one['cpu_s']:.2f} | {r['peak_bytes'] / 1e6:.0f} "
            f"| {r['peak_bytes'] / one['peak_bytes']:.2f} | {r['held']} "
            f"| {r['bytes_sent'] / 1e6:.1f} | {r['messages_sent']} |")
    return "\n".join(lines)


def model(rows):
    """1e9 sources, 1e10 leaves on 1000 cores, from the inserted tree on 4 ranks."""
    four = next(r for r in rows if r["kind"] == INSERTED and r["law"] == "strong" and r["ranks"] == 4)
    sources, leaves, cores, bandwidth, latency = 1e9, 1e10, 1000, 1e9, 1e-5
    own = sources / cores
    # What crosses a border grows as the border: the square root of the own sources, of a surface.
    four_own = four["sources"] / 4
    received = four["received"] * (own / four_own) ** 0.5
    seconds_per_leaf = four["cpu_s"] / (four["leaves"] / 4)
    build = seconds_per_leaf * leaves / cores
    octants = four["octants"] / 4 * cores
    # Each rank searches its sources for each bound of every octant.
    bounds = 1e-7 * BOUNDS * octants
    octant_pairs = 1e-8 * octants * octants / cores
    reduced = octants * BOUNDS * 8 * 2 / bandwidth
    sent = 56 * (own + received) / bandwidth + 50 * cores * latency
    total = build + bounds + octant_pairs + reduced + sent
    return {"sources": sources, "leaves": leaves, "cores": cores, "build_s": build, "bounds_s": bounds,
            "octant_pairs_s": octant_pairs, "reduce_s": reduced, "exchange_s": sent, "total_s": total,
            "octants_per_rank": octants / cores, "received_per_rank": received, "seconds_per_leaf": seconds_per_leaf}


def main():
    os.makedirs(folder, exist_ok=True)
    rows, swept = [], []
    with tempfile.TemporaryDirectory() as place:
        for kind, (share, options) in OF_LAYERS.items():
            path = os.path.join(place, "layers.csv")
            write_sources(count // share, path, is_layered=True)
            for ranks in RANKS:
                rows.append(row(kind, "layers", ranks, count // share, run(ranks, path, options)))
                print(rows[-1], flush=True)
        for law in ("strong", "weak"):
            for ranks in RANKS:
                n = count if law == "strong" else count // 4 * ranks
                path = os.path.join(place, f"{n}.csv")
                if not os.path.exists(path):
                    write_sources(n, path)
                for kind, options in KINDS.items():
                    if law == "weak" and kind != INSERTED:
                        continue
                    rows.append(row(kind, law, ranks, n, run(ranks, path, options)))
                    print(rows[-1], flush=True)
                if law == "strong":
                    swept.append(json.loads(by_ranks(ranks, sweeps, path)))
    write_results(rows, swept)


def write_results(rows, swept):
    predicted = model(rows)
    with open(os.path.join(folder, "scaling.json"), "w", encoding="utf-8") as file:
        json.dump({"rows": rows, "sweeps": swept, "model": predicted}, file, indent=1)
        file.write("\n")
    strong = [r for r in rows if r["law"] == "strong"]
    weak = [r for r in rows if r["law"] == "weak"]
    layers = [r for r in rows if r["law"] == "layers"]
    p = predicted
    sweep_lines = "\n".join(
        f"| {r['ranks']} | {r['rounds']} | {r['cpu_s']:.2f} | {r['bytes_sent'] / 1e3:.0f} "
        f"| {r['longest_by']:.3f} |" for r in swept)
    with open(os.path.join(folder, "summary.md"), "w", encoding="utf-8") as file:
        file.write(f"""# Octrees by ranks of MPI

Made by `bench/mpi`. Sources on a bumpy sphere, three times denser on one side; `controlspace-mpi build`, one thread
a rank, ranks sharing two processors: CPU s is the processor time of the slowest rank (without reading), peak MB,
sources held (its own, and those received), MB and messages are the largest of any rank. A message is what one rank
sends to another in one collective call.

Strong scaling:

{table(strong)}

Weak scaling:

{table(weak)}

Layers, tensors that are four times shorter along the radius:

{table(layers)}

While they adapt to tensors, a rank keeps answers at shared places: one rank up to 500000 (150 MB), each of several up to
75000. A process without sources takes 20 to 24 MB.

## Beside it: sweeps over faces

What parallel codes do (`bench/mpi_sweeps.cpp`): the same leaves of K_oL are graded from leaf to leaf, and values of
other ranks' leaves exchanged until nothing changes. That is quicker, but not the field: lengths at the leaves'
centres, which are exact above, are up to {max(r['longest_by'] for r in swept):.2f} times too long. CPU s is that of the gradation alone.

| ranks | rounds | CPU s | kB sent | longest length, of the exact one |
|---:|---:|---:|---:|---:|
{sweep_lines}

## Model of a large machine

{p['sources']:.0e} sources and {p['leaves']:.0e} leaves of K_oL, inserted, on {p['cores']} cores: {p['total_s']:.0f} s.

| part | s | assumption |
|---|---:|---|
| build | {p['build_s']:.1f} | {p['seconds_per_leaf'] * 1e6:.2f} µs a leaf as on 4 ranks here, exchange included |
| bounds | {p['bounds_s']:.1f} | {p['octants_per_rank']:.0f} octants a rank as here, {BOUNDS} bounds each, 0.1 µs: most searches end at the root |
| pairs of octants | {p['octant_pairs_s']:.1f} | 10 ns a pair, shared by the ranks |
| sums over all ranks | {p['reduce_s']:.1f} | 8 bytes a bound, twice, at 1 GB/s |
| exchange | {p['exchange_s']:.2f} | {p['received_per_rank']:.0f} sources received, as the border of a surface grows; 1 GB/s, 10 µs a message |

Not in it: reading the file, waiting for the slowest rank (its CPU time is taken for all), and networks that are
slower when all ranks send at once. None of it was run on such a machine.
""")


if __name__ == "__main__":
    main()
