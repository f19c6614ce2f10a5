"""Changes of meaning ("mutants") in C++ sources, drawn at random.

Works on text in the layout of .clang-format, in which binary operators stand between spaces and brackets of templates do not. Code is what lies
in functions, and constants of namespaces; comments, strings, option descriptions and whatever makes texts or throws are left alone.
"""
import random
import re
from dataclasses import dataclass

# Statements that make a text, an error or the description of an option.
LEFT_ALONE = re.compile(r"\bthrow\b|visitor|<<|Error\b|[tT]ext\b|[tT]exts\b|\breason\b|message|fault|\blog|static_assert|std::to_string|formatNumber")
# Functions that return or write texts.
TEXT_FUNCTION = re.compile(r"^\s*(?:static |inline )*(?:const )?(?:std::string|char)[&*]? |::describe\(|\bdescribe\(|Descriptor\b[\w:]*\(|\bnames?\(")
KEYWORD = re.compile(r"(?:return|break|continue|using|case|default|else|do|goto|delete|if|for|while|switch|const|auto|static|typedef|try|catch)\b")
RESERVATION = re.compile(r"\.reserve\(")
STATEMENT = re.compile(r"(?:\+\+|--|\*)?[A-Za-z_][^\s]*?(?: [-+*/|&]?= .*|\(.*\)|\+\+|--)$", re.DOTALL)
SMALLEST = 1e-5  # constants below it guard against rounding


@dataclass(frozen=True)
class Mutant:
    """`text[start:end]` of a file becomes `now`; `line` counts from one, `old` and `new` are the lines with single spaces."""

    file: str
    line: int
    kind: str
    start: int
    end: int
    now: str
    old: str
    new: str

    @property
    def key(self):
        return f"{self.file}:{self.line}: {self.old} => {self.new}"

    def applied(self, text):
        return text[:self.start] + self.now + text[self.end:]


def masked(text):
    """The text with comments, strings and lines of the preprocessor blank; places stay."""
    pattern = re.compile(r'//[^\n]*|/\*.*?\*/|R"\(.*?\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|^#[^\n]*', re.DOTALL | re.MULTILINE)
    return pattern.sub(lambda found: re.sub(r"[^\n]", " ", found.group()), text)


def kind_of_brace(head, inside):
    """What a `{` opens, from the text before it back to the last `;`, `{` or `}`, and from what it lies in."""
    if re.search(r"\bnamespace\b", head):
        return "namespace"
    if re.search(r"\b(?:struct|class|enum|union)\b", head) and "(" not in head:
        return "type"
    if inside not in ("namespace", "type", None):
        return inside
    if TEXT_FUNCTION.search(head):
        return "texts"
    return "function" if ")" in head else "values"


class Source:
    """A file's text with its statements and what kind of brace each place lies in."""

    def __init__(self, name, text):
        self.name, self.text, self.code = name, text, masked(text)
        self.kinds = []  # by place
        self.bodies = []  # (place behind `{`, head) of functions
        self.statements = []  # (start, end) with `;` at the end
        self._read()

    def _read(self):
        stack, start = [], 0
        levels = [0]  # open parentheses, one count for each open brace
        for place, sign in enumerate(self.code):
            self.kinds.append(stack[-1] if stack else None)
            levels[-1] += (sign == "(") - (sign == ")")
            if sign == "{":
                self._open(stack, self.code[start:place], place)
                levels.append(0)
            elif sign == "}" and stack:
                stack.pop()
                levels.pop()
            elif sign == ";" and levels[-1] <= 0:
                self.statements.append((start, place + 1))
            if sign in "{}" or (sign == ";" and levels[-1] <= 0):
                start = place + 1

    def _open(self, stack, head, place):
        inside = stack[-1] if stack else None
        kind = kind_of_brace(head, inside)
        if kind == "function" and inside != "function":
            self.bodies.append((place + 1, head.strip()))
        stack.append(kind)

    def statement_around(self, place):
        """Text from the last to the next end of a statement or block."""
        begin = max(self.code.rfind(sign, 0, place) for sign in ";{}") + 1
        ends = [self.code.find(sign, place) for sign in ";{}"]
        return self.code[begin:min((end for end in ends if end >= 0), default=len(self.code))]

    def usable(self, place):
        """Whether changes at a place are changes of meaning."""
        statement = self.statement_around(place)
        if LEFT_ALONE.search(statement):
            return False
        if self.kinds[place] in ("function", "values"):
            return True
        return self.kinds[place] == "namespace" and "constexpr" in statement

    def mutant(self, kind, start, end, now):
        first = self.text.rfind("\n", 0, start) + 1
        last = self.text.find("\n", max(end - 1, start))
        old, new = self.text[first:last], self.text[first:start] + now + self.text[end:last]
        lead = len(self.text[start:end]) - len(self.text[start:end].lstrip())
        line = self.text.count("\n", 0, start + lead) + 1
        return Mutant(self.name, line, kind, start, end, now, " ".join(old.split()), " ".join(new.split()))


def replaced(source, kind, pattern, now):
    """Mutants where `pattern` matches; its group 1 becomes now(group), several if that is a list."""
    for found in re.finditer(pattern, source.code):
        if not source.usable(found.start(1)):
            continue
        texts = now(found)
        for text in texts if isinstance(texts, list) else [texts]:
            yield source.mutant(kind, found.start(1), found.end(1), text)


def swap(table):
    return lambda found: table[found.group(1)]


def boundaries(source):
    return replaced(source, "boundary", r" (<=|>=|<|>)\s", swap({"<": "<=", "<=": "<", ">": ">=", ">=": ">"}))


def comparisons(source):
    table = {"<": ">=", "<=": ">", ">": "<=", ">=": "<", "==": "!=", "!=": "=="}
    return replaced(source, "comparison", r" (<=|>=|<|>|==|!=)\s", swap(table))


def signs(source):
    table = {"+": "-", "-": "+", "+=": "-=", "-=": "+=", "*": "/", "/": "*", "*=": "/=", "/=": "*="}
    yield from replaced(source, "sign", r" ([-+*/]=?)\s", swap(table))
    yield from replaced(source, "sign", r"(?:(?<=[,=?:*/+<>] )|(?<=[(\[{])|(?<=return ))(-)(?=[\w(])", lambda found: "")


def constants(source):
    def others(found):
        number = found.group(1)
        value = float(number)
        if "." not in number:
            return [str(int(value) + 1), str(int(value) - 1)]
        if value == 0.0:
            return "1.0"
        return [] if value < SMALLEST else [repr(2.0 * value), repr(0.5 * value)]
    return replaced(source, "constant", r"(?<![\w.\[<])(?<!e-)(\d+\.\d+|\d+)(?=[FU]?(?![\w.]))", others)


def extremes(source):
    table = {"min": "max", "max": "min", "lower_bound": "upper_bound", "upper_bound": "lower_bound", "floor": "ceil", "ceil": "floor"}
    return replaced(source, "extreme", r"std::(min|max|lower_bound|upper_bound|floor|ceil)\(", swap(table))


def removals(source):
    """Statements of their own left out, but those that only reserve memory."""
    for start, end in source.statements:
        statement = source.code[start:end - 1].strip()
        begin = start + len(source.code[start:end]) - len(source.code[start:end].lstrip())
        if KEYWORD.match(statement) or not STATEMENT.match(statement) or not source.usable(begin):
            continue
        if not RESERVATION.search(statement) and source.kinds[begin] == "function":
            yield source.mutant("removal", begin, end, ";")


def conditions(source):
    """Conditions that always or never hold."""
    for found in re.finditer(r"\bif \(", source.code):
        depth, end = 1, found.end()
        while depth and end < len(source.code):
            depth += (source.code[end] == "(") - (source.code[end] == ")")
            end += 1
        condition = source.code[found.end():end - 1]
        following = source.code[end:end + 12].lstrip()
        if re.search(r"[^=!<>]=[^=]|;", condition) or following.startswith("throw") or not source.usable(found.start()):
            continue
        for now in ("true", "false"):
            yield source.mutant("condition", found.end(), end - 1, now)
    yield from replaced(source, "condition", r"(?<![\w)])(!)(?=[\w(])", lambda found: "")


def arguments(source):
    """Two arguments the other way round, but of functions for which that is the same."""
    pattern = r"(?<!std::min)(?<!std::max)(?<!std::hypot)(?<=\w)\((([A-Za-z_][\w.]*(?:\(\))?), ([A-Za-z_][\w.]*(?:\(\))?))\)(?! \{)"
    for found in re.finditer(pattern, source.code):
        if source.usable(found.start(1)) and source.kinds[found.start()] == "function" and found.group(2) != found.group(3):
            yield source.mutant("arguments", found.start(1), found.end(1), f"{found.group(3)}, {found.group(2)}")


def junctions(source):
    return replaced(source, "junction", r"(&&|\|\|)\s", swap({"&&": "||", "||": "&&"}))


def indices(source):
    return replaced(source, "index", r"[\w)]\[([a-z]\w*)\]", lambda found: [f"{found.group(1)} + 1", f"{found.group(1)} - 1"])


def returns(source):
    """Functions that return a default at once."""
    for place, head in source.bodies:
        name = re.search(r"([\w:~]+)\(", head)
        parts = name.group(1).split("::") if name else []
        if not name or "~" in name.group(1) or head.startswith(name.group(1)) or len(parts) > 1 and parts[-1] == parts[-2]:
            continue
        yield source.mutant("return", place, place, " return;" if re.match(r"(?:inline |static )*void\b", head) else " return {};")


OPERATORS = {"boundary": boundaries, "comparison": comparisons, "sign": signs, "constant": constants, "extreme": extremes, "removal": removals,
             "condition": conditions, "arguments": arguments, "junction": junctions, "index": indices, "return": returns}


def sites(sources):
    """All mutants of the sources by operator, in a fixed order."""
    found = {kind: [] for kind in OPERATORS}
    for source in sources:
        for kind, operator in OPERATORS.items():
            found[kind].extend(operator(source))
    return found


def draw(sources, seed):
    """Mutants without end of sites: first the operator, then the site, each equally likely; none comes twice."""
    random_numbers = random.Random(seed)
    left = {kind: list(mutants) for kind, mutants in sites(sources).items() if mutants}
    while left:
        kind = random_numbers.choice(sorted(left))
        yield left[kind].pop(random_numbers.randrange(len(left[kind])))
        if not left[kind]:
            del left[kind]
