#!/usr/bin/python3
"""What mutation.py draws from a small source, and that the lists of mutants follow the code.

    test_mutation.py RESULT.xml
"""
import itertools
import sys
import unittest
from pathlib import Path

import yaml

HERE = Path(__file__).resolve().parent
SOURCES = HERE.parents[1] / "src"
sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
import junit  # noqa: E402
import mutation  # noqa: E402

TEXT = '''// a < b in a comment
#include <a>
namespace cdiff {
constexpr double kReach = 10.0;  // [m]
struct Place {
  double along = 0.0;
};
std::string nameOf(int a) { return a < 1 ? "a < b" : "c"; }
double gap(const std::vector<double>& v, double a, double b) {
  if (a < b && b > 1e-9) return std::max(a, b);
  if (a > b) throw core::InputError("a > b");
  total_ += v[i];
  return -a + sum(a, b);
}
void Follower::reset() {
  for (int i = 0; i < 3; ++i) add(i);
}
Follower::Follower(int a) : a_(a) {}
}  // namespace cdiff
'''


def new_lines(kind):
    return [mutant.new for mutant in mutation.OPERATORS[kind](mutation.Source("a.cpp", TEXT))]


class Mutation(unittest.TestCase):
    def test_operators(self):
        self.assertEqual(new_lines("boundary"), ["if (a <= b && b > 1e-9) return std::max(a, b);", "if (a < b && b >= 1e-9) return std::max(a, b);",
                                                 "for (int i = 0; i <= 3; ++i) add(i);"])
        self.assertEqual(new_lines("comparison")[0], "if (a >= b && b > 1e-9) return std::max(a, b);")
        self.assertEqual(new_lines("sign"), ["total_ -= v[i];", "return -a - sum(a, b);", "return a + sum(a, b);"])
        self.assertEqual(new_lines("constant"), ["constexpr double kReach = 20.0; // [m]", "constexpr double kReach = 5.0; // [m]",
                                                 "for (int i = 1; i < 3; ++i) add(i);", "for (int i = -1; i < 3; ++i) add(i);",
                                                 "for (int i = 0; i < 4; ++i) add(i);", "for (int i = 0; i < 2; ++i) add(i);"])
        self.assertEqual(new_lines("extreme"), ["if (a < b && b > 1e-9) return std::min(a, b);"])
        self.assertEqual(new_lines("removal"), [";"])
        self.assertEqual(new_lines("condition"), ["if (true) return std::max(a, b);", "if (false) return std::max(a, b);"])
        self.assertEqual(new_lines("arguments"), ["return -a + sum(b, a);"])
        self.assertEqual(new_lines("junction"), ["if (a < b || b > 1e-9) return std::max(a, b);"])
        self.assertEqual(new_lines("index"), ["total_ += v[i + 1];", "total_ += v[i - 1];"])
        self.assertEqual(new_lines("return"), ["double gap(const std::vector<double>& v, double a, double b) { return {};",
                                               "void Follower::reset() { return;"])

    def test_what_never_changes_meaning_is_left_alone(self):
        source = mutation.Source("a.cpp", "double f(double a, double b) {\n  values.reserve(a);\n  return std::hypot(a, b);\n}\n")
        self.assertEqual([*mutation.removals(source), *mutation.arguments(source)], [])

    def test_a_mutant_is_the_text_with_its_change(self):
        source = mutation.Source("a.cpp", TEXT)
        mutant = next(mutation.removals(source))
        self.assertEqual(mutant.line, TEXT[:TEXT.index("total_")].count("\n") + 1)
        self.assertEqual(mutant.applied(TEXT), TEXT.replace("total_ += v[i];", ";"))

    def test_a_seed_is_a_draw_and_every_site_comes_once(self):
        def keys(seed, count):
            return [mutant.key for mutant in itertools.islice(mutation.draw([mutation.Source("a.cpp", TEXT)], seed), count)]
        self.assertEqual(keys(1, 8), keys(1, 8))
        self.assertNotEqual(keys(1, 8), keys(2, 8))
        number = sum(map(len, mutation.sites([mutation.Source("a.cpp", TEXT)]).values()))
        self.assertEqual(len(set(keys(1, 1000))), number)


def single(text):
    """With single spaces, as mutants name lines."""
    return " ".join(text.split())


class Lists(unittest.TestCase):
    def test_every_equivalent_mutant_can_be_drawn(self):
        rows = yaml.safe_load((HERE / "equivalent_mutants.yaml").read_text())
        self.assertGreater(len(rows), 1)
        for row in rows:
            path = SOURCES / row["file"]
            self.assertTrue(path.is_file(), f"equivalent_mutants.yaml: there is no file {row['file']}")
            drawn = itertools.chain(*mutation.sites([mutation.Source(row["file"], path.read_text())]).values())
            self.assertIn((single(row["was"]), single(row["now"])), {(mutant.old, mutant.new) for mutant in drawn}, row["file"])

    def test_every_listed_mutant_applies(self):
        rows = yaml.safe_load((HERE / "mutants.yaml").read_text())
        self.assertGreater(len(rows), 1)
        for row in rows:
            path = SOURCES / row["file"]
            self.assertTrue(path.is_file(), f"mutants.yaml: there is no file {row['file']}")
            text = path.read_text()
            for was, now in [(row["was"], row["now"]), *row.get("also", [])]:
                self.assertEqual(text.count(was), 1, f"mutants.yaml: {row['file']}: {was}")
                text = text.replace(was, now)


if __name__ == "__main__":
    load = unittest.defaultTestLoader.loadTestsFromTestCase
    suite = unittest.TestSuite([*load(Mutation), *load(Lists)])
    names = [test.id() for test in suite]
    outcome = unittest.TextTestRunner(verbosity=2).run(suite)
    junit.write_unittest(sys.argv[1], "mutation", outcome, names)
    sys.exit(not outcome.wasSuccessful())
