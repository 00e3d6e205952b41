"""What a diagnosis says. All of it is data: JSON in, JSON out."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import BaseModel, ConfigDict, Field


class _Record(BaseModel):
    model_config = ConfigDict(extra="forbid", allow_inf_nan=False, frozen=True)


class Region(_Record):
    """Where pixels lie: how many, the box around them (pixels, inclusive), and what is seen there."""

    pixels: int
    x0: int
    y0: int
    x1: int
    y1: int
    words: str = Field(description="in the scene's own names: 'on objects[0] (sphere, clay), in the highlight of light key'")


class Alternative(_Record):
    """A cause that does the same on this scene: the scene cannot tell them apart."""

    id: str
    parameter: Any = None
    reading: str = ""


class Found(_Record):
    """One cause of a diagnosis; or, with id `unexplained`, what no cause accounts for.

    explained: share of the diverging pixels that is lost when this cause alone is left out (for `unexplained`: the share that
    stays diverging). residual_max_abs: the largest |a − changed reference| over the pixels that are not edges, W/(m²·sr), all
    causes together. words: the cause in a sentence with its parameter. recognised: the parameter's name where it has one: "π",
    "1/4π", "255/256". declared: the adapter declares it. alternatives: causes that the scene cannot tell from this one. terms:
    for `unexplained`: correlation of what is left with each term of the reference, strongest first.
    """

    id: str
    parameter: Any = None
    reading: str = ""
    explained: float | None = None
    residual_max_abs: float | None = None
    side: str | None = Field(default=None, description="the adapter that departs from the model")
    words: str = ""
    formula: tuple[str, str] | None = Field(default=None, description="what the model says, what the renderer does instead")
    recognised: str | None = None
    suspects: Literal["renderer", "translation"] | None = None
    declared: bool = False
    region: Region | None = None
    alternatives: tuple[Alternative, ...] = ()
    terms: dict[str, float] = {}


class Diagnosis(_Record):
    """Why one render departs from the truth of its case.

    diverging: pixels that diverged before. explained: the share of them that all causes together bring within uncertainty;
    broken: pixels that agreed before and no longer do under the causes. causes: proven ones, most explaining first; last
    `unexplained` where anything is left. dialect: how the render stands to the adapter's declared dialect: agree, diverge, or
    None where nothing declared concerns the case. seconds: what the diagnosis took.
    """

    adapter: str
    diverging: int
    explained: float
    broken: int = 0
    causes: tuple[Found, ...] = ()
    dialect: Literal["agree", "diverge"] | None = None
    tried: int = Field(default=0, description="hypotheses that were evaluated")
    seconds: float = 0.0

    @property
    def proven(self) -> tuple[Found, ...]:
        return tuple(cause for cause in self.causes if cause.id != "unexplained")
