"""A copy of the source tree in which a check may change files."""
import filecmp
import os
import shutil
import subprocess

LEFT_OUT = {".git", "build", "devel", "install", "results"}


def environment_of(build, share):
    """For programs of another build than the one whose devel/setup.bash was sourced: its libraries go first."""
    libraries = [str(build / "devel" / "lib"), *filter(None, [os.environ.get("LD_LIBRARY_PATH")])]
    return {**os.environ, "LD_LIBRARY_PATH": ":".join(libraries), "E2E_CDIFF_SHARE": str(share), "SUMO_HOME": "/usr/share/sumo"}


class SourceCopy:
    """A copy at `root` with its build folder at the usual place, so that ccache knows the files. One that lies there already is brought
    up to date."""

    def __init__(self, source, source_build, root):
        self.root, self.build = root, root / "build"
        root.mkdir(parents=True, exist_ok=True)
        for old in root.iterdir():
            if old != self.build and not (source / old.name).exists():
                remove(old)
        for top in source.iterdir():
            if top.name not in LEFT_OUT and top != source_build:
                bring(top, root / top.name)

    def ninja(self, targets):
        return ninja(self.build, self.root, targets)


def ninja(build, root, targets):
    """Whether these targets of the tree at `root` build, and what ninja says; $JOBS at a time."""
    environment = {**os.environ, "CCACHE_BASEDIR": str(root)}
    jobs = ["-j", os.environ["JOBS"]] if os.environ.get("JOBS") else []
    done = subprocess.run(["ninja", "-C", build, *jobs, *targets], env=environment, capture_output=True, text=True, check=False)
    return done.returncode == 0, done.stdout


def remove(path):
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink()


def bring(source, copy):
    """Makes `copy` equal to `source`; files that are equal stay as they are, with their times."""
    if not source.is_dir():
        if not copy.is_file() or not filecmp.cmp(source, copy, shallow=False):
            shutil.copyfile(source, copy)
            shutil.copymode(source, copy)
        return
    copy.mkdir(exist_ok=True)
    names = {path.name for path in source.iterdir()} - {"__pycache__"}
    for old in copy.iterdir():
        if old.name not in names:
            remove(old)
    for name in sorted(names):
        bring(source / name, copy / name)
