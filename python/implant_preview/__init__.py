"""How skin and adipose stretch over an implant or a tissue expander.

Scenes and results are dictionaries with the fields of docs/formats.md (units in the names: mm, kPa, N, ml, mmHg); lists of numbers
in results are NumPy arrays. Scenes may be JSON text too. Long calls hold no interpreter lock; Ctrl+C ends them.

An illustration from a simplified model, not a prediction for a person.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _native
from ._native import SceneError

__all__ = [
    "SceneError",
    "Shape",
    "bands",
    "default_scene",
    "map",
    "opening_scene",
    "quantities",
    "schema",
    "shape",
    "solve",
    "solve_many",
    "solve_matrix",
]

__version__: str = _native.version()

Scene = Mapping[str, Any] | str

# Scenes that are read ahead of the results, for each thread: none waits for the next scene.
_AHEAD = 8


def _text(value: Scene) -> str:
    return value if isinstance(value, str) else json.dumps(value, default=_plain)


def _plain(value: Any) -> Any:
    """Numbers and arrays of NumPy, as JSON has them."""
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} is no part of a scene; allowed: what JSON holds, NumPy numbers and arrays")


def _columns(points: list[dict[str, float | None]]) -> dict[str, npt.NDArray[np.float64]]:
    """A list of points as arrays by name; NaN where a point lacks a number."""
    names = dict.fromkeys(name for point in points for name in point)
    return {name: np.array([point.get(name, np.nan) for point in points], dtype=float) for name in names}


def _object(text: str) -> dict[str, Any]:
    value: dict[str, Any] = json.loads(text)
    return value


def _paths(fields: Sequence[str] | None) -> list[str] | None:
    return None if fields is None else list(fields)


def _result(text: str) -> dict[str, Any]:
    result = _object(text)
    for name in ("profile", "profile_skin", "profile_y", "profile_skin_y"):
        if isinstance(result.get(name), list):
            result[name] = _columns(result[name])
    return result


def default_scene() -> dict[str, Any]:
    """The scene of the defaults: a hemisphere of 55 mm under layered tissue over a flat chest."""
    return _object(_native.default_scene())


def opening_scene() -> dict[str, Any]:
    """The plan that the app opens with: an implant of 12 cm and 225 ml, pinch 2 cm, normal skin, the usual chest."""
    return _object(_native.opening_scene())


def schema() -> dict[str, Any]:
    """The JSON Schema of a scene."""
    return _object(_native.schema())


def quantities() -> list[str]:
    """Names of the quantities of :func:`solve_matrix`, :func:`map` and :func:`bands`."""
    return _native.quantities()


def solve(scene: Scene, *, fields: Sequence[str] | None = None) -> dict[str, Any]:
    """Solves a scene.

    ``fields``: paths of the result, as ``"strain.max_principal"``, that are computed and returned beside ``status``; default: all.

    Returns the result (docs/formats.md, ``result/3``): ``status``, ``contact_force_n`` [N], ``contact_pressure_mmhg``,
    ``strain`` [-], ``cover_mm`` and more. The profiles (``profile``, ``profile_skin``, over a chest ``profile_y``,
    ``profile_skin_y``) are dictionaries of arrays of shape (points,), lengths in mm, stresses in kPa.

    Raises :class:`SceneError` with one line for a scene out of its limits.
    """
    return _result(_native.solve(_text(scene), _paths(fields)))


def solve_many(
    scenes: Iterable[Scene],
    *,
    threads: int | None = None,
    in_order: bool = True,
    fields: Sequence[str] | None = None,
) -> Iterator[dict[str, Any]]:
    """Solves scenes for as long as they come, on threads (default: one for each core), in bounded memory.

    ``fields``: as of :func:`solve`; fewer are faster.

    Yields a result for each scene, in the order of the scenes or, with ``in_order=False``, as they are ready. A result has
    ``index``, the place of its scene from 0, and ``id`` if the scene has one; a scene out of its limits has ``{"index", "id",
    "error"}`` in its place, and the others go on.
    """
    pool = _native.Pool(threads, in_order, _paths(fields))
    ahead = _AHEAD * (threads or os.cpu_count() or 1)
    ids: dict[int, Any] = {}

    def named(answer: tuple[int, str | None, str | None]) -> dict[str, Any]:
        index, text, error = answer
        head = {"index": index} | ({"id": ids.pop(index)} if index in ids else {})
        return head | ({"error": error} if text is None else _result(text))

    def taken() -> Iterator[dict[str, Any]]:
        while (answer := pool.take()) is not None:
            yield named(answer)

    answers = taken()
    for count, scene in enumerate(scenes):
        identity, text = _named(scene)
        if identity is not None:
            ids[count] = identity
        pool.submit(text)
        if count >= ahead:
            yield from islice(answers, 1)
    pool.finish()
    yield from answers


def _named(scene: Scene) -> tuple[Any, str]:
    """The ``id`` of a scene and its text."""
    if not isinstance(scene, str):
        return scene.get("id"), _text(scene)
    try:
        value = json.loads(scene) if '"id"' in scene else None
    except ValueError:
        value = None
    return (value.get("id") if isinstance(value, dict) else None), scene


def solve_matrix(
    template: Scene,
    names: Sequence[str],
    values: npt.ArrayLike,
    *,
    outputs: Sequence[str],
    threads: int | None = None,
) -> npt.NDArray[np.float64]:
    """Quantities of scenes in which numbers of a template vary, for SALib, OpenTURNS, emcee and the like.

    ``names``: the numbers, as ``base_width_mm``, ``volume_ml``, ``pinch_mm``, ``strain_scale``, ``layers[1].poisson_ratio``,
    ``chest.radius_across_mm``, or the path of any other number in the template, as ``solver.nodes_per_side`` (all:
    docs/command-line.md, ``--table``). ``values``: shape (scenes, names). ``outputs``: names of
    :func:`quantities`. Returns shape (scenes, outputs), NaN where a scene has no answer.

    Raises :class:`SceneError` for an unknown name and for the first row out of its limits.
    """
    matrix = np.ascontiguousarray(values, dtype=np.float64)
    if matrix.ndim != 2:
        raise SceneError(f"values has {matrix.ndim} dimensions; allowed: 2, (scenes, names)")
    return _native.matrix(_text(template), list(names), matrix, list(outputs), threads)


def map(  # noqa: A001 - the name of the command
    scene: Scene,
    *,
    x: Mapping[str, Any],
    y: Mapping[str, Any] | None = None,
    grid: Mapping[str, Any] | None = None,
    show: str = "greatest_strain",
    threads: int | None = None,
) -> dict[str, Any]:
    """Solves a map: one or two numbers of a scene varied over a grid.

    ``x``, ``y``: ``{"field", "from", "to", "count"}``; ``grid``: ``{"nodes_per_side", "tolerance"}``; ``show``: the quantity of the
    contour lines. Returns the map as its file has it (docs/formats.md, ``map/1``), and in ``values`` the quantities as arrays of
    shape (y, x), with one axis (x,), NaN where a scene has no shape.
    """
    options = {"x": x, "y": y, "show": show} | ({} if grid is None else {"grid": grid})
    found = _object(_native.map(_text(scene), _text(options), threads))
    rows = [axis["count"] for axis in reversed(found["axes"])]
    points = _columns([point["values"] for point in found["points"]])
    return found | {"values": {name: values.reshape(rows) for name, values in points.items()}}


def bands(scene: Scene, *, threads: int | None = None, **choices: Any) -> dict[str, Any]:
    """Bands of a result by what is unknown about a person.

    ``choices``: ``samples`` (16 to 16384), ``seed``, ``importance_rows``, ``grid``, ``unknowns`` (docs/formats.md). Returns the report
    of the command ``bands``: ``bands`` with percentiles and ``importance``, the assumptions, and ``profile`` with the arrays ``s_mm`` of
    shape (points,) and ``r_mm``, ``z_mm`` of shape (points, 3): 10th, 50th and 90th percentile.
    """
    report = _object(_native.bands(_text(scene), _text(choices), threads))
    return report | {"profile": _columns(report["profile"])}


class Shape(NamedTuple):
    """The deformed shape of a scene.

    Faces and triangles suit ``pyvista.PolyData.from_regular_faces(shape.points[-1], shape.triangles)``.
    """

    result: dict[str, Any]
    """The result, as of :func:`solve`."""
    points: npt.NDArray[np.float32]
    """Vertices of the inner face, of the faces between the layers and of the skin [mm], shape (layers + 1, vertices, 3); of a right
    breast mirrored in x."""
    triangles: npt.NDArray[np.uint32]
    """Vertices of each triangle of a face, counter-clockwise seen from the skin, shape (triangles, 3)."""
    fields: dict[str, npt.NDArray[np.float32]]
    """Values at the vertices, shape (vertices,): ``strain``, ``area_stretch`` and ``cover_mm`` of the skin,
    ``contact_pressure_kpa``, ``traction_kpa``, ``wrinkle_state`` (0 taut, 1 wrinkled, 2 slack), ``wrinkle_strain``. Of the layers,
    counted from the skin, shape (layers, vertices): ``layer_strain``, ``thickness_stretch``, ``stress_kpa``."""


def shape(scene: Scene) -> Shape:
    """Solves a scene; returns its deformed shape with the fields at the vertices.

    Raises :class:`SceneError` as :func:`solve` does.
    """
    found = _native.shape(_text(scene))
    return Shape(_result(found["result"]), found["points"], found["triangles"], found["fields"])
