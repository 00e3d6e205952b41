"""The process that workers are forked from: `python -m equilux.nursery CONTROL_FD`.

Importing what every worker needs takes half a second, forking a process that has imported it a hundredth. The nursery has one
thread and has never run an adapter, so forking it is safe. It reports the end of every worker, keeps its process id from being
used again until the engine lets go of it, and when the engine is gone it ends whatever is left.

Messages, one JSON object per packet of a SOCK_SEQPACKET pair. From the engine: {"start": number, "adapter", "entry_point"}
with three file descriptors (requests, replies, log), {"release": pid}. From the nursery: {"ready": true},
{"started": number, "pid"}, {"ended": pid, "status"} where a negative status is a signal.
"""

from __future__ import annotations

import json
import os
import select
import signal
import socket
import sys
import traceback
from typing import Any

import numpy as np

from equilux import worker

MAX_PACKET = 1 << 16


def main(control: socket.socket) -> None:
    """Serve the engine until it closes its end."""
    os.set_inheritable(control.fileno(), False)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    wake_read, wake_write = os.pipe()
    os.set_blocking(wake_write, False)
    os.set_blocking(wake_read, False)
    signal.set_wakeup_fd(wake_write, warn_on_full_buffer=False)
    signal.signal(signal.SIGCHLD, lambda *_: None)  # only the wake-up matters
    children: set[int] = set()
    try:
        control.send(json.dumps({"ready": True}).encode())
        while True:
            ready, _, _ = select.select([control.fileno(), wake_read], [], [])
            if wake_read in ready:
                os.read(wake_read, 4096)
            if control.fileno() in ready and not _serve(control, children, (control.fileno(), wake_read, wake_write)):
                return
            for pid in list(children):
                if (status := _ended(pid)) is not None:
                    children.discard(pid)
                    control.send(json.dumps({"ended": pid, "status": status}).encode())
    except ConnectionError:
        return  # the engine was killed
    finally:
        _end_all(children)


def _serve(control: socket.socket, children: set[int], ours: tuple[int, ...]) -> bool:
    """Do what one packet asks. False when the engine has closed its end."""
    packet, descriptors, _, _ = socket.recv_fds(control, MAX_PACKET, 3)
    if not packet:
        return False
    message = json.loads(packet)
    if "release" in message:
        _reap(message["release"])
    else:
        pid = _start(message, descriptors, ours)
        children.add(pid)
        control.send(json.dumps({"started": message["start"], "pid": pid}).encode())
    return True


def _start(message: dict[str, Any], descriptors: list[int], ours: tuple[int, ...]) -> int:
    """Fork a worker. Returns its process id; in the child, never returns."""
    pid = os.fork()
    if pid:
        for descriptor in descriptors:
            os.close(descriptor)
        return pid
    status = 1
    try:
        os.setsid()
        signal.set_wakeup_fd(-1)
        signal.signal(signal.SIGCHLD, signal.SIG_DFL)
        for descriptor in ours:
            os.close(descriptor)
        requests, replies, log = descriptors
        os.dup2(log, 1)
        os.dup2(log, 2)
        os.close(log)
        np.random.seed()  # a forked generator would repeat its siblings' numbers
        worker.main(message["adapter"], message["entry_point"], requests, replies)
        status = 0
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stderr.flush()
        os._exit(status)


def _ended(pid: int) -> int | None:
    """Exit status of a child that has ended, negative for a signal; None while it runs. It stays a zombie: its id stays taken."""
    result = os.waitid(os.P_PID, pid, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    if result is None:
        return None
    return result.si_status if result.si_code == os.CLD_EXITED else -result.si_status


def _reap(pid: int) -> None:
    os.waitpid(pid, 0)


def _end_all(children: set[int]) -> None:
    """The engine is gone: an idle worker ends by itself, one that hangs must not outlive it."""
    from equilux.process_tree import Tree

    for pid in children:
        Tree(pid).kill()


if __name__ == "__main__":
    main(socket.socket(fileno=int(sys.argv[1])))
