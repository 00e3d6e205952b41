"""The pytest plugin: `pytest scene_specs --equilux-adapters povray,vtk` judges scenes as `equilux run` does.

Loaded into every pytest run of an environment that has equilux, so this file imports the standard library and pytest only; the
rest is imported when a scene is collected. `docs/ci.md` is the manual.
"""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from equilux.pytest_plugin.session import Conductor

SUFFIX = ".scene.yaml"
_CONDUCTOR = pytest.StashKey["Conductor"]()
_ASKED = pytest.StashKey["tuple[tuple[str, ...], str]"]()

# Option, its ini option's type, what it takes, help. Those of `equilux run`, by the same names.
_OPTIONS: tuple[tuple[str, Any, str, str], ...] = (
    ("adapters", "string", "A,B", "adapters to use, separated by commas; the reference and the oracle are added"),
    ("out", "string", "DIR", "folder of the results tree (default: equilux-out)"),
    ("set", "linelist", "KNOB=V", "a knob, [ADAPTER.]KNOB=VALUE; may be given several times"),
    ("case_filter", "string", "GLOB", "only the cases of this name; * and ? are wild"),
    ("timeout", "string", "S", "seconds that one render may take (default: 120)"),
    ("memory", "string", "MIB", "MiB that one render may hold resident"),
    ("jobs", "string", "N", "cores to use (default: all, shared between the workers of xdist)"),
    ("limit", "linelist", "NAME=V", "raise a limit on specs; may be given several times"),
    ("diagnosis_timeout", "string", "S", "seconds that the diagnosis of one render may take (default: 20)"),
    ("as_is", "bool", "", "render also with an adapter that lacks a feature of the scene, and judge what comes"),
    ("no_reuse", "bool", "", "render and compare anew, whatever was made before"),
    ("no_diagnose", "bool", "", "do not say why renders diverge"),
)


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("equilux", "equilux: scenes as test cases")
    for name, kind, takes, text in _OPTIONS:
        flag = f"--equilux-{name.replace('_', '-')}"
        if kind == "bool":
            group.addoption(flag, dest=f"equilux_{name}", action="store_true", default=None, help=text)
        else:
            action = "append" if kind == "linelist" else "store"
            group.addoption(flag, dest=f"equilux_{name}", action=action, default=None, metavar=takes, help=text)
        parser.addini(f"equilux_{name}", f"as {flag}", type=kind, default=None)
    parser.addini(
        "equilux_collect",
        f"whether *{SUFFIX} files are collected: always, never, or auto (where they are named on the command line, "
        "below a folder that is and does not belong to testpaths, or anywhere once adapters are given)",
        default="auto",
    )


def given(config: pytest.Config, name: str) -> Any:
    """An option from the command line, else from the ini file, else None."""
    value = config.getoption(f"equilux_{name}")
    return config.getini(f"equilux_{name}") or None if value is None else value


# --- collecting -------------------------------------------------------------------------------------------------------


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    if not file_path.name.endswith(SUFFIX) or not _wanted(file_path, parent.config):
        return None
    from equilux.pytest_plugin.collecting import SpecFile

    return SpecFile.from_parent(parent, path=file_path)


def _wanted(path: Path, config: pytest.Config) -> bool:
    """Whether somebody asked for this scene: see `equilux_collect`."""
    rule = config.getini("equilux_collect")
    if rule not in ("auto", "always", "never"):
        raise pytest.UsageError(f"equilux_collect: got '{rule}', expected auto, always or never")
    if rule != "auto":
        return bool(rule == "always")
    if given(config, "adapters"):
        return True
    return any(path == root or root in path.parents for root in map(Path, _asked(config)[0]))


def _asked(config: pytest.Config) -> tuple[tuple[str, ...], str]:
    """Files and folders named on the command line of the session, without folders of `testpaths` (those hold tests, whose
    fixtures may be scenes); and a name that all processes of the session share."""
    if _ASKED not in config.stash:
        told = getattr(config, "workerinput", {}).get("equilux")
        config.stash[_ASKED] = (tuple(told[0]), str(told[1])) if told else (_named_paths(config), f"pytest-{os.getpid()}")
    return config.stash[_ASKED]


def _named_paths(config: pytest.Config) -> tuple[str, ...]:
    if config.args_source is not pytest.Config.ArgsSource.ARGS:
        return ()
    homes = [config.rootpath / home for home in config.getini("testpaths")]
    named = [(config.invocation_params.dir / argument.partition("::")[0]).resolve() for argument in config.args]
    return tuple(str(path) for path in named if path.is_file() or not any(home == path or home in path.parents for home in homes))


def _conductor(config: pytest.Config) -> Conductor:
    if _CONDUCTOR not in config.stash:
        from equilux.pytest_plugin.session import Conductor
        from equilux.pytest_plugin.settings import Settings

        config.stash[_CONDUCTOR] = Conductor(Settings.of(config, _asked(config)[1]))
    return config.stash[_CONDUCTOR]


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if (conductor := config.stash.get(_CONDUCTOR, None)) is not None:
        from equilux.pytest_plugin.collecting import deselect

        deselect(config, items, conductor)


def pytest_collection_finish(session: pytest.Session) -> None:
    """Everything that will be run is known: what to render, and that somebody must hold the results tree."""
    if (conductor := session.config.stash.get(_CONDUCTOR, None)) is not None and not session.config.option.collectonly:
        from equilux.pytest_plugin.collecting import PairItem

        chosen = [item for item in session.items if isinstance(item, PairItem)]
        conductor.choose((item.case, item.pair) for item in chosen)
        if chosen and not hasattr(session.config, "workerinput"):
            _open_tree(session.config)


# --- xdist ------------------------------------------------------------------------------------------------------------


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """A worker of xdist is told what only the controller knows."""
    node.workerinput["equilux"] = _asked(node.config)


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_node_collection_finished(node: Any, ids: list[str]) -> None:
    """The controller collects nothing itself, and holds the results tree for all of its workers."""
    if any(f"{SUFFIX}::" in each for each in ids):
        _open_tree(node.config)


# --- results ----------------------------------------------------------------------------------------------------------


def _open_tree(config: pytest.Config) -> None:
    from equilux.complaint import BadUsage

    try:
        _conductor(config).open_tree(("pytest", *map(str, config.invocation_params.args)))
    except BadUsage as problem:
        pytest.exit(str(problem), returncode=pytest.ExitCode.USAGE_ERROR)


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    """Here for the controller of xdist too: what was scored is told by the reports."""
    if report.when == "call":
        for name, value in report.user_properties:
            if name == "equilux.scored":
                _scored[str(value)] = _scored.get(str(value), 0) + 1


_scored: dict[str, int] = {}
"""How many items were scored ("yes") and not ("no") in this process's session. One process is one session, but for tests of
pytest plugins, which is why a session starts it anew."""


def pytest_sessionstart() -> None:
    _scored.clear()


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    if _scored and not _scored.get("yes") and session.exitstatus == pytest.ExitCode.OK:
        session.exitstatus = pytest.ExitCode.NO_TESTS_COLLECTED
    if (conductor := session.config.stash.get(_CONDUCTOR, None)) is not None:
        conductor.finish()


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    if _scored and not _scored.get("yes"):
        terminalreporter.write_line("equilux: nothing was scored (exit code 4 of 'equilux run')", yellow=True)
    if (conductor := config.stash.get(_CONDUCTOR, None)) is not None:
        for line in conductor.last_words():
            terminalreporter.write_line(line)
