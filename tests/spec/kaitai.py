"""As much of Kaitai Struct as ``spec/vmesh.ksy`` takes, read as its own runtime does."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any, Final

Spec = dict[str, Any]

_INTEGERS: Final = {"u1": 1, "u2": 2, "u4": 4}
_TERNARY: Final = re.compile(r"\(([^()?]+)\?([^()?:]+):([^()?:]+)\)")


class Reader:
    """Bytes from their start on, by bits from the lowest or by whole bytes."""

    def __init__(self, data: bytes) -> None:
        self.data = data
        self.at = 0  # in bits

    def bits(self, count: int) -> int:
        """A number of some bits within a byte."""
        byte = self.data[self.at >> 3]
        assert (self.at & 7) + count <= 8, "a number of bits lies within a byte"
        number = byte >> (self.at & 7) & (1 << count) - 1
        self.at += count
        return number

    def take(self, length: int) -> bytes:
        """Whole bytes, from the next one on if the last was not read to its end."""
        start = -(-self.at // 8)
        taken = self.data[start : start + length]
        assert len(taken) == length, "the bytes are there"
        self.at = 8 * (start + length)
        return taken

    @property
    def is_at_end(self) -> bool:
        """Whether all bytes were taken."""
        return self.at == 8 * len(self.data)


class Repeated(list[Any]):
    """A field that repeats; expressions ask for its size."""

    @property
    def size(self) -> int:
        """How many there are."""
        return len(self)


def evaluate(expression: str | int, **names: Any) -> Any:
    """What an expression says; Kaitai's and Python's differ only in the choice between two."""
    text = _TERNARY.sub(r"((\2) if (\1) else (\3))", str(expression))
    return eval(text, {"__builtins__": {}}, names)


def parse(spec: Spec, reader: Reader, known: Spec | None = None) -> Any:
    """The fields of a type, and its instances, by name."""
    known = {**(known or {}), **spec.get("types", {})}
    record = SimpleNamespace()
    for field in spec["seq"]:
        if "if" in field and not evaluate(field["if"], **vars(record)):
            continue
        setattr(record, field["id"], _read(field, reader, record, known, spec))
    for name, instance in spec.get("instances", {}).items():
        setattr(record, name, evaluate(instance["value"], **vars(record)))
    return record


def _read(field: Spec, reader: Reader, record: Any, known: Spec, spec: Spec) -> Any:
    """A field, or all of them if it repeats."""
    repeat = field.get("repeat")
    if repeat is None:
        return _read_one(field, reader, record, known, spec)
    found = Repeated()
    if repeat == "eos":
        while not reader.is_at_end:
            found.append(_read_one(field, reader, record, known, spec))
        return found
    while repeat == "until" or len(found) < evaluate(field["repeat-expr"], **vars(record)):
        found.append(_read_one(field, reader, record, known, spec))
        if repeat == "until" and evaluate(field["repeat-until"], _=found[-1]):
            break
    return found


def _read_one(field: Spec, reader: Reader, record: Any, known: Spec, spec: Spec) -> Any:
    """A field once."""
    kind = field.get("type")
    if "contents" in field:
        parts = [p.encode() if isinstance(p, str) else bytes([p]) for p in field["contents"]]
        wanted = b"".join(parts)
        assert reader.take(len(wanted)) == wanted, "fixed bytes are as stated"
        return wanted
    if isinstance(kind, str) and kind in known:
        return parse(known[kind], reader, known)
    if isinstance(kind, str) and kind in _INTEGERS:
        return int.from_bytes(reader.take(_INTEGERS[kind]), "little")
    if isinstance(kind, str) and re.fullmatch(r"b[1-8]", kind):
        number = reader.bits(int(kind[1:]))
        return spec["enums"][field["enum"]][number] if "enum" in field else number
    if field.get("size-eos"):
        return reader.take(len(reader.data) - reader.at // 8)
    content = reader.take(evaluate(field["size"], **vars(record)))
    if isinstance(kind, dict):
        value = evaluate(kind["switch-on"], **vars(record))
        case = kind["cases"].get(f'"{value}"')
        # As the runtime of Kaitai does: the bytes stay beside what is made of them.
        record._raw_content = content
        return parse(known[case], Reader(content), known) if case else content
    return content.decode(field["encoding"]) if kind == "str" else content
