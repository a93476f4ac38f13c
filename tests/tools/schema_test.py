"""schema_test.py SOURCE BUILD: the JSON Schemas, by a validator of others (python3-jsonschema).

Each scenario, map and noise file of the repository must be valid. Of the files with one mistake each, those with a mistake
of shape must be invalid: an unknown key, a missing key, a value of another type or outside of its range. Each object that
a verb prints must be valid, and no longer be so with one more member or without one. Exit status 77: a package of Python is
missing.
"""

import collections
import json
import pathlib
import re
import subprocess
import sys
import tempfile

try:
    import jsonschema
    import yaml
except ImportError as missing:
    print(f"skipped: {missing} (tools/setup)")
    sys.exit(77)

import schema_outputs

source, build = (pathlib.Path(path).resolve() for path in sys.argv[1:3])
program = build / "bin/rehearse"
broken = source / "fixtures/broken"
failures = []


class Core(yaml.SafeLoader):
    """YAML 1.2's core schema, as editors read it: 1e-9 is a number, and yes a word."""


Core.yaml_implicit_resolvers = {}
for tag, expression, letters in (
    ("bool", r"true|false", "tf"),
    ("int", r"[-+]?[0-9]+", "-+0123456789"),
    ("float", r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", "-+.0123456789"),
    ("null", r"~|null|Null|NULL|", ["~", "n", "N", ""]),
):
    Core.add_implicit_resolver(f"tag:yaml.org,2002:{tag}", re.compile(f"^(?:{expression})$"), list(letters))
Core.add_constructor("tag:yaml.org,2002:int", lambda loader, node: int(node.value))
Core.add_constructor("tag:yaml.org,2002:float", lambda loader, node: float(node.value))
# in JSON, names of members are text
Core.add_constructor(
    "tag:yaml.org,2002:map",
    lambda loader, node: {str(key.value): loader.construct_object(value, deep=True) for key, value in node.value},
)


def load(file):
    return yaml.load(file.read_bytes(), Core)


def fail(text):
    failures.append(text)
    print(text)


def sentence(error):
    return f"{'/'.join(map(str, error.absolute_path))}: {error.message[:200]}"


def validators():
    found = {}
    for file in sorted((build / "share/rehearse/schemas").glob("*.json")):
        schema = json.loads(file.read_text())
        jsonschema.Draft202012Validator.check_schema(schema)
        found[file.stem] = jsonschema.Draft202012Validator(schema)
        printed = subprocess.run([program, "doc", "--schema", file.stem], capture_output=True, text=True, check=True)
        assert json.loads(printed.stdout) == schema, file
    return found


def kind_of(document):
    """The name of the schema of a file; none: it has no schema."""
    if not isinstance(document, dict):
        return None
    marks = {"rehearse": "scenario", "rehearse_map": "map", "noise": "noise"}
    return next((schema for mark, schema in marks.items() if mark in document), None)


def check_files(schemas):
    """All files of the repository that aren't there for their mistakes."""
    files = subprocess.run(["git", "ls-files", "*.yaml", "*.noise"], cwd=source, capture_output=True, text=True)
    names = files.stdout.split() or [str(file.relative_to(source)) for folder in ("fixtures", "golden", "tools", "tests")
                                     for ending in ("yaml", "noise") for file in (source / folder).rglob(f"*.{ending}")]
    counts = collections.Counter()
    for name in names:
        if "node_modules" in name or "fuzz/corpus" in name or name.startswith("fixtures/broken/"):
            continue
        document = load(source / name)
        kind = kind_of(document)
        if kind is None:
            continue
        counts[kind] += 1
        error = jsonschema.exceptions.best_match(schemas[kind].iter_errors(document))
        if error:
            fail(f"{name} isn't valid: {sentence(error)}")
    print("valid files:", dict(counts))
    assert counts["scenario"] >= 30 and counts["map"] >= 2 and counts["noise"] >= 3, counts


# Mistakes of shape, by the parser's message with its hint.
SHAPES = {
    "unknown key": r"unknown key '.*",
    "missing key": r".* has (no '\w+'|neither '\w+' nor '\w+') \| expected .*",
    "wrong type": r".* is (a list|a map|empty|the text '.*'|'.*') \| expected (a number|a whole number|true or false|a list|a map|text|"
    r"an angle|a rate|a color|a short name).*",
    "out of range": r".* is \S+ \| expected a (number|whole number) (from|above|at least).*",
}
# Those of them that depend on other values, or on the unit of a number: their files are valid.
BEYOND_SCHEMAS = {
    "unknown key": [],
    "missing key": ["fault_delayed_without_delay", "fault_heavier_without_mass", "fault_weak_without_effort", "heightmap_without_height",
                    "joint_without_axis", "shape_without_mass"],
    "wrong type": ["actuator_backlash_in_meters", "actuator_bandwidth_zero", "golden_state_zero", "light_angle_beyond"],
    "out of range": ["expect_no_such_magnitude", "joystick_trigger_negative"],
}
# How many of the scenarios with a mistake have one of each kind.
COUNTS = {"unknown key": 17, "missing key": 37, "wrong type": 68, "out of range": 47, "another mistake": 214}


def shape_of(text):
    return next((shape for shape, form in SHAPES.items() if re.fullmatch(form, text)), "another mistake")


def check_broken_scenarios(schemas):
    counts, beyond, others = collections.Counter(), {shape: [] for shape in SHAPES}, 0
    for file in sorted(broken.glob("scenario_*.yaml")):
        try:
            document = load(file)
        except (yaml.YAMLError, RecursionError):
            continue  # it is no YAML
        outcome = subprocess.run([program, "inspect", "--scenario", file, "--json"], capture_output=True, text=True)
        errors = [one for one in json.loads(outcome.stdout)["findings"] if one["severity"] == "error"]
        shape = shape_of(f"{errors[0]['message']} | {errors[0]['hint']}") if errors else "another mistake"
        counts[shape] += 1
        is_valid = schemas["scenario"].is_valid(document)
        if is_valid and shape in SHAPES:
            beyond[shape].append(file.stem.removeprefix("scenario_"))
        others += shape not in SHAPES and not is_valid
    print("scenarios with a mistake:", dict(counts), f"and of the other mistakes {others} are invalid, too")
    if beyond != BEYOND_SCHEMAS:
        fail(f"mistakes of shape that a schema doesn't find: {beyond}")
    if dict(counts) != COUNTS:
        fail(f"the table of mistakes is {dict(counts)}")


# Maps and noise floors with a mistake of shape; the others depend on a log, a model, or another key.
BROKEN_MAPS = """a_list a_scenario angles_in_turns another_version camera_interpolated camera_without_pictures clock_of_the_wall
commands_max_age commands_of_another_quantity commands_shift_of_seconds controller_delay controller_library controller_text
device_of_none empty imu_text imu_without_device joint_offset_with_unit joint_without_name joints_unknown_key joystick_axis_number
joystick_axis_unknown joystick_button_unknown joystick_buttons_list max_age_zero names_a_list no_time_step no_version
nothing_mapped renamed_a_topic restart_of_a_word sampling_unknown state_without_names tick_a_rate tick_grid_of_a_rate
tick_latency_of_a_word time_step_of_a_rate time_step_zero tolerance_of_nothing topic_a_list topic_missing unknown_key
velocity_unknown body_with_slash joints_empty""".split()
BROKEN_NOISE = ["negative", "of_an_unknown_level", "of_another_version", "without_recording"]


def check_broken(schema, kind, expected):
    invalid = []
    for file in sorted(broken.glob(f"{kind}_*")):
        try:
            if not schema.is_valid(load(file)):
                invalid.append(file.stem.removeprefix(f"{kind}_"))
        except yaml.YAMLError:
            continue
    if invalid != sorted(expected):
        fail(f"of the {kind} files, these differ: {sorted(set(invalid) ^ set(expected))}")


def check_outputs(schemas, folder):
    named = set()
    for name, words, value in schema_outputs.collect(program, source, folder):
        named.add(name)
        error = jsonschema.exceptions.best_match(schemas[name].iter_errors(value))
        if error:
            fail(f"the object of rehearse {' '.join(words)} isn't valid: {sentence(error)}")
            continue
        if not (build / "share/rehearse/schemas" / f"{name}.json").exists():
            fail(f"there is no schema {name}")
        for what, changed in schema_outputs.mutations(value):
            if schemas[name].is_valid(changed):
                fail(f"the schema {name} allows {what}: rehearse {' '.join(words)}")
    inputs = {"scenario", "map", "tolerances", "noise"}
    missing = set(schemas) - named - inputs
    if missing:
        fail(f"no object was validated of {sorted(missing)}")
    print("validated objects:", len(named))


def check_new_project(folder):
    """The line for editors in the scenario of a new project names a file that exists."""
    subprocess.run([program, "new", "project"], cwd=folder, check=True, capture_output=True)
    first = (folder / "project/scenarios/hold.yaml").read_text().splitlines()[0]
    schema = re.fullmatch(r"# yaml-language-server: \$schema=(/.*)", first)
    if not schema or not pathlib.Path(schema[1]).is_file():
        fail(f"a new scenario begins with: {first}")


def main():
    schemas = validators()
    check_files(schemas)
    check_broken_scenarios(schemas)
    check_broken(schemas["map"], "map", BROKEN_MAPS)
    check_broken(schemas["noise"], "noise", BROKEN_NOISE)
    with tempfile.TemporaryDirectory(prefix="rehearse_schemas_") as folder:
        check_outputs(schemas, pathlib.Path(folder))
        check_new_project(pathlib.Path(folder))
    return 1 if failures else 0


sys.exit(main())
