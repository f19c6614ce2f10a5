#!/usr/bin/python3
"""What the scripts have built and run, seen by stand-ins for cmake, ninja and ctest.

    test_scripts.py BUILD SOURCE RESULT.xml
"""
import contextlib
import gzip
import io
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402

BUILD, SOURCE = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
STAND_INS = ["cmake", "ninja", "ctest", "roslaunch"]


def calls_of(script, *arguments):
    """The commands that a script gave to the stand-ins, each as a list of words."""
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "calls"
        # Exported functions of bash come before any program of that name.
        environment = {**os.environ, **{f"BASH_FUNC_{name}%%": f'() {{ echo {name} "$@" >>{log}; }}' for name in STAND_INS}}
        (Path(folder) / "devel").mkdir()
        (Path(folder) / "devel" / "setup.bash").touch()
        subprocess.run([SOURCE / "scripts" / script, *arguments], env={**environment, "BUILD": folder, "OPEN": "yes"}, cwd=folder, timeout=60,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False)
        return [line.split() for line in log.read_text().splitlines()] if log.exists() else []


def targets_of(calls):
    """What ninja was asked for: the words behind -C FOLDER -j N."""
    return [call[5:] for call in calls if call[0] == "ninja"]


@contextlib.contextmanager
def unbuilt_session():
    """scripts/session of a package that is not built, in a folder with a space: a function of its arguments."""
    with tempfile.TemporaryDirectory() as folder:
        scripts = Path(folder) / "my package" / "scripts"
        scripts.mkdir(parents=True)
        for name in ("session", "isolated", "environment"):
            shutil.copy(SOURCE / "scripts" / name, scripts)
        yield lambda *arguments: subprocess.run([scripts / "session", *arguments], env={**os.environ, "BUILD": "no build"}, capture_output=True, text=True,
                                                check=False)


class Scripts(unittest.TestCase):
    @unittest.skipUnless((BUILD / "devel" / "setup.bash").exists() and (SOURCE / "devel").exists(), "built elsewhere")
    def test_rosrun_and_path_find_the_same_program(self):
        found = subprocess.run(["bash", "-c", f". '{BUILD}/devel/setup.bash' && rosrun e2e_cdiff cdiff --version && cdiff --version"],
                               env={**os.environ, "PATH": "/usr/bin:" + os.environ["PATH"]}, stdin=subprocess.DEVNULL, timeout=60,
                               capture_output=True, text=True, check=False)
        self.assertEqual(found.returncode, 0, found.stdout + found.stderr)
        lines = found.stdout.splitlines()
        self.assertEqual(lines[:len(lines) // 2], lines[len(lines) // 2:])
        self.assertTrue(lines)

    def test_open_loop_measures_are_compared_in_pairs(self):
        # Moments 1, 1, 2 and differences 0.1, 0.2, 0.3: pooled 0.9 / 4. With three networks the interval holds all draws, from 0.1 to 0.3.
        with tempfile.TemporaryDirectory() as folder:
            for name, values in (("base", [1, 1, 1]), ("other", [1.1, 1.2, 1.3]), ("fewer", [1, 1])):
                rows = [f"{i},{moments},l2,{value}" for i, (moments, value) in enumerate(zip([1, 1, 2], values))]
                (Path(folder) / name).write_text("\n".join(["network,moments,measure,value", *rows]), encoding="utf-8")

            def compared(other):
                return subprocess.run([SOURCE / "scripts/compare_open_loop", "base", other], cwd=folder, timeout=60, capture_output=True, text=True, check=False)

            self.assertEqual(compared("other").stdout, "l2 1.000 1.225 +0.225 [+0.100, +0.300]\n")
            self.assertNotEqual(compared("fewer").returncode, 0)

    def test_searches_are_checked_before_anything_runs(self):
        def refused(change, *arguments):
            """What a shipped procedure, changed, gives: exit code and error."""
            with tempfile.TemporaryDirectory() as folder:
                text = (SOURCE / "config/searches/paper_weights.yaml").read_text(encoding="utf-8")
                (Path(folder) / "changed.yaml").write_text(change(text), encoding="utf-8")
                (Path(folder) / "empty").mkdir()
                done = subprocess.run([SOURCE / "scripts/search_weights", "changed.yaml", "--suite", "empty", "--results", "results", *arguments],
                                      cwd=folder, timeout=60, capture_output=True, text=True, check=False)
                self.assertEqual(os.listdir(Path(folder) / "results") if (Path(folder) / "results").exists() else [], [])
                return done.returncode, done.stderr

        for procedure in sorted((SOURCE / "config/searches").glob("*.yaml")):  # each one shipped comes as far as the suite
            code, error = refused(lambda _, path=procedure: path.read_text(encoding="utf-8"))
            self.assertEqual((code, "'empty' holds no scenarios" in error), (3, True), error)
        for change, named in ((lambda text: text.replace("w_safe: 50", "w_safe: -50"), "w_safe is -50"),
                              (lambda text: text.replace("order: [w_area", "order: [w_aera"), "'w_aera'"),
                              (lambda text: text.replace("factors: [0.33, 3]", "factors: [0, 3]"), "factors"),
                              (lambda text: text.replace("seeds:", "sedes:"), "seeds"),
                              (lambda text: text + "names: [", "changed.yaml")):
            code, error = refused(change)
            self.assertEqual((code, named in error), (3, True), error)

    def test_openscenario_files_are_counted_by_what_becomes_of_them(self):
        scenario = '<OpenSCENARIO><RoadNetwork><LogicFile filepath="Town09_Opt"/></RoadNetwork><Storyboard/></OpenSCENARIO>'
        # A stand-in for cdiff that does what the file's name says. "partly" ends only without what is not supported.
        program = """#!/bin/bash
name=$(basename "$2" .xosc)
while [ $# -gt 0 ]; do
  case $1 in --results) results=$2 ;; --network) network=$2 ;; --ignore-unsupported) ignore=yes ;; esac
  shift
done
[ "$(basename "$network")" = Town09.net.xml ] || { echo "cdiff: no network" >&2; exit 3; }
fault='/x/y.xosc:3: <TrailerAction>: this action is not supported'
mkdir -p "$results"
echo '{"status": "completed", "ego": {"collisions": 1}, "faults": [{"text": "'"$fault"' and was ignored"}]}' >"$results/summary.json"
case $name in
  good) exit 1 ;;
  partly) [ "${ignore:-}" ] && exit 0; echo "cdiff: $fault; --ignore-unsupported goes on without it" >&2; exit 3 ;;
  slow) exec sleep 60 ;;
  *) echo "cdiff: /x/y.xosc:7: the attribute 's' is missing" >&2; exit 3 ;;
esac
"""
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / "cdiff").write_text(program)
            (root / "cdiff").chmod(0o755)
            (root / "Town09.net.xml").touch()
            (root / "set/catalogs").mkdir(parents=True)
            (root / "set/catalogs/cars.xosc").write_text("<OpenSCENARIO><Catalog/></OpenSCENARIO>")
            for name in ("good", "partly", "slow", "bad"):
                (root / f"set/{name}.xosc").write_text(scenario)

            def covered(*arguments):
                return subprocess.run([SOURCE / "scripts/openscenario_coverage", "--cdiff", root / "cdiff", *arguments], timeout=60,
                                      capture_output=True, text=True, check=False)

            done = covered(root / "set", "--networks", root, "--limit", "5", "--files")
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("| set | 4 | 1 | 1 | 1 | 1 |", done.stdout)
            for line in ("1 x <TrailerAction>: this action is not supported", "1 x the attribute 's' is missing", "1 x no end within 5 s"):
                self.assertIn(line, done.stdout.splitlines())
            self.assertIn("completed, 1 collisions of the ego", done.stdout)
            self.assertIn("| set | 4 | 0 | 0 | 0 | 4 |", covered(root / "set").stdout)
            self.assertEqual(covered(root / "set/catalogs").returncode, 3)

    def test_exports_are_compared_with_their_sessions(self):
        # The stand-in for cdiff drives "a" 0.3 m away in x and 0.4 m in y, one tick late; the ego does not count, nor does who is in one alone.
        # "a" is 5 m long and comes toward the ego of 4 m at x = 10: from tick 2 on, 4.3 m are less than half of both lengths. "d" touches it
        # a tick after its recorded contact; "b" is not there. The second ego touches "e" earlier.
        program = """#!/bin/bash
while [ $# -gt 0 ]; do case $1 in --output) export=$2 ;; --results) results=$2 ;; esac; shift; done
[ -z "${export:-}" ] || { mkdir -p "$export"; touch "$export/x.xosc"; exit 0; }
mkdir -p "$results"
printf 'tick,id,x,y,heading\\n0,ego,9,9,0\\n1,a,5.3,0.4,0\\n2,a,5.7,0,0\\n2,c,0,0,0\\n1,d,10,3,0\\n2,d,10,1,0\\n' >"$results/trace.csv"
echo '{"ego": {"contacts": [{"tick": 1, "with": "e"}]}}' >"$results/summary.json"
exit 1
"""
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / "cdiff").write_text(program)
            (root / "cdiff").chmod(0o755)
            (root / "run").mkdir()

            def compared():
                return subprocess.run([SOURCE / "scripts/openscenario_accuracy", "--cdiff", root / "cdiff", "--pictures", root / "pictures", root / "run"],
                                      timeout=60, capture_output=True, text=True, check=False)

            self.assertEqual(compared().returncode, 3)
            rows = ["0,ego,10,0,0", "1,ego,10,0,0", "2,ego,10,0,0", "0,a,4,0,0", "1,a,5,0,0", "2,a,5.7,0,0", "1,b,0,0,0", "1,d,10,3,0", "2,d,10,1,0"]
            (root / "run/trace.csv").write_text("\n".join(["tick,id,x,y,heading", *rows, ""]))
            (root / "run/vehicles.csv").write_text("id,length,width,height\nego,4,2,1\na,5,2,1\nd,4,2,1\n")
            contacts = [{"tick": 2, "with": "a"}, {"tick": 1, "with": "d"}, {"tick": 2, "with": "b"}, {"tick": 2, "with": "e"}]
            (root / "run/summary.json").write_text(json.dumps({"ego": {"contacts": contacts}}))
            done = compared()
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertIn("| run | 4 | 0.500 | 0.05 | 1 of 3 | 1 |", done.stdout)
            self.assertIn("Largest: 0.500 m and 0.05 s in 1 sessions\nContacts again: 1 of 3; with vehicles that are gone: 1", done.stdout)
            picture = (root / "pictures/run.svg").read_text()
            self.assertEqual(picture.count("<polygon"), 5, picture)  # ego, "a", "d"; "a" and "d" driven again, without the ego

    def test_benchmark_builds_itself_only(self):
        self.assertEqual(targets_of(calls_of("benchmark", "camera")), [["cdiff_benchmark"]])
        self.assertEqual(targets_of(calls_of("benchmark", "--json", "x", "map")), [["cdiff_benchmark"]])

    def test_benchmark_of_builds_counts_files_and_targets(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / "src/toy").mkdir(parents=True)
            for name in ("scripts/setup", "scripts/packages.txt", "scripts/packages_build.txt", "scripts/benchmark", "benchmark/build_benchmark.py"):
                (root / name).parent.mkdir(exist_ok=True)
                shutil.copy(SOURCE / name, root / name)
            (root / "CMakeLists.txt").write_text("project(toy LANGUAGES CXX)\nadd_library(toy src/toy/a.cpp src/toy/b.cpp)\n"
                                                 "add_executable(other src/toy/c.cpp)\n")
            for name in "abc":
                (root / f"src/toy/{name}.cpp").write_text("int main() { return 0; }\n" if name == "c" else f"int {name}() {{ return 0; }}\n")
            modified = (root / "src/toy/a.cpp").stat().st_mtime_ns
            done = subprocess.run([root / "scripts/benchmark", "build", "--targets", "toy", "--touch", "src/toy/a.cpp", "--json", root / "x.json"],
                                  env={name: value for name, value in os.environ.items() if name not in ("BUILD", "PREFIX")},
                                  capture_output=True, text=True, timeout=120, check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            values = {line.split()[0]: float(line.split()[1]) for line in done.stdout.splitlines()}
            self.assertEqual({row["figure"]: round(row["value"], 3) for row in json.loads((root / "x.json").read_text())}, values)
            # All of "toy" from nothing, then a.cpp alone and the library; "other" never.
            self.assertEqual([values[f"build_{name}_{what}"] for name in ("targets", "touch_toy") for what in ("files", "targets")], [2, 1, 1, 1])
            self.assertGreater(values["build_targets_processor"], 0.0)
            self.assertEqual((root / "src/toy/a.cpp").stat().st_mtime_ns, modified)

    def test_the_benchmark_of_the_loop_needs_the_nodes(self):
        for arguments in ([], ["loop"], ["--json", "x"]):
            self.assertEqual(targets_of(calls_of("benchmark", *arguments)), [["cdiff_benchmark", "e2e_cdiff_nodes"]])

    def test_demo_builds_no_test_and_no_benchmark(self):
        with tempfile.TemporaryDirectory() as results:
            self.assertEqual(targets_of(calls_of("demo", results)), [["e2e_cdiff_session_programs"]])

    def test_demo_configures_no_trainer_and_no_test(self):
        with tempfile.TemporaryDirectory() as results:
            configured = next(call for call in calls_of("demo", results) if call[0] == "cmake")
        for part in ("TESTS", "BENCHMARKS", "TRAINING"):
            self.assertIn(f"-DE2E_CDIFF_{part}=OFF", configured)

    def test_packages_of_sessions_are_those_that_the_demo_installs(self):
        sessions, build = ((SOURCE / f"scripts/{name}.txt").read_text(encoding="utf-8").split() for name in ("packages", "packages_build"))
        for package in ("libtorch-dev", "libgtest-dev", "libbenchmark-dev"):
            self.assertNotIn(package, sessions)
            self.assertIn(package, build)

    def test_containers_name_scripts_and_paths_that_exist(self):
        dockerfile = (SOURCE / "Dockerfile").read_text(encoding="utf-8")
        container = json.loads((SOURCE / ".devcontainer/devcontainer.json").read_text(encoding="utf-8"))
        bases = re.findall(r"^FROM (\S+)", dockerfile, re.MULTILINE)
        self.assertEqual({container["image"], *bases}, {"debian:12"})
        scripts = re.findall(r"^RUN (scripts/\S+)$", dockerfile, re.MULTILINE)
        self.assertEqual(scripts, ["scripts/package"])
        for script in [*scripts, container["onCreateCommand"]]:
            self.assertTrue(os.access(SOURCE / script, os.X_OK), script)
        # The first stage leaves the package where scripts/package puts it; the second one installs that file.
        folder = re.search(r"^COPY --from=build /e2e_cdiff/(\S+)/ /packages/$", dockerfile, re.MULTILINE).group(1)
        build, sub = folder.split("/")
        package = (SOURCE / "scripts/package").read_text(encoding="utf-8")
        self.assertIn(f"BUILD=${{BUILD:-{build}}}", package)
        name = re.search(rf'"\$BUILD"/{sub}/(\S+\.deb)', package).group(1)
        self.assertIn(f"/packages/{name} ", dockerfile)

    def test_containers_get_what_is_committed(self):
        ignored = (SOURCE / ".dockerignore").read_text(encoding="utf-8").split()
        self.assertIn("build", ignored)
        tracked = subprocess.run(["git", "-C", SOURCE, "ls-files"], capture_output=True, text=True, check=False).stdout.splitlines()
        if not tracked:
            self.skipTest("the source is no checkout of git")
        self.assertEqual({path for path in tracked if path.split("/")[0] in ignored}, set())

    def test_packages_that_setup_installs_are_packages(self):
        names = [name for file in sorted((SOURCE / "scripts").glob("packages*.txt")) for line in file.read_text(encoding="utf-8").splitlines()
                 if not line.startswith("#") for name in line.split()]
        known = subprocess.run(["apt-cache", "madison", *names], capture_output=True, text=True, check=False).stdout
        if not known:
            self.skipTest("apt has no lists here")
        self.assertEqual(set(names) - {line.split("|")[0].strip() for line in known.splitlines()}, set())

    def test_the_package_is_built_for_sessions_below_opt(self):
        calls = calls_of("package")
        self.assertIn("-DCMAKE_INSTALL_PREFIX=/opt/e2e_cdiff", calls[0])
        self.assertEqual(targets_of(calls), [["e2e_cdiff_session_programs"]])
        self.assertEqual(calls_of("package", "--bogus"), [])

    @unittest.skipUnless((BUILD / "devel/lib/e2e_cdiff/cdiff").exists(), "the program is not built")
    def test_the_manual_and_the_completion_know_the_commands(self):
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run([SOURCE / "scripts/write_reference", "--cdiff", BUILD / "devel/lib/e2e_cdiff/cdiff", "--manual", folder], check=True, timeout=100)
            page = gzip.decompress((Path(folder) / "cdiff.1.gz").read_bytes()).decode()
            self.assertIn(".SH EXPORT\n", page)
            self.assertNotRegex(page, re.compile(r"^'", re.MULTILINE))

            def completed(*words):
                line = f"source {folder}/cdiff; COMP_WORDS=(cdiff {' '.join(words)}); COMP_CWORD={len(words)}; _cdiff; echo ${{COMPREPLY[@]}}"
                return subprocess.run(["bash", "-c", line], check=True, capture_output=True, text=True, timeout=20).stdout.split()

            self.assertEqual(completed("exp"), ["export"])
            self.assertEqual(completed("export", "--for"), ["--format"])
            self.assertEqual(completed("--ver"), ["--version"])

    def test_the_manual_of_a_build_without_the_trainer_leaves_its_help_out(self):
        program = """#!/bin/bash
case $* in
  --help) printf 'Subcommands:\\n  run    Run\\n  train  Train\\n' ;;
  --version) echo cdiff 1.2.3 ;;
  "run --help") echo Run ;;
  *) exit 3 ;;
esac
"""
        with tempfile.TemporaryDirectory() as folder:
            cdiff = Path(folder) / "cdiff"
            cdiff.write_text(program)
            cdiff.chmod(0o755)
            subprocess.run([SOURCE / "scripts/write_reference", "--cdiff", cdiff, "--manual", Path(folder) / "manual"], check=True, timeout=60)
            page = gzip.decompress((Path(folder) / "manual/cdiff.1.gz").read_bytes()).decode()
            self.assertIn(".SH RUN\n", page)
            self.assertNotIn(".SH TRAIN\n", page)

    def test_demo_builds_nothing_for_help_or_bad_arguments(self):
        for arguments in (["--help"], ["--bogus"], ["one", "two"]):
            self.assertEqual(calls_of("demo", *arguments), [], arguments)

    def test_those_targets_need_no_file_of_a_test(self):
        for targets in (["cdiff_benchmark", "e2e_cdiff_nodes"], ["e2e_cdiff_programs"], ["e2e_cdiff_session_programs"]):
            inputs = subprocess.run(["ninja", "-C", BUILD, "-t", "inputs", *targets], check=True, capture_output=True, text=True).stdout
            self.assertIn("devel/lib/libe2e_cdiff_core.so", inputs)
            self.assertNotIn("test/", inputs)
        self.assertNotIn("libe2e_cdiff_learning", inputs)

    def test_pictures_of_rviz_name_the_packages_they_lack(self):
        done = subprocess.run([SOURCE / "scripts/draw_rviz", "session"], env={**os.environ, "PATH": "/nowhere"}, timeout=60, capture_output=True, text=True,
                              check=False)
        self.assertEqual(done.returncode, 2)
        listed = (SOURCE / "scripts/packages_rviz.txt").read_text(encoding="utf-8").split()
        for package in ("rviz", "xvfb", "imagemagick", "xdotool"):
            self.assertIn(package, done.stderr)
            self.assertIn(package, listed)

    def test_pictures_are_of_views_that_exist(self):
        done = subprocess.run([SOURCE / "scripts/draw_rviz", "--help"], timeout=60, capture_output=True, text=True, check=False)
        views = re.search(r"^  VIEW +(.*)$", done.stdout, re.MULTILINE).group(1).split(", ")
        self.assertEqual(sorted(views), sorted(path.stem for path in (SOURCE / "rviz").glob("*.rviz")))

    def test_setup_refuses_what_it_does_not_know(self):
        self.assertEqual(calls_of("setup", "--no-test"), [])
        self.assertEqual(calls_of("setup", "--only"), [])

    def test_check_reads_what_changed(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / "scripts").mkdir()
            (root / "src").mkdir()
            shutil.copy(SOURCE / "scripts" / "check", root / "scripts")
            shutil.copy(SOURCE / ".clang-format", root)
            git = ["git", "-C", folder, "-c", "user.name=a", "-c", "user.email=a@b"]

            def check(*arguments):
                done = subprocess.run([root / "scripts" / "check", "--format", *arguments], capture_output=True, text=True, check=False)
                return done.returncode, done.stdout
            (root / "src/old.cpp").write_text("int  old;\n")  # not formatted
            subprocess.run([*git, "init", "-q", "-b", "main"], check=True)
            for text in ("first", "second"):
                (root / "src/kept.cpp").write_text(f"int {text};\n")
                subprocess.run([*git, "add", "-A"], check=True)
                subprocess.run([*git, "commit", "-qm", text], check=True)
            if check()[0] == 77:
                self.skipTest("no clang-format")
            self.assertEqual(check(), (0, "clang-format: 1 files, 0 with findings\n"))  # kept.cpp
            (root / "src/new.h").write_text("int  fresh;\n")
            self.assertEqual(check(), (1, "src/new.h is not formatted\nclang-format: 2 files, 1 with findings\n"))
            self.assertEqual(check("--all")[1].splitlines()[:2], ["src/new.h is not formatted", "src/old.cpp is not formatted"])
            self.assertEqual(check("--base", "nowhere")[0], 3)

    def test_check_reads_a_tenth_or_what_changed_since_the_tag(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name in ("scripts/check", ".codespellrc", "test/misspelled_on_purpose.txt"):
                (root / name).parent.mkdir(exist_ok=True)
                shutil.copy(SOURCE / name, root / name)
            (root / "src").mkdir()
            for i in range(21):
                (root / f"src/s{i:02}.cpp").write_text("// A kernal.\n")
            git = ["git", "-C", folder, "-c", "user.name=a", "-c", "user.email=a@b"]
            subprocess.run([*git, "init", "-q", "-b", "main"], check=True)
            subprocess.run([*git, "add", "-A"], check=True)
            subprocess.run([*git, "commit", "-qm", "first"], check=True)

            def checked(*arguments):
                done = subprocess.run([root / "scripts" / "check", "--spelling", *arguments], capture_output=True, text=True, check=False)
                if done.returncode == 77:
                    self.skipTest("no codespell")
                return [line.partition(":")[0] for line in done.stdout.splitlines() if line.endswith("kernal ==> kernel")]
            # 21 sources: those at 0, 10 and 20 on days that end with 0, two on other days.
            self.assertEqual(checked("--rotating", "330"), ["src/s00.cpp", "src/s10.cpp", "src/s20.cpp"])
            self.assertEqual(checked("--rotating", "9"), ["src/s09.cpp", "src/s19.cpp"])
            self.assertGreaterEqual(len(checked("--rotating")), 2)
            subprocess.run([*git, "tag", "0.1.0"], check=True)
            self.assertEqual(checked("--rotating"), [])
            (root / "src/s07.cpp").write_text("// Another kernal.\n")
            self.assertEqual(checked("--rotating"), ["src/s07.cpp"])

    def test_words_that_tests_misspell_are_misspelled_elsewhere(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name in ("scripts/check", ".codespellrc", "test/misspelled_on_purpose.txt"):
                (root / name).parent.mkdir(exist_ok=True)
                shutil.copy(SOURCE / name, root / name)
            for name in ("docs/a.md", "test/a.cpp", ".github/a.md"):
                (root / name).parent.mkdir(exist_ok=True)
                (root / name).write_text("senario of a tread\nin\\nin kOwn\n")
            done = subprocess.run([root / "scripts" / "check", "--spelling", "--all", "--junit", root / "found.xml"], capture_output=True, text=True, check=False)
            if done.returncode == 77:
                self.skipTest("no codespell")
            self.assertEqual(done.stdout.splitlines()[:2], [".github/a.md:1: senario ==> scenario", "docs/a.md:1: senario ==> scenario"])
            self.assertEqual(done.returncode, 1)
            self.assertEqual((root / "found.xml").read_text().count("<failure"), 2)

    def test_clang_tidy_ends_with_its_time(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            (root / "scripts").mkdir()
            (root / "src").mkdir()
            (root / "programs").mkdir()
            shutil.copy(SOURCE / "scripts" / "check", root / "scripts")
            for name in ("quick", "slow", "wrong"):
                (root / f"src/{name}.cpp").touch()
            (root / "CMakeLists.txt").write_text("cmake_minimum_required(VERSION 3.16)\nproject(toy LANGUAGES CXX)\n"
                                                 "add_library(toy src/quick.cpp src/slow.cpp src/wrong.cpp)\nadd_custom_target(e2e_cdiff_generate_messages_cpp)\n")
            stand_in = root / "programs/clang-tidy-14"
            stand_in.write_text("#!/bin/bash\ncase ${!#} in *slow*) exec sleep 60 ;; *wrong*) echo found; exit 1 ;; esac\n")
            stand_in.chmod(0o755)

            def check(minutes):
                return subprocess.run([root / "scripts" / "check", "--tidy", "--all", "--minutes", minutes], capture_output=True, text=True, check=False, timeout=50,
                                      env={**os.environ, "PATH": f"{root}/programs:{os.environ['PATH']}", "BUILD": "build", "JOBS": "3"})
            done = check("0.2")
            self.assertEqual(done.stdout, "found\nclang-tidy: 2 files, 1 with findings; its time ended before 1 more\n", done.stderr)
            self.assertEqual(done.returncode, 1)
            stand_in.write_text("#!/bin/bash\ncase ${!#} in *slow*) exec sleep 60 ;; esac\n")
            self.assertEqual(check("0.05").returncode, 0)  # the end of its time is no failure

    def test_continuous_integration_ends_with_the_line_of_the_tests(self):
        # Each case: exit codes of clang-tidy's check and of the tests -> that of .ci/run.
        for check, tests, expected in ((0, 0, 0), (1, 0, 1), (0, 1, 1), (2, 1, 1), (2, 0, 2)):
            with tempfile.TemporaryDirectory() as folder:
                root = Path(folder) / "package"
                for name, body in ((".ci/run", None), ("scripts/setup", "echo set up"), ("scripts/check", f"echo $*; exit {check}"),
                                   ("scripts/test", f"echo many lines; echo 5 passed, {tests} failed, 0 skipped; exit {tests}")):
                    (root / name).parent.mkdir(parents=True, exist_ok=True)
                    (root / name).write_text((SOURCE / name).read_text() if body is None else f"#!/bin/bash\n{body}\n")
                    (root / name).chmod(0o755)
                git = ["git", "-C", root, "-c", "user.name=a", "-c", "user.email=a@b"]
                subprocess.run([*git, "init", "-q", "-b", "main"], check=True)
                subprocess.run([*git, "add", "-A"], check=True)
                subprocess.run([*git, "commit", "-qm", "first"], check=True)
                done = subprocess.run([root / ".ci/run"], capture_output=True, text=True, check=False, timeout=60)
                self.assertEqual(done.returncode, expected, done.stderr)
                self.assertEqual(done.stdout.splitlines()[-1], f"5 passed, {tests} failed, 0 skipped")
                self.assertIn("--tidy --rotating --minutes 5\n", done.stdout)
                self.assertEqual("clang-tidy failed" in done.stdout, check != 0)

    def test_the_picture_of_the_layers_follows_the_lists_of_cmake(self):
        with tempfile.TemporaryDirectory() as folder:
            root = Path(folder)
            for name in ("scripts/draw_layers", "test/layers/check_layers.py", "test/support/junit.py"):
                (root / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(SOURCE / name, root / name)
            (root / "docs/images").mkdir(parents=True)
            for name, links in (("core", ""), ("geometry", "e2e_cdiff_core"), ("map", "e2e_cdiff_geometry e2e_cdiff_core"), ("learning", "")):
                (root / "src" / name).mkdir(parents=True)
                (root / "src" / name / "CMakeLists.txt").write_text(f"cdiff_layer({name}\n  SOURCES a.cpp LINK {links})  # e2e_cdiff_cbv\n")
            learning = root / "src/learning/CMakeLists.txt"
            learning.write_text("cdiff_layer(samples SOURCES a.cpp)\ncdiff_layer(learning SOURCES b.cpp LINK e2e_cdiff_samples)\n"
                                "target_link_libraries(e2e_cdiff_learning PRIVATE e2e_cdiff_core)\n")

            def draw(*arguments):
                return subprocess.run([root / "scripts/draw_layers", *arguments], capture_output=True, text=True, check=False).returncode
            self.assertEqual(draw("--check"), 1)
            self.assertEqual([draw(), draw("--check"), draw("--chek")], [0, 0, 3])
            picture = (root / "docs/images/layers.svg").read_text()
            self.assertEqual(set(re.findall(r'<text x="[^"]*" y="[^"]*">(\w+)<', picture)), {"core", "geometry", "map", "learning"})
            # geometry -> core, map -> geometry; that map is linked with core follows. The line of learning, six rows above core, has a part for each.
            self.assertEqual(picture.count('class="link"'), 2 + 6)
            self.assertEqual(picture.count('class="torch"'), 1 + 1)  # learning and the key
            learning.write_text(learning.read_text().replace("e2e_cdiff_core", "e2e_cdiff_map"))
            self.assertEqual(draw("--check"), 1)

    def test_nightly_tests_are_left_to_nightly(self):
        def ctest(*arguments):
            return next(call for call in calls_of("test", *arguments) if call[0] == "ctest")
        self.assertEqual(ctest()[-2:], ["-LE", "nightly"])
        self.assertNotIn("-LE", ctest("--nightly"))
        self.assertEqual(ctest("--nightly", "soak")[-2:], ["-R", "soak"])
        self.assertEqual(ctest("--nightly", "others")[-2:], ["-LE", "nightly"])
        self.assertEqual(calls_of("test", "--nighty"), [])
        self.assertIn(["e2e_cdiff_nightly_tests"], targets_of(calls_of("test", "--nightly")))

    def test_a_session_that_ends_at_once_keeps_its_exit_code_in_a_folder_with_a_space(self):
        with unbuilt_session() as session:
            self.assertEqual([session("scenario:=a").returncode for _ in range(5)], [2] * 5)  # not built yet

    def test_a_session_begins_where_its_output_is_closed(self):
        done = subprocess.run(["bash", "-c", f"BUILD='no build' '{SOURCE}/scripts/session' scenario:=a >&-"], capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, 2, done.stderr)  # not built
        self.assertNotIn("file descriptor", done.stderr)

    def test_a_session_refuses_control_characters_and_shows_none(self):
        with unbuilt_session() as session:
            for value in ("max_cbv=1\n", "max_cbv=1\vseed=2", "max_cbv=\x1b[31m1", "max_cbv=1\x7f"):
                done = session(f"set:={value}")
                self.assertEqual(done.returncode, 3, done.stderr)
                self.assertTrue(done.stderr.rstrip("\n").isprintable(), repr(done.stderr))
            self.assertEqual(session("scenario:=\u00e4").returncode, 2)

    def test_a_session_that_is_interrupted_at_once_says_so(self):
        def catches(process):
            status = Path(f"/proc/{process}/status").read_text()
            return int(re.search(r"^SigCgt:\s*(\w+)$", status, re.MULTILINE)[1], 16) >> (signal.SIGHUP - 1) & 1  # the last of its traps

        for delay in range(0, 100, 4):  # [ms] from when its shell takes signals
            with self.subTest(delay=delay), tempfile.TemporaryDirectory() as folder:
                session = subprocess.Popen([SOURCE / "scripts" / "session", "scenario:=a"], env={**os.environ, "BUILD": "no build"}, cwd=folder,
                                           stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, start_new_session=True)
                while session.poll() is None and not catches(session.pid):
                    pass
                time.sleep(delay / 1000)
                if session.poll() is None:
                    os.killpg(session.pid, signal.SIGINT)  # as Ctrl-C does
                said = session.communicate(timeout=60)[0]
                self.assertIn(session.returncode, (2, 130))  # 2: not built
                self.assertTrue(said.strip())
                self.assertNotIn("Traceback", said)

    def test_the_record_keeps_rows_of_checks_that_did_not_run(self):
        with tempfile.TemporaryDirectory() as folder:
            build, document = Path(folder), Path(folder) / "nightly.md"
            known = [{"name": name, "properties": [{"name": "LABELS", "value": ["nightly"]}]} for name in ("soak", "mutants", "new", "page", "gates")]
            ctest = build / "ctest"
            ctest.write_text("#!/bin/sh\necho '" + json.dumps({"tests": [*known, {"name": "unit"}]}) + "'\n")
            ctest.chmod(0o755)
            (build / "Testing").mkdir()
            (build / "Testing" / "ctest.xml").write_text(
                '<testsuite><testcase name="soak" time="90" status="run"/>'
                '<testcase name="page" time="0" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/></testcase>'
                '<testcase name="new" time="0" status="notrun"><skipped message="Unable to find executable: /new"/></testcase></testsuite>')
            results = build / "test_results" / "e2e_cdiff"
            junit.write(results / "gtest-soak.xml", "soak", [("a", 1.0, None), ("b", 1.0, "broke")])
            document.write_text("Text.\n<!-- written by scripts/test --nightly: begin -->\n| Check | Last run |\n|---|---|\n"
                                "| `mutants` | 2026-01-01 | abc | 2 cores | 54 passed, 0 failed | 12.0 |\n<!-- end -->\nMore.\n")
            subprocess.run([SOURCE / "test" / "nightly" / "record.py", build, document, json.dumps(["2026-02-02", "def", "1 core"])], check=True,
                           env={**os.environ, "PATH": f"{folder}:{os.environ['PATH']}"})
            rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in document.read_text().splitlines() if "|" in line][2:]
            self.assertEqual([row[0] for row in rows], ["every other test", "`soak`", "`mutants`", "`new`", "`page`"])
            self.assertEqual(rows[1][1:], ["2026-02-02", "def", "1 core", "1 passed, 1 failed", "1.5"])
            self.assertEqual(rows[3][4], "failed")  # its program is missing
            self.assertIn("left out", rows[4][4])
            self.assertEqual(rows[2][1:], ["2026-01-01", "abc", "2 cores", "54 passed, 0 failed", "12.0"])
            self.assertEqual(rows[0][1], "not run yet")  # "unit" was left out
            self.assertTrue(document.read_text().startswith("Text.\n") and document.read_text().endswith("-->\nMore.\n"))

    def test_a_test_that_is_skipped_is_no_passed_one(self):
        class Some(unittest.TestCase):
            def test_runs(self):
                pass

            @unittest.skip("not here")
            def test_is_skipped(self):
                pass

        suite = unittest.defaultTestLoader.loadTestsFromTestCase(Some)
        names = [test.id() for test in suite]
        with tempfile.TemporaryDirectory() as folder:
            junit.write_unittest(Path(folder) / "some.xml", "some", unittest.TextTestRunner(stream=io.StringIO()).run(suite), names)
            counted = subprocess.run([sys.executable, SOURCE / "scripts" / "count_tests.py", folder], capture_output=True, text=True, check=False).stdout
        self.assertEqual(counted.splitlines()[-1], "1 passed, 0 failed, 1 skipped")


if __name__ == "__main__":
    suite = unittest.defaultTestLoader.loadTestsFromTestCase(Scripts)
    names = [test.id() for test in suite]
    outcome = unittest.TextTestRunner(verbosity=2).run(suite)
    junit.write_unittest(sys.argv[3], "scripts", outcome, names)
    sys.exit(not outcome.wasSuccessful())
