#!/usr/bin/python3
"""Check what the documents say about the source tree: paths, links, identifiers, the folder table; and American spelling in all texts.

    check_docs.py SOURCE RESULT.xml

No text of the tree spells one of BRITISH. Each file and folder that a document names exists; each row of docs/glossary.md and docs/notation.md names identifiers that stand in
the files of the row; no mark such as @RATE@ waits for its figure; the folder table and the order of layers in docs/architecture.md are those of the tree and of check_layers.py;
docs/images/layers.svg is what scripts/draw_layers makes, and the pictures of scripts/draw_pictures are what it makes; package.xml, CMakeLists.txt, CITATION.cff and the newest release in CHANGELOG.rst have one version.
"""
import re
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
import check_layers  # noqa: E402
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402

TOPS = ["src", "include", "test", "docs", "scripts", "config", "benchmark", "cmake", "examples", "launch", "msg"]
PATH = re.compile(r"(?<![\w./-])(?:" + "|".join(TOPS) + r")/[\w./{},*-]*")
SOURCE_NAME = re.compile(r"`([\w./-]+\.(?:cpp|h|cpp\.in|py))`")
LINK = re.compile(r"\]\(([^)\s]+)\)")
# Words that stand for a name of the reader's own.
PLACEHOLDER = re.compile(r"\b(?:[A-Z]{3,}|Name)\b|[A-Z]{3,}_")
# Files that a document has the reader make.
MADE_BY_READER = {"src/guidance/standstill_objective.h", "src/guidance/standstill_objective.cpp"}
# British words, as stems; "manoeuvre" and the variants "grey" of image_effect are keys in files, which stay.
BRITISH = ["centre", "metre", "kilometre", "millimetre", "centimetre", "neighbour", "colour", "behaviour", "grey", "towards", "afterwards", "spelt",
           "travelled", "travelling", "signalled", "labelled", "labelling", "modelled", "modelling", "cancelled", "judgement", "licence", "defence",
           "favour", "honour", "catalogue", "artefact", "programme", "learnt", "tyre", "kerb", "whilst", "analysed", "analysing",
           *(stem + ending for stem in ("optimi", "normali", "minimi", "maximi", "penali", "parametri", "rasteri", "recogni", "initiali", "seriali",
                                        "synchroni", "generali", "summari", "randomi", "organi", "signali", "visuali", "standardi", "speciali",
                                        "denormali", "locali", "reali") for ending in ("se", "sed", "ser", "sing", "sation"))]
SPELLING = re.compile(r"(?<![A-Za-z_])(?:" + "|".join(BRITISH) + r")(?:s|d|ed|ing)?(?![A-Za-z_])", re.IGNORECASE)
TEXTS = {".h", ".cpp", ".in", ".py", ".md", ".rst", ".yaml", ".msg", ".launch", ".cmake", ".txt", ".css", ".js", ""}
# Folders and files whose words stand for something else: sealed bytes, keys in files, and this list.
LEFT_ALONE = ["config/suites", "config/evaluations/image_effect.yaml", "test/layers/check_docs.py"]
MOST_WORDS_OF_A_RELEASE = 600
TABLES = ["docs/glossary.md", "docs/notation.md"]


def documents(source):
    return sorted([*source.glob("*.md"), *(path for top in ("docs", "examples", ".github") for path in (source / top).rglob("*.md"))])


def source_names(source):
    """Paths of all sources, each with a slash before it, to be compared by their ends."""
    return ["/" + str(path.relative_to(source)) for top in TOPS for path in (source / top).rglob("*") if path.suffix in (".h", ".cpp", ".in", ".py")]


def expanded(text):
    """a.{h,cpp} -> a.h, a.cpp."""
    found = re.search(r"\{([^{}]*)\}", text)
    return [text] if not found else [text[:found.start()] + part + text[found.end():] for part in found.group(1).split(",")]


def exists(source, path):
    if path in MADE_BY_READER:
        return True
    parts = path.rstrip("/").split("/")
    for index, part in enumerate(parts):
        if PLACEHOLDER.search(part):
            return (source / "/".join(parts[:index])).is_dir()
    return any(source.glob(path)) if "*" in path else (source / path).exists()


def headings(text):
    """Anchors of a page, as GitHub makes them."""
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in re.findall(r"^#+ +(.*)$", text, re.MULTILINE)}


def wrong_paths(source):
    names = source_names(source)
    for page in documents(source):
        text = page.read_text()
        for line, content in enumerate(text.splitlines(), 1):
            place = f"{page.relative_to(source)}:{line}"
            for found in PATH.finditer(content):
                for path in expanded(found.group(0).rstrip(".,")):
                    if not exists(source, path):
                        yield f"{place}: there is no '{path}'"
            for name in SOURCE_NAME.findall(content):
                if not any(known.endswith("/" + name) for known in names) and not PLACEHOLDER.search(name) and name not in MADE_BY_READER:
                    yield f"{place}: no source is called '{name}'"
            for link in LINK.findall(content):
                target, _, anchor = link.partition("#")
                file = page.parent / target if target else page
                if "://" in link:
                    continue
                if not file.exists():
                    yield f"{place}: the link '{link}' leads nowhere"
                elif anchor and file.suffix == ".md" and anchor not in headings(file.read_text()):
                    yield f"{place}: '{target or page.name}' has no heading '#{anchor}'"


def cells(line):
    return [cell.strip() for cell in re.split(r"(?<!\\)\|", line.strip())[1:-1]]


def wrong_identifiers(source, table):
    """Rows whose last cell names `identifiers` and the `files` that hold them."""
    rows = 0
    for line, content in enumerate((source / table).read_text().splitlines(), 1):
        if not content.startswith("|") or set(content) <= set("|-: ") or cells(content)[-1] == "In the code":
            continue
        rows += 1
        words = re.findall(r"`([^`]+)`", cells(content)[-1])
        files = [source / word for word in words if "/" in word]
        identifiers = [part for word in words if "/" not in word for part in word.split("::")]
        if not files or not identifiers:
            yield f"{table}:{line}: names no {'identifier' if files else 'file'}"
        texts = [file.read_text() for file in files if file.is_file()]
        for file in files:
            if not file.is_file():
                yield f"{table}:{line}: there is no file '{file.relative_to(source)}'"
        for identifier in identifiers:
            if texts and not any(re.search(rf"\b{re.escape(identifier)}\b", text) for text in texts):
                yield f"{table}:{line}: '{identifier}' does not occur in {' or '.join(str(file.relative_to(source)) for file in files)}"
    if rows < 2:
        yield f"{table} has no rows; its form has changed"


def wrong_folders(source):
    """The folder table against the tree, the arrows against the order that check_layers.py knows."""
    text = (source / "docs/architecture.md").read_text()
    layers = text.partition("## Layers")[2].partition("\n## ")[0]
    rows = [cells(line)[0] for line in layers.splitlines() if line.startswith("|")][2:]
    named = {name.strip() for row in rows for name in row.split(",") if "/" not in name}
    there = {path.name for path in (source / "src").iterdir() if (path / "CMakeLists.txt").exists()}
    for name in sorted(there ^ named):
        yield f"docs/architecture.md: the folder table and src/ disagree about '{name}'"
    for row in rows:
        for name in row.split(","):
            if "/" in name and not exists(source, "src/" + name.strip()):
                yield f"docs/architecture.md: there is no folder 'src/{name.strip()}'"
    arrows = re.search(r"```\n(.*?)```", layers, re.DOTALL)
    drawn = [set(re.findall(r"\w+", row)) for row in (arrows.group(1) if arrows else "").split("->")]
    order = [set(row.split()) - {"planner_training"} for row in reversed(check_layers.ORDER)]
    if drawn != [row for row in order if row]:
        yield "docs/architecture.md: the arrows are not the order of test/layers/check_layers.py"


def british_words(source):
    """Places of British spelling in the texts of the tree."""
    folders = [source / top for top in [*TOPS, "networks", "rviz", "sumo"]]
    paths = [path for folder in folders for path in sorted(folder.rglob("*"))] + sorted(source.glob("*.*"))
    for path in paths:
        name = str(path.relative_to(source))
        if not path.is_file() or path.suffix not in TEXTS or any(name.startswith(left) for left in LEFT_ALONE):
            continue
        for line, content in enumerate(path.read_text(errors="ignore").splitlines(), 1):
            for found in SPELLING.finditer(content):
                yield f"{name}:{line}: '{found.group(0)}' is British spelling"


def unfilled(source):
    """Marks such as @RATE@ that stand for a figure to come."""
    for path in documents(source):
        for line, content in enumerate(path.read_text().splitlines(), 1):
            for found in re.finditer(r"@+[A-Z][A-Z0-9_]*@+", content):
                yield f"{path.relative_to(source)}:{line}: '{found.group(0)}' was to be filled in"


def wrong_picture(source):
    """What the scripts that draw pictures say of theirs."""
    for script in ("draw_layers", "draw_pictures"):
        done = subprocess.run(["/usr/bin/python3", source / "scripts" / script, "--check"], capture_output=True, text=True, check=False)
        if done.returncode != 0:
            yield from (done.stdout + done.stderr).splitlines()


def wrong_release(source):
    """Files that name another version or date than the newest release in CHANGELOG.rst, and a release that takes long to read."""
    def found_in(name, pattern):
        found = re.search(pattern, (source / name).read_text(), re.MULTILINE)
        return found.group(1) if found else "none"
    release = re.search(r"^(\d+\.\d+\.\d+) \((\d{4}-\d\d-\d\d)\)\n-+\n(.*?)(?=^\S+ \(|\Z)", (source / "CHANGELOG.rst").read_text(), re.MULTILINE | re.DOTALL)
    if not release:
        yield "CHANGELOG.rst: no release such as '0.1.0 (2026-11-28)'"
        return
    version, date, text = release.groups()
    for name, pattern, expected in (("package.xml", r"<version>(.*?)</version>", version), ("CMakeLists.txt", r"^project\(\w+ VERSION (\S+)", version),
                                    ("CITATION.cff", r"^version: (\S+)", version), ("CITATION.cff", r"^date-released: (\S+)", date)):
        if found_in(name, pattern) != expected:
            yield f"{name}: {found_in(name, pattern)}, but the newest release in CHANGELOG.rst is {version} of {date}"
    if len(text.split()) > MOST_WORDS_OF_A_RELEASE:
        yield f"CHANGELOG.rst: release {version} has {len(text.split())} words, more than {MOST_WORDS_OF_A_RELEASE}"


def self_test():
    """The search finds what is wrong, and nothing else."""
    wrong = []
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder)
        (source / "src/map").mkdir(parents=True)
        (source / "docs").mkdir()
        (source / "src/map/route.h").write_text("class Route {};\n")
        page = source / "docs/a.md"
        page.write_text("# Two words\n`src/map/route.{h,cpp}` `map/route.h` `rout.h` `src/planners/NAME/x.h` `src/map/NAME.h` [b](b.md) [c](#two-words) [d](#two)\n"
                        "results/test/x `src/*/route.h`\n")
        expected = ["src/map/route.cpp", "rout.h", "src/planners/NAME/x.h", "b.md", "#two'"]
        found = list(wrong_paths(source))
        wrong += [f"finds {found}"] if len(found) != len(expected) else []
        wrong += [f"misses {word}" for word in expected if not any(word in line for line in found)]
        page.write_text("Colours of centred `analyses`, analysed.\nA centimetre, kEgoKilometres, parameter, reality\n")
        found = list(british_words(source))
        if [line.split("'")[1] for line in found] != ["Colours", "centred", "analysed", "centimetre"]:
            wrong.append(f"finds {found}")
        (source / "CHANGELOG.rst").write_text("Forthcoming\n-----------\n* new\n\n0.2.0 (2026-01-02)\n------------------\n* a\n\n0.1.0 (2025-01-02)\n---\n" + "b " * 700)
        (source / "package.xml").write_text("<version>0.2.0</version>\n")
        (source / "CMakeLists.txt").write_text("project(a VERSION 0.1.0 LANGUAGES CXX)\n")
        (source / "CITATION.cff").write_text("cff-version: 1.2.0\nversion: 0.2.0\ndate-released: 2026-01-03\n")
        found = list(wrong_release(source))
        if [line.split(",")[0] for line in found] != ["CMakeLists.txt: 0.1.0", "CITATION.cff: 2026-01-03"]:
            wrong.append(f"finds {found}")
        page.write_text("@@B2D@@ and @RATE@, a@B.c, @param\n")
        if len(list(unfilled(source))) != 2:
            wrong.append("misses @@B2D@@ or @RATE@, or finds others")
        page.write_text("| T | In the code |\n|---|---|\n| a \\| b | `Route`, `src/map/route.h` |\n| c | `Rout`, `src/map/route.h` |\n| d | `src/map/route.h` |\n")
        found = list(wrong_identifiers(source, "docs/a.md"))
        if [line.split(":")[1] for line in found] != ["4", "5"]:
            wrong.append(f"finds {found}")
    return [f"the search goes wrong: {text}" for text in wrong]


def main():
    source, result = Path(sys.argv[1]).resolve(), Path(sys.argv[2])
    results = [("self_test", self_test()), ("paths", list(wrong_paths(source))), ("folders", list(wrong_folders(source))), ("picture", list(wrong_picture(source))),
               ("release", list(wrong_release(source))),
               ("spelling", list(british_words(source))), ("unfilled", list(unfilled(source)))]
    results += [(Path(table).stem, list(wrong_identifiers(source, table))) for table in TABLES]
    for _, found in results:
        print("\n".join(found), end="\n" if found else "")
    junit.write_findings(result, "docs", results)
    return 1 if any(found for _, found in results) else 0


if __name__ == "__main__":
    sys.exit(main())
