"""Expressions of Python as text in WGSL."""

from __future__ import annotations

import ast
from collections.abc import Collection

import numpy as np

#: Functions, and the numbers of arguments that they take.
FUNCTIONS = {
    "abs": (1, 1),
    "atan": (1, 1),
    "clamp": (3, 3),
    "cos": (1, 1),
    "exp": (1, 1),
    "log": (1, 1),
    "max": (2, 8),
    "min": (2, 8),
    "pow": (2, 2),
    "sign": (1, 1),
    "sin": (1, 1),
    "sqrt": (1, 1),
    "tan": (1, 1),
    "tanh": (1, 1),
}
OPERATORS: dict[type[ast.operator], str] = {ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.Div: "/"}
COMPARISONS: dict[type[ast.cmpop], str] = {
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
}
#: The greatest whole exponent that is written as a product.
MOST_FACTORS = 8
#: The largest number of float32.
LARGEST = float(np.finfo(np.float32).max)
#: The longest base of a power that is written as a product, in letters.
LONGEST = 4000


def to_wgsl(what: str, expression: str, names: Collection[str]) -> str:
    """Translates an expression of numbers.

    ``what`` begins messages, and ``names`` are the values that the expression may use.

    Raises
    ------
    ValueError
        For anything else than numbers, names, ``+ - * / **``, ``a if b else c``, comparisons and the functions above, with line and
        column.
    """
    try:
        return _Translation(what, expression, names).text()
    except (RecursionError, MemoryError):
        raise ValueError(f"{what}: the expression is too deep") from None


class _Translation:
    def __init__(self, what: str, expression: str, names: Collection[str]) -> None:
        self.what = what
        self.expression = expression
        self.names = names
        before = expression[: len(expression) - len(expression.lstrip())]
        self.line = before.count("\n")
        self.column = len(before) - (before.rfind("\n") + 1)

    def text(self) -> str:
        stripped = self.expression.strip()
        if not stripped:
            raise ValueError(f"{self.what}: expected an expression, got an empty text")
        try:
            tree = ast.parse(stripped, mode="eval")
        except SyntaxError as error:
            # Of an expression that ends too early, Python does not name the place.
            lines = stripped.splitlines()
            line, column = (error.lineno, error.offset - 1) if error.lineno and error.offset else (len(lines), len(lines[-1]))
            raise self._error(line, column, f"this is no expression of Python: {error.msg}") from None
        return self._number(tree.body)

    def _error(self, line: int, column: int, message: str) -> ValueError:
        """The error of a place: line from 1, column from 0, in the text without the space around it."""
        column += self.column if line == 1 else 0
        line += self.line
        shown = self.expression.splitlines()[line - 1 : line]
        marked = "".join(f"\n    {text}\n    {' ' * column}^" for text in shown)
        return ValueError(f"{self.what}, line {line}, column {column + 1}: {message}{marked}")

    def _refused(self, node: ast.expr, message: str) -> ValueError:
        line = self.expression.strip().splitlines()[node.lineno - 1]
        # Columns of `ast` count bytes.
        column = len(line.encode()[: node.col_offset].decode())
        return self._error(node.lineno, column, message)

    def _number(self, node: ast.expr) -> str:
        match node:
            case ast.Constant(value=bool()) | ast.Constant(value=str() | bytes() | complex() | None):
                raise self._refused(node, f"expected a number, got {node.value!r}")
            case ast.Constant(value=int() | float() as value):
                if abs(value) > LARGEST:
                    raise self._refused(node, "this number is out of the range of float32")
                return repr(float(value))
            case ast.Name(id=name) if name in self.names:
                return name
            case ast.Name(id=name):
                known = ", ".join(sorted(self.names))
                raise self._refused(node, f"{name!r} is not known here, expected one of: {known}")
            case ast.UnaryOp(op=ast.USub(), operand=operand):
                return f"(-{self._number(operand)})"
            case ast.UnaryOp(op=ast.UAdd(), operand=operand):
                return self._number(operand)
            case ast.BinOp(op=ast.Pow(), left=left, right=right):
                return self._power(self._number(left), right)
            case ast.BinOp(op=op, left=left, right=right) if type(op) in OPERATORS:
                return f"({self._number(left)} {OPERATORS[type(op)]} {self._number(right)})"
            case ast.IfExp(test=test, body=body, orelse=orelse):
                return f"select({self._number(orelse)}, {self._number(body)}, {self._condition(test)})"
            case ast.Call(func=ast.Name(id=name), args=arguments, keywords=[]) if name in FUNCTIONS:
                return self._call(node, name, arguments)
            case ast.Call():
                raise self._refused(node, f"this function is not known, expected one of: {', '.join(FUNCTIONS)}")
            case ast.Compare() | ast.BoolOp() | ast.UnaryOp(op=ast.Not()):
                raise self._refused(node, "a condition is no number, expected one only in 'a if CONDITION else b'")
        raise self._refused(node, "this is not allowed, expected numbers, names, + - * / **, 'a if b else c', and functions")

    def _power(self, base: str, exponent: ast.expr) -> str:
        """Products and roots where they will do: pow() of WGSL takes no negative base, and devices round it in their own ways."""
        value: object = None
        match exponent:
            case ast.Constant(value=int() | float() as number) if not isinstance(number, bool):
                value = number
            case ast.UnaryOp(op=ast.USub(), operand=ast.Constant(value=int() | float() as number)) if number > 0:
                return f"(1.0 / {self._power(base, exponent.operand)})"
        if not isinstance(value, (int, float)) or (2 * value) % 1 != 0 or value > MOST_FACTORS:
            return f"pow({base}, {self._number(exponent)})"
        if len(base) > LONGEST:
            raise self._refused(exponent, "the base of this power is too long, compute it in WGSL")
        factors = [base] * int(value) + ([f"sqrt({base})"] if value % 1 else [])
        return f"({' * '.join(factors)})" if factors else "1.0"

    def _call(self, node: ast.expr, name: str, arguments: list[ast.expr]) -> str:
        least, most = FUNCTIONS[name]
        if not least <= len(arguments) <= most:
            expected = str(least) if least == most else f"{least} to {most}"
            raise self._refused(node, f"{name}() takes {expected} argument{'s' * (most > 1)}, got {len(arguments)}")
        given = [self._number(argument) for argument in arguments]
        if name in ("min", "max"):
            text = given[0]
            for other in given[1:]:
                text = f"{name}({text}, {other})"
            return text
        return f"{name}({', '.join(given)})"

    def _condition(self, node: ast.expr) -> str:
        match node:
            case ast.Compare(left=left, ops=ops, comparators=others) if all(type(op) in COMPARISONS for op in ops):
                sides = [self._number(side) for side in (left, *others)]
                pairs = zip(sides, ops, sides[1:], strict=False)
                return "(" + " && ".join(f"({a} {COMPARISONS[type(op)]} {b})" for a, op, b in pairs) + ")"
            case ast.BoolOp(op=op, values=values):
                word = " && " if isinstance(op, ast.And) else " || "
                return "(" + word.join(self._condition(value) for value in values) + ")"
            case ast.UnaryOp(op=ast.Not(), operand=operand):
                return f"(!{self._condition(operand)})"
        raise self._refused(node, "expected a comparison, such as speed > 0")
