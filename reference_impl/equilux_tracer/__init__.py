"""The Embree tracer: the reference that every other renderer is judged against.

Embree finds candidates; double and double-double precision decide which surface is nearest, where, and how it shines.
"""

from equilux_tracer._tracer import Cancel, Cancelled, TracerError
from equilux_tracer._tracer import embree_version as EMBREE_VERSION
from equilux_tracer.channels import CHANNELS, Channel
from equilux_tracer.tracer import PACKET_CHANNELS, VERSION, Precision, Tracer, Traversal

__all__ = [
    "CHANNELS", "EMBREE_VERSION", "PACKET_CHANNELS", "VERSION",
    "Cancel", "Cancelled", "Channel", "Precision", "Tracer", "TracerError", "Traversal",
]  # fmt: skip
