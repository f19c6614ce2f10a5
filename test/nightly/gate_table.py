"""The table of docs/reliability.md: for each gate what was tried last, and what held."""
import datetime

from record import machine, revision

BEGIN, END = "<!-- written by test/nightly/gates.py: begin -->", "<!-- end -->"
HEAD = ["| Gate | What must hold | Tried | Held | Last run | Revision | Machine | Minutes |", "|---|---|---|---|---|---|---|---|"]
NEVER = ["not run yet", "", "", "", "", ""]


def row(verdict, stamp):
    held = verdict.tried - len(verdict.failures)
    return [str(verdict.tried), str(held) if held == verdict.tried else f"**{held}**", *stamp, f"{verdict.seconds / 60:.1f}"]


def stamp_of(source):
    """Date, revision and machine, to be taken before the gates are tried."""
    return [datetime.date.today().isoformat(), revision(source), machine()]


def write(document, gates, verdicts, stamp):
    """Writes rows of `verdicts`; those of other gates stay as they are."""
    before, _, rest = document.read_text().partition(BEGIN)
    table, _, after = rest.partition(END)
    kept = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines() if line.startswith("| `")]
    rows = {cells[0].strip("`"): cells[2:] for cells in kept}
    rows.update({verdict.gate.name: row(verdict, stamp) for verdict in verdicts})
    lines = HEAD + [f"| `{name}` | {gate.holds} | " + " | ".join(rows.get(name, NEVER)) + " |" for name, gate in gates.items()]
    document.write_text(before + BEGIN + "\n" + "\n".join(lines) + "\n" + END + after)
