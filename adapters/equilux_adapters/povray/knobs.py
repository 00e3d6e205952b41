"""The speed/accuracy settings of the POV-Ray adapter."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from equilux.adapter import Knobs

Levels = Annotated[int, Field(ge=1, le=256)]


class PovrayKnobs(Knobs):
    """POV-Ray writes 16-bit integers, so range and precision are bought with exposures, one POV-Ray process each; or floats, of
    less precision, in one.
    """

    channel: Literal["png16", "exr", "hdr"] = Field(
        default="png16", json_schema_extra={"faster": ["hdr", "exr", "png16"], "steps": ["hdr", "exr", "png16"]},
        description="what POV-Ray writes: one Radiance picture (8 bits and a common exponent), one OpenEXR picture (half floats, "
        "11 bits), or 16-bit PNG at several exposures",
    )
    exposures: int = Field(
        default=12, ge=1, le=16, json_schema_extra={"faster": "smaller", "steps": [1, 2, 4, 8, 12]},
        description="most exposures merged into one image; the brightest part is always unclipped, the dark end gives way",
    )
    relative_precision: float = Field(
        default=1e-4, ge=2e-5, le=0.1, json_schema_extra={"faster": "larger", "steps": [1e-2, 1e-3, 1e-4, 2e-5]},
        description="relative error by quantisation, from `darkest` upwards",
    )
    darkest: float = Field(
        default=1e-3, gt=0, le=1e6, json_schema_extra={"faster": "larger", "steps": [0.1, 1e-3, 1e-5]},
        description="radiance, W/(m² sr), down to which `relative_precision` holds; lowered where all is darker",
    )
    fade_ratio: float = Field(
        default=1e-5, ge=1e-7, le=1e-1, json_schema_extra={"faster": "larger", "steps": [1e-2, 1e-3, 1e-5]},
        description="fade_distance of a pure inverse-square or inverse-linear light, as a fraction of its nearest lit distance",
    )
    max_trace_level: Levels | Literal["scene"] = Field(
        default="scene", json_schema_extra={"faster": "smaller", "steps": [1, 2, 3, 5, 9, "scene"]},
        description="levels of rays that are followed, the camera's own included, where the scene's recursion_limit asks for "
        "more; what the others would bring is bounded by the weights of mirrors and glass",
    )
    adc_bailout: float = Field(
        default=0.0, ge=0, le=0.5, json_schema_extra={"faster": "larger", "steps": [0.1, 1 / 255, 1e-3, 1e-5, 0.0]},
        description="rays that count less are not followed (POV-Ray's own default is 1/255), nor are layers of a texture that "
        "are seen through others by less",
    )
    antialias: int = Field(
        default=0, ge=0, le=9, json_schema_extra={"faster": "smaller", "steps": [0, 2, 3, 5]},
        description="points added per row and column of a pixel where neighbours differ; 0: the centre alone. The mean over a "
        "pixel is not the radiance at its centre: by how much is found by a picture of the centres, and stated",
    )
    antialias_threshold: float = Field(
        default=0.3, ge=0, le=3, json_schema_extra={"faster": "larger", "steps": [1.0, 0.3, 0.0]},
        description="with antialias: the difference of neighbouring pixels, gamma-encoded, from which on points are added; "
        "0: everywhere",
    )
    threads: int = Field(
        default=1, ge=1, le=64, json_schema_extra={"faster": "larger"}, description="render threads of each POV-Ray process",
    )
