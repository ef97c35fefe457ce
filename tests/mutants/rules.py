"""The kinds of bugs that are planted: each rule looks at a place of the syntax tree and says how its text would read.

A mutation replaces the bytes [start, end) of a file by `text`, in which the marker ON stands for "this bug is on". The
original stays as the other branch, so one build holds many bugs and a run chooses one.
"""

import re
from dataclasses import dataclass

from clang.cindex import CursorKind, TypeKind

ON = "@ON@"


@dataclass(frozen=True)
class Mutation:
    rule: str
    start: int
    end: int
    before: str
    after: str
    text: str


NUMBERS = {TypeKind.BOOL, TypeKind.CHAR_S, TypeKind.UCHAR, TypeKind.SHORT, TypeKind.USHORT, TypeKind.INT, TypeKind.UINT,
           TypeKind.LONG, TypeKind.ULONG, TypeKind.LONGLONG, TypeKind.ULONGLONG, TypeKind.FLOAT, TypeKind.DOUBLE}
FLOATING = {TypeKind.FLOAT, TypeKind.DOUBLE}
EXPRESSIONS = {CursorKind.CALL_EXPR, CursorKind.BINARY_OPERATOR, CursorKind.COMPOUND_ASSIGNMENT_OPERATOR,
               CursorKind.UNARY_OPERATOR, CursorKind.UNEXPOSED_EXPR}
# Equal whichever operand comes first: no bug.
COMMUTATIVE = {"min", "max", "Min", "Max", "Mul", "Add", "And", "Or", "Xor", "swap", "operator==", "operator!=", "operator*",
               "operator+", "operator&", "operator|"}
OPTION = re.compile(r"\b(options?_?|query|asked|ask|wishes|settings?|limits|filter)(\.|->)(\w+(\.|->))*\w+$")


def kind_of(cursor):
    return cursor.type.get_canonical().kind


class Source:
    """A file's bytes with what the rules ask of them."""

    def __init__(self, path):
        with open(path, "rb") as file:
            self.bytes = file.read()

    def text(self, start, end):
        return self.bytes[start:end].decode("utf-8", "replace")

    def of(self, cursor):
        return self.text(cursor.extent.start.offset, cursor.extent.end.offset)

    def one_line(self, text):
        return re.sub(r"\s+", " ", text)


def mutation(rule, source, start, end, after, whole=None):
    """after: what the expression becomes. whole: the replacement when it is no expression with a twin."""
    before = source.text(start, end)
    if "//" in before or "#" in before or "/*" in before or not before.strip():
        return None
    after = source.one_line(after)
    text = whole if whole is not None else f"({ON} ? ({after}) : ({before}))"
    return Mutation(rule, start, end, source.one_line(before), after, text)


def binary(cursor, source):
    """Comparisons, connectives, arithmetic: the operator stands between the two operands' texts."""
    children = list(cursor.get_children())
    if len(children) != 2:
        return
    left, right = children
    start, end = cursor.extent.start.offset, cursor.extent.end.offset
    middle = source.text(left.extent.end.offset, right.extent.start.offset).strip()
    a, b = source.of(left), source.of(right)
    if left.extent.start.offset != start or right.extent.end.offset != end:
        return
    boundary = {"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="}
    turned = {"<": ">", "<=": ">=", ">": "<", ">=": "<="}
    if middle in boundary:
        yield mutation("comparison", source, start, end, f"{a} {boundary[middle]} {b}")
        if middle in turned:
            yield mutation("comparison turned", source, start, end, f"{a} {turned[middle]} {b}")
    elif middle in ("&&", "||"):
        yield mutation("connective", source, start, end, f"({a}) {'||' if middle == '&&' else '&&'} ({b})")
        yield mutation("condition left out", source, start, end, a)
        yield mutation("condition left out", source, start, end, b)
    elif middle in ("+", "-", "*", "/") and kind_of(cursor) in NUMBERS:
        other = {"+": "-", "-": "+", "*": "+", "/": "*"}[middle]
        yield mutation("arithmetic", source, start, end, f"({a}) {other} ({b})")
        if middle in ("-", "/"):
            yield mutation("operands swapped", source, start, end, f"({b}) {middle} ({a})")
        if middle in ("+", "-") and re.fullmatch(r"1", b):
            yield mutation("off by one", source, start, end, a)


def literal(cursor, source):
    start, end = cursor.extent.start.offset, cursor.extent.end.offset
    text = source.of(cursor)
    if cursor.kind == CursorKind.INTEGER_LITERAL and re.fullmatch(r"\d+[uUlL]*", text):
        yield mutation("off by one", source, start, end, f"{text} + 1")
    elif cursor.kind == CursorKind.FLOATING_LITERAL and re.fullmatch(r"[\d.]+(e[-+]?\d+)?f?", text):
        other = f"2 * {text}" if float(text.rstrip("f")) != 0 else "1.0"
        yield mutation("constant", source, start, end, other)
    elif cursor.kind == CursorKind.CXX_BOOL_LITERAL_EXPR and text in ("true", "false"):
        yield mutation("constant", source, start, end, "false" if text == "true" else "true")


def unary(cursor, source):
    children = list(cursor.get_children())
    start, end = cursor.extent.start.offset, cursor.extent.end.offset
    text = source.of(cursor)
    if len(children) != 1 or children[0].extent.end.offset != end:
        return
    operand = source.of(children[0])
    if text.startswith("-") and not text.startswith("--") and kind_of(cursor) in NUMBERS:
        yield mutation("sign", source, start, end, operand)
    elif text.startswith("!"):
        yield mutation("negation", source, start, end, f"static_cast<bool>({operand})")


def call(cursor, source):
    start, end = cursor.extent.start.offset, cursor.extent.end.offset
    text = source.of(cursor)
    for one, other in (("std::min(", "std::max("), ("std::max(", "std::min(")):
        if text.startswith(one):
            yield mutation("min and max", source, start, end, other + text[len(one):])
    if cursor.spelling in COMMUTATIVE:
        return
    arguments = [a for a in cursor.get_arguments() if a is not None]
    for first, second in zip(arguments, arguments[1:]):
        one, other = source.of(first), source.of(second)
        if one == other or first.type.get_canonical().spelling != second.type.get_canonical().spelling:
            continue
        if first.extent.start.offset < start or second.extent.end.offset > end or not one or not other:
            continue
        after = (source.text(start, first.extent.start.offset) + other +
                 source.text(first.extent.end.offset, second.extent.start.offset) + one +
                 source.text(second.extent.end.offset, end))
        if after.endswith(")"):
            yield mutation("arguments swapped", source, start, end, after)


def option(cursor, parent, source):
    """A read of an option: as if it had never been given."""
    text = source.of(cursor)
    if parent.kind != CursorKind.UNEXPOSED_EXPR or source.of(parent) != text or kind_of(cursor) not in NUMBERS:
        return
    if OPTION.search(text):
        start, end = cursor.extent.start.offset, cursor.extent.end.offset
        yield mutation("option ignored", source, start, end, "{}",
                       f"collided_mutants::empty_if({ON}, {text})")


def is_view(of_type):
    return re.search(r"\b(span|basic_string_view)<", of_type.get_canonical().spelling) is not None


def field(cursor, source):
    """`.name = value` in braces: as if the field had not been copied."""
    for child in cursor.get_children():
        named = re.match(r"\.(\w+) = ", source.of(child))
        if not named:
            continue
        if any(is_view(part.referenced.type) for part in child.get_children() if part.kind == CursorKind.MEMBER_REF and part.referenced):
            continue  # of the copy that empty_if() makes it would be a view, also while the bug is off
        start, end = child.extent.start.offset + named.end(), child.extent.end.offset
        value = source.text(start, end)
        if value and not value.startswith("{"):
            yield mutation("field not copied", source, start, end, "{}", f"collided_mutants::empty_if({ON}, {value})")


def statement(cursor, source):
    """A statement of its own, left out."""
    start, end = cursor.extent.start.offset, cursor.extent.end.offset
    if cursor.kind not in EXPRESSIONS or source.text(end, end + 1) != ";":
        return
    text = source.of(cursor)
    if "co_" in text or text.startswith("throw"):
        return
    rule = "field not copied" if re.match(r"[\w.\->\[\]()]+(\.|->)\w+ = ", text) else "statement left out"
    yield mutation(rule, source, start, end + 1, "nothing", f"if (!{ON}) {{ {text}; }}")


def jump(cursor, source):
    start, end = cursor.extent.start.offset, cursor.extent.end.offset
    text = source.of(cursor)
    if text in ("continue", "break", "return") and source.text(end, end + 1) == ";":
        yield mutation("statement left out", source, start, end + 1, "nothing", f"if (!{ON}) {text};")


def is_constant(cursor, parent, source):
    """Declarations and conditions whose values the compiler must know: no bug is on while it compiles."""
    if parent.kind == CursorKind.IF_STMT and cursor == next(parent.get_children()):
        return re.match(r"if\s+constexpr", source.of(parent)) is not None
    return cursor.kind in (CursorKind.DECL_STMT, CursorKind.STATIC_ASSERT) and re.match(
        r"(static |inline )?constexpr|static_assert|using|enum", source.of(cursor))


def at(cursor, parent, source):
    """Every mutation of this very node."""
    kind = cursor.kind
    if kind == CursorKind.BINARY_OPERATOR:
        yield from binary(cursor, source)
    elif kind in (CursorKind.INTEGER_LITERAL, CursorKind.FLOATING_LITERAL, CursorKind.CXX_BOOL_LITERAL_EXPR):
        yield from literal(cursor, source)
    elif kind == CursorKind.UNARY_OPERATOR:
        yield from unary(cursor, source)
    elif kind == CursorKind.CALL_EXPR:
        yield from call(cursor, source)
    elif kind == CursorKind.MEMBER_REF_EXPR:
        yield from option(cursor, parent, source)
    elif kind == CursorKind.INIT_LIST_EXPR:
        yield from field(cursor, source)
    elif kind in (CursorKind.BREAK_STMT, CursorKind.CONTINUE_STMT, CursorKind.RETURN_STMT):
        yield from jump(cursor, source)
    if parent.kind == CursorKind.COMPOUND_STMT:
        yield from statement(cursor, source)
