# SPDX-License-Identifier: Apache-2.0
"""Tables and plot of bench/speed: RAW (a folder of Google Benchmark's JSON files) OUTPUT (a folder)."""
import datetime
import json
import math
import pathlib
import statistics
import sys

import matplotlib
import numpy as np

matplotlib.use("Agg")
import matplotlib.pyplot as plt

ORDERS = ["random", "grid", "elements", "morton", "walk"]
WORKS = ["rho:1/tau:1", "rho:1/tau:0.2", "rho:0.2/tau:1", "rho:0.2/tau:0.2", "layered/tau:1"]
LIMITS = {"K_oL": 3, "K_oLB": 3, "K_L": 4, "K_L-s_G": 4, "K_V": 2.5, "K_oV": 2.5}
COUNTERS = ["payload", "topology", "auxiliary", "sources", "leaves", "ns_random", "ns_elements"]
BYTES = {"K_L": (64, 40), "K_oL": (64, 40), "K_V": (160, 105), "K_oV": (160, 105)}
CREATION_S = {("K_L", WORKS[0]): 0.09, ("K_oL", WORKS[0]): 0.09, ("K_V", WORKS[0]): 0.2,
              ("K_oV", WORKS[0]): 0.2, ("K_oL", WORKS[3]): 1.5}


def read_samples(raw):
    """name -> counter -> samples; times in ns under "ns", wall-clock times in s under "s"."""
    samples, context = {}, {}
    for file in sorted(raw.glob("*.json")):
        content = json.loads(file.read_text())
        context = content["context"]
        runs = [run for run in content["benchmarks"] if run["run_type"] == "iteration"]
        for run in sorted(runs, key=lambda r: r["family_index"]):  # they ran in random order
            name = run["run_name"]
            for ending in ("/real_time", "/manual_time"):
                name = name.removesuffix(ending)
            unit = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1.0}[run["time_unit"]]
            values = {"s": run["real_time"] * unit}
            if "per_query" in run:
                values["ns"] = run["per_query"] * 1e9
            values |= {key: run[key] for key in COUNTERS if key in run}
            for key, value in values.items():
                samples.setdefault(name, {}).setdefault(key, []).append(float(f"{value:.5g}"))
    context.pop("host_name", None)
    return samples, context


class Report:
    def __init__(self, samples):
        self.samples = samples
        self.lines = []

    def median(self, name, key="ns"):
        values = self.samples.get(name, {}).get(key)
        return statistics.median(values) if values else None

    def ns(self, structure, work, order, kind="access"):
        return self.median(f"{kind}/{structure}/{work}/{order}")

    def structures(self, kind, work):
        parts = (name.split("/", 2) for name in self.samples if name.startswith(kind + "/"))
        return list(dict.fromkeys(p[1] for p in parts if p[2].startswith(work)))

    def table(self, title, head, rows):
        self.lines += ["", "## " + title, "", "| " + " | ".join(head) + " |",
                       "|---|" + "---:|" * (len(head) - 1),
                       *("| " + " | ".join(row) + " |" for row in rows)]


def base_of(structure):
    for form in ("-doubles", "-floats", "-log16", "-log8"):
        structure = structure.removesuffix(form)
    return structure


def number(x, ending=""):
    return "" if x is None else f"{x:.3g}{ending}"


def over(a, b):
    return a / b if a is not None and b else None


def verdict(value, most):
    return "" if value is None else "met" if value <= most else "missed"


def aimed(value, most):
    """Two cells, empty where nothing is aimed at."""
    return [f"<= {most}", verdict(value, most)] if most else ["", ""]


def access_tables(report):
    for work in WORKS:
        names = report.structures("access", work)
        orders = [o for o in ORDERS if names and report.ns(names[0], work, o) is not None]
        if not names:
            continue
        rows = []
        for name in names:
            linear = any(word in name for word in ("V", "trilinear"))
            peers = ("uniform-trilinear", "openvdb-uniform-trilinear") if linear else (
                "uniform-nearest", "openvdb-uniform-nearest")
            row = [name]
            for order in orders:
                ns = report.ns(name, work, order)
                ratios = [over(ns, report.ns(base_of(name), work, order, "limit"))]
                ratios += [over(ns, report.ns(peer, work, order)) for peer in peers]
                told = ", ".join(number(r) or "-" for r in ratios)
                row.append(f"{number(ns)} ({told})")
            rows.append(row)
        report.table(f"Access, {work}", ["structure"] + orders, rows)


def access_targets(report):
    work, order = WORKS[0], "random"
    rows = []
    fine = {peer: report.ns(peer + "-fine", work, order)
            for peer in ("uniform-nearest", "openvdb-uniform-nearest")}
    for name in report.structures("access", work):
        base, ns = base_of(name), report.ns(name, work, order)
        if base in LIMITS:
            ratio = over(ns, report.ns(base, work, order, "limit"))
            rows.append([name, "limit", number(ratio), *aimed(ratio, LIMITS[base])])
        if base == "K_Li":
            ratio = over(ns, report.ns(name.replace("K_Li", "K_L"), work, order))
            rows.append([name, "K_L", number(ratio), *aimed(ratio, 4)])
        if base == "K_oL":
            for peer, peer_ns in fine.items():
                ratio = over(ns, peer_ns)
                rows.append([name, peer + "-fine", number(ratio), *aimed(ratio, 1)])
    report.table(f"Targets of access, {work}, {order} order",
                 ["structure", "against", "ratio", "target", ""], rows)


def one_by_one(report):
    for work in WORKS:
        rows = []
        for name in report.structures("length", work):
            random = report.ns(name, work, "random", "length")
            others = [report.ns(name, work, order, kind) for kind, order in
                      (("length", "walk"), ("cursor", "random"), ("cursor", "walk"))]
            if None in (random, *others):
                continue
            ratio = over(others[-1], random)
            rows.append([name, *map(number, (random, *others, ratio)),
                         *aimed(ratio, 0.5 if name.startswith("K_") else None)])
        if rows:
            report.table(f"Lengths one by one, in ns, {work}",
                         ["structure", "random", "walk", "random, by a cursor",
                          "walk, by a cursor", "that over random", "target", ""], rows)


def memory(report):
    for work in WORKS:
        names = report.structures("access", work)
        if not names:
            continue
        rows = []
        for name in names:
            parts = [report.median(f"access/{name}/{work}/random", key)
                     for key in ("payload", "topology", "auxiliary")]
            if name == "direct":
                continue  # has no elements
            target = BYTES.get(base_of(name), (None, None))[name.endswith(("-floats", "-log16", "-log8"))]
            read = parts[0] + parts[1]
            rows.append([name, *(f"{p:.1f}" for p in [*parts, read]), *aimed(read, target)])
        report.table(f"Bytes per leaf (grids: per cell), {work}",
                     ["structure", "payload", "topology", "auxiliary", "payload + topology",
                      "target", ""], rows)


def creation(report):
    names = sorted({n.rsplit("/", 1)[0] for n in report.samples if n.startswith("creation/")})
    if not names:
        return
    rows = []
    for name in sorted(names, key=lambda n: WORKS.index(n.split("/", 2)[2])):
        _, structure, work = name.split("/", 2)
        one = report.median(name + "/one-thread", "s")
        many = report.median(name + "/all-threads", "s")
        leaves = report.median(name + "/one-thread", "leaves")
        target = CREATION_S.get((structure, work))
        rows.append([structure, work, f"{leaves:.0f}" if leaves else "", number(one),
                     number(over(one, leaves) and 1e9 * one / leaves),
                     *aimed(one, target), number(over(one, many))])
    report.table("Creation: insertion and gradation",
                 ["structure", "work", "leaves", "s", "ns/leaf", "target", "",
                  "all threads: times faster"], rows)


def parallel(report):
    rows = []
    for name in report.samples:
        if not name.startswith("parallel/") or not name.endswith("/1-threads"):
            continue
        base = name.removesuffix("1-threads")
        many = [n for n in report.samples if n.startswith(base) and n != name]
        if not many:
            continue
        threads = int(many[0].rsplit("/", 1)[1].split("-")[0])
        ratio = over(report.median(name), report.median(many[0]))
        target = 0.9 * threads
        rows.append(name.split("/")[1:3] +
                    [number(report.median(name)), str(threads), number(ratio), f">= {target:.2g}",
                     "met" if ratio >= target else "missed"])
    if rows:
        report.table("Many threads, random places",
                     ["structure", "queries", "ns, one thread", "threads", "times faster", "target",
                      ""], rows)


def exponent(points):
    """Of a power law through points (x, y)."""
    return np.polyfit(*np.log(points).T, 1)[0]


def growth(report, output):
    series = {}
    for name in report.samples:
        if name.startswith("growth/"):
            _, structure, kind, _ = name.split("/")
            point = [report.median(name, key) for key in
                     ("sources", "leaves", "s", "ns_random", "ns_elements")]
            series.setdefault((kind, structure), []).append(point)
    rows = []
    for (kind, structure), points in series.items():
        large = [p for p in points if p[0] > 5e3]
        created = exponent([(p[0], p[2]) for p in large])
        rows.append([f"{structure}, {kind}", f"{points[0][0]:.0f} .. {points[-1][0]:.0f}",
                     f"{points[-1][1]:.0f}", number(points[-1][2]), f"{created:.2f}",
                     *aimed(created, 1.1)])
        first, last = points[0], points[-1]
        logs = math.log(last[0]) / math.log(first[0])
        for column in (3, 4):
            ratio = last[column] / first[column]
            rows[-1] += [f"{exponent([(p[0], p[column]) for p in points]):.2f}",
                         f"{ratio:.2g}", f"{logs:.2g}", verdict(ratio, logs)]
    report.table("Cost as work grows",
                 ["structure", "sources", "most leaves", "longest creation, s",
                  "exponent of creation", "target", ""] +
                 [f"{order}: {what}" for order in ("random", "elements")
                  for what in ("exponent of access", "last / first", "log n: last / first", "")],
                 rows)
    report.lines += ["", "Exponents: of a power of the number of sources; of creation from 5000 "
                     "sources on. Access is to grow no faster than log n.", "", "![](growth.svg)"]
    figure, axes = plt.subplots(1, 2, figsize=(9.8, 5.2), layout="constrained")
    structures = sorted({structure for _, structure in series})
    for ax, column, label, least, law in (
            (axes[0], 2, "creation [s]", lambda n: 1e-6 * n, "n"),
            (axes[1], 3, "access, random places [ns]", lambda n: 4 * math.log10(n), "log n")):
        for (kind, structure), points in series.items():
            ax.plot([p[0] for p in points], [p[column] for p in points],
                    ("o-" if kind == "finer" else "s--"), markersize=4,
                    color=f"C{structures.index(structure)}", label=f"{structure}, {kind}")
        sources = sorted({p[0] for points in series.values() for p in points})
        ax.plot(sources, [least(n) for n in sources], "k:", label=law)
        ax.set(xscale="log", yscale="log", xlabel="sources", ylabel=label)
        ax.grid(color="#dddddd")
        ax.legend(frameon=False, fontsize=7, ncols=2)
    for ending in ("svg", "png"):
        figure.savefig(output / f"growth.{ending}", dpi=150)


def main():
    raw, output = map(pathlib.Path, sys.argv[1:])
    samples, context = read_samples(raw)
    report = Report(samples)
    report.lines += [
        "# Speed and memory", "",
        f"`bench/speed`, {datetime.date.today()}, {context['num_cpus']} processors of "
        f"{context['mhz_per_cpu']} MHz, load {context['load_avg'][0]:.1f} at the start. Medians, "
        "ns a query of a batch, in processor time of one thread. In brackets: times the limit (a "
        "gather of the same metrics, or of eight that are blended, by numbers known beforehand), "
        "times the uniform grid and times OpenVDB's dense tree (nearest beside constants, "
        "trilinear beside K_V and K_oV). *-doubles*, *-floats*, *-log16*, *-log8*: forms that are only read."]
    access_targets(report)
    access_tables(report)
    one_by_one(report)
    memory(report)
    creation(report)
    parallel(report)
    growth(report, output)
    text = "\n".join(report.lines) + "\n"
    (output / "speed.md").write_text(text)
    (output / "samples.json").write_text(
        json.dumps({"context": context, "samples": samples}, separators=(",", ":")) + "\n")
    print(text)


main()
