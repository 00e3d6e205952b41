"""How fast equilux is, beside what bounds it: measurements, written to build/bench.json. Never installed."""
