"""tests/bench/instructions.py BUILD [--most COUNT]: counts the instructions of a recorded tick of SR1, by callgrind.

They don't depend on the load of the machine. Two recordings of different length are counted; the difference is that of
the ticks alone. Exit 1: beside its step (World::actuate and World::step) a tick has more than COUNT.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
TICKS = (200, 1200)
TICK, STEP = "rehearse::Run::step()", "rehearse::step_world("
PARTS = {
    "read the world": "rehearse::World::sense() const",
    "hash its state": "rehearse::World::state_hash() const",
    "record": ("rehearse::RecordingSink::begin_tick(", "rehearse::RecordingSink::emit("),
    "call the controller": "rehearse::ControllerHost::control()",
}


def recorded(build, folder, ticks):
    """Inclusive instructions by function of a recording of so many ticks."""
    counts = folder / f"{ticks}"
    counts.mkdir()
    scenario = SOURCE / "fixtures/scenarios/sr1_minimum.yaml"
    text = scenario.read_text().replace("../models", str(SOURCE / "fixtures/models"))
    text = re.sub(r"^cameras:.*$", "cameras: none", text, flags=re.MULTILINE)
    (folder / "sr1.yaml").write_text(text)
    environment = dict(
        os.environ, REHEARSE_CONTROLLER_PATH=f"{build}/lib/rehearse/controllers", XDG_CACHE_HOME=str(folder / "cache")
    )
    words = [build / "bin/rehearse", "record", folder / "sr1.yaml", "-o", counts / "run.mcap"]
    callgrind = ["valgrind", "--tool=callgrind", "--trace-children=yes", f"--callgrind-out-file={counts}/%p.out"]
    duration = ["--duration", f"{ticks / 1000:g}"]
    subprocess.run([*callgrind, *words, *duration], env=environment, check=True, capture_output=True)
    largest = max(counts.glob("*.out"), key=lambda file: file.stat().st_size)  # others are of short-lived children
    annotate = ["callgrind_annotate", "--inclusive=yes", "--threshold=100", "--auto=no", "--tree=none", largest]
    lines = subprocess.run(annotate, check=True, capture_output=True, text=True).stdout.splitlines()
    found = (re.match(r"\s*([\d,]+)\s*\([^)]*\)\s+[^:]*:(rehearse::.*)$", line) for line in lines)
    return {match[2]: int(match[1].replace(",", "")) for match in found if match}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=Path)
    parser.add_argument("--most", type=int)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        few, many = (recorded(arguments.build.resolve(), Path(folder), ticks) for ticks in TICKS)

    def per_tick(names):
        prefixes = (names,) if isinstance(names, str) else names
        less, more = (sum(n for name, n in run.items() if name.startswith(prefixes)) for run in (few, many))
        if more <= less:
            sys.exit(f"callgrind saw no {' or '.join(prefixes)}")
        return (more - less) / (TICKS[1] - TICKS[0])

    step = per_tick(STEP)
    beside = per_tick(TICK) - step
    print(f"a tick beside its step: {beside:.0f} instructions; the step: {step:.0f}")
    for part, names in PARTS.items():
        print(f"  {part}: {per_tick(names):.0f}")
    return 1 if arguments.most is not None and beside > arguments.most else 0


if __name__ == "__main__":
    sys.exit(main())
