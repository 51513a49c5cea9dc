#!/usr/bin/env python3
"""Shows that the scenes are sharp: each defect of tests/scenes/defects, put into a copy of the
tree, must break the law that its patch names, which holds without it. A defect that no scene can
show, since it is not one of structures, must break a test of another program, which its patch names.

The copy and its build folder are kept, so that a second run builds little.
"""

import argparse
import os
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FIRST_SCENE = 1


def copy_tree(to):
    """Writes what differs alone: the rest need not be built again."""
    names = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"],
        cwd=ROOT, capture_output=True, text=True, check=True).stdout.split("\0")
    for name in filter(None, names):
        source, copy = ROOT / name, to / name
        if not source.is_file():
            continue
        if not copy.exists() or copy.read_bytes() != source.read_bytes():
            copy.parent.mkdir(parents=True, exist_ok=True)
            copy.write_bytes(source.read_bytes())
            copy.chmod(source.stat().st_mode)


def quiet(command, folder):
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(" ".join(map(str, command)) + "\n" + done.stdout + done.stderr)


def build(tree, programs, jobs):
    if not (tree / "build/ci/build.ninja").exists():
        quiet(["cmake", "--preset", "ci"], tree)
    quiet(["ninja", "-C", "build/ci", f"-j{jobs}", *programs], tree)


def defect(patch):
    """The program of tests and the law, or test, that a patch names."""
    head = dict(line.split(": ", 1) for line in patch.read_text().partition("---")[0].splitlines())
    return head.get("Program", "tests_scenes"), head["Law"]


def run(tree, program, law, scenes):
    """Status and output of a law over all structures that it is for, up to the first failure."""
    cases = law.replace(",", "\\,") + (": *" if program == "tests_scenes" else "")
    return subprocess.run(
        [f"build/ci/bin/{program}", cases, "--abort"], cwd=tree,
        capture_output=True, text=True, errors="replace",
        env=os.environ | {"CONTROLSPACE_FIRST_SCENE": str(FIRST_SCENE),
                          "CONTROLSPACE_SCENES": str(scenes)})


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--copy", type=Path, default=ROOT / "build/defects",
                        help="folder of the copy (build/defects)")
    parser.add_argument("--only", action="append", help="a patch without .patch; may be repeated")
    parser.add_argument("--scenes", type=int, default=60, help="for each structure (60)")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    options = parser.parse_args()

    patches = sorted((ROOT / "tests/scenes/defects").glob("*.patch"))
    if options.only:
        patches = [patch for patch in patches if patch.stem in options.only]
    if not patches:
        sys.exit("no defect is called so")
    defects = {patch: defect(patch) for patch in patches}
    missed = False
    copy_tree(options.copy)
    build(options.copy, {program for program, _ in defects.values()}, options.jobs)
    for program, law in dict.fromkeys(defects.values()):
        done = run(options.copy, program, law, options.scenes)
        if done.returncode != 0 or "No test cases matched" in done.stdout:
            sys.exit(f"without a defect: {law}\n{done.stdout[-4000:]}")
        print(f"without a defect: holds: {law}", flush=True)
    for patch, (program, law) in defects.items():
        quiet(["patch", "-p1", "--forward", "--input", patch], options.copy)
        try:
            build(options.copy, [program], options.jobs)
            done = run(options.copy, program, law, options.scenes)
        finally:
            quiet(["patch", "-p1", "--reverse", "--input", patch], options.copy)
        if done.returncode == 0:
            print(f"{patch.stem}: NOT FOUND by {options.scenes} scenes: {law}", flush=True)
            missed = True
            continue
        seed = re.search(r"seed := (\d+)", done.stdout)
        name = re.search(re.escape(law) + r": (?!\*)(.+)", done.stdout)
        if seed is None or name is None:
            print(f"{patch.stem}: found, status {done.returncode}: {law}", flush=True)
            continue
        count = int(seed[1]) - FIRST_SCENE + 1
        print(f"{patch.stem}: found by scene {count} of {name[1].strip()}: {law}", flush=True)
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
