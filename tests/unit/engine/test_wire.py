"""Messages over a pipe arrive whole or are refused; nothing that comes can make the reader wait for ever or eat memory."""

from __future__ import annotations

import os
import struct
import threading
import time
from collections.abc import Iterator

import pytest

from equilux import wire


@pytest.fixture
def pipe() -> Iterator[tuple[int, int]]:
    read, write = os.pipe()
    os.set_blocking(read, False)
    os.set_blocking(write, False)
    yield read, write
    for fd in (read, write):
        try:
            os.close(fd)
        except OSError:
            continue  # the test closed it


def test_a_message_larger_than_the_pipe_arrives_whole(pipe: tuple[int, int]):
    payload = os.urandom(300_000)
    sender = threading.Thread(target=wire.send, args=(pipe[1], payload, time.monotonic() + 10))
    sender.start()
    assert wire.receive(pipe[0], time.monotonic() + 10) == payload
    sender.join()


def test_bytes_that_are_no_message_are_garbage(pipe: tuple[int, int]):
    os.write(pipe[1], b"Segmentation fault\n")
    with pytest.raises(wire.Garbage, match="starts with the bytes b'Segm'"):
        wire.receive(pipe[0], time.monotonic() + 1)


def test_a_message_beyond_the_limit_is_refused_unread(pipe: tuple[int, int]):
    os.write(pipe[1], struct.pack("<4sI", wire.MAGIC, 2**32 - 1))
    with pytest.raises(wire.Garbage, match="4294967295 bytes long, the limit is 100"):
        wire.receive(pipe[0], time.monotonic() + 1, 100)


def test_half_a_message_and_a_closed_pipe_is_closed(pipe: tuple[int, int]):
    os.write(pipe[1], struct.pack("<4sI", wire.MAGIC, 10) + b"half")
    os.close(pipe[1])
    with pytest.raises(wire.Closed):
        wire.receive(pipe[0], time.monotonic() + 1)


def test_half_a_message_and_silence_is_too_long(pipe: tuple[int, int]):
    os.write(pipe[1], struct.pack("<4sI", wire.MAGIC, 10) + b"half")
    started = time.monotonic()
    with pytest.raises(wire.TookTooLong):
        wire.receive(pipe[0], started + 0.2)
    assert time.monotonic() - started < 5


def test_sending_to_nobody_is_closed(pipe: tuple[int, int]):
    os.close(pipe[0])
    with pytest.raises(wire.Closed):
        wire.send(pipe[1], b"x" * 100_000, time.monotonic() + 1)


def test_sending_to_somebody_who_does_not_read_is_too_long(pipe: tuple[int, int]):
    with pytest.raises(wire.TookTooLong):
        wire.send(pipe[1], b"x" * 1_000_000, time.monotonic() + 0.2)
