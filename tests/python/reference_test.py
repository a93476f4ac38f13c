"""reference_test.py SOURCE: tools/site/pages/reference/python.md is what tools/site/python_reference.py prints."""

import difflib
import subprocess
import sys
from pathlib import Path

source = Path(sys.argv[1])
program = source / "tools/site/python_reference.py"
printed = subprocess.run([sys.executable, program, source / "tools/new_project/models/arm.urdf"], check=True,
                         stdout=subprocess.PIPE, text=True).stdout
page = (source / "tools/site/pages/reference/python.md").read_text()
difference = list(difflib.unified_diff(page.splitlines(), printed.splitlines(), "python.md", "docstrings", lineterm="", n=0))
print("\n".join(difference))
assert len(printed) > 5000, "the module has lost its docstrings"
if difference:
    print(f"write it anew: python3 {program} {source}/tools/new_project/models/arm.urdf > tools/site/pages/reference/python.md")
sys.exit(bool(difference))
