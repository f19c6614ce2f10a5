#!/usr/bin/python3
"""The install space as a user's package sees it: public headers compile alone, and examples/my_plugins builds and works.

    test_install_space.py BUILD SOURCE RESULT.xml
"""
import json
import os
import shutil
import subprocess
import sys
import tempfile
import unittest
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402

BUILD, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
ENVIRONMENT = {**os.environ, "PATH": "/usr/bin:" + os.environ["PATH"], "SUMO_HOME": "/usr/share/sumo"}


def run(*command, **settings):
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=250,
                          check=False, **{"env": ENVIRONMENT, **settings})
    return done.returncode, done.stdout


def checked(*command, **settings):
    code, text = run(*command, **settings)
    if code != 0:
        raise RuntimeError(f"{' '.join(map(str, command))} ended with {code}:\n{text[-4000:]}")
    return text


def install(prefix):
    """Installs into `prefix`. Catkin writes the prefix of the configuration into its own files; here it is another one."""
    checked("cmake", "--install", BUILD, "--prefix", prefix)
    configured = next(line.split("=", 1)[1] for line in (BUILD / "CMakeCache.txt").read_text().splitlines()
                      if line.startswith("CMAKE_INSTALL_PREFIX:"))
    for file in [*prefix.glob("share/e2e_cdiff/cmake/*.cmake"), *prefix.glob("*setup*")]:
        if file.is_file():
            file.write_text(file.read_text().replace(configured, str(prefix)))


class InstallSpace(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="e2e_cdiff_install_"))
        cls.addClassCleanup(shutil.rmtree, cls.folder, True)
        cls.prefix = cls.folder / "prefix"
        install(cls.prefix)
        shutil.copytree(SOURCE / "examples/my_plugins", cls.folder / "src/my_plugins")
        checked("cmake", "-S", cls.folder / "src/my_plugins", "-B", cls.folder / "build", "-G", "Ninja",
                f"-DCMAKE_PREFIX_PATH={cls.prefix}", f"-DCMAKE_INSTALL_PREFIX={cls.prefix}",
                "-DPYTHON_EXECUTABLE=/usr/bin/python3", "-DPython3_EXECUTABLE=/usr/bin/python3")
        checked("ninja", "-C", cls.folder / "build", "install")
        cls.environment = {**ENVIRONMENT, "ROS_PACKAGE_PATH": str(cls.prefix / "share"), "CMAKE_PREFIX_PATH": str(cls.prefix)}
        cls.environment.pop("E2E_CDIFF_SHARE", None)

    def cdiff(self, *arguments):
        return run(self.prefix / "lib/e2e_cdiff/cdiff", *arguments, env=self.environment, cwd=self.folder)

    def test_public_headers_compile_alone(self):
        include = self.prefix / "include"
        headers = sorted((SOURCE / "include/e2e_cdiff").rglob("*.h"))
        self.assertGreater(len(headers), 10)
        self.assertLess(len(headers), 60, "the public API is small; private headers lie beside their sources")

        def fault(header):
            installed = include / header.relative_to(SOURCE / "include")
            code, text = run("g++", "-std=c++17", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", "-I", include, "-isystem",
                             "/usr/include/eigen3", "-x", "c++", "-include", installed, "/dev/null")
            return f"{header.name}: {text}" if code else ""

        with ThreadPoolExecutor(2) as pool:
            faults = [text for text in pool.map(fault, headers) if text]
        self.assertEqual(faults, [])

    def test_a_planner_an_objective_and_a_metric_of_ones_own_serve_a_session(self):
        results = self.folder / "session"
        code, text = self.cdiff("run", "crossing_left_turn", "--results", results, "--set", "ego_planner=creep", "--set", "creep.speed=3",
                                "--set", "guidance.keep_right.weight=0.5", "--set", "protocol.time_limit=4")
        self.assertIn(code, (0, 1), text)
        summary = json.loads((results / "summary.json").read_text())
        self.assertEqual(summary["ego_planner"], "creep")
        self.assertEqual([fault for fault in summary["faults"] if "creep" in str(fault)], [])
        self.assertIn("creep", (results / "report.html").read_text())
        self.assertIn("keep_right", (results / "report.html").read_text())
        self.assertGreater(summary["metrics"]["ego_jerk"]["value"], 0.0)
        self.assertIn("Ego jerk", (results / "report.html").read_text())

    def test_validate_lists_and_checks_them(self):
        code, text = self.cdiff("validate", "--planners")
        self.assertEqual(code, 0, text)
        self.assertIn("creep", text)
        self.assertIn("libmy_plugins.so", text)
        scenario = self.folder / "mine.yaml"
        scenario.write_text((SOURCE / "config/scenarios/crossing_left_turn.yaml").read_text() + "creep:\n  speed: 99\n")
        code, text = self.cdiff("validate", scenario)
        self.assertEqual(code, 3, text)
        self.assertIn("creep.speed", text)

    def test_a_batch_and_its_table_take_them(self):
        matrix = self.folder / "mine_matrix.yaml"
        matrix.write_text("scenarios: [crossing_left_turn]\nseeds: [1]\nego_planners: [creep]\ncbv_planners: [pdm_lite]\n"
                          "set: [protocol.time_limit=3]\n")
        code, text = self.cdiff("evaluate", matrix, "--results", self.folder / "batch")
        self.assertIn(code, (0, 1), text)
        header, row = (self.folder / "batch/runs.csv").read_text().splitlines()[:2]
        columns = header.split(",")
        self.assertIn("creep", row)
        self.assertIn("ego_jerk", columns)

    def test_the_node_graph_takes_them(self):
        results = self.folder / "graph"
        code, text = run(self.prefix / "share/e2e_cdiff/scripts/session", "scenario:=crossing_left_turn", "ego_planner:=creep",
                         "cbv_planner:=pdm_lite", "set:=protocol.time_limit=3", f"results:={results}",
                         env={**self.environment, "ROS_HOME": str(self.folder / "ros_home"), "ROS_IP": "127.0.0.1"}, cwd=self.folder)
        self.assertIn(code, (0, 1), text)
        summary = json.loads((results / "summary.json").read_text())
        self.assertEqual(summary["ego_planner"], "creep")
        self.assertEqual(summary["status"], "timed_out", text)
        self.assertGreater(summary["metrics"]["ego_jerk"]["value"], 0.0)

    def test_an_unbuilt_plug_in_is_named(self):
        package = self.folder / "broken" / "lost_plugins"
        package.mkdir(parents=True)
        text = (SOURCE / "examples/my_plugins/package.xml").read_text().replace("my_plugins", "lost_plugins")
        (package / "package.xml").write_text(text)
        environment = {**self.environment, "ROS_PACKAGE_PATH": str(package.parent)}
        code, text = run(self.prefix / "lib/e2e_cdiff/cdiff", "validate", "crossing_left_turn", env=environment)
        self.assertEqual(code, 3, text)
        self.assertIn("liblost_plugins.so", text)
        self.assertIn(str(package / "package.xml"), text)


if __name__ == "__main__":
    suite = unittest.defaultTestLoader.loadTestsFromTestCase(InstallSpace)
    names = [test.id() for test in suite]
    outcome = unittest.TextTestRunner(verbosity=2).run(suite)
    if len(outcome.errors) == 1 and "setUpClass" in str(outcome.errors[0][0]):
        junit.write(sys.argv[3], "install_space", [(name.rpartition(".")[2], 0.0, outcome.errors[0][1]) for name in names])
    else:
        junit.write_unittest(sys.argv[3], "install_space", outcome, names)
    sys.exit(0 if outcome.wasSuccessful() else 1)
