# SPDX-License-Identifier: BSD-3-Clause
# Copyright (c) 2026 The e2e_cdiff authors
"""Ego routes through a SUMO network, drawn by a fixed rule that knows nothing of how a session ends.

Rule: two edges are drawn; between them the shortest chain of connected edges that the lanes allow (a lane change needs
40 m of its edge). The route starts 5 m or more after the first edge's start and ends 25 m or more into the last edge,
both drawn. It is kept when it is 150 to 300 m long, passes a junction where another edge joins or a lane ends, and
enters one of the edges that the network is made for (where it names some). Nothing else is asked of it.
"""
import heapq
import math
import xml.etree.ElementTree as ElementTree

SHORTEST, LONGEST = 150.0, 300.0  # m
LANE_CHANGE = 40.0  # m of an edge for each lane
BEFORE_JUNCTION = 25.0  # m from start or goal to the nearest junction
TRIES = 2000


class Network:
    """Edges, lanes and connections of a .net.xml file; turn-rounds are left out."""

    def __init__(self, text):
        root = ElementTree.fromstring(text)
        self.edges, self.length, self.shapes, self.ends = {}, {}, {}, {}
        for edge in root.iter("edge"):
            lanes = edge.findall("lane")
            self.edges[edge.get("id")] = [lane.get("id") for lane in lanes]
            self.ends[edge.get("id")] = (edge.get("from"), edge.get("to"))
            for lane in lanes:
                self.length[lane.get("id")] = float(lane.get("length"))
                self.shapes[lane.get("id")] = [tuple(map(float, point.split(",")[:2]))
                                               for point in lane.get("shape").split()]
        self.read_connections(root)
        self.junctions = {junction.get("id"): junction for junction in root.iter("junction")}

    def read_connections(self, root):
        self.links = {}  # (from edge, to edge): {from lane: (to lane, via)}
        self.inside = {}  # internal lane: the next internal lane
        for link in root.iter("connection"):
            if link.get("from").startswith(":"):
                if link.get("via"):
                    self.inside[f"{link.get('from')}_{link.get('fromLane')}"] = link.get("via")
            elif link.get("dir") != "t":
                lanes = self.links.setdefault((link.get("from"), link.get("to")), {})
                lanes.setdefault(int(link.get("fromLane")), (int(link.get("toLane")), link.get("via")))

    def ordinary_edges(self):
        return sorted(edge for edge in self.edges if not edge.startswith(":"))

    def edge_length(self, edge):
        return self.length[self.edges[edge][0]]

    def chain(self, via):
        """Internal lanes of one connection."""
        lanes = []
        while via:
            lanes.append(via)
            via = self.inside.get(via)
        return lanes

    def through(self, start, end):
        """The connection on the right: its internal lanes."""
        lanes = self.links[start, end]
        return self.chain(lanes[min(lanes)][1])


def shortest_chain(network, start, end):
    """Edges from start to end with the least length of those between; ties by id."""
    following = {}
    for one, other in sorted(network.links):
        following.setdefault(one, []).append(other)
    queue, done = [(0.0, [start])], set()
    while queue:
        cost, chain = heapq.heappop(queue)
        if chain[-1] == end:
            return chain
        if chain[-1] in done:
            continue
        done.add(chain[-1])
        for edge in following.get(chain[-1], []):
            inner = sum(network.length[lane] for lane in network.through(chain[-1], edge))
            heapq.heappush(queue, (round(cost + inner + network.edge_length(edge), 3), chain + [edge]))
    return None


def lanes_allow(network, chain, first_length):
    """Whether lane changes of LANE_CHANGE meters each lead along the chain, from any lane of the first edge."""
    lanes = set(range(len(network.edges[chain[0]])))
    for i, (one, other) in enumerate(zip(chain, chain[1:])):
        reach = int((first_length if i == 0 else network.edge_length(one)) / LANE_CHANGE)
        pairs = network.links[one, other]
        lanes = {to for lane, (to, _) in pairs.items() if any(abs(lane - own) <= reach for own in lanes)}
    return bool(lanes)


def passes_conflict(network, chain):
    """Whether another edge joins on the way, or the next edge has fewer lanes."""
    for one, other in zip(chain, chain[1:]):
        node = network.ends[one][1]
        entering = [edge for edge in network.ordinary_edges() if network.ends[edge][1] == node and edge != one]
        back = network.ends[other][1], node  # the opposite direction of the road that is driven on
        if any(network.ends[edge] != back for edge in entering):
            return True
        if len(network.edges[other]) < len(network.edges[one]):
            return True
    return False


def draw_route(network, draws, through):
    """The first route that the rule allows, or None after TRIES pairs of edges."""
    edges = network.ordinary_edges()
    for _ in range(TRIES):
        start, end = draws.pick(edges), draws.pick(edges)
        shares = draws.unit(), draws.unit()
        if start == end or network.edge_length(start) < 5.0 + BEFORE_JUNCTION:
            continue
        if network.edge_length(end) < 5.0 + BEFORE_JUNCTION:
            continue
        chain = shortest_chain(network, start, end)
        if chain is None or (through and not set(chain[1:]) & set(through)):
            continue
        route = with_offsets(network, chain, shares)
        driven = network.edge_length(start) - route["start_offset"]
        if SHORTEST <= route["length"] <= LONGEST and lanes_allow(network, chain, driven) and passes_conflict(
                network, chain):
            return route
    return None


def with_offsets(network, chain, shares):
    """Start and end by two shares in [0, 1) of what the first and last edge leave."""
    first, last = network.edge_length(chain[0]), network.edge_length(chain[-1])
    start = round(5.0 + shares[0] * (first - 5.0 - BEFORE_JUNCTION), 1)
    end = round(5.0 + shares[1] * (last - 5.0 - BEFORE_JUNCTION), 1)
    length = first - start + last - end + sum(network.edge_length(edge) for edge in chain[1:-1])
    for pair in zip(chain, chain[1:]):
        length += sum(network.length[lane] for lane in network.through(*pair))
    return {"edges": chain, "start_offset": start, "end_offset": end, "length": round(length, 1)}


def turns(network, chain):
    """Change of heading at each junction of the chain [deg, positive left]."""
    found = []
    for one, other in zip(chain, chain[1:]):
        before, after = network.shapes[network.edges[one][0]], network.shapes[network.edges[other][0]]
        heading = [math.degrees(math.atan2(b[1] - a[1], b[0] - a[0]))
                   for a, b in ((before[-2], before[-1]), (after[0], after[1]))]
        found.append((heading[1] - heading[0] + 180.0) % 360.0 - 180.0)
    return found


def conflicts(network, chain):
    """How many edges have streams that cross the chain at its junctions (SUMO's foes of its connections) or join it."""
    found = set()
    for one, other in zip(chain, chain[1:]):
        found |= {start for start, end in network.links if end == other}
        found |= crossing_edges(network, one, other)
    return len(found - set(chain))


def crossing_edges(network, one, other):
    """Edges whose connections are foes of the connection from one edge to the other."""
    junction = network.junctions[network.ends[one][1]]
    inner = junction.get("intLanes").split()
    owner = {}  # index of a connection in the junction: the edge that it comes from
    for (start, _), lanes in network.links.items():
        for _, via in lanes.values():
            owner.update({inner.index(lane): start for lane in network.chain(via) if lane in inner})
    foes = {int(row.get("index")): row.get("foes") for row in junction.findall("request")}
    rows = [foes.get(inner.index(lane), "") for lane in network.through(one, other) if lane in inner]
    return {owner[i] for bits in rows for i in owner if i < len(bits) and bits[-1 - i] == "1"}
