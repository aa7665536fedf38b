"""Builds the wheel of the Python module with CMake: the backend that pyproject.toml names (PEP 517).

The wheel holds the module and beside it, in pliant/_lib, what it needs of Pliant: libpliant.so.1 and pliant-mesh.
Debian's libraries stay where they are. What is compiled is kept in build/wheel, so that a second time is short.
"""

import base64
import hashlib
import io
import os
import pathlib
import shutil
import subprocess
import sys
import sysconfig
import tarfile
import tempfile
import tomllib
import zipfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def project():
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def tag():
    """Of this interpreter on this system, as in cp311-cp311-linux_x86_64."""
    interpreter = "cp%d%d" % sys.version_info[:2]
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return "%s-%s-%s" % (interpreter, interpreter, platform)


def metadata():
    about = project()
    lines = ["Metadata-Version: 2.1", "Name: " + about["name"], "Version: " + about["version"],
             "Summary: " + about["description"], "License: " + about["license"]["text"],
             "Author: " + about["authors"][0]["name"], "Requires-Python: " + about["requires-python"]]
    return "\n".join(lines + ["Requires-Dist: " + name for name in about["dependencies"]]) + "\n"


def run(*words):
    subprocess.run([str(word) for word in words], check=True, cwd=ROOT)


def compiled(staging):
    """Compiles the module and puts what belongs into a wheel below `staging`."""
    if not (ROOT / "python" / "CMakeLists.txt").exists():
        raise SystemExit("this tree has no folder python/: there is no module to build")
    build = ROOT / "build" / "wheel"
    run("cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DPLIANT_TESTS=OFF",
        "-DPLIANT_PAGE=OFF", "-DPLIANT_RELOCATABLE=ON", "-DPLIANT_PYTHON=ON", "-DPLIANT_PYTHON_SITE=site",
        "-DPython3_EXECUTABLE=" + sys.executable, r"-DCMAKE_MODULE_LINKER_FLAGS=-Wl,-rpath,\$ORIGIN/_lib")
    run("cmake", "--build", build, "--target", "pliant_python", "pliant_shared", "pliant_mesh")
    run("cmake", "--install", build, "--component", "python", "--prefix", staging / "installed", "--strip")
    module = staging / "pliant"
    shutil.copytree(staging / "installed" / "site" / "pliant", module)
    shutil.rmtree(staging / "installed")
    (module / "_lib").mkdir()
    for name in ("libpliant.so.1", "pliant-mesh"):
        found = [path for path in build.rglob(name) if path.is_file()]
        shutil.copy(found[0], module / "_lib" / name)


def get_requires_for_build_wheel(config_settings=None):
    return []


def get_requires_for_build_sdist(config_settings=None):
    return []


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    about = project()
    name = "%s-%s" % (about["name"], about["version"])
    with tempfile.TemporaryDirectory() as folder:
        staging = pathlib.Path(folder)
        compiled(staging)
        info = staging / (name + ".dist-info")
        info.mkdir()
        (info / "METADATA").write_text(metadata(), encoding="utf-8")
        (info / "WHEEL").write_text("Wheel-Version: 1.0\nGenerator: pliant\nRoot-Is-Purelib: false\nTag: %s\n" % tag())
        for licence in ("LICENSE", "LICENSES.md"):
            shutil.copy(ROOT / licence, info / licence)
        wheel = "%s-%s.whl" % (name, tag())
        write_wheel(pathlib.Path(wheel_directory) / wheel, staging, info)
    return wheel


def write_wheel(wheel, staging, info):
    """A zip file with its own list of contents, RECORD, as the last entry."""
    record = []
    with zipfile.ZipFile(wheel, "w", zipfile.ZIP_DEFLATED) as archive:
        for path in sorted(path for path in staging.rglob("*") if path.is_file()):
            inside = path.relative_to(staging).as_posix()
            digest = base64.urlsafe_b64encode(hashlib.sha256(path.read_bytes()).digest()).rstrip(b"=").decode()
            record.append("%s,sha256=%s,%d" % (inside, digest, path.stat().st_size))
            archive.write(path, inside)
        place = (info / "RECORD").relative_to(staging).as_posix()
        archive.writestr(place, "\n".join(record + [place + ",,"]) + "\n")


def sources():
    """What is tracked; in a source archive, everything that it came with."""
    if (ROOT / "PKG-INFO").exists():
        made = ("build/", "out/")
        paths = (path.relative_to(ROOT).as_posix() for path in sorted(ROOT.rglob("*")) if not path.is_dir())
        return [path for path in paths
                if path != "PKG-INFO" and not path.startswith(made) and "__pycache__" not in path]
    listed = subprocess.run(["git", "ls-files", "-z"], check=True, cwd=ROOT, capture_output=True).stdout
    return list(filter(None, listed.decode().split("\0")))


def build_sdist(sdist_directory, config_settings=None):
    """The sources and PKG-INFO, below one folder."""
    about = project()
    name = "%s-%s" % (about["name"], about["version"])
    with tarfile.open(os.path.join(sdist_directory, name + ".tar.gz"), "w:gz") as archive:
        for path in sources():
            archive.add(ROOT / path, name + "/" + path, recursive=False)
        text = metadata().encode()
        info = tarfile.TarInfo(name + "/PKG-INFO")
        info.size, info.mode = len(text), 0o644
        archive.addfile(info, io.BytesIO(text))
    return name + ".tar.gz"
