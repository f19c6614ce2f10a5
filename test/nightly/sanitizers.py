#!/usr/bin/python3
"""Build with a sanitizer of gcc in a folder of its own and run the unit tests in it.

    sanitizers.py address|thread BUILD SOURCE RESULT.xml [PROGRAM...]

`address`: AddressSanitizer and UndefinedBehaviorSanitizer, all layers without ROS and libtorch, sessions with the real SUMO among
their tests. `thread`: ThreadSanitizer, the tests of what runs processes and threads. ROS, libtorch and oneDNN come without
instrumentation, so what belongs to them is left out or suppressed. Each test program is one case.
"""
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402
from source_copy import environment_of  # noqa: E402

KIND, BUILD, SOURCE, RESULT = sys.argv[1], Path(sys.argv[2]).resolve(), Path(sys.argv[3]).resolve(), Path(sys.argv[4])
FLAGS = {"address": "-fsanitize=address,undefined -fno-sanitize-recover=undefined", "thread": "-fsanitize=thread"}
# Instrumented, gcc 12 takes the vector that its own avx512fintrin.h leaves undefined on purpose for a fault of ours.
# ThreadSanitizer does not know fences, which Boost's Asio has.
WARNINGS = "-Wno-error=uninitialized -Wno-error=maybe-uninitialized -Wno-error=tsan"
# Their sessions run in other processes, which take hours with a sanitizer.
LEFT_OUT = ("test_cli_",)
# Nothing of memory or threads is in these that the others do not run too, and with a sanitizer they take many minutes.
SLOW = {"test_suite_suite_generator", "test_suite_shipped_suite", "test_diffusion_planner_guided_plans", "test_diffusion_planner_modes",
        "test_planners_mirror_symmetry", "test_diffusion_safetensors_memory", "test_session_soak", "test_evaluation_driving_gate"}
THREADED = ["test_core_fork_server", "test_core_forked_work", "test_core_lease", "test_core_process_pool", "test_core_stage_times",
            "test_map_drivable_area", "test_diffusion_image_encoder", "test_diffusion_planner_guided_plans",
            "test_evaluation_executor", "test_evaluation_worker", "test_session_decision_cycle",
            "test_session_observer_thread", "test_session_session_control", "test_simulation_sumo_loss",
            "test_video_session_video", "test_watch_live_session"]
# Cases that are enough with ThreadSanitizer: the others of the program run the same threads, minutes each.
CASES = {"test_diffusion_planner_guided_plans": "*.SafetyCriticalApproachesTheEgo"} if KIND == "thread" else {}
OPTIONS = {"ASAN_OPTIONS": "detect_leaks=1:abort_on_error=0", "UBSAN_OPTIONS": "print_stacktrace=1",
           "LSAN_OPTIONS": "print_suppressions=0", "TSAN_OPTIONS": "halt_on_error=0:exitcode=66:second_deadlock_stack=1:die_after_fork=0"}
# ThreadSanitizer: GDAL, which OpenCV's image codecs load, takes two locks of its own in either order at its start, in one thread.
DEADLOCKS = "deadlock:libgdal.so\n"
# LeakSanitizer: libtraci does not free a connection whose SUMO is lost; libsumo's readers of XML keep some texts.
LEAKS = "leak:libtracicpp.so\nleak:libxerces-c\nleak:libicuuc.so\n"


def programs(folder):
    """Names of the test programs to build: those asked for, else all that the sanitizer is for."""
    if sys.argv[5:]:
        return sys.argv[5:]
    if KIND == "thread":
        return THREADED
    listed = subprocess.run(["ninja", "-C", folder, "-t", "targets", "all"], check=True, capture_output=True, text=True).stdout
    names = {line.partition(":")[0] for line in listed.splitlines() if line.endswith(": phony")}
    return sorted(name for name in names if name.startswith("test_") and name not in SLOW and not name.startswith(LEFT_OUT))


def build(folder):
    subprocess.run(["cmake", "-S", SOURCE, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=None", "-DE2E_CDIFF_ROS=OFF",
                    "-DE2E_CDIFF_TRAINING=OFF", "-DE2E_CDIFF_BENCHMARKS=OFF", "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache",
                    f"-DCMAKE_CXX_FLAGS=-O1 -g1 -fno-omit-frame-pointer {FLAGS[KIND]} {WARNINGS}"], check=True, stdout=subprocess.DEVNULL)
    names = programs(folder)
    subprocess.run(["ninja", "-C", folder, *names], check=True)
    return names


def foreign_libraries(program, folder, environment):
    """Libraries of ours that the program would load from another build, where they have no sanitizer; one line each."""
    shown = subprocess.run(["ldd", program], env=environment, check=True, capture_output=True, text=True).stdout
    ours = [line.split("=>")[1].split()[0] for line in shown.splitlines() if "libe2e_cdiff_" in line and "=>" in line]
    return "".join(f"{library} is not of this build\n" for library in ours if not library.startswith(str(folder)))


def run(program, folder):
    """None when the program passes, else the end of what it wrote."""
    environment = {**environment_of(folder, SOURCE), **OPTIONS}
    # Not that of the caller, whose libraries, without sanitizer, would come before those that the program names.
    library = next(folder.rglob("libe2e_cdiff_libsumo.so"), None)  # loaded by its name alone
    environment["LD_LIBRARY_PATH"] = str(library.parent) if library else ""
    for options, text in (("TSAN_OPTIONS", DEADLOCKS), ("LSAN_OPTIONS", LEAKS)):
        suppressions = folder / f"{options}.txt"
        suppressions.write_text(text)
        environment[options] += f":suppressions={suppressions}"
    environment.setdefault("E2E_CDIFF_DATA", str(SOURCE / ".." / "shared" / "data"))
    foreign = foreign_libraries(program, folder, environment)
    if foreign:
        return foreign
    # Limits of memory are for programs without a sanitizer.
    arguments = [program, "--gtest_filter=" + CASES.get(program.name, "") + "-*Memory*"]
    try:
        done = subprocess.run(arguments, env=environment, cwd=program.parent, timeout=900, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, errors="replace", check=False)
    except subprocess.TimeoutExpired:
        return "no end within 900 s"
    return None if done.returncode == 0 else f"exit code {done.returncode}\n" + done.stdout[-6000:]


def main():
    folder = BUILD / f"sanitizer_{KIND}"
    cases = []
    for name in build(folder):
        begin = time.monotonic()
        failure = run(next(path for path in folder.rglob(name) if path.is_file()), folder)
        cases.append((name, time.monotonic() - begin, failure))
        print(f"{cases[-1][1]:7.1f} s  {'FAILED' if failure else 'passed'}  {name}", flush=True)
        if failure:
            print(failure, flush=True)
    junit.write(RESULT, f"sanitizer_{KIND}", cases)
    return any(failure for _, _, failure in cases)


if __name__ == "__main__":
    sys.exit(main())
