#!/usr/bin/python3
"""Check how the documents read: words a page, long sentences, long lines, phrases that are no plain English, dates where they do not belong.

    check_prose.py SOURCE RESULT.xml

Tables and code count for nothing. A new page needs a budget below, and the pages of docs/ have 30,000 words together: whoever adds a page's worth removes one.
"""
import re
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402

# Most words of prose, by page.
BUDGETS = {"README.md": 950, "CONTRIBUTING.md": 1300, "docs/README.md": 350,
           # tutorials
           "docs/first_session.md": 700, "docs/test_your_ego.md": 700, "docs/your_own_scenario.md": 900, "docs/your_own_objective.md": 500,
           # how-to
           "docs/evaluation.md": 700, "docs/scaling.md": 400, "docs/search.md": 350, "docs/training.md": 1000, "docs/plugins.md": 450, "docs/replay.md": 450, "docs/export.md": 400, "docs/openscenario.md": 400, "docs/install.md": 400, "docs/steering.md": 450, "docs/watch.md": 300, "docs/rviz.md": 450, "docs/carla.md": 300, "docs/what_if.md": 450, "docs/suites.md": 500,
           "docs/sealed_suites.md": 700, "docs/sealed_suites_log.md": 650, "docs/troubleshooting.md": 700,
           # explanation
           "docs/architecture.md": 900, "docs/diffusion_planner.md": 900, "docs/guidance.md": 1000, "docs/cbv_identification.md": 450,
           "docs/realism.md": 900, "docs/statistics.md": 900, "docs/where_we_differ.md": 750, "docs/challenging.md": 600, "docs/planners.md": 700, "docs/comparison.md": 400,
           **{f"docs/{name}.md": 350 for name in ("pdm_lite", "plant", "pluto", "ppo", "rift", "uniad_mini", "vad_mini")},
           # reference
           "docs/metrics.md": 700, "docs/ros_api.md": 1080, "docs/protocols.md": 900, "docs/camera.md": 600, "docs/neural_network.md": 600,
           "docs/report.md": 400, "docs/result_folder.md": 500, "docs/glossary.md": 1200, "docs/notation.md": 800, "docs/nightly.md": 300, "docs/reliability.md": 300,
           # results
           "docs/results.md": 1200, "docs/paper_tables.md": 300, "docs/ablations.md": 800, "docs/benchmarks.md": 500, "docs/reproduce.md": 600,
           "docs/model_card.md": 700, "docs/model_card_paper.md": 350, "docs/model_card_paper_literal.md": 200}
MOST_WORDS = 30000  # of docs/
LONG, LONGEST, LONG_SHARE = 30, 45, 0.05  # words of a sentence, share of those that are long
LINE = 120  # characters
MARKED = ["as (?:a )?figures?", "but for (?:those|what|the|if|two|where)", "none could", "none of which", "by themselves on none", "it has its price",
          "what (?:it|they) (?:comes?|came) to", "is seen;? nor", r"of (?:the )?some \d+", "has been tried", "Of (?:the|these|those|two|attacks|plans|scenes|other) ",
          "is so not", "and so much do", "beside other work", "the default before", "as it was", "as they were", "today's"]
DATED = {"docs/results.md", "docs/sealed_suites.md", "docs/sealed_suites_log.md", "docs/nightly.md", "docs/reliability.md", "docs/model_card.md", "docs/model_card_paper.md",
         "docs/model_card_paper_literal.md",
         "docs/reproduce.md", "docs/comparison.md", "docs/openscenario.md"}
DATE_OR_MACHINE = re.compile(r"\b20\d\d-\d\d-\d\d\b|\bEPYC\b|\bXeon\b")


def words(text):
    return sum(bool(re.search(r"\w", word)) for word in text.split())


def without_code(text):
    return re.sub(r"```.*?```", lambda found: "\n" * found.group(0).count("\n"), text, flags=re.DOTALL)


def blocks(text):
    """(line, text) of each paragraph and list item."""
    found, first, lines = [], 1, []
    for number, line in enumerate([*without_code(text).splitlines(), ""], 1):
        item = re.match(r"\s*(?:[*\-]|\d+\.) ", line)
        if not line.strip() or line.startswith(("#", "|")) or item:
            if lines:
                found.append((first, " ".join(lines)))
            lines, first = ([line], number) if item else ([], number + 1)
        else:
            first = first if lines else number
            lines.append(line)
    return found


def sentences(text):
    """(line of its paragraph, sentence); code and link targets are one word."""
    for number, block in blocks(text):
        plain = re.sub(r"`[^`]*`", "X", re.sub(r"\]\([^)]*\)", "]", block))
        for sentence in re.split(r"(?<=[.!?:])\s+(?=[A-Z*\[`\"(])", " ".join(plain.split())):
            if words(sentence) >= 3:
                yield number, sentence


def prose_words(text):
    return sum(words(block) for _, block in blocks(text)) + sum(words(line) for line in without_code(text).splitlines() if line.startswith("#"))


def pages(source):
    """Text of each page without what is made from the code: from the comment that says so to the end."""
    paths = [source / "README.md", source / "CONTRIBUTING.md", *sorted((source / "docs").rglob("*.md"))]
    texts = {str(path.relative_to(source)): path.read_text() for path in paths if path.is_file()}
    return {name: re.split(r"<!-- (?:Made|From here on made) by ", text)[0] for name, text in texts.items()}


def over_budget(texts, budgets=None):
    budgets = BUDGETS if budgets is None else budgets
    counts = {name: prose_words(text) for name, text in texts.items()}
    for name, count in counts.items():
        if name not in budgets and count > 0:
            yield f"{name}: has no budget of words in test/layers/check_prose.py"
        elif count > budgets.get(name, 0):
            yield f"{name}: {count} words of prose, more than {budgets[name]}"
    together = sum(count for name, count in counts.items() if name.startswith("docs/"))
    if together > MOST_WORDS:
        yield f"docs: {together} words of prose, more than {MOST_WORDS}"


def long_sentences(texts):
    every, long = 0, []
    for name, text in texts.items():
        for number, sentence in sentences(text):
            every += 1
            count = words(sentence)
            if count > LONGEST:
                yield f"{name}:{number}: a sentence of {count} words: {sentence[:80]} ..."
            elif count > LONG:
                long.append(f"{name}:{number}: {count} words: {sentence[:80]} ...")
    if len(long) > LONG_SHARE * every:
        yield f"{len(long)} of {every} sentences have more than {LONG} words:"
        yield from long


def long_lines(texts):
    for name, text in texts.items():
        for number, line in enumerate(without_code(text).splitlines(), 1):
            if len(line) > LINE and not line.startswith("|"):
                yield f"{name}:{number}: {len(line)} characters"


def phrases(texts):
    pattern = re.compile(r"\b(?:" + "|".join(MARKED) + ")")
    for name, text in texts.items():
        for number, line in enumerate(without_code(text).splitlines(), 1):
            for found in pattern.finditer(line):
                yield f"{name}:{number}: '{found.group(0)}' is no plain English"


def dates(texts):
    for name, text in texts.items():
        for number, line in enumerate([] if name in DATED else text.splitlines(), 1):
            for found in DATE_OR_MACHINE.finditer(line):
                yield f"{name}:{number}: '{found.group(0)}' belongs in {', '.join(sorted(DATED))}"


def self_test():
    """Each check finds its fault, and nothing else."""
    bad = {"docs/a.md": "# One two\n\n" + "word " * 46 + ".\n\n" + "x" * 121 + "\n\nMet as a figure on 2026-01-02.\n\n| " + "cell " * 200 + "|\n```\n" + "code " * 200 + "\n```\n"}
    good = {"docs/a.md": "# One two\n\nA short sentence. Another one.\n"}
    checks = [(lambda texts: over_budget(texts, {"docs/a.md": 20}), 1), (long_sentences, 1), (long_lines, 2), (phrases, 1), (dates, 1)]
    wrong = [f"check {place} finds {list(check(bad))}" for place, (check, count) in enumerate(checks) if len(list(check(bad))) != count]
    wrong += [f"check {place} finds {list(check(good))} in good text" for place, (check, _) in enumerate(checks) if list(check(good))]
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "docs").mkdir()
        (Path(folder) / "docs" / "new.md").write_text("# New\n")
        if len(list(over_budget(pages(Path(folder))))) != 1:
            wrong.append("a page without a budget is not found")
    return wrong


def main():
    source, result = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    texts = pages(source)
    results = [("self_test", self_test()), *((check.__name__, list(check(texts))) for check in (over_budget, long_sentences, long_lines, phrases, dates))]
    for _, found in results:
        print("\n".join(found), end="\n" if found else "")
    junit.write_findings(result, "prose", results)
    return 1 if any(found for _, found in results) else 0


if __name__ == "__main__":
    sys.exit(main())
