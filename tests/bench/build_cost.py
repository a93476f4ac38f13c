"""tests/bench/build_cost.py [demo] [--headers] [--costs FILE]: the processor time of a build; tools/bench --build runs it.

Builds the last commit and commit aed51e9e on two cores or more, each from a clean clone and without a compiler cache, in
turns: what tools/demo builds of either, then all of either. Prints both sums with their ratio and its budget, and the
twenty units that take longest. demo: leaves out the rest of all. --headers: also the headers that take longest to parse,
by clang's -ftime-trace on the ten longest units of the demo. --costs: also writes the seconds of each output to FILE, by
which other builds estimate their time left. Exit 1: a ratio is above its budget.
"""

import argparse
import collections
import json
import os
import re
import resource
import shlex
import shutil
import subprocess
import sys
import time
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
SCRATCH = SOURCE / "build/cost"
BASE = "aed51e9e"
BUDGETS = {"demo": 0.35, "all": 0.55}  # of the base's processor time
DEMO_OF_OLDER_COMMITS = "rehearse_installed SR1MinimumController"  # before tools/lib.sh named it


class Failure(Exception):
    """A command that failed."""


def run(words, log=None, **options):
    """Runs a command, with its output in a file; returns its processor time and that of its children [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with open(log or os.devnull, "a", encoding="utf-8") as output:
        status = subprocess.run(words, stdout=output, stderr=subprocess.STDOUT, check=False, **options).returncode
    if status:
        raise Failure(f"{shlex.join(map(str, words))} failed" + (f"; its output is in {log}" if log else ""))
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def git(*words):
    return subprocess.run(["git", "-C", SOURCE, *words], check=False, capture_output=True, text=True).stdout.strip()


class Build:
    """A commit in a clean clone, with its build folder."""

    def __init__(self, name, commit):
        self.name, self.folder = name, SCRATCH / name
        self.source, self.build, self.times = (self.folder / part for part in ("source", "build", "times"))
        self.seconds = {}  # of demo, of all
        self.clock = {}
        shutil.rmtree(self.folder, ignore_errors=True)
        self.folder.mkdir(parents=True)
        self.log = self.folder / "log"
        run(["git", "clone", "--quiet", "--shared", "--no-checkout", SOURCE, self.source], self.log)
        run(["git", "-C", self.source, "checkout", "--quiet", "--detach", commit], self.log)
        for modules in SOURCE.glob("*/*/node_modules"):  # of npm, which tools/setup has fetched
            target = self.source / modules.relative_to(SOURCE)
            if target.parent.exists():
                target.symlink_to(modules)
        launcher = Path(__file__).resolve().with_name("timed")
        run(["cmake", "-S", self.source, "--preset", "release", "-B", self.build,
             f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}", f"-DCMAKE_CXX_LINKER_LAUNCHER={launcher}"],
            self.log, cwd=self.source)  # fmt: skip

    def targets(self, what):
        if what == "all":
            return []
        found = re.search(r"^demo_targets=\((.*)\)", (self.source / "tools/lib.sh").read_text(), re.MULTILINE)
        return ["--target", *(found[1] if found else DEMO_OF_OLDER_COMMITS).split()]

    def make(self, what):
        """Builds the demo's targets, or the rest of all."""
        begin = time.monotonic()
        words = ["cmake", "--build", self.build, "--parallel", str(os.cpu_count()), *self.targets(what)]
        environment = dict(os.environ, REHEARSE_BUILD_TIMES=str(self.times), CCACHE_DISABLE="1")
        seconds = run(words, self.log, env=environment)
        self.seconds[what] = seconds + (self.seconds["demo"] if what == "all" else 0.0)
        self.clock[what] = time.monotonic() - begin + (self.clock["demo"] if what == "all" else 0.0)
        print(f"{self.name}: {what}: {self.seconds[what]:.0f} s of processors, {self.clock[what]:.0f} s of the clock",
              file=sys.stderr)  # fmt: skip

    def units(self):
        """Processor seconds by output of the compiler and the linker."""
        units = collections.Counter()
        for line in self.times.read_text().splitlines():
            user, system, output = line.split(maxsplit=2)
            units[output] += float(user) + float(system)
        return units

    def other_outputs(self, units):
        """Seconds of the clock by output of the other commands, by ninja's log."""
        others = {}
        for line in (self.build / ".ninja_log").read_text().splitlines()[1:]:
            begin, end, _, output, _ = line.split("\t")
            if output not in units and not output.startswith("/"):
                others[output] = (int(end) - int(begin)) / 1000
        return others


def headers(build):
    """Seconds that clang takes to parse each header with all that it includes, and their counts, of the ten longest
    units."""
    commands = {}
    for entry in json.loads((build.build / "compile_commands.json").read_text()):
        commands[re.search(r" -o (\S+)", entry["command"])[1]] = entry
    units = [unit for unit, _ in build.units().most_common() if unit in commands][:10]
    traces = build.folder / "headers"
    traces.mkdir()
    seconds, counts = collections.Counter(), collections.Counter()
    for number, unit in enumerate(units):
        words, taken = [], shlex.split(commands[unit]["command"])
        taken = taken[next(i for i, word in enumerate(taken) if re.search(r"\+\+(-\d+)?$", word)) + 1 :]
        while taken:
            word = taken.pop(0)
            if word == "-o":
                taken.pop(0)
            elif word == "-include" and taken[0].endswith("cmake_pch.hxx"):
                # beside the original lies what gcc has made of it
                header = traces / f"{number}.hxx"
                shutil.copy(taken.pop(0), header)
                words += ["-include", header]
            elif not word.startswith(("-Winvalid-pch", "-Werror", "-femit-")):
                words.append(word)
        target = traces / f"{number}.o"
        run(["clang++", "-w", "-Wno-unknown-warning-option", "-Qunused-arguments", *words, "-ftime-trace",
             "-ftime-trace-granularity=1000", "-o", target], build.log, cwd=commands[unit]["directory"])  # fmt: skip
        of_unit = set()
        for event in json.loads(target.with_suffix(".json").read_text())["traceEvents"]:
            file = os.path.normpath(event.get("args", {}).get("detail", "")).removeprefix(f"{build.source}/")
            if event["name"] == "Source" and not file.endswith((".cpp", ".cxx")):
                seconds[file] += event["dur"] / 1e6
                of_unit.add(file)
        counts.update(of_unit)
    return units, seconds, counts


def write_costs(build, file):
    units = build.units()
    seconds = {output.removeprefix(f"{build.build}/"): value for output, value in units.items()}
    seconds.update(build.other_outputs(seconds))
    lines = sorted(f"{value:.1f} {output}\n" for output, value in seconds.items() if value >= 0.05 and output != "-")
    lines.sort(key=lambda line: line.split()[1])
    file.write_text("# Processor seconds of each output of a build, by which other builds estimate their time left.\n"
                    "# tools/bench --build --costs writes this file.\n" + "".join(lines))  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", nargs="?", choices=["demo", "all"], default="all")
    parser.add_argument("--headers", action="store_true")
    parser.add_argument("--costs", type=Path)
    asked = parser.parse_args()
    if not git("rev-parse", "HEAD"):
        raise Failure("a clone of git is needed, because two commits are built")
    if asked.headers and not shutil.which("clang++"):
        raise Failure("--headers needs clang++: tools/setup installs it")
    if asked.costs and asked.what != "all":
        raise Failure("--costs needs all units: leave out `demo`")
    if git("status", "--porcelain", "--untracked-files=no"):
        print("changes that aren't committed are left out", file=sys.stderr)
    now, base = Build("now", "HEAD"), None
    if git("cat-file", "-t", BASE) == "commit":
        base = Build("base", BASE)
    whats = ["demo"] if asked.what == "demo" else ["demo", "all"]
    for what in whats:
        for build in (now, base):
            if build:
                build.make(what)

    over = 0
    print(f"{'processor time of a build':<26} {'now [s]':>8} {'base [s]':>8} {'ratio':>6} {'at most':>7}")
    for what in whats:
        line = f"{what:<26} {now.seconds[what]:>8.0f}"
        if base:
            ratio = now.seconds[what] / base.seconds[what]
            is_over = ratio > BUDGETS[what]
            over += is_over
            line += f" {base.seconds[what]:>8.0f} {ratio:>6.3f} {BUDGETS[what]:>7.2f}{'  OVER' if is_over else ''}"
        print(line)
    if not base:
        print(f"Skipped: the figures of commit {BASE}, which this clone lacks; `git fetch --unshallow` fetches it.")
    units = now.units()
    print(f"\nof {len(units)} units with {sum(units.values()):.0f} s the longest [s]:")
    for unit, seconds in units.most_common(20):
        print(f"{seconds:>8.1f} {unit.removeprefix(f'{now.build}/')}")
    if asked.costs:
        write_costs(now, asked.costs)
    if asked.headers:
        longest, seconds, counts = headers(now)
        print(f"\nheaders in the {len(longest)} longest units, with all that they include, by clang [s], and in how many:")
        for file, value in seconds.most_common(25):
            print(f"{value:>8.1f} {counts[file]:>3} {file}")
    return 1 if over else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Failure as failure:
        sys.exit(f"error: {failure}")
