# SPDX-License-Identifier: BSD-3-Clause
# Copyright (c) 2026 The e2e_cdiff authors
"""Networks by SUMO's netgenerate: random nets (--rand) and spider webs (--spider), with lanes, speeds and priorities by
types and lights guessed by netgenerate. No training code calls netgenerate (test/suite/check_sealed_suites.py)."""
from plain_networks import XML_HEAD

SPEEDS = [8.33, 11.11, 13.89, 16.67]  # m/s
KINDS = ["random", "random", "random", "random", "random", "spider", "spider", "spider"]


def types_xml(draws):
    """Three types of road: priority, lanes a direction and limit [m/s]; --random-type gives each road one of them."""
    roads = [(3, draws.whole(2, 3)), (2, draws.whole(1, 2)), (1, 1)]
    lines = [f'    <type id="road{priority}" priority="{priority}" numLanes="{lanes}" speed="{draws.pick(SPEEDS)}"/>'
             for priority, lanes in roads]
    return XML_HEAD + "<types>\n" + "\n".join(lines) + "\n</types>\n"


def random_options(draws):
    return ["--rand", "--rand.iterations", draws.whole(10, 15), "--rand.min-distance", draws.whole(70, 95),
            "--rand.max-distance", draws.whole(120, 170), "--rand.min-angle", draws.whole(45, 60),
            "--rand.connectivity", 0.95, "--bidi-probability", 1]


def spider_options(draws):
    options = ["--spider", "--spider.arm-number", draws.whole(4, 6), "--spider.circle-number", 2,
               "--spider.space-radius", draws.whole(70, 100), "--perturb-x", f"norm(0,{draws.uniform(4, 8)})",
               "--perturb-y", f"norm(0,{draws.uniform(4, 8)})"]
    return options + (["--spider.omit-center"] if draws.unit() < 0.5 else [])


def options_of(kind, draws):
    """netgenerate's drawn options; how lanes and junctions are built stands in networks/netconvert.netccfg."""
    options = random_options(draws) if kind == "random" else spider_options(draws)
    options += ["--random-type", "--tls.guess", "--tls.guess.threshold", draws.whole(35, 60)]
    return [str(option) for option in options + ["--seed", draws.whole(1, 10**6)]]
