"""The HTML report of an equilux run. It reads a results tree and nothing else."""

from equilux_report.build import build
from equilux_report.tradeoff import build_tradeoff

__all__ = ["build", "build_tradeoff"]
