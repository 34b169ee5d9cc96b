"""Sizes of NetCDF's classic files (versions 1, 2 and 5), by their heads: libraries fill what a file lacks in silence."""
import struct
from typing import Any, List, Tuple

import numpy as np

# Bytes of a number by its code: byte, char, short, int, float, double; unsigned ones and those of 8 bytes.
_BYTES = (0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8)


def _padded(count: int) -> int:
    return -(-count // 4) * 4


class _Head:
    """Numbers of a head, one after the other."""

    def __init__(self, file: Any, version: int) -> None:
        self.file, self.version = file, version

    def number(self, code: str) -> int:
        return int(struct.unpack(code, self.file.read(struct.calcsize(code)))[0])

    def count(self) -> int:
        return self.number(">q" if self.version == 5 else ">i")

    def offset(self) -> int:
        return self.number(">i" if self.version == 1 else ">q")

    def rows(self) -> range:
        """Of a list: its tag and its length."""
        self.number(">i")
        return range(self.count())

    def name(self) -> None:
        self.file.seek(_padded(self.count()), 1)

    def attributes(self) -> None:
        for _ in self.rows():
            self.name()
            kind = self.number(">i")
            self.file.seek(_padded(self.count() * _BYTES[kind]), 1)


def classic_bytes(path: str) -> int:
    """Bytes up to the last value that the head of a classic file states; 0: another file, or one without a number of records.

    Raises struct.error or IndexError where the head itself is broken.
    """
    with open(path, "rb") as file:
        magic = file.read(4)
        if magic[:3] != b"CDF" or magic[3:] not in (b"\1", b"\2", b"\5"):
            return 0
        head = _Head(file, magic[3])
        records = head.count()
        lengths = []
        for _ in head.rows():
            head.name()
            lengths.append(head.count())
        head.attributes()
        last = 0
        of_records: "List[Tuple[int, int]]" = []
        for _ in head.rows():
            head.name()
            shape = [lengths[head.count()] for _ in range(head.count())]
            head.attributes()
            edge = _BYTES[head.number(">i")]
            head.count()  # the padded size, which large variables do not fit
            begin = head.offset()
            size = edge * int(np.prod([length for length in shape if length > 0], dtype=object))
            if shape[:1] == [0]:
                of_records.append((begin, size))
            else:
                last = max(last, begin + size)
    if of_records and records > 0:
        # Records lie one behind the other, padded unless there is one variable.
        step = sum(_padded(size) for _, size in of_records) if len(of_records) > 1 else of_records[0][1]
        last = max(last, max(begin + size for begin, size in of_records) + (records - 1) * step)
    return last
