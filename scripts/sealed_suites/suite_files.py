# SPDX-License-Identifier: BSD-3-Clause
# Copyright (c) 2026 The e2e_cdiff authors
"""The files of a sealed suite: scenarios, suite.yaml, and seal.sha256 with a line "HASH  PATH" for every other file."""
import hashlib

HEAD = "# SPDX-License-Identifier: BSD-3-Clause\n# Copyright (c) 2026 The e2e_cdiff authors\n#\n"
VEHICLES = {"low": 9, "medium": 12, "high": 16}  # kept alive near the ego, as in the other suites


def scenario_text(route):
    """The session of a route; the protocol's own time limit holds (40 s)."""
    return (HEAD + f"# Route of a sealed suite (docs/sealed_suites.md): {route['manoeuvre']}, traffic {route['density']}."
            f"\n\nschema_version: 1\nname: {route['name']}\n"
            f"network: ../networks/{route['network']}/{route['network']}.net.xml\n"
            f"route:\n  edges: [{', '.join(route['edges'])}]\n  start_offset: {route['start_offset']:g}\n"
            f"  end_offset: {route['end_offset']:g}\n  start_speed: 6\ndemand: generated\n"
            f"traffic:\n  density: {VEHICLES[route['density']]}\n  radius: 120\n  warm_up: 30\n"
            "protocol:\n  preset: rift_dev10\n"
            "verdict:\n  minimum_route_completion: 90\n  statuses: [completed, timed_out, collided]\n"
            f"  maximum_contacts_at_fault: 0\n  contact_without_fault: by_mode\nseed: {route['seed']}\n")


def suite_text(name, seed, routes):
    lines = [f"  - {{name: {r['name']}, network: {r['network']}, edges: [{', '.join(r['edges'])}], "
             f"start_offset: {r['start_offset']:g}, end_offset: {r['end_offset']:g}, manoeuvre: {r['manoeuvre']}, "
             f"turn: {r['turn']:g}, length: {r['length']:g}, conflicts: {r['conflicts']}, density: {r['density']}, "
             f"seed: {r['seed']}}}\n" for r in routes]
    return (HEAD + "# Routes of a sealed suite: offsets and lengths in m, turns in degrees (positive left); "
            f"docs/sealed_suites.md.\n\nschema_version: 1\nname: {name}\nseed: {seed}\nsealed: true\nroutes:\n"
            + "".join(lines))


def write_seal(folder):
    """Hashes of all files in the folder, sorted by path; sha256sum -c reads them."""
    files = sorted(path for path in folder.rglob("*") if path.is_file() and path.name != "seal.sha256")
    lines = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.relative_to(folder)}\n" for path in files]
    (folder / "seal.sha256").write_text("".join(lines))
