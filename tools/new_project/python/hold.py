"""Holds the arm at the angle where it starts, or at the one in its options [rad], against gravity and pushes."""

import rehearse

STIFFNESS = 60.0  # [N·m/rad]
DAMPING = 6.0  # [N·m·s/rad]


class Hold(rehearse.Controller):
    def initialize(self, io):
        self.shoulder = io.joint("SHOULDER")
        self.shoulder.read("q", "dq")
        self.shoulder.command("u")
        options = io.options.split()
        self.target = float(options[0]) if options else self.shoulder.q  # [rad]

    def control(self):
        self.shoulder.u = STIFFNESS * (self.target - self.shoulder.q) - DAMPING * self.shoulder.dq
