"""The objects that verbs print with --json: each command of a list prints one that is valid, and that has no member
without a row."""

import copy
import json
import os
import pathlib
import re
import shutil
import subprocess


class Outputs:
    """Runs commands in a folder, and collects what they print by the name of its schema."""

    def __init__(self, program, folder):
        self.program, self.folder = program, folder
        self.objects = []  # (name of the schema, words, object)

    def run(self, schema, *words, lines=False):
        """Runs `rehearse WORDS --json`, and keeps its object, or the object of each line."""
        words = [str(word) for word in words]
        outcome = subprocess.run([self.program, *words, "--json"], cwd=self.folder, capture_output=True, text=True)
        assert outcome.stdout.startswith("{"), f"rehearse {' '.join(words)} prints no object: {outcome.stderr}"
        texts = outcome.stdout.splitlines() if lines else [outcome.stdout]
        for text in texts:
            self.objects.append((schema, words, json.loads(text)))
        return self.objects[-1][2]


def objects_in(value, path=()):
    """All objects inside a value, with their paths."""
    if isinstance(value, dict):
        yield path, value
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        yield from objects_in(inner, (*path, key))


def at(value, path):
    for key in path:
        value = value[key]
    return value


# Members of the outermost object that are there only sometimes.
OPTIONAL = {"alignment", "replayed", "report", "kept_failures", "slurm", "first", "costs"}


def mutations(value):
    """The value with one more member in an object of each kind, and without each member of the outermost."""
    for path, _ in objects_in(value):
        if path[:1] == ("message",):  # of a log's own type
            continue
        if any(isinstance(key, int) and key > 0 for key in path):
            continue
        changed = copy.deepcopy(value)
        at(changed, path)["a_new_member"] = []
        yield f"a new member at {'/'.join(map(str, path)) or 'the top'}", changed
    for name in value:
        if name in OPTIONAL:
            continue
        yield f"no '{name}'", {key: inner for key, inner in value.items() if key != name}


CAMPAIGN = """rehearse: 1
duration: 0.2
bodies:
  - {name: Box, box: {size: [1, 1, 1]}, mass: 2, position: [0, 0, 1], velocity: {linear: [0, 0, 0.001]}}
expect:
  - {channel: Box/Box/position/z, above: 0.85, at: end}
vary:
  speed: {path: "bodies.Box.velocity.linear[2]", uniform: [-0.5, 0.5]}
  height: {path: "bodies.Box.position[2]", uniform: [0.9, 1.1]}
pass_rate: {at_least: 0.5}
sometimes: {low: "Box/Box/position/z < 0.7"}
"""


def collect_campaign(outputs):
    run = outputs.run
    run("sweep", "sweep", "box.yaml", "--cases", 12, "--seed", 1, "-o", "boxes")
    run("sweep", "sweep", "status", "boxes")
    run("sweep", "sweep", "resume", "boxes")
    run("sweep", "sweep", "report", "boxes")
    run("sweep", "sweep", "report", "boxes", "--against", "boxes", "--margin", "0.1")
    results = [json.loads(line) for line in (outputs.folder / "boxes/results.jsonl").read_text().splitlines()]
    failed = next(result["case"] for result in results if result["verdict"] == "violated")
    run("sweep-case", "sweep", "case", failed, "boxes", "-o", "case.mcap")
    run("sweep-shrink", "sweep", "shrink", failed, "boxes", "-o", "small.yaml")
    run("sweep-towards", "sweep", "box.yaml", "--cases", 6, "--towards", "Box/Box/position/z above 0.85 m at the end",
        "--rounds", 2, "--estimate", 8, "-o", "steered")
    run("sweep", "sweep", "status", "absent")


def collect_fuzz(outputs):
    """A fuzz test with a finding."""
    program = pathlib.Path(outputs.program).parent / "planted_fuzz"
    (outputs.folder / "fuzzed").mkdir()
    (outputs.folder / "fuzzed/CTestTestfile.cmake").write_text(
        f'add_test(Planted.ComparesFloats "{program}" "--gtest_filter=Planted.ComparesFloats")\n')
    for runs in (1600, 1616):
        outputs.run("fuzz", "fuzz", "Planted.ComparesFloats", "--build", "fuzzed", "--runs", runs)
    outputs.run("fuzz", "fuzz", "Planted.Absent", "--build", "fuzzed")


# A rod on a motor, at rest and moved.
ROD = """<robot name="Rod"><link name="BASE"/><joint name="HINGE" type="continuous"><parent link="BASE"/><child
link="ROD"/><axis xyz="0 1 0"/></joint><link name="ROD"><inertial><origin xyz="0 0 -0.3"/><mass value="1"/>
<inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.002"/></inertial></link></robot>"""
SWING = """rehearse: 1
duration: 1
bodies:
  - name: Rod
    model: rod.urdf
    fixed: true
    joints: {HINGE: 1}
    controllers: [{name: Shake, library: Shaker}]
    actuators: [{joint: HINGE, damping: 0.1, velocity_gain: 0.1}]
noise:
  - {joint: "Rod/*", displacement: {stddev: 0.0005}, velocity: {stddev: 0.01}}
"""


def collect_fits(outputs):
    """A fit that finds a number, one that finds none, and wear."""
    run, folder = outputs.run, outputs.folder
    controllers = pathlib.Path(outputs.program).parents[1] / "tests/controllers"
    (folder / "rod.urdf").write_text(ROD)
    for name, damping in (("earlier", 0.1), ("later", 0.2)):
        text = SWING.replace("Shaker}", f"{controllers}/Shaker.so}}").replace("damping: 0.1", f"damping: {damping}")
        (folder / f"{name}.yaml").write_text(text)
        run("record", "record", f"{name}.yaml", "-o", f"{name}.mcap")
    damping, gain = "bodies.Rod.actuators[0].damping", "bodies.Rod.actuators[0].velocity_gain"
    run("fit", "fit", "later.mcap", "--scenario", "earlier.yaml", "--vary", damping, "--judge", "earlier.mcap", "-o",
        "fitted.yaml")
    run("fit", "fit", "later.mcap", "--scenario", "earlier.yaml", "--vary", damping, gain)
    run("fit-wear", "fit", "--wear", "earlier.mcap", "later.mcap", "--scenario", "earlier.yaml", "--vary", damping)
    run("fit-wear", "fit", "--wear", "earlier.mcap", "later.mcap", "--scenario", "earlier.yaml", "--vary", damping, gain)
    run("fit", "fit", "later.mcap", "--scenario", "earlier.yaml", "--vary", "duration.nothing")


def collect_goldens(outputs, fixtures, golden):
    """A project whose controller has changed: its golden is reviewed, rejected, accepted."""
    run, folder = outputs.run, outputs.folder
    name = "Spring.SwingsWithItsNaturalFrequency"
    for file in golden.glob(name + ".*"):
        shutil.copy(file, folder / "golden")
    text = (fixtures / "scenarios/spring.yaml").read_text().replace("../models", str(fixtures / "models"))
    assert "stiffness: 80" in text
    (folder / "stiff.yaml").write_text(text.replace("stiffness: 80", "stiffness: 90"))
    history = ["--history", "history.jsonl", "--commit", "abcdef0123", "--date", "2026-01-01"]
    run("check", "check", "stiff.yaml", *history)
    run("check", "check", "stiff.yaml", "box.yaml", fixtures / "broken/scenario_unknown_key.yaml", *history)
    for line in (folder / "history.jsonl").read_text().splitlines():
        outputs.objects.append(("history-line", ["a line of a history"], json.loads(line)))
    run("history", "history", "history.jsonl")
    run("golden-list", "golden", "list")
    for verb in ("reject", "accept"):
        subprocess.run([outputs.program, "check", "stiff.yaml"], cwd=folder, env={**os.environ, "REHEARSE_GOLDEN": ""},
                       capture_output=True)
        run("golden-review", "golden", "review")
        run(f"golden-{verb}", "golden", verb, name)
        run(f"golden-{verb}", "golden", verb, "Absent.One")
    if shutil.which("valgrind"):
        subprocess.run([outputs.program, "check", "stiff.yaml", "--instructions"], cwd=folder,
                       env={**os.environ, "REHEARSE_GOLDEN": "accept", "CI": ""}, capture_output=True)
        run("instructions", "check", "stiff.yaml", "--instructions")
        counts = folder / "golden" / f"{name}.instructions"
        counts.write_text(re.sub(r"\[5, [0-9]+\]", "[5, 1]", counts.read_text()))
        run("instructions", "check", "stiff.yaml", "--instructions")
    run("golden-noise", "golden", "noise", "stiff.yaml")
    run("golden-prune", "golden", "prune", "--no-tests")


def collect_log(outputs, fixtures, golden):
    run = outputs.run
    log, model = golden / "Tank.IsDrivenByJoystick.mcap", fixtures / "models/tank.urdf"
    subprocess.run([outputs.program, "map", log, "--model", model, "-o", "tank.map.yaml"], cwd=outputs.folder, check=True,
                   capture_output=True)
    run("replay-log", "replay", log, "--controller", "TankController", "--model", model, "--map", "tank.map.yaml")
    run("replay-log", "replay", log, "--controller", "TankController", "--model", model, "--map",
        fixtures / "broken/map_unknown_key.yaml")


FLOWN = """rehearse: 1
duration: 0.1
bodies:
  - name: Walker
    model: pendulum.urdf
    fixed: true
    controllers: [{name: Walk, library: GUEST, delay: false}]
"""


def collect_flight(outputs, fixtures):
    """A robot's loop, recorded by a tap."""
    model, programs, tap = outputs.folder / "pendulum.urdf", outputs.program.parent, f"schemas-{os.getpid()}"
    model.write_text((fixtures / "models/pendulum.urdf").read_text().replace('"imu"', '"Imu"', 1))  # as the loop names it
    guest = next((programs.parent / "tests/tools").glob("**/tap_GUEST.so"))
    (outputs.folder / "flown.yaml").write_text(FLOWN.replace("GUEST", str(guest)))
    subprocess.run([programs / "tap_loop", tap, model, "100", "hinge"], check=True)
    subprocess.run([outputs.program, "tap", tap, "--recover", "-o", "flight.mcap"], cwd=outputs.folder, check=True,
                   capture_output=True)
    outputs.run("check-flight", "check", "flown.yaml", "--flight", "flight.mcap")


def collect(program, source, folder):
    """The objects of every verb, as they are printed for the fixtures."""
    outputs = Outputs(program, folder)
    run = outputs.run
    fixtures, golden = source / "fixtures", source / "golden"
    spring, swing = fixtures / "scenarios/spring.yaml", golden / "Spring.SwingsWithItsNaturalFrequency.mcap"
    standing = golden / "SR1.StandsUnderItsMinimumController.mcap"
    run("record", "record", spring, "-o", "spring.mcap", "--verify")
    run("record", "record", fixtures / "scenarios/sr1_standing.yaml", "-o", "sr1.mcap", "--duration", "0.05", "--realtime")
    run("record-branch", "record", "--from-checkpoint", "spring.mcap@tick:100", "-o", "branch.mcap")
    run("record", "record", fixtures / "broken/scenario_unknown_key.yaml", "-o", "broken.mcap")
    run("check", "check", spring, "--golden", swing)
    run("check", "check", fixtures / "broken/scenario_unknown_key.yaml")
    (folder / "golden").mkdir()
    (folder / "box.yaml").write_text(CAMPAIGN)
    collect_goldens(outputs, fixtures, golden)
    collect_campaign(outputs)
    collect_fuzz(outputs)
    collect_fits(outputs)
    run("replay", "replay", standing)
    run("replay-tick", "replay", standing, "--tick", "10")
    run("replay-watch", "replay", standing, "--watch", "SR1/WAIST/*", "--until", "0.01", lines=True)
    run("replay-when", "replay", standing, "--when", "SR1/RLEG_KNEE/u > 0", lines=True)
    run("cat", "cat", standing, "--limit", "20", lines=True)
    run("diff", "diff", swing, swing)
    run("diff", "diff", swing, "spring.mcap")
    run("diff", "diff", swing, standing)
    run("audit", "audit", standing)
    run("coverage", "audit", standing, "--coverage")
    if shutil.which("gdb"):
        run("beside", "replay", standing, "--until", "0.01", "--beside", "SR1MinimumController")
    run("info", "info", swing)
    run("report", "report", swing, "-o", "report.html")
    run("export", "export", swing, "-o", "tables")
    run("export", "export", swing, "--viewer", "foxglove", "-o", "viewer.mcap")
    run("doctor", "doctor", swing)
    run("doctor", "doctor", fixtures / "broken/mcap_nothing.mcap")
    run("recover", "recover", swing, "-o", "whole.mcap")
    run("filter", "filter", swing, "-o", "part.mcap", "--until", "1")
    run("merge", "merge", swing, swing, "-o", "both.mcap", "--keep-apart")
    run("inspect", "inspect", fixtures / "models/sr1.urdf")
    run("inspect", "inspect", "--scenario", fixtures / "scenarios/rover.yaml")
    run("inspect", "inspect", "absent.urdf")
    collect_log(outputs, fixtures, golden)
    run("import", "import", fixtures / "projects/wagon.cnoid", "-o", "imported")
    collect_flight(outputs, fixtures)
    return outputs.objects
