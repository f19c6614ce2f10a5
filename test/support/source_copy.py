"""A copy of the source tree in which a check may change files."""
import os
import shutil
import subprocess

LEFT_OUT = {".git", "build", "devel", "install", "results"}


def environment_of(build, share):
    """For programs of another build than the one whose devel/setup.bash was sourced: its libraries go first."""
    libraries = [str(build / "devel" / "lib"), *filter(None, [os.environ.get("LD_LIBRARY_PATH")])]
    return {**os.environ, "LD_LIBRARY_PATH": ":".join(libraries), "E2E_CDIFF_SHARE": str(share), "SUMO_HOME": "/usr/share/sumo"}


class SourceCopy:
    """A copy at `root` with its build folder at the usual place, so that ccache knows the files."""

    def __init__(self, source, source_build, root):
        self.root, self.build = root, root / "build"
        root.mkdir()
        for top in source.iterdir():
            if top.name in LEFT_OUT or top == source_build:
                continue
            if top.is_dir():
                shutil.copytree(top, root / top.name)
            else:
                shutil.copy(top, root)

    def ninja(self, targets):
        """Whether these targets build, and what ninja says."""
        environment = {**os.environ, "CCACHE_BASEDIR": str(self.root)}
        done = subprocess.run(["ninja", "-C", self.build, *targets], env=environment, capture_output=True, text=True, check=False)
        return done.returncode == 0, done.stdout
