"""What the types of `model` say about each field: whether it takes one value, one of several parts, or many of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from types import UnionType
from typing import Annotated, Any, Literal, TypeVar, Union, get_args, get_origin

from pydantic import ConfigDict, TypeAdapter
from pydantic.fields import FieldInfo

from equilux_scenes.model import Part
from equilux_scenes.values import Allowed

_STRICT = ConfigDict(strict=True, allow_inf_nan=False)


@dataclass(frozen=True)
class Leaf:
    """A value that pydantic validates as a whole."""

    adapter: TypeAdapter[Any]
    allowed: Allowed
    words: tuple[str, ...] = ()  # of a value that is one of several words


@dataclass(frozen=True)
class PartOf:
    """One of several parts, told apart by the key `discriminator`; or just one part."""

    classes: tuple[type[Part], ...]
    discriminator: str | None = None

    def tags(self) -> dict[str, type[Part]]:
        """Value of the discriminator → part."""
        assert self.discriminator is not None
        return {get_args(cls.model_fields[self.discriminator].annotation)[0]: cls for cls in self.classes}


@dataclass(frozen=True)
class Many:
    """A list of parts, or a mapping from names to parts."""

    container: Literal["list", "mapping"]
    of: PartOf


Kind = Leaf | PartOf | Many


@cache
def fields_of(cls: type[Part]) -> tuple[tuple[str, Kind, FieldInfo], ...]:
    """Name, kind of value and declaration of each field."""
    return tuple(
        (name, _kind(field.annotation, tuple(field.metadata), field.discriminator), field)
        for name, field in cls.model_fields.items()
    )


PartType = TypeVar("PartType", bound=Part)


@cache
def kinds_of(base: type[PartType]) -> Mapping[str, type[PartType]]:
    """The value of `kind` → the kind of part, of all that derive from `base`."""
    found: dict[str, type[PartType]] = {}
    for cls in base.__subclasses__():
        if "kind" in cls.model_fields:
            found[get_args(cls.model_fields["kind"].annotation)[0]] = cls
        found.update(kinds_of(cls))
    return found


def _kind(annotation: Any, metadata: tuple[Any, ...], discriminator: Any) -> Kind:
    origin, arguments = get_origin(annotation), get_args(annotation)
    if part := _part_of(annotation, discriminator):
        return part
    if origin is dict and (part := _part_of(arguments[1])):
        return Many("mapping", part)
    if origin is tuple and arguments[-1] is Ellipsis and (part := _part_of(arguments[0])):
        return Many("list", part)
    if origin in (Union, UnionType):
        (present,) = (item for item in arguments if not _is_none(item))
        return _kind(present, metadata, None)
    adapter: TypeAdapter[Any] = TypeAdapter(Annotated[annotation, *metadata] if metadata else annotation, config=_STRICT)
    return Leaf(adapter, _allowed(annotation, metadata), _words(annotation))


def _part_of(annotation: Any, discriminator: Any = None) -> PartOf | None:
    """The part, or the union of parts told apart by their discriminator; None for anything else."""
    if get_origin(annotation) is Annotated:
        field = next((item for item in annotation.__metadata__ if isinstance(item, FieldInfo)), None)
        return _part_of(annotation.__origin__, field.discriminator if field is not None else discriminator)
    alternatives = get_args(annotation) if get_origin(annotation) in (Union, UnionType) else (annotation,)
    parts = tuple(item for item in alternatives if isinstance(item, type) and issubclass(item, Part))
    return PartOf(parts, discriminator) if parts else None


def _is_none(annotation: Any) -> bool:
    """What stands for a key that is left out. Null itself is never accepted."""
    return annotation is type(None) or (get_origin(annotation) is Annotated and annotation.__origin__ is type(None))


def _allowed(annotation: Any, metadata: tuple[Any, ...]) -> Allowed:
    """The `Allowed` of a field, or of what its annotation is made of."""
    found = next((item for item in metadata if isinstance(item, Allowed)), None)
    if found is not None:
        return found
    for part in (annotation, *get_args(annotation)):
        if get_origin(part) is Annotated:
            return _allowed(part.__origin__, part.__metadata__)
    if words := _words(annotation):
        return Allowed(" or ".join(words))
    raise TypeError(f"{annotation} says nowhere in words what it allows")


def _words(annotation: Any) -> tuple[str, ...]:
    return tuple(item for item in get_args(annotation) if isinstance(item, str)) if get_origin(annotation) is Literal else ()
