"""Messages between the engine and a worker: four bytes of magic, four of length, then the payload; over private pipes.

Requests (engine → worker) are pickles, because the engine trusts itself; replies (worker → engine) are JSON, because third-party
code runs in there and may write anything anywhere.
"""

from __future__ import annotations

import os
import select
import struct
import time
from typing import Final

MAGIC: Final = b"EQX1"
HEADER: Final = struct.Struct("<4sI")
MAX_REPLY: Final = 8 << 20
"""A reply is a few kilobytes of JSON (the picture goes through a file); anything far above is garbage."""


class Closed(Exception):
    """The other end is gone."""


class Garbage(Exception):
    """What came is not a message. The text says what came."""


class TookTooLong(Exception):
    """The deadline passed."""


def send(fd: int, payload: bytes, deadline: float | None = None) -> None:
    """Write one message. Raises Closed, TookTooLong (with a deadline in `time.monotonic` seconds, on a non-blocking fd)."""
    rest = memoryview(HEADER.pack(MAGIC, len(payload)) + payload)
    while rest:
        _wait(fd, select.POLLOUT, deadline)
        try:
            rest = rest[os.write(fd, rest[:65536]) :]
        except BlockingIOError:
            continue
        except BrokenPipeError as problem:
            raise Closed from problem


def receive(fd: int, deadline: float | None = None, limit: int | None = None) -> bytes:
    """Read one message. Raises Closed, TookTooLong, Garbage."""
    magic, length = HEADER.unpack(_exactly(fd, HEADER.size, deadline))
    if magic != MAGIC:
        raise Garbage(f"the reply starts with the bytes {magic!r}, expected {MAGIC!r}")
    if limit is not None and length > limit:
        raise Garbage(f"the reply is {length} bytes long, the limit is {limit}")
    return _exactly(fd, length, deadline)


def _exactly(fd: int, count: int, deadline: float | None) -> bytes:
    parts = bytearray()
    while len(parts) < count:
        _wait(fd, select.POLLIN, deadline)
        try:
            part = os.read(fd, min(count - len(parts), 1 << 20))
        except BlockingIOError:
            continue
        if not part:
            raise Closed
        parts += part
    return bytes(parts)


def _wait(fd: int, event: int, deadline: float | None) -> None:
    """Wait until the fd is ready (or hung up: then the read or write says so)."""
    poll = select.poll()
    poll.register(fd, event)
    while True:
        left = None if deadline is None else max(0.0, deadline - time.monotonic())
        if poll.poll(None if left is None else left * 1000 + 1):
            return
        if left == 0.0:
            raise TookTooLong
