"""stoop.cpp in Python."""

import rehearse

STIFFNESS = 8000.0  # [N·m/rad]
ARM_STIFFNESS = 3000.0  # [N·m/rad]
DAMPING = 100.0  # [N·m·s/rad]
SMOOTHING = 0.2  # of the velocity filter, per step


class Leg:
    def __init__(self, joint):
        joint.read("q")
        joint.command("u")
        name = joint.name
        self.joint = joint
        self.stiffness = ARM_STIFFNESS if "ARM" in name else STIFFNESS
        self.bend = 2.0 if "KNEE" in name else -1.0 if "HIP_P" in name or "ANKLE_P" in name else 0.0
        self.start = self.before = joint.q
        self.velocity = 0.0


class Stoop(rehearse.Controller):
    def initialize(self, io):
        self.io = io
        self.depth = float(io.options)
        self.legs = [Leg(joint) for joint in io.joints]
        self.tick = self.phase = 0

    def control(self):
        if self.phase == 0 and self.tick == 100:
            self.phase = 1
        if self.phase == 1 and self.tick == 400:
            self.phase = 2
        share = 0.0 if self.phase == 0 else (self.tick - 100) / 300.0 if self.phase == 1 else 1.0
        self.io.variable("phase", self.phase)
        for leg in self.legs:
            q = leg.joint.q
            target = leg.start + self.depth * leg.bend * share
            leg.velocity += SMOOTHING * ((q - leg.before) / self.io.time_step - leg.velocity)
            leg.before = q
            leg.joint.u = leg.stiffness * (target - q) - DAMPING * leg.velocity
        self.tick += 1
