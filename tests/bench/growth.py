"""tests/bench/growth.py BUILD [--json FILE] [--small]: measures how time and memory of verbs grow; tools/bench --growth
runs it.

Each curve has three sizes. The exponent is that of the power law through the last two: 1 is linear growth, 0 none. A
curve's bounds apply to its largest size, in a table of MB, of exponents of time, or of the ratio of two times. Exit 1: a
value is above its bound. --small: a hundredth of each size, so that a test sees every curve at work.
"""

import argparse
import json
import math
import os
import struct
import sys
import tempfile
import time
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]


class Failure(Exception):
    """A command that ended with an unexpected status."""


class Bench:
    """Commands in a scratch folder, with their time [s] and their largest memory [MB]."""

    def __init__(self, build: Path, folder: Path):
        self.rehearse = build / "bin/rehearse"
        self.folder = folder
        self.environment = dict(
            os.environ,
            REHEARSE_CONTROLLER_PATH=f"{build}/lib/rehearse/controllers:{build}/tests/bench",
            XDG_CACHE_HOME=str(folder / "cache"),
            NO_COLOR="1",
        )
        # goldens are written here, which CI is refused
        self.environment.pop("CI", None)

    def run(self, *words, statuses=(0,), environment=None, folder="."):
        """Runs `rehearse WORDS`; returns (seconds, megabytes) of it and of the processes that it waited for."""
        log = self.folder / "log"
        begin = time.monotonic()
        child = os.fork()
        if child == 0:
            out = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
            os.dup2(out, 1)
            os.dup2(out, 2)
            os.chdir(self.folder / folder)
            os.execve(self.rehearse, ["rehearse", *map(str, words)], dict(self.environment, **(environment or {})))
        _, status, usage = os.wait4(child, 0)
        seconds = time.monotonic() - begin
        if os.waitstatus_to_exitcode(status) not in statuses:
            raise Failure(f"rehearse {' '.join(map(str, words))}: {log.read_text(errors='replace')[-2000:]}")
        return seconds, usage.ru_maxrss * 1024 / 1e6

    def write(self, name, text):
        path = self.folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path


def pendulum(ticks, name="pendulum", controller="PendulumSwingUpController", golden=None):
    """A scenario of so many ticks of a millisecond."""
    model = SOURCE / "fixtures/models/inverted_pendulum.urdf"
    return (
        f"rehearse: 1\nname: {name}\n"
        + (f"golden: {golden}\n" if golden else "")
        + f"duration: {ticks / 1000}\nbodies:\n  - name: Pendulum\n    model: {model}\n    controllers:\n"
        f"      - {{name: C, library: {controller}}}\n"
    )


def ticks(bench, n):
    """A pendulum of n ticks: recorded, replayed, compared, reported, proved."""
    # the model's controller wants steps of 5 ms
    scenario = pendulum(n, golden="G.R").replace("rehearse: 1\n", "rehearse: 1\ntime_step: 0.005\n")
    scenario = scenario.replace(f"duration: {n / 1000}", f"duration: {n * 0.005:g}")
    bench.write(f"p{n}/fixtures/scenarios/pendulum.yaml", scenario)
    bench.write(f"p{n}/golden/.keep", "")
    yaml = f"p{n}/fixtures/scenarios/pendulum.yaml"
    yield "record", bench.run("record", yaml, "-o", "a.mcap")
    yield "replay", bench.run("replay", "a.mcap")
    yield "diff of equal traces", bench.run("diff", "a.mcap", "a.mcap")
    yield "report", bench.run("report", "a.mcap", "-o", "report.html")
    yield "report beside a golden", bench.run("report", "a.mcap", "a.mcap", "-o", "report.html")
    late = f"a.mcap@{(n - 10) * 0.005:g}s"
    yield "branch from its end", bench.run("record", "--from-checkpoint", late, "-o", "branch.mcap")
    bench.run("check", yaml, environment={"REHEARSE_GOLDEN": "new"}, statuses=(0, 1))
    bench.run("check", yaml)  # the first check simulates
    yield "check, proved", bench.run("check", yaml)


def lines(bench, n):
    """A controller that writes n lines, ten a tick."""
    yaml = bench.write("lines.yaml", pendulum(n // 10, name="lines", controller="chatty"))
    bench.run("record", yaml, "-o", "lines.mcap")
    yield "info --full", bench.run("info", "--full", "lines.mcap")
    yield "diff", bench.run("diff", "lines.mcap", "lines.mcap")
    yield "report", bench.run("report", "lines.mcap", "-o", "lines.html")
    yield "report beside a golden", bench.run("report", "lines.mcap", "lines.mcap", "-o", "lines2.html")


def scenarios(bench, n):
    """A project of n scenarios, all proved."""
    for i in range(n):
        text = pendulum(100, name=f"s{i}", golden=f"S.{i}")
        text = text.replace("rehearse: 1\n", "rehearse: 1\ntime_step: 0.005\n")
        bench.write(f"q{n}/fixtures/scenarios/s{i}.yaml", text)
    bench.write(f"q{n}/golden/.keep", "")
    bench.run("check", folder=f"q{n}", environment={"REHEARSE_GOLDEN": "new"}, statuses=(0, 1))
    bench.run("check", folder=f"q{n}")
    yield "check -j1", bench.run("check", "-j1", folder=f"q{n}")
    yield "check -j2", bench.run("check", "-j2", folder=f"q{n}")


def ball(path, triangles):
    """A closed ball of about so many triangles, as binary STL. Another process makes it: a command's largest memory
    includes that of its parent at its start."""
    child = os.fork()
    if child == 0:
        write_ball(path, triangles)
        os._exit(0)
    os.waitpid(child, 0)


def write_ball(path, triangles):
    rings = max(3, round(math.sqrt(triangles / 4)))
    around = 2 * rings

    def vertex(ring, step):
        polar, turn = math.pi * ring / rings, 2 * math.pi * step / around
        return (
            math.sin(polar) * math.cos(turn) if 0 < ring < rings else 0.0,
            math.sin(polar) * math.sin(turn) if 0 < ring < rings else 0.0,
            math.cos(polar),
        )

    corners = [[struct.pack("<3f", *vertex(r, s % around)) for s in range(around + 1)] for r in range(rings + 1)]
    faces = []
    for r in range(rings):
        for s in range(around):
            a, b, c, d = corners[r][s], corners[r + 1][s], corners[r + 1][s + 1], corners[r][s + 1]
            if r + 1 < rings:
                faces.append(a + b + c)
            if r > 0:
                faces.append(a + c + d)
    with open(path, "wb") as file:
        file.write(b"ball".ljust(80) + struct.pack("<I", len(faces)))
        for face in faces:
            file.write(bytes(12) + face + bytes(2))


def triangles(bench, n):
    """A mesh of n triangles that touches the floor: its convex hull is made, then read."""
    ball(bench.folder / f"ball{n}.stl", n)
    mesh = f'<geometry><mesh filename="ball{n}.stl"/></geometry>'
    inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    bench.write(
        f"ball{n}.urdf",
        f'<robot name="ball"><link name="ball"><inertial><mass value="1"/>{inertia}</inertial>'
        f"<collision>{mesh}</collision></link></robot>",
    )
    yaml = bench.write(f"ball{n}.yaml", f"rehearse: 1\nduration: 0.001\nbodies: [{{name: B, model: ball{n}.urdf}}]\n")
    yield "first load", bench.run("record", yaml, "-o", "ball.mcap")
    yield "second load", bench.run("record", yaml, "-o", "ball.mcap")


def boxes(bench, n):
    """A pile of n boxes in the 50 ticks after they have met; then, if they may sleep, in ticks in which they do."""
    side = 6
    items = ["{name: Floor, box: {size: [20, 20, 0.2]}, fixed: true, position: [0, 0, -0.1]}"]
    for i in range(n):
        x, y, z = i % side, i // side % side, i // (side * side)
        items.append(
            f"{{name: B{i}, box: {{size: [0.2, 0.2, 0.2]}}, mass: 1, "
            f"position: [{0.21 * x + 0.05 * (z % 2)}, {0.21 * y}, {0.1 + 0.2 * z}]}}"
        )
    text = "rehearse: 1\nduration: DURATION\nSOLVERbodies:\n" + "".join(f"  - {item}\n" for item in items)

    def tick(solver, begin, ticks):
        """The mean time of some ticks from the `begin`-th on."""
        seconds = []
        for last in (begin, begin + ticks):
            bench.write("pile.yaml", text.replace("DURATION", f"{last / 1000}").replace("SOLVER", solver))
            taken, memory = bench.run("record", "pile.yaml", "-o", "pile.mcap")
            seconds.append(taken)
        return max(seconds[1] - seconds[0], 1e-6) / ticks, memory

    yield "a tick", tick("", 1, 50)
    yield "a tick, asleep", tick("solver: {sleep_after: 0.02}\n", 200, 50)


# Curve: sizes, and the bounds of its largest size by verb: MB, exponent of time, and if it has one, the ratio of its time
# to that of another verb. None: not bounded. Exponents and ratios have room for other load on the machine.
CURVES = {
    ticks: ((10_000, 100_000, 1_000_000), {
        "record": (100, 1.3), "replay": (100, 1.3), "diff of equal traces": (100, 1.3),
        "report": (120, 1.3), "report beside a golden": (120, 1.3),
        "branch from its end": (120, 1.3, "replay", 2.5), "check, proved": (100, 1.3),
    }),
    lines: ((10_000, 100_000, 1_000_000), {
        "info --full": (100, 1.3), "diff": (100, 1.3), "report": (100, 1.3),
        "report beside a golden": (100, 1.3),
    }),
    scenarios: ((50, 200, 1000), {"check -j1": (60, 1.3), "check -j2": (60, 1.3, "check -j1", 0.8)}),
    triangles: ((10_000, 100_000, 1_000_000), {"first load": (500, 1.3), "second load": (200, 1.3)}),  # first: aimed at 200
    boxes: ((100, 300, 900), {"a tick": (None, None), "a tick, asleep": (None, None)}),
}  # fmt: skip


def exponent(a, b, of_a, of_b):
    """The power p with of ~ size^p between two sizes."""
    return math.log(of_b / of_a) / math.log(b / a)


def measure(build, small):
    """Yields (curve, verb, sizes, seconds, megabytes)."""
    for curve, (sizes, _) in CURVES.items():
        sizes = [max(1, size // 100) for size in sizes] if small else sizes
        values = {}
        with tempfile.TemporaryDirectory(prefix="rehearse_growth_") as scratch:
            for size in sizes:
                for verb, value in curve(Bench(build, Path(scratch)), size):
                    values.setdefault(verb, []).append(value)
        for verb, of_sizes in values.items():
            yield curve.__name__, verb, sizes, [v[0] for v in of_sizes], [v[1] for v in of_sizes]


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("build", type=Path)
    options.add_argument("--json", type=Path, help="also write the curves to this file")
    options.add_argument("--small", action="store_true")
    asked = options.parse_args()
    curves, over, times = [], 0, {}
    print(f"{'of':<10} {'curve':<24} {'n':>9} {'s':>9} {'MB':>7} {'at most':>7} {'exponent':>8} {'at most':>7}")
    for name, verb, sizes, seconds, megabytes in measure(asked.build.resolve(), asked.small):
        curves.append({"of": name, "verb": verb, "n": sizes})
        curves[-1]["seconds"] = [float(f"{s:.3g}") for s in seconds]
        curves[-1]["megabytes"] = [round(mb) for mb in megabytes]
        bounds = next(bounds for curve, (_, bounds) in CURVES.items() if curve.__name__ == name)
        most, steepest, *of_other = bounds[verb]
        times[verb] = seconds[-1]
        power = exponent(sizes[-2], sizes[-1], seconds[-2], seconds[-1])
        is_over = not asked.small and ((most and megabytes[-1] > most) or (steepest and power > steepest))
        ratio = ""
        if of_other:
            other, limit = of_other
            value = seconds[-1] / times[other]
            ratio = f"  {value:.2f} of {other}, at most {limit}"
            is_over = is_over or (not asked.small and value > limit)
        over += bool(is_over)
        for n, s, mb in list(zip(sizes, seconds, megabytes))[:-1]:
            print(f"{name:<10} {verb:<24} {n:>9} {s:>9.3f} {mb:>7.0f}")
        print(f"{name:<10} {verb:<24} {sizes[-1]:>9} {seconds[-1]:>9.3f} {megabytes[-1]:>7.0f} {most or '-':>7} "
              f"{power:>8.2f} {steepest or '-':>7}{ratio}{'  OVER' if is_over else ''}", flush=True)
    if asked.json:
        asked.json.write_text("[\n " + ",\n ".join(map(json.dumps, curves)) + "\n]\n")
    return 1 if over else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except Failure as failure:
        sys.exit(f"error: {failure}")
