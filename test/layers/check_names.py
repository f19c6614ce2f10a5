#!/usr/bin/python3
"""Check that a name stands as a string in its table alone: where else it is spelled, a change of the table would not reach.

    check_names.py SOURCE RESULT.xml

Each section of SECTIONS names a table, how names are read from it and which files are searched for them.
"""
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402

LITERAL = re.compile(r'"((?:[^"\\\n]|\\.)*)"')
INCLUDE = re.compile(r"^[ \t]*#[ \t]*include.*$", re.MULTILINE)


def literals_of(text):
    """(line number, contents) of each string of a C++ source; comments and includes hold none. Neighbors are one string."""
    text = INCLUDE.sub("", text)
    text = re.sub(r"//[^\n]*|/\*.*?\*/|" + LITERAL.pattern,
                  lambda found: found.group(0) if found.group(0).startswith('"') else "\n" * found.group(0).count("\n"), text, flags=re.DOTALL)
    for found in re.finditer(LITERAL.pattern + r'(?:\s*"(?:[^"\\\n]|\\.)*")*', text):
        yield text.count("\n", 0, found.start()) + 1, "".join(LITERAL.findall(found.group(0)))


def topic_names(table):
    """Names of topics, without slot: of cbv_K/control also /control, with which a name could be put together."""
    names = re.findall(r'ChannelId::k\w+,\s*"([^"]+)"', table)
    return names + [name[name.index("K") + 1:] for name in names if "K" in name]


def topic_patterns(names):
    """A name with a slash anywhere in a string. A name of one word ("metrics") may mean something else: as a whole string
    with a slash before it, or where a topic is advertised or subscribed to."""
    for name in names:
        inner = name.strip("/")
        word = re.escape(inner).replace("K", r"(?:K|\d+|)")
        if "/" in inner:
            yield re.compile(rf"(?<![a-z_]){word}(?![a-z_/])")
        elif name.startswith("/") and f"cbv_K{name}" in names:
            yield re.compile(rf"^{re.escape(name)}$")
        else:
            yield re.compile(rf"^/{word}$")


def topic_calls(names):
    words = "|".join(re.escape(name.strip("/")) for name in names)
    return re.compile(rf'(?:advertise|subscribe|resolve)(?:<[^;(]*>)?\([^;"]*"/?(?:{words})"')


def planner_names(table):
    """The planners of the list in src/planners/CMakeLists.txt."""
    return re.search(r"set\(CDIFF_PLANNERS ([a-z_0-9 ]+)\)", table).group(1).split()


def planner_patterns(names):
    """A name of several words anywhere in a string; one of a single word ("diffusion") as a whole string."""
    for name in names:
        yield re.compile(rf"(?<![a-z_]){name}(?![a-z_])" if "_" in name else rf"^{name}$")


def no_calls(_names):
    return re.compile(r"(?!)")


# Files in which a name means something else: the life cycle of CBVs, a class of the pages' style.
OTHER_MEANINGS = {"rift": {"src/cbv/cbv_options.cpp", "src/cbv/cbv_options.h", "src/evaluation/batch_report.cpp"}}

# "own": the folder whose files may spell the names.
SECTIONS = {
    "topics": {"table": "src/node_graph/messages/channels.cpp", "search": ["src"], "names": topic_names, "patterns": topic_patterns, "calls": topic_calls},
    "planners": {"table": "src/planners/CMakeLists.txt", "search": ["src"], "own": "src/planners", "names": planner_names,
                 "patterns": planner_patterns, "calls": no_calls},
}


def violations(source, section):
    table = source / section["table"]
    names = section["names"](table.read_text())
    if len(names) < 2:
        yield f"{section['table']} names nothing; its form has changed"
    patterns = list(section["patterns"](names))
    for folder in section["search"]:
        for path in sorted((source / folder).rglob("*")):
            own = section.get("own")
            if path.suffix not in (".h", ".cpp") or path == table or own and source / own in path.parents:
                continue
            text = path.read_text()
            for line, literal in literals_of(text):
                if str(path.relative_to(source)) in OTHER_MEANINGS.get(literal, ()):
                    continue
                if any(pattern.search(literal) for pattern in patterns):
                    yield f"{path.relative_to(source)}:{line}: {literal!r} is a name of {section['table']}"
            for found in section["calls"](names).finditer(text):
                line = text.count("\n", 0, found.start()) + 1
                yield f"{path.relative_to(source)}:{line}: {found.group(0)!r} spells a name of {section['table']}"


def self_test():
    """The search finds what it must, and nothing else."""
    names = topic_names('{ChannelId::kA, "ego/route", x}, {ChannelId::kB,\n "cbv_K/control"}, {ChannelId::kC, "metrics"}')
    patterns = list(topic_patterns(names))
    hits = lambda literal: any(pattern.search(literal) for pattern in patterns)
    wanted = ["ego/route", "on ego/route yet", "/ego/route", "cbv_3/control", "/control", "/metrics"]
    free = ["metrics", "/ego/route_completion", "control", "/metrics/ttc", "out of control"]
    wrong = [text for text in wanted if not hits(text)] + [text for text in free if hits(text)]
    if not topic_calls(names).search('node.advertise<msgs::A>("metrics", 1)'):
        wrong.append("advertise")
    if list(literals_of('#include "a"\n// "b"\nf("c"\n  "d");')) != [(3, "cd")]:
        wrong.append("literals")
    return [f"the search goes wrong with {text!r}" for text in wrong]


def main():
    source, result = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    cases = [("self_test", self_test())] + [(name, list(violations(source, section))) for name, section in SECTIONS.items()]
    for _, found in cases:
        print("\n".join(found), end="\n" if found else "")
    junit.write_findings(result, "names", cases)
    return 1 if any(found for _, found in cases) else 0


if __name__ == "__main__":
    sys.exit(main())
