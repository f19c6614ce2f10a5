"""JUnit files of checks written in Python, where `scripts/test` counts them."""
import xml.etree.ElementTree as ElementTree
from pathlib import Path


def write(path, suite, cases, skipped=()):
    """Writes `cases`, a list of (name, seconds, failure text or None); `skipped`: names of those that did not run."""
    root = ElementTree.Element("testsuite", name=suite)
    for name, seconds, failure in cases:
        case = ElementTree.SubElement(root, "testcase", classname=suite, name=name, time=f"{seconds:.3f}")
        if failure is not None:
            ElementTree.SubElement(case, "failure", message=failure)
        elif name in skipped:
            ElementTree.SubElement(case, "skipped")
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    ElementTree.ElementTree(root).write(path, encoding="utf-8", xml_declaration=True)


def write_findings(path, suite, cases):
    """Writes `cases`, a list of (name, texts of what is wrong)."""
    write(path, suite, [(name, 0.0, "\n".join(found) or None) for name, found in cases])


def write_unittest(path, suite, result, names):
    """Writes the outcome of `unittest` for the tests `names`."""
    problems = {test.id(): text for test, text in result.failures + result.errors}
    skipped = {test.id().rpartition(".")[2] for test, _ in result.skipped}
    write(path, suite, [(name.rpartition(".")[2], 0.0, problems.get(name)) for name in names], skipped)
