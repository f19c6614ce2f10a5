#!/usr/bin/python3
"""Check the layer table on the compiler's own dependency records: which headers each target really read.

    check_layers.py BUILD SOURCE RESULT.xml

Debian puts ROS, SUMO, torch and OpenCV headers in /usr/include, so the compiler stops nobody; this does.
"""
import re
import subprocess
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402

# Headers that only some layers may read: pattern -> layers that may.
RESTRICTED = {
    "ROS": (r"^/usr/include/(ros|rosbag|tf2|tf2_ros|roscpp|xmlrpcpp|rosconsole|message_filters|diagnostic_updater|dynamic_reconfigure|image_transport|cv_bridge|"
            r"[a-z_]+_msgs)/|/devel/include/", {"node_graph", "nodes", "cli", "examples"}),
    "torch": (r"^/usr/include/(torch|ATen|c10)/", {"learning", "planner_training"}),
    "planner training": (r"/src/planners/[a-z_0-9]+/training/", {"planner_training"}),
    "oneDNN": (r"^/usr/include/(oneapi/)?dnnl", {"inference", "diffusion"}),
    "libsumo": (r"^/usr/include/libsumo/", {"simulation"}),
    "OpenCV": (r"^/usr/include/opencv4/", {"rendering", "record", "page", "video", "node_graph"}),
}
# Layers from the lowest up: a layer reads headers of its own row and of rows above it in this list.
ORDER = ["core", "geometry", "map traffic", "dynamics", "cbv reference_driver", "metrics guidance inference rendering simulation", "diffusion learning storyboard", "planning",
         "planners", "session", "plugins suite record", "planner_training", "page exchange", "video watch what_if", "collection", "evaluation node_graph", "realism", "nodes cli"]
RANK = {name: rank for rank, row in enumerate(ORDER) for name in row.split()}


def records_of_ninja(build):
    text = subprocess.run(["ninja", "-C", build, "-t", "deps"], check=True, capture_output=True, text=True).stdout
    record, headers = None, []
    for line in text.splitlines():
        if line and not line.startswith((" ", "ninja:")):
            record, headers = line.split(":")[0], []
            yield record, headers
        elif line.strip():
            headers.append(line.strip())


def records_of_make(build):
    for path in Path(build).rglob("*.o.d"):
        words = path.read_text().replace("\\\n", " ").split()
        yield str(path.relative_to(build))[:-2], words[1:]


def layer_of_folder(folder):
    """Layer of a folder below src: its first part, and planner_training for planners/NAME/training."""
    return "planner_training" if re.fullmatch(r"planners/[a-z_0-9]+/training", folder) else folder.split("/")[0]


def layer_of(record):
    """Layer of an object file; in a catkin workspace its path begins with the package's folder."""
    if "examples/" in record:
        return "examples"
    found = re.search(r"(?:^|/)src/([a-z_0-9/]+)/CMakeFiles/", record)
    return layer_of_folder(found.group(1)) if found else None


def violations(layer, headers, source, build):
    for header in headers:
        path = str((Path(build) / header).resolve())
        for name, (pattern, allowed) in RESTRICTED.items():
            if layer not in allowed and re.search(pattern, path):
                yield f"reads {name}'s header {path}"
        inside = re.search(re.escape(source) + r"/(?:include/e2e_cdiff|src)/([a-z_0-9/]+)/", path)
        if inside and RANK.get(layer_of_folder(inside.group(1)), -1) > RANK.get(layer, 99):
            yield f"reads {path}, which is of a higher layer"


def main():
    build, source, result = sys.argv[1:4]
    source = str(Path(source).resolve())
    records = list(records_of_ninja(build) if (Path(build) / "build.ninja").exists() else records_of_make(build))
    checked = [(record, headers) for record, headers in records if layer_of(record)]
    cases = {}  # by layer
    for record, headers in checked:
        found = sorted(set(violations(layer_of(record), headers, source, build)))
        cases.setdefault(layer_of(record), []).extend(f"{record}: {line}" for line in found)
    print("".join(f"{line}\n" for found in cases.values() for line in found), end="")
    if not cases:
        print("no dependency record was found; build first")
    junit.write_findings(result, "layers", cases.items())
    return 1 if not cases or any(cases.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
