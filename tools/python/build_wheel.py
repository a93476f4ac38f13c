"""pip's way to the module (PEP 517): the wheel is CMake's installation of the command, its libraries and the module.

pip writes the installation into the environment's folder, as CMake would; a file `rehearse.pth` tells Python where the
module is in it. The compiled parts are of the interpreter that runs pip, which has to be that of the build.
"""

import base64
import hashlib
import os
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parents[2]
COMPONENTS = ("runtime", "samples", "python")
PACKAGES = "lib/python3/dist-packages"


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    """Writes the wheel, and returns its name. The setting `build` names a build folder that is complete."""
    given = (config_settings or {}).get("build")
    build = Path(given).resolve() if given else compiled()
    with tempfile.TemporaryDirectory() as folder:
        prefix = Path(folder)
        for component in COMPONENTS:
            run("cmake", "--install", build, "--prefix", prefix, "--component", component, "--strip")
        return packed(prefix, Path(wheel_directory))


def build_sdist(sdist_directory, config_settings=None):
    sys.exit("error: the module is built from the whole source tree of Rehearse: pip install tools/python")


def run(*words):
    subprocess.run([str(word) for word in words], check=True, stdout=sys.stderr)


def compiled():
    """A build of all that is installed; it takes a quarter of an hour once."""
    build = SOURCE / "build-python"
    run("cmake", "-S", SOURCE, "-B", build, "-D", "CMAKE_BUILD_TYPE=Release", "-D", "REHEARSE_PYTHON=ON")
    run("cmake", "--build", build, "--parallel", os.cpu_count() or 1, "--target", "rehearse_installed", "rehearse_python")
    return build


def installed(prefix):
    """The files of an installation, by their names in it; a library once, by the name that others load it by."""
    files = {path.relative_to(prefix).as_posix(): path for path in sorted(prefix.rglob("*")) if path.is_file()}
    aliased = {path.resolve() for path in files.values() if path.is_symlink()}
    return {name: path for name, path in files.items() if path.is_symlink() or path not in aliased}


def packed(prefix, wheel_directory):
    files = installed(prefix.resolve())
    module = f"{PACKAGES}/rehearse/_rehearse{sysconfig.get_config_var('EXT_SUFFIX')}"
    if module not in files:
        sys.exit(f"error: the build has no module for {sys.executable} ({Path(module).name}): it is for Debian's python3, "
                 "and is left out if pybind11-dev or python3-dev isn't installed")
    stated = next(name for name in files if name.endswith(".dist-info/METADATA"))
    facts = {Path(name).name: files.pop(name).read_bytes() for name in list(files) if ".dist-info/" in name}
    title = Path(stated).parent.name.removesuffix(".dist-info")  # rehearse-0.1.0
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    tag = f"{python}-{python}-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
    packages_from_site = os.path.relpath("/" + PACKAGES, f"/lib/{Path(sysconfig.get_path('stdlib')).name}/site-packages")
    content = {f"{title}.data/data/{name}": (path.read_bytes(), path.stat().st_mode) for name, path in files.items()}
    content["rehearse.pth"] = (packages_from_site.encode() + b"\n", 0o644)
    wheel = f"Wheel-Version: 1.0\nGenerator: rehearse\nRoot-Is-Purelib: false\nTag: {tag}\n"
    for name, text in {**facts, "WHEEL": wheel.encode()}.items():
        content[f"{title}.dist-info/{name}"] = (text, 0o644)
    name = f"{title}-{tag}.whl"
    write(wheel_directory / name, content, f"{title}.dist-info/RECORD")
    return name


def write(file, content, record):
    """A wheel with these files, each with its mode; `record` is the list of them."""
    lines = []
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as wheel:
        for name, (data, mode) in content.items():
            entry = zipfile.ZipInfo(name)
            entry.external_attr = (mode & 0o777) << 16 | 0o100000 << 16
            entry.compress_type = zipfile.ZIP_DEFLATED
            wheel.writestr(entry, data)
            digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
            lines.append(f"{name},sha256={digest},{len(data)}")
        wheel.writestr(record, "\n".join([*lines, f"{record},,"]) + "\n")
