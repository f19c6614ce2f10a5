#!/usr/bin/python3
"""Run the sessions of docs/reproduce.md, "Ten sessions, number by number", and compare every figure printed there.

    test_printed_figures.py CDIFF SOURCE RESULT.xml
    test_printed_figures.py CDIFF SOURCE --write       puts this machine's figures into the section

A figure is compared with the key of `summary.json` that its column names, and with the line that `cdiff run` prints, to the last
printed digit. Where the section's instruction sets or SUMO are not those of this machine, the test names the difference and allows what
the last column of the section's first table says.
"""
import copy
import json
import re
import shlex
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402

HEADING = "## Ten sessions, number by number"
# Facts of session.yaml, as the section names them.
FACTS = {"SUMO": r'^  version: "SUMO ([^"]+)"', "denoiser": r'cbv_denoiser_instruction_set: "([^"]+)"',
         "encoder": r'cbv_encoder_instruction_set: "([^"]+)"', "other code": r'^  instruction_set: "([^"]+)"'}
ALLOWED = re.compile(r"equal|(\d+) %(?: or ([\d.]+))?")
AT_LEAST = {"figures": 10, "sessions": 10, "scenarios": 5}


def section_of(text):
    return text.partition(HEADING + "\n")[2].partition("\n## ")[0]


def rows_of(section, columns):
    """Rows of the tables with so many columns, without heads."""
    rows = [[cell.strip().strip("`") for cell in line.strip().strip("|").split("|")] for line in section.splitlines() if line.startswith("|")]
    rows = [row for row in rows if len(row) == columns]
    return [row for index, row in enumerate(rows) if index > 0 and not set(row[0]) <= set("-: ")]


class Table:
    """What the section says: facts, columns (name, key, line, allowed) and sessions (command, figures as printed)."""

    def __init__(self, text):
        self.section = section_of(text)
        self.facts = {name: (re.search(rf"{name} `([^`]+)`", self.section) or [None, "nothing"])[1] for name in FACTS}
        self.columns = [dict(zip(("name", "key", "line", "allowed"), row)) for row in rows_of(self.section, 4)]
        self.sessions = [{"command": row[0], "figures": row[1:]} for row in rows_of(self.section, len(self.columns) + 1)]

    def faults(self):
        """Why the section is no table to test by."""
        scenarios = {row["command"].split()[2] for row in self.sessions}
        counts = {"figures": sum(len(row["figures"]) for row in self.sessions), "sessions": len(self.sessions), "scenarios": len(scenarios)}
        wrong = [f"{counts[name]} {name}, at least {least} were expected" for name, least in AT_LEAST.items() if counts[name] < least]
        wrong += [f"the section does not name '{name}'" for name, fact in self.facts.items() if fact == "nothing"]
        allowed = [column["allowed"] for column in self.columns]
        wrong += [f"'{text}' is neither 'equal' nor '5 %' nor '5 % or 0.05'" for text in allowed if not ALLOWED.fullmatch(text)]
        return wrong + [f"'{row['command']}' is no 'cdiff run'" for row in self.sessions if not row["command"].startswith("cdiff run ")]


def value_at(summary, key):
    for part in key.split("."):
        summary = summary[part]
    return summary


def printed_in(output, line):
    """The number at '#' in the line that `cdiff run` prints; blanks count as one."""
    pattern = r"\s+".join(re.escape(word).replace(r"\#", r"(-?\d+(?:\.\d+)?)") for word in line.split())
    found = re.search(r"(?<!\S)" + pattern, output)
    return found.group(1) if found else None


def within(figure, value, allowed):
    """Whether `value` is the printed figure but for what 'equal', '5 %' or '5 % or 0.05' allows."""
    decimals = len(figure.partition(".")[2])
    share, least = (float(number or 0) for number in ALLOWED.fullmatch(allowed).groups())
    return f"{value:.{decimals}f}" == figure or abs(value - float(figure)) <= max(abs(float(figure)) * share / 100, least)


def wrong_figures(columns, figures, run, exact):
    """A text for each figure that a run does not have."""
    wrong = []
    for column, figure in zip(columns, figures):
        value, printed = value_at(run["summary"], column["key"]), printed_in(run["output"], column["line"])
        if value is None or printed is None:
            wrong.append(f"{column['name']}: {figure} stands in docs/reproduce.md, the run has {value} and prints {printed}")
            continue
        decimals = len(figure.partition(".")[2])
        same = f"{value:.{decimals}f}" == figure == printed
        allowed = within(figure, float(value), column["allowed"]) and printed == f"{value:.{decimals}f}"
        if not (same if exact else allowed):
            wrong.append(f"{column['name']}: {figure} stands in docs/reproduce.md, {column['key']} is {value}, printed as {printed}")
    return wrong


def run_session(cdiff, command, folder):
    """The command as it stands; its summary, its output, the facts of its machine."""
    words = shlex.split(command)
    done = subprocess.run([cdiff, *words[1:]], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=240, check=False)
    results = Path(folder) / words[words.index("--results") + 1]
    if not (results / "summary.json").is_file():
        raise RuntimeError(f"'{command}' ended with {done.returncode} and no summary.json: {done.stderr[-800:]}")
    session = (results / "session.yaml").read_text()
    facts = {name: (re.search(pattern, session, re.MULTILINE) or [None, "unknown"])[1] for name, pattern in FACTS.items()}
    return {"summary": json.loads((results / "summary.json").read_text()), "output": done.stdout, "facts": facts}


def differences(table_facts, facts):
    return [f"{name} {facts[name]} in place of {table_facts[name]}" for name in FACTS if facts[name] != table_facts[name]]


def unnoticed_alterations(columns, run):
    """Figures of a run of which one digit can change unnoticed."""
    true = []
    for column in columns:
        true.append(printed_in(run["output"], column["line"]) or "0")
    missed = wrong_figures(columns, true, run, True)
    for index, column in enumerate(columns):
        for place in (place for place, letter in enumerate(true[index]) if letter.isdigit()):
            altered = list(true)
            altered[index] = true[index][:place] + str((int(true[index][place]) + 1) % 10) + true[index][place + 1:]
            if len(wrong_figures(columns, altered, run, True)) != 1:
                missed.append(f"{column['name']}: {altered[index]} in place of {true[index]} is not noticed")
    return missed


def self_test():
    """A section of one session: its own figures pass, altered ones do not, another machine's pass as far as is allowed."""
    text = (f"{HEADING}\nSUMO `1`, denoiser `a`, encoder `b`, other code `c`.\n| column | key | line | allowed |\n|---|---|---|---|\n"
            "| contacts | `cbv.hits` | `CBV hits #` | equal |\n| mean | `m.mean` | `mean # s` | 5 % or 0.05 |\n\n"
            "| command | contacts | mean |\n|---|---|---|\n| `cdiff run x --results r` | 2 | 8.64 |\n\n## Next\n| a | b | c | d |\n")
    table = Table(text)
    run = {"summary": {"cbv": {"hits": 2}, "m": {"mean": 8.6412}}, "output": "  CBV hits      2 (1)\n  mean     8.64 s (n = 3)\n"}
    figures = table.sessions[0]["figures"] if table.sessions else []
    wrong = [] if figures == ["2", "8.64"] and len(table.columns) == 2 and table.facts["encoder"] == "b" else [f"reads {table.__dict__}"]

    def expect(count, figures, exact, run=run):
        found = wrong_figures(table.columns, figures, run, exact)
        if len(found) != count:
            wrong.append(f"{figures}, exact {exact}: {count} findings expected, {found}")
    expect(0, ["2", "8.64"], True)
    expect(1, ["2", "8.65"], True)
    expect(1, ["3", "8.64"], True)
    expect(0, ["2", "9.08"], False)  # 5 % of 9.08 is 0.45, the distance 0.44
    expect(1, ["2", "9.12"], False)  # 0.456 against 0.479
    expect(1, ["3", "8.64"], False)
    small = copy.deepcopy(run)
    small["summary"]["m"]["mean"], small["output"] = 0.049, "CBV hits 2\nmean 0.05 s\n"
    expect(0, ["2", "0.00"], False, small)  # 0.049 is below 0.05
    small["output"] = "CBV hits 2\nmean 0.06 s\n"  # prints what it does not have
    expect(1, ["2", "0.05"], False, small)
    return wrong + unnoticed_alterations(table.columns, run)


def compared(table, row, cdiff, folder, altered):
    """What is wrong with a row, and how this machine differs; `altered` collects what a changed digit of it would hide."""
    try:
        run = run_session(cdiff, row["command"], folder)
        others = differences(table.facts, run["facts"])
        altered += unnoticed_alterations(table.columns, run)
        found = wrong_figures(table.columns, row["figures"], run, not others)
    except (RuntimeError, LookupError, subprocess.TimeoutExpired) as error:
        return [repr(error)], []
    return found + [f"this machine has {text}" for text in others if found], others


def test(cdiff, source, result):
    table = Table((source / "docs/reproduce.md").read_text())
    cases = [("self_test", 0.0, "\n".join(self_test()) or None), ("table", 0.0, "\n".join(table.faults()) or None)]
    altered, noted = [], []
    with tempfile.TemporaryDirectory() as folder:
        for row in table.sessions:
            begin = time.monotonic()
            found, others = compared(table, row, cdiff, folder, altered)
            if others != noted:
                print(f"this machine has {'; '.join(others)}: figures may differ as far as docs/reproduce.md allows")
                noted = others
            cases.append((row["command"], time.monotonic() - begin, "\n".join(found) or None))
            outcome = "FAILED" if found else "as far as allowed" if others else "as printed"
            print(f"{cases[-1][1]:6.1f} s  {outcome}  {row['command']}", *found, sep="\n          ", flush=True)
    cases.append(("an_altered_digit_is_noticed", 0.0, "\n".join(altered) or None))
    junit.write(result, "printed_figures", cases)
    for name, _, failure in cases:
        if failure and " " not in name:
            print(f"{name}: {failure}")
    return 1 if any(failure for _, _, failure in cases) else 0


def write(cdiff, source):
    """Puts fresh figures and facts into the section; its commands and columns stay."""
    page = source / "docs/reproduce.md"
    text = page.read_text()
    table = Table(text)
    section = table.section
    with tempfile.TemporaryDirectory() as folder:
        for row in table.sessions:
            run = run_session(cdiff, row["command"], folder)
            figures = [printed_in(run["output"], column["line"]) or "-" for column in table.columns]
            wrong = wrong_figures(table.columns, figures, run, True)
            if wrong:
                raise RuntimeError(f"'{row['command']}' prints what summary.json does not have: {wrong}")
            head = f"| `{row['command']}` |"
            section = "\n".join(f"{head} {' | '.join(figures)} |" if line.startswith(head) else line for line in section.split("\n"))
            for name, fact in run["facts"].items():
                section = section.replace(f"{name} `{table.facts[name]}`", f"{name} `{fact}`")
            table.facts = run["facts"]
    page.write_text(text.replace(table.section, section))
    return 0


if __name__ == "__main__":
    program, tree = str(Path(sys.argv[1]).resolve()), Path(sys.argv[2]).resolve()
    sys.exit(write(program, tree) if sys.argv[3] == "--write" else test(program, tree, sys.argv[3]))
