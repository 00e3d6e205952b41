"""The trade of speed for accuracy, measured: every setting of every renderer, its error against the truth and its time by phase;
the Pareto fronts, and what follows from them: presets, and which setting meets a demanded accuracy."""
