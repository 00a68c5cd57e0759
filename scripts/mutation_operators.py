# SPDX-License-Identifier: Apache-2.0
# Copyright Contributors to the cg2raw Project.
"""The small faults that scripts/mutants plants in a Python source.

mutmut changes functions only, through wrappers that signatures and processes of the
command meet; cosmic-ray changes files in the tree, runs all tests for each, and brings
a database and a web client. Texts are not changed here: of a message, most changes are
no faults. Nor are annotations, decorators and f-strings.
"""

import ast
import itertools
from dataclasses import dataclass

SWAPS = {
    ast.Add: ("+", "-"),
    ast.Sub: ("-", "+"),
    ast.Mult: ("*", "/"),
    ast.Div: ("/", "*"),
    ast.FloorDiv: ("//", "/"),
    ast.Mod: ("%", "//"),
    ast.Pow: ("**", "*"),
    ast.BitAnd: ("&", "|"),
    ast.BitOr: ("|", "&"),
    ast.LShift: ("<<", ">>"),
    ast.RShift: (">>", "<<"),
    ast.Lt: ("<", "<="),
    ast.LtE: ("<=", "<"),
    ast.Gt: (">", ">="),
    ast.GtE: (">=", ">"),
    ast.Eq: ("==", "!="),
    ast.NotEq: ("!=", "=="),
    ast.Is: ("is", "is not"),
    ast.IsNot: ("is not", "is"),
    ast.In: ("in", "not in"),
    ast.NotIn: ("not in", "in"),
    ast.And: ("and", "or"),
    ast.Or: ("or", "and"),
}
PAIRS = [
    ("min", "max"),
    ("any", "all"),
    ("minimum", "maximum"),
    ("argmin", "argmax"),
    ("floor", "ceil"),
]
NAMES = dict(PAIRS) | {right: left for left, right in PAIRS}
CONDITIONS = (ast.Name, ast.Attribute, ast.Call, ast.Subscript)
NOT_CHANGED = {"annotation", "returns", "decorator_list"}
ARGUMENTS_NOT_CHANGED = {"strict", "optimize"}  # of zip, of einsum


@dataclass(frozen=True)
class Mutation:
    """One fault: text takes the place of source[start:end], in bytes.

    lines has the lines of the statement that decide which tests run it, from 1 on, or
    None for what runs at import."""

    start: int
    end: int
    text: str
    line: int
    lines: range | None

    def apply(self, source: bytes) -> bytes:
        """Return the source with the fault."""
        return source[: self.start] + self.text.encode() + source[self.end :]

    def compiles(self, source: bytes) -> bool:
        """Return whether the source with the fault is Python."""
        try:
            compile(self.apply(source), "mutant", "exec", dont_inherit=True)
        except SyntaxError:
            return False
        return True


def mutations(source: bytes) -> list[Mutation]:
    """Return the faults of a Python source in order; a few of them do not compile."""
    found = _Finder(source)
    found.visit(ast.parse(source))
    return sorted(found.found, key=lambda one: (one.start, one.end, one.text))


class _Finder(ast.NodeVisitor):
    def __init__(self, source: bytes) -> None:
        self.source = source
        lengths = map(len, source.splitlines(keepends=True))
        self.starts = [0, *itertools.accumulate(lengths)]
        self.found: list[Mutation] = []
        self.statement: ast.stmt | None = None
        self.functions = 0

    def start(self, node: ast.AST) -> int:
        return self.starts[node.lineno - 1] + node.col_offset

    def end(self, node: ast.AST) -> int:
        return self.starts[node.end_lineno - 1] + node.end_col_offset

    def add(self, node: ast.AST, text: str, start=None, end=None) -> None:
        """Note a fault in a node, or in a part of its text."""
        lines = None
        if self.functions:
            lines = range(self.statement.lineno, node.end_lineno + 1)
        start = self.start(node) if start is None else start
        end = self.end(node) if end is None else end
        line = self.source.count(b"\n", 0, start) + 1
        self.found.append(Mutation(start, end, text, line, lines))

    def swap(self, node: ast.AST, operator: ast.AST, left, right) -> None:
        """Swap the operator that stands between two nodes."""
        old, new = SWAPS.get(type(operator), (None, None))
        start, end = self.end(left), self.start(right)
        at = self.source.find(old.encode(), start, end) if old else -1
        if at >= 0:
            self.add(node, new, at, at + len(old))

    def generic_visit(self, node: ast.AST) -> None:
        for name, value in ast.iter_fields(node):
            if name in NOT_CHANGED:
                continue
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST):
                    self.visit(child)

    def visit(self, node: ast.AST) -> None:
        if isinstance(node, ast.JoinedStr):
            return
        outer = self.statement
        if isinstance(node, ast.stmt):
            self.statement = node
        if isinstance(node, ast.If | ast.IfExp | ast.While):
            self.condition(node.test)
        for condition in getattr(node, "ifs", []):
            self.condition(condition)
        super().visit(node)
        self.statement = outer

    def condition(self, node: ast.expr) -> None:
        text = self.source[self.start(node) : self.end(node)].decode()
        if text == "TYPE_CHECKING":
            return
        if isinstance(node, CONDITIONS):
            self.add(node, f"not ({text})")

    def visit_FunctionDef(self, node) -> None:
        self.visit(node.args)  # the values that arguments have run at import
        self.functions += 1
        for child in node.body:
            self.visit(child)
        self.functions -= 1

    visit_AsyncFunctionDef = visit_FunctionDef

    def visit_Lambda(self, node: ast.Lambda) -> None:
        self.visit(node.args)
        self.visit(node.body)

    def visit_BinOp(self, node: ast.BinOp) -> None:
        self.swap(node, node.op, node.left, node.right)
        self.generic_visit(node)

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        self.swap(node, node.op, node.target, node.value)
        self.generic_visit(node)

    def visit_Compare(self, node: ast.Compare) -> None:
        sides = itertools.pairwise([node.left, *node.comparators])
        for operator, (left, right) in zip(node.ops, sides, strict=True):
            self.swap(node, operator, left, right)
        self.generic_visit(node)

    def visit_BoolOp(self, node: ast.BoolOp) -> None:
        for left, right in itertools.pairwise(node.values):
            self.swap(node, node.op, left, right)
        self.generic_visit(node)

    def visit_UnaryOp(self, node: ast.UnaryOp) -> None:
        if isinstance(node.op, ast.Not | ast.USub):
            length = 3 if isinstance(node.op, ast.Not) else 1
            self.add(node, "", self.start(node), self.start(node) + length)
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        if isinstance(node.value, bool):
            self.add(node, str(not node.value))
        elif isinstance(node.value, int | float):
            self.add(node, repr(node.value + 1))

    def visit_Call(self, node: ast.Call) -> None:
        name = getattr(node.func, "id", getattr(node.func, "attr", ""))
        if name in NAMES:
            end = self.end(node.func)
            self.add(node.func, NAMES[name], end - len(name), end)
        for keyword in node.keywords:
            if keyword.arg in ARGUMENTS_NOT_CHANGED:
                continue
            if keyword.arg:
                end = self.end(keyword)
                rest = self.source[end : self.end(node)].lstrip()
                if rest.startswith(b","):
                    end = self.source.index(b",", end) + 1
                self.add(keyword, "", self.start(keyword), end)
        self.generic_visit(node)

    def visit_keyword(self, node: ast.keyword) -> None:
        if node.arg not in ARGUMENTS_NOT_CHANGED:
            self.generic_visit(node)

    def visit_Return(self, node: ast.Return) -> None:
        if node.value and getattr(node.value, "value", node) is not None:
            self.add(node.value, "None")
        self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> None:
        if isinstance(node.value, ast.Call):
            self.add(node, "pass")
        self.generic_visit(node)

    def visit_Raise(self, node: ast.Raise) -> None:
        self.add(node, "pass")

    def visit_Break(self, node: ast.Break) -> None:
        self.add(node, "continue")

    def visit_Continue(self, node: ast.Continue) -> None:
        self.add(node, "break")
