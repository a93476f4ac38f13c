#!/usr/bin/env python3
"""closed_form.py RECORDING: the efforts of chain_run.yaml are those of a ramp and a PI controller, written here anew."""
import subprocess
import sys

begin, rise, goal = 0.1, 0.5, 0.2  # of the trajectory: its message [s], its duration [s], the angle [rad]
p, i, step = 900.0, 40.0, 0.001    # the gains, and the cycle [s]
most = 1e-12                       # relative to the largest effort


def series(name):
    topic = "/Arm/Manager/variable/" + name
    lines = subprocess.run(["rehearse", "cat", "--topics", topic, sys.argv[1]], check=True, capture_output=True,
                           text=True).stdout.splitlines()
    return [(float(line.split()[0]), float(line.split("data=")[1].strip('"'))) for line in lines]


integral, worst, largest = 0.0, 0.0, 0.0
angles, efforts = series("state%2FJ2%2Fposition"), series("command%2FJ2%2Feffort")
for (time, angle), (_, effort) in list(zip(angles, efforts))[1:]:  # the first cycle activates the controllers
    error = min(max((time + step - begin) / rise, 0.0), 1.0) * goal - angle  # a command is for the end of a cycle
    expected = p * error + integral
    integral += i * error * step
    worst, largest = max(worst, abs(effort - expected)), max(largest, abs(expected))
print(f"largest effort {largest:.3g} N·m, worst difference {worst:.3g} N·m")
sys.exit(largest < 1.0 or worst > most * largest)
