#!/usr/bin/env bash
# pip_test.sh SOURCE BUILD WORK: installs the module by pip into a virtual environment, offline, from a build that is there;
# uses it; removes it, and looks for what is left.
set -euo pipefail

source=$1 build=$2 work=$3
rm -rf "$work"
mkdir -p "$work"
cd "$work"
unset PYTHONPATH CMAKE_PREFIX_PATH
/usr/bin/python3 -m venv --system-site-packages environment # numpy is Debian's
find environment -not -name '*.pyc' | sort > before
pip=environment/bin/pip
$pip install --quiet --no-index --no-build-isolation "$source/tools/python" --config-settings "build=$build"
environment/bin/rehearse --version
cat > damp.py << 'END'
import rehearse


class Damp(rehearse.Controller):
    def initialize(self, io):
        self.hinge = io.joint("hinge")
        self.hinge.read("dq")
        self.hinge.command("u")

    def control(self):
        self.hinge.u = -0.4 * self.hinge.dq
END
cat > damp.yaml << END
rehearse: 1
duration: 1
bodies:
  - name: Pendulum
    model: $source/fixtures/models/pendulum.urdf
    joints: {hinge: 20 deg}
    controllers: [{library: damp.py:Damp}]
END
environment/bin/python - << 'END'
import rehearse

assert rehearse.command().endswith("environment/bin/rehearse"), rehearse.command()
run = rehearse.record("damp.yaml", "damp.mcap")
assert run.failure is None and run.ticks == 1000
trace = rehearse.Trace("damp.mcap")
print(trace, trace["Pendulum/hinge/q"].min())
assert rehearse.replay("damp.mcap").equal
END
environment/bin/python -m pytest --help > help
grep -q rehearse_golden help # the plugin
$pip uninstall --quiet --yes rehearse
find environment -not -name '*.pyc' -not -name __pycache__ | sort > after
if comm -13 before after | grep -i rehearse; then
  echo "pip left these behind"
  exit 1
fi
