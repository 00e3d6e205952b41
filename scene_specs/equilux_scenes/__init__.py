"""Neutral scene specs: the typed model, the loader with located errors, features, sweeps, transforms and meshes.

Begin at `loader` (files → `SceneFile` → `case.Case`); `model` says what a spec may hold. Knows no renderer.
"""
