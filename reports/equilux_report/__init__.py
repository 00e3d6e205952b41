"""The HTML report of an equilux run. It reads a results tree and nothing else."""

from equilux_report.build import build

__all__ = ["build"]
