# SPDX-License-Identifier: BSD-3-Clause
# Copyright (c) 2026 The e2e_cdiff authors
"""Networks from parametrized plain XML: nodes, edges and connections, every number drawn (m, m/s, map frame)."""
import math

KINDS = ["roundabout", "merge", "lane_drop", "weaving", "bridge_ramp", "t_junction", "signals", "crossing"]
STREET_SPEEDS = [8.33, 11.11, 13.89, 16.67]
ROAD_SPEEDS = [13.89, 16.67, 19.44, 22.22]
XML_HEAD = ('<?xml version="1.0" encoding="UTF-8"?>\n<!-- SPDX-License-Identifier: BSD-3-Clause -->\n'
            "<!-- Copyright (c) 2026 The e2e_cdiff authors -->\n")


class Plan:
    """Sources of one network; ids get its prefix, so that no edge is called as one of another suite."""

    def __init__(self, prefix):
        self.prefix = prefix
        self.nodes, self.edges, self.connections = [], [], []
        self.through = []  # edges of which a route must contain one; empty: any route will do

    def node(self, name, x, y, z=0.0, kind="priority"):
        self.nodes.append(f'<node id="{self.prefix}{name}" x="{x:.1f}" y="{y:.1f}" z="{z:.1f}" type="{kind}"/>')

    def edge(self, name, start, end, lanes, speed, priority=2, shape=()):
        points = " ".join(",".join(f"{value:.1f}" for value in point) for point in shape)
        self.edges.append(
            f'<edge id="{self.prefix}{name}" from="{self.prefix}{start}" to="{self.prefix}{end}" numLanes="{lanes}" '
            f'speed="{speed}" priority="{priority}"' + (f' shape="{points}"' if points else "") + "/>")

    def both_ways(self, name, start, end, lanes, speed, priority=2, shape=()):
        self.edge(name + "_in", end, start, lanes, speed, priority, list(reversed(shape)))
        self.edge(name + "_out", start, end, lanes, speed, priority, shape)

    def connect(self, start, end, pairs):
        """Lanes of one edge to lanes of the next, counted from the right."""
        for one, other in pairs:
            self.connections.append(f'<connection from="{self.prefix}{start}" to="{self.prefix}{end}" '
                                    f'fromLane="{one}" toLane="{other}"/>')

    def sources(self):
        """Text of each source by the end of its name."""
        texts = {}
        for end, root, lines in (("nod", "nodes", self.nodes), ("edg", "edges", self.edges),
                                 ("con", "connections", self.connections)):
            if lines:
                texts[end] = XML_HEAD + f"<{root}>\n" + "".join(f"    {line}\n" for line in lines) + f"</{root}>\n"
        return texts


def at(angle, radius):
    """Point at an angle [deg] and a distance [m] from the origin."""
    return radius * math.cos(math.radians(angle)), radius * math.sin(math.radians(angle))


def add_arm(plan, draws, name, angle, inner, start, lanes, speed, priority):
    """A road from a junction outward, bent half-way; `inner` is the distance at which it starts."""
    bend = draws.uniform(-20, 20)
    middle, outer = at(angle, inner + 70), at(angle + bend * 0.5, inner + draws.uniform(140, 175))
    plan.node(name, *outer, kind="dead_end")
    plan.both_ways(name, start, name, lanes, speed, priority, [at(angle, inner), middle, outer])


def roundabout(plan, draws):
    arms, lanes = draws.whole(3, 5), draws.whole(1, 2)
    radius = draws.uniform(17, 25) + 9 * (lanes - 1)
    speed = draws.pick(STREET_SPEEDS[:3])
    angles = [draws.uniform(0, 60) + 360.0 / arms * i + draws.uniform(-8, 8) for i in range(arms)]
    for i, angle in enumerate(angles):
        plan.node(f"ring{i}", *at(angle, radius))
        add_arm(plan, draws, f"arm{i}", angle, radius, f"ring{i}", lanes, speed, 1)
    angles.append(angles[0] + 360.0)
    for i in range(arms):
        step = (angles[i + 1] - angles[i]) / 8.0
        arc = [at(angles[i] + step * j, radius) for j in range(9)]
        plan.edge(f"circle{i}", f"ring{i}", f"ring{(i + 1) % arms}", lanes, 8.33, 3, arc)
        plan.through.append(f"circle{i}")


def crossing_arms(plan, draws, angles, lanes, kind):
    """Arms at the given angles, every second one a main road."""
    plan.node("middle", 0, 0, kind=kind)
    speeds = [draws.pick(STREET_SPEEDS) for _ in range(2)]
    for i, angle in enumerate(angles):
        skewed = angle + draws.uniform(-12, 12)
        add_arm(plan, draws, f"arm{i}", skewed, 0, "middle", lanes[i % 2], speeds[i % 2], 3 - 2 * (i % 2))


def t_junction(plan, draws):
    crossing_arms(plan, draws, [0, draws.pick([80, 90, 100]), 180], [draws.whole(1, 2), 1], "priority_stop")


def signals(plan, draws):
    crossing_arms(plan, draws, [0, 90, 180, 270], [draws.whole(2, 3), draws.whole(1, 2)], "traffic_light")


def crossing(plan, draws):
    kind = draws.pick(["right_before_left", "priority", "allway_stop"])
    lanes = [1, 1] if kind == "right_before_left" else [draws.whole(1, 2), 1]
    crossing_arms(plan, draws, [0, 90, 180, 270], lanes, kind)


def add_return(plan, draws, start, end, speed):
    """The opposite direction of a road along the x axis, beside it (the median is 3 m wide)."""
    plan.node("back_from", end, 3, kind="dead_end")
    plan.node("back_to", start, 3, kind="dead_end")
    plan.edge("back", "back_from", "back_to", draws.whole(1, 2), speed)


def add_ramp(plan, draws, name, node, reach, entering, lanes, speed):
    """A ramp south of the x axis that meets the road in node (name, x) at an acute angle."""
    x = node[1]
    side = -1.0 if entering else 1.0
    depth = draws.uniform(28, 45)
    points = [(x, 0), (x + side * 0.35 * reach, -0.06 * reach), (x + side * 0.7 * reach, -0.5 * depth),
              (x + side * reach, -depth)]
    plan.node(f"{name}_end", *points[-1], kind="dead_end")
    ends = (f"{name}_end", node[0]) if entering else (node[0], f"{name}_end")
    plan.edge(name, *ends, lanes, speed, 1, list(reversed(points)) if entering else points)


def main_road(plan, draws, places, lanes, speed, names):
    """A road along the x axis through nodes p0, p1, ... at the given places, an edge between each two."""
    for i, place in enumerate(places):
        plan.node(f"p{i}", place, 0, kind="dead_end" if i in (0, len(places) - 1) else "priority")
    for i, name in enumerate(names):
        plan.edge(name, f"p{i}", f"p{i + 1}", lanes[i], speed, 3)
    add_return(plan, draws, places[0], places[-1], speed)


def merge(plan, draws):
    """An on-ramp of one or two lanes onto a road of two or three; the added lanes end."""
    lanes, ramp, speed = draws.whole(2, 3), draws.whole(1, 2), draws.pick(ROAD_SPEEDS)
    end = 160 + draws.uniform(70, 110)
    main_road(plan, draws, [0, 160, end, end + 160], [lanes, lanes + ramp, lanes], speed, ["before", "merge", "after"])
    add_ramp(plan, draws, "ramp", ("p1", 160), 130, True, ramp, draws.pick(STREET_SPEEDS))
    plan.connect("before", "merge", [(i, i + ramp) for i in range(lanes)])
    plan.connect("ramp", "merge", [(i, i) for i in range(ramp)])
    plan.connect("merge", "after", [(i + ramp, i) for i in range(lanes)])
    plan.through.append("merge")


def lane_drop(plan, draws):
    """Three lanes become two, two become one; lanes end on the right or on the left."""
    speed, first = draws.pick(ROAD_SPEEDS[:3]), 150
    second = first + draws.uniform(70, 110)
    main_road(plan, draws, [0, first, second, second + 160], [3, 2, 1], speed, ["three", "two", "one"])
    skip = [draws.whole(0, 1), draws.whole(0, 1)]
    plan.connect("three", "two", [(i + skip[0], i) for i in range(2)])
    plan.connect("two", "one", [(skip[1], 0)])
    plan.through.append("two")


def weaving(plan, draws):
    """An on-ramp and an off-ramp with an auxiliary lane between them, so that both streams cross."""
    lanes, speed = draws.whole(2, 3), draws.pick(ROAD_SPEEDS)
    end = 150 + draws.uniform(90, 140)
    main_road(plan, draws, [0, 150, end, end + 150], [lanes, lanes + 1, lanes], speed, ["before", "weave", "after"])
    add_ramp(plan, draws, "on", ("p1", 150), 120, True, 1, draws.pick(STREET_SPEEDS))
    add_ramp(plan, draws, "off", ("p2", end), 120, False, 1, draws.pick(STREET_SPEEDS))
    plan.connect("before", "weave", [(i, i + 1) for i in range(lanes)])
    plan.connect("on", "weave", [(0, 0)])
    plan.connect("weave", "after", [(i + 1, i) for i in range(lanes)])
    plan.connect("weave", "off", [(0, 0)])
    plan.through.append("weave")


def bridge_ramp(plan, draws):
    """A road on a bridge over another one, and a ramp that climbs from the lower road and joins on the bridge."""
    height, join = draws.uniform(6, 8), draws.uniform(120, 150)
    lanes, speed, low = draws.whole(1, 2), draws.pick(ROAD_SPEEDS[:3]), draws.pick(STREET_SPEEDS)
    foot = -draws.uniform(120, 150)
    end = join + draws.uniform(70, 100)
    for name, x, y, z, kind in (("west", -150, 0, height, "dead_end"), ("join", join, 0, height, "priority"),
                                ("narrow", end, 0, height, "priority"), ("east", end + 150, 0, height, "dead_end"),
                                ("south", 0, foot - 120, 0, "dead_end"), ("foot", 0, foot, 0, "priority"),
                                ("north", 0, 160, 0, "dead_end")):
        plan.node(name, x, y, z, kind)
    for name, start, finish, count in (("bridge", "west", "join", lanes), ("added", "join", "narrow", lanes + 1),
                                       ("onward", "narrow", "east", lanes)):
        plan.edge(name, start, finish, count, speed, 3)
        plan.edge("opposite_" + name, finish, start, lanes, speed, 3)
    for name, start, finish in (("low", "south", "foot"), ("under", "foot", "north")):
        plan.both_ways(name, start, finish, 1, low)
    curve = [(0.0, foot, 0.0)]
    for share in (0.15, 0.3, 0.45, 0.6, 0.75, 0.9):
        x = join * (3 * share * share * (1 - share) * 0.55 + share**3) + 24 * share * (1 - share)
        y = foot * ((1 - share)**3 + 3 * share * (1 - share)**2 * 0.6 + 3 * share * share * (1 - share) * 0.09)
        curve.append((x, y, height * share))
    plan.edge("ramp", "foot", "join", 1, draws.pick(STREET_SPEEDS), 1, curve + [(join, 0.0, height)])
    for start, finish in (("low_out", "under_out"), ("low_out", "ramp"), ("under_in", "low_in")):
        plan.connect(start, finish, [(0, 0)])
    plan.connect("bridge", "added", [(i, i + 1) for i in range(lanes)])
    plan.connect("ramp", "added", [(0, 0)])
    plan.connect("added", "onward", [(i + 1, i) for i in range(lanes)])
    plan.through.append("added")


DRAWN = {"roundabout": roundabout, "merge": merge, "lane_drop": lane_drop, "weaving": weaving,
         "bridge_ramp": bridge_ramp, "t_junction": t_junction, "signals": signals, "crossing": crossing}


def drawn_plan(kind, draws, prefix):
    plan = Plan(prefix)
    DRAWN[kind](plan, draws)
    return plan
