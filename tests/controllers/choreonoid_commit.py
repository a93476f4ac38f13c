#!/usr/bin/env python3
"""States the commit of Choreonoid that Rehearse meets, and what a checkout has changed since.

usage: choreonoid_commit.py CHECKOUT COMMIT PAGE

CHECKOUT: of Choreonoid. COMMIT: which PAGE must name. Prints the later commits of the checkout that concern the headers
for controllers or the simulator items. Fails if the page names another commit, or if the checkout lacks it.
"""

import subprocess
import sys
from pathlib import Path

PATHS = ("src/Body/Body.h", "src/Body/Link.h", "src/Body/Device.h", "src/Body/SimpleController.h",
         "src/Body/ControllerIO.h", "src/Body/StdBodyLoader.cpp", "src/Body/ForwardDynamicsABM.cpp",
         "src/Body/ForwardDynamicsCBM.cpp", "src/BodyPlugin/AISTSimulatorItem.cpp",
         "src/BodyPlugin/KinematicSimulatorItem.cpp", "src/BodyPlugin/SimpleControllerItem.cpp",
         "src/BodyPlugin/SimulatorItem.cpp", "src/ODEPlugin/ODESimulatorItem.cpp")


def main():
    checkout, commit, page = sys.argv[1], sys.argv[2], Path(sys.argv[3])
    if f"head {commit[:8]}" not in page.read_text(encoding="utf-8"):
        print(f"{page} doesn't say that it is about the head {commit[:8]}")
        return 1
    log = subprocess.run(["git", "-C", checkout, "log", "--oneline", "--no-decorate", f"{commit}..HEAD", "--", *PATHS],
                         capture_output=True, text=True, check=False)
    if log.returncode != 0:
        print(f"{checkout} is no checkout that has the commit {commit}: {log.stderr.strip()}")
        return 1
    later = log.stdout.splitlines()
    print(f"met: {commit}; {len(later)} later commits of this checkout concern headers and simulator items")
    print("\n".join(later))
    return 0


if __name__ == "__main__":
    sys.exit(main())
