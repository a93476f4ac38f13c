"""Scenarios of the arm with controllers in Python, each written for a test."""

from pathlib import Path

SCENARIO = """rehearse: 1
duration: {duration}
bodies:
  - name: Arm
    model: {model}
    joints: {{SHOULDER: -45 deg}}
    controllers:
      - {{name: Hold, library: '{library}', options: '{options}'}}
"""

HOLD = """import rehearse


class Hold(rehearse.Controller):
    def initialize(self, io):
        self.io = io
        self.shoulder = io.joint("SHOULDER")
        self.shoulder.read("q", "dq")
        self.shoulder.command("u")
        self.target = self.shoulder.q

    def control(self):
        tick = round(self.io.time / self.io.time_step)
        {body}
        self.shoulder.u = 60.0 * (self.target - self.shoulder.q) - 6.0 * self.shoulder.dq
"""


def scenario(model: Path, library: str = "hold.py:Hold", duration: float = 0.2, options: str = "") -> str:
    Path("hold.yaml").write_text(SCENARIO.format(model=model, library=library, duration=duration, options=options))
    return "hold.yaml"


def hold(body: str = "pass", file: str = "hold.py") -> None:
    """Writes a controller; its control() does this first, where `tick` is the number of the step."""
    Path(file).write_text(HOLD.format(body=body))
