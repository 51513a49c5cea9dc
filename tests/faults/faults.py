#!/usr/bin/python3 -B
# SPDX-License-Identifier: Apache-2.0
"""Faults for real: full disks, missing rights, folders that vanish, kill -9, two runs at once, little memory.

    faults.py PROGRAM [--kills N] [--cases N] [--only PART]

After each fault finished cases are readable, an old file is intact or a new one whole, and what was not killed has
said what is wrong in one line and a status other than 0. N: kills of saving and of a study, together. Parts are the functions below that take a folder alone, and kills.
"""
import argparse, collections, fcntl, json, os, pathlib, random, resource, shutil, signal, subprocess, sys, tempfile, threading, time

parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
parser.add_argument("program", type=pathlib.Path)
parser.add_argument("--kills", type=int, default=20)
parser.add_argument("--cases", type=int, default=30)
parser.add_argument("--only")
options = parser.parse_args()

PROGRAM = str(options.program.resolve())
SOURCES = "x,y,z,h\n" + "".join(f"{i / 40},{i * i / 1600},0.5,{0.02 + i / 1000}\n" for i in range(41))
STUDY = ("compare --sources s.csv --structures K_L,K_oL,K_oV --splits s_L --access-points 100 --access-repeats 1 "
         "--creation-repeats 1 --fine-probe-grid 9 --probe-grid 5").split()
counts = collections.Counter()
failures = []
chance = random.Random(1)


def check(holds, what):
    if not holds:
        failures.append(what)
        print("FAILED:", what, flush=True)


def start(arguments, folder, setup=None):
    def prepare():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # a file that may not grow: an error of writing
        if setup:
            setup()
    return subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=folder, preexec_fn=prepare, text=True,
                            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE)


def run(arguments, folder, setup=None):
    process = start(arguments, folder, setup)
    out, err = process.communicate(timeout=300)
    return process.returncode, err


def refused(status_and_err, what):
    """Whether the program ended by itself, with one line that says why."""
    status, err = status_and_err
    errors = [line for line in err.splitlines() if "error" in line]
    check(status > 0 and len(errors) == 1, f"{what}: status {status}, {err[-400:]!r}")


def rows_of(folder):
    """Finished cases in the results of a folder; None without results."""
    file = folder / "results.json"
    if not file.exists():
        return None
    try:
        return json.loads(file.read_text())["rows"]
    except ValueError as error:
        check(False, f"{file} cannot be read: {error}")
        return []


def no_leftovers(folder, what):
    left = [str(f.name) for f in folder.rglob("*.partial")]
    check(not left, f"{what}: left behind {left}")


WRITERS = {  # file: command
    "f.ctrl": "build s.csv -o f.ctrl",
    "f.csv": "export old.ctrl -o f.csv", "f.pos": "export old.ctrl -o f.pos", "f.vti": "export old.ctrl -o f.vti",
    "f.vtu": "export old.ctrl -o f.vtu", "f.htg": "export old.ctrl -o f.htg", "f.vdb": "export old.ctrl -o f.vdb",
    "f.structured": "export old.ctrl -o f.structured", "f.msz": "export old.ctrl -o f.msz",
    "m.csv": "query old.ctrl places.csv -o m.csv",
}


def inputs(folder):
    (folder / "s.csv").write_text(SOURCES)
    (folder / "places.csv").write_text("x,y,z\n" + "0.5,0.5,0.5\n" * 300)
    status, err = run(["build", "s.csv", "-o", "old.ctrl"], folder)
    check(status == 0, f"build: {err}")


def file_sizes(folder):
    """Files whose size is limited at all places: a disk that is full at every write."""
    for name, command in WRITERS.items():
        target = folder / name
        status, err = run(command.split(), folder)
        if status != 0:
            check("cannot be written: build" in err or "installed without" in err, f"{command}: {err}")
            continue
        size = target.stat().st_size
        target.write_bytes(b"old")
        for limit in sorted({0, 1, size // 2, size - 1, *(chance.randrange(size) for _ in range(4))}):
            def at_most():
                resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
            refused(run(command.split(), folder, at_most), f"{command} with files of {limit} bytes")
            check(target.read_bytes() == b"old", f"{name} of {limit} bytes was touched")
            no_leftovers(folder, command)
            counts["full disk"] += 1


def study_on_full_disk(folder, out, fill):
    """A study where no file, or no disk, takes more; then it goes on."""
    result = run([*STUDY, "--output", out], folder, fill)
    refused(result, f"study, {fill or 'small disk'}")
    rows = rows_of(out)
    counts["full disk"] += 1
    return rows


def whole_study(folder):
    whole = folder / "whole"
    if not whole.exists():
        check(run([*STUDY, "--output", whole], folder)[0] == 0, "study")
    return whole


def study_sizes(folder):
    whole = whole_study(folder)
    size = (whole / "results.json").stat().st_size
    for limit in sorted({0, 100, *(chance.randrange(size) for _ in range(8)), size - 1}):
        def at_most():
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))
        out = folder / "limited"
        rows = study_on_full_disk(folder, out, at_most)
        if rows is not None:
            status, err = run([*STUDY, "--resume", out], folder)
            check(status == 0 and len(rows_of(out)) == 3, f"study after {limit} bytes goes on: {err}")
        shutil.rmtree(out, ignore_errors=True)


def small_disk(folder):
    """The same on a disk that is full, where this may mount one."""
    disk = folder / "disk"
    disk.mkdir()
    for kilobytes in (4, 12, 16, 24, 40, 64, 100):
        mount = ["mount", "-t", "tmpfs", "-o", f"size={kilobytes}k", "none", str(disk)]
        if subprocess.run(mount, stderr=subprocess.DEVNULL).returncode != 0:
            print("no small disk: this user may not mount one")
            return
        try:
            (disk / "f.ctrl").write_bytes(b"old")
            status, err = run("build s.csv -o disk/f.ctrl".split(), folder)
            if status != 0:
                refused((status, err), f"build on a disk of {kilobytes} kB")
                check((disk / "f.ctrl").read_bytes() == b"old", "f.ctrl was touched")
                no_leftovers(disk, "build")
            (disk / "f.ctrl").unlink()
            result = run([*STUDY, "--output", disk / "out"], folder)
            if result[0] != 0:
                refused(result, f"study on a disk of {kilobytes} kB")
            rows_of(disk / "out")
            counts["full disk"] += 2
        finally:
            subprocess.run(["umount", str(disk)], check=True)


def no_rights(folder):
    locked = folder / "locked"
    locked.mkdir()
    (locked / "f.ctrl").write_bytes(b"old")
    (folder / "secret.csv").write_text(SOURCES)
    (folder / "secret.csv").chmod(0)
    locked.chmod(0o555)
    folder.chmod(0o755)

    def as_nobody():
        if os.getuid() == 0:  # whom no rights stop
            os.setgroups([])
            os.setgid(65534)
            os.setuid(65534)
    for command in ("build s.csv -o locked/f.ctrl", "export old.ctrl -o locked/f.vti", "build secret.csv -o f.ctrl",
                    "query old.ctrl places.csv -o locked/m.csv"):
        refused(run(command.split(), folder, as_nobody), command)
        counts["no rights"] += 1
    refused(run([*STUDY, "--output", "locked/out"], folder, as_nobody), "study")
    check((locked / "f.ctrl").read_bytes() == b"old", "f.ctrl was touched")
    check(len(list(locked.iterdir())) == 1, "something was left in a locked folder")
    locked.chmod(0o755)


def folder_vanishes(folder):
    refused(run("build s.csv -o gone/f.ctrl".split(), folder), "build into no folder")
    for _ in range(5):
        out = folder / "vanishing"
        process = start([*STUDY, "--output", out], folder)
        while process.poll() is None and not (out / "results.json").exists():
            time.sleep(0.001)
        time.sleep(chance.uniform(0, 0.3))
        shutil.rmtree(out, ignore_errors=True)
        _, err = process.communicate(timeout=300)
        if process.returncode != 0:  # or all was written before
            refused((process.returncode, err), "study whose folder vanishes")
            counts["folder vanished"] += 1
        shutil.rmtree(out, ignore_errors=True)


def seconds(arguments, folder):
    began = time.monotonic()
    check(run(arguments, folder)[0] == 0, str(arguments))
    return time.monotonic() - began


def killed(arguments, folder, most):
    """Kills the program at a random moment; whether it was still running."""
    process = start(arguments, folder)
    time.sleep(chance.uniform(0, most))
    process.send_signal(signal.SIGKILL)
    process.communicate(timeout=300)
    if process.returncode != -signal.SIGKILL:
        return False
    counts["kills"] += 1
    return True


def kill_saving(folder, kills):
    target = folder / "k.ctrl"
    build = "build s.csv --within 1.02 -o k.ctrl".split()
    most = seconds(build, folder)
    new, old = target.read_bytes(), (folder / "old.ctrl").read_bytes()
    for _ in range(kills):
        target.write_bytes(old)
        killed(build, folder, most)
        check(target.read_bytes() in (old, new), "a killed save left another file")
        for left in folder.glob("k.ctrl.*.partial"):
            counts["temporary files of kills"] += 1
            left.unlink()
    check(run("info k.ctrl".split(), folder)[0] == 0, "the file after kills is read")


def kill_study(folder, kills):
    reference = rows_of(whole_study(folder))
    most = seconds([*STUDY, "--output", "timed"], folder)
    shutil.rmtree(folder / "timed")
    out = folder / "killed"
    left = kills
    while left > 0:
        if rows_of(out) is not None and json.loads((out / "results.json").read_text())["complete"]:
            finish_killed(folder, out, reference)
        rows = rows_of(out)
        how = "--resume" if rows is not None else "--output"
        left -= killed([*STUDY, how, out], folder, most)
        after = rows_of(out)
        if rows is not None:
            check(after is not None and after[:len(rows)] == rows, "a finished case was lost")
    if rows_of(out) is not None:
        finish_killed(folder, out, reference)


def drawn_runs(cases):
    """Runs of a study with settings at random."""
    trees, others = "K_L K_Li K_V K_oL K_oLB K_oV K_oLi".split(), "K_LA K_oLA uniform-nearest uniform-trilinear".split()
    text = ""
    for _ in range(cases):
        run = {"structures": f'"{chance.choice(trees + others)}"', "splits": f'"{chance.choice(["s_L", "s_G", "s_M"])}"',
               "g_r": round(chance.uniform(1.05, 2), 3), "tau": round(chance.uniform(0.3, 3), 3),
               "rho": chance.choice([4, 6, 8]), "epsilon": round(chance.uniform(0.01, 0.4), 3)}
        if chance.random() < 0.3:
            run["target_delta"] = round(chance.uniform(0.1, 0.5), 3)
        elif chance.random() < 0.3:
            run["schedule"] = f'"{chance.choice(["queue", "passes"])}"'
        if chance.random() < 0.3:
            run |= {"s_a": 2, "s_n": 0.5}
        text += "[[runs]]\n" + "".join(f"{key} = {value}\n" for key, value in run.items())
    return text


def resident_bytes(process):
    try:
        status = pathlib.Path(f"/proc/{process.pid}/status").read_text()
    except OSError:
        return 0
    return next((1024 * int(line.split()[1]) for line in status.splitlines() if line.startswith("VmRSS")), 0)


def long_study(folder):
    """Many cases with random settings in one run: all finish, in memory that does not grow with their number."""
    (folder / "long.toml").write_text(
        'sources = "sphere"\nh = 0.1\naccess_points = 100\naccess_repeats = 1\ncreation_repeats = 1\n'
        "fine_probe_grid = 9\nprobe_grid = 5\nvoxel = 0.1\nmax_memory = 0.2\n" + drawn_runs(options.cases))
    out = folder / "long"
    process = start(["compare", "long.toml", "--output", out, "--quiet"], folder)
    samples = []

    def watch():
        while process.poll() is None:
            samples.append(resident_bytes(process))
            time.sleep(0.02)
    watcher = threading.Thread(target=watch)
    watcher.start()
    _, err = process.communicate(timeout=3600)
    watcher.join()
    check(process.returncode in (0, 3), f"a long study: status {process.returncode}, {err[-400:]!r}")
    rows = rows_of(out) or []
    check(len(rows) == options.cases, f"a long study has {len(rows)} of {options.cases} rows")
    # By halves: what single cases take varies, what leaks adds up.
    earlier, later = (max(part, default=0) for part in (samples[:len(samples) // 2], samples[len(samples) // 2:]))
    check(later <= 1.25 * earlier + 2e7, f"a long study grows from {earlier / 1e6:.0f} to {later / 1e6:.0f} MB")
    counts["cases of a long study"] += len(rows)
    counts["MB of its first half, at most"], counts["MB of its second half"] = round(earlier / 1e6), round(later / 1e6)


def kills(folder):
    kill_saving(folder, options.kills // 2)
    kill_study(folder, options.kills - options.kills // 2)


def finish_killed(folder, out, reference):
    """The study goes on to the end, with the answers of one that was not disturbed."""
    if not json.loads((out / "results.json").read_text())["complete"]:
        status, err = run([*STUDY, "--resume", out], folder)
        check(status == 0, f"a killed study goes on: {err}")
    report = json.loads((out / "results.json").read_text())
    check(report["complete"], "a killed study is completed")
    same = all(a[key] == b[key] for a, b in zip(report["rows"], reference) for key in ("structure", "cells", "delta_R_max"))
    check(same and len(report["rows"]) == len(reference), "a killed study has the answers of another")
    counts["studies finished after kills"] += 1
    shutil.rmtree(out)


def two_at_once(folder):
    """One of them writes, the other says that it may not."""
    other = folder / "other"
    other.mkdir()
    held = os.open(other, os.O_RDONLY)
    fcntl.flock(held, fcntl.LOCK_EX)
    for command in (*STUDY, "--output", other), (*STUDY, "--resume", other):
        status, err = run(command, folder)
        refused((status, err), "a run into the folder of another")
        check("another run" in err, err)
    os.close(held)
    for resume in (False, True, False, True, False, True):
        out = folder / "both"
        if resume:
            check(run([*STUDY, "--output", out], folder)[0] == 0, "study")
            text = json.loads((out / "results.json").read_text())
            text["rows"], text["complete"] = text["rows"][:1], False
            (out / "results.json").write_text(json.dumps(text))
        both = [start([*STUDY, "--resume" if resume else "--output", out], folder) for _ in range(2)]
        ends = [(p.communicate(timeout=300)[1], p.returncode) for p in both]
        check(sorted(status for _, status in ends)[0] == 0, f"one of two runs succeeds: {ends}")
        for err, status in ends:
            if status != 0:
                refused((status, err), "the other run")
        check(len(rows_of(out) or []) == 3, f"two runs wrote {len(rows_of(out) or [])} cases")
        counts["two runs at once"] += 1
        shutil.rmtree(out)


def little_memory(folder):
    large = (folder / "large.csv")
    large.write_text("x,y,z,h\n" + "".join(f"{i % 97},{i % 89},{i % 83},0.3\n" for i in range(40000)))
    for megabytes in (14, 18, 22, 25, 28, 31, 34, 37, 40, 45, 50, 60, 80):
        def cap():
            resource.setrlimit(resource.RLIMIT_AS, (megabytes << 20, megabytes << 20))
        for command in ("info old.ctrl", "build large.csv --within 1.02 -o old.ctrl", "export old.ctrl -o f.csv",
                        "export old.ctrl --samples 3000 -o f.vti", " ".join(STUDY) + " --output capped"):
            before = (folder / "old.ctrl").read_bytes()
            status, err = run(command.split(), folder, cap)
            if status == 127:  # the system cannot start it, and says so in words of its own
                counts["not started"] += 1
            elif status == 0:
                if "build" in command:
                    (folder / "old.ctrl").write_bytes(before)
            elif status == 3:  # a study whose cases failed for this reason, and say so
                errors = [row["error"] for row in rows_of(folder / "capped") if row["error"]]
                check(all("memory" in error or "thread" in error for error in errors), f"{megabytes} MB: {errors}")
                counts["out of memory"] += 1
            else:
                refused((status, err), f"{command} in {megabytes} MB")
                check("memory" in err, f"{command} in {megabytes} MB: {err[-300:]!r}")
                check((folder / "old.ctrl").read_bytes() == before, "a file was touched")
                no_leftovers(folder, f"{command} in {megabytes} MB")
                counts["out of memory"] += 1
            rows_of(folder / "capped")
            shutil.rmtree(folder / "capped", ignore_errors=True)
    check(counts["out of memory"] >= 20, f"only {counts['out of memory']} commands ran out of memory")


with tempfile.TemporaryDirectory(prefix="controlspace-faults-") as name:
    folder = pathlib.Path(name)
    inputs(folder)
    for part in (file_sizes, study_sizes, small_disk, no_rights, folder_vanishes, two_at_once, little_memory, long_study,
                 kills):
        if options.only in (None, part.__name__):
            part(folder)
print(", ".join(f"{what}: {count}" for what, count in sorted(counts.items())))
sys.exit(1 if failures else 0)
