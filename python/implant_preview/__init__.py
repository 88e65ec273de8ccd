"""How skin and adipose stretch over an implant or a tissue expander.

Scenes and results are dictionaries with the fields of docs/formats.md (units in the names: mm, kPa, N, ml, mmHg); lists of numbers
in results are NumPy arrays. Scenes may be JSON text too, and have numbers of NumPy, ``Decimal`` and ``Fraction``; a gap (``None``, a masked
entry, NaN) raises :class:`SceneError` with its field. Long calls hold no interpreter lock; Ctrl+C ends them at once.

An illustration from a simplified model, not a prediction for a person.
"""

from __future__ import annotations

import itertools
import json
import operator
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from decimal import Decimal
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from . import _native
from ._native import SceneError

__all__ = [
    "Body",
    "Deformed",
    "Fitted",
    "SceneError",
    "Shape",
    "bands",
    "curve",
    "default_scene",
    "deform",
    "fit_body",
    "map",
    "opening_scene",
    "propose_marks",
    "quantities",
    "read_body",
    "schema",
    "shape",
    "solve",
    "solve_many",
    "solve_matrix",
    "times",
]

__version__: str = _native.version()

Scene = Mapping[str, Any] | str

_MOST_THREADS = 1024

# Scenes that are read ahead of the results, for each thread: none waits for the next scene.
_AHEAD = 8


def _text(value: Scene) -> str:
    if isinstance(value, str):
        return value
    if not isinstance(value, Mapping):
        raise TypeError(f"{type(value).__name__} is no scene; allowed: a dictionary or JSON text")
    try:
        return json.dumps(value, default=_plain)
    except TypeError as error:
        raise TypeError(f"{_place(value)}{error}") from None


def _plain(value: Any) -> Any:
    """Numbers and arrays of NumPy, ``Decimal`` and ``Fraction``, as JSON has them. What a mask hides is null, which a scene refuses."""
    if isinstance(value, (np.longdouble, Decimal, Fraction)):
        return float(value)
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{type(value).__name__} is no part of a scene; allowed: what JSON holds, numbers, NumPy arrays")


def _place(value: Any, path: str = "") -> str:
    """The path of the first part that cannot become JSON, for a message."""
    parts: Iterable[tuple[str, Any]] = ()
    if isinstance(value, Mapping):
        parts = ((f"{path}.{name}", part) for name, part in value.items())
    elif isinstance(value, (list, tuple)):
        parts = ((f"{path}[{k}]", part) for k, part in enumerate(value))
    for name, part in parts:
        try:
            json.dumps(part, default=_plain)
        except TypeError:
            return _place(part, name)
    return path.removeprefix(".") + ": " if path else ""


def _threads(threads: int | None) -> int | None:
    """A number of threads; numbers beyond the greatest one are limited."""
    if threads is None:
        return None
    number = operator.index(threads)
    if number < 1:
        raise ValueError(f"threads is {number}; allowed: 1 to {_MOST_THREADS}, or None for one a core")
    return min(number, _MOST_THREADS)


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

    Returns the result (docs/formats.md, ``result/1``): ``status``, ``contact_force_n`` [N], ``contact_pressure_mmhg``,
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
    "error"}`` in its place, and so has an entry that is no scene; the others go on. An exception of the producer comes after the results
    of the scenes before it. A forked child cannot read on: it calls ``solve_many`` again.

    ``threads``: 1 to 1024.
    """
    if isinstance(scenes, (str, bytes, bytearray, Mapping)):
        raise TypeError("scenes is one scene; allowed: a list or another iterable of scenes (one scene: solve)")
    return _results(iter(scenes), _threads(threads), in_order, _paths(fields))


def _results(
    scenes: Iterator[Scene], threads: int | None, in_order: bool, fields: list[str] | None
) -> Iterator[dict[str, Any]]:
    pool = _native.Pool(threads, in_order, fields)
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
    failure: Exception | None = None
    for count in itertools.count():
        try:
            scene = next(scenes)
        except StopIteration:
            break
        except Exception as error:  # noqa: BLE001 - of any producer: the results so far come first
            failure = error
            break
        _submit(pool, scene, count, ids)
        if count >= ahead:
            yield from itertools.islice(answers, 1)
    pool.finish()
    yield from answers
    if failure is not None:
        raise failure


def _submit(pool: _native.Pool, scene: Scene, index: int, ids: dict[int, Any]) -> None:
    """Queues a scene and notes its ``id``; an entry that is no scene has an error in its place."""
    try:
        identity = _id(scene)
        if identity is not None:
            ids[index] = identity
        pool.submit(_text(scene))
    except (TypeError, ValueError, ArithmeticError, AttributeError, RecursionError) as error:
        line = " ".join(str(error).split())
        pool.refuse(line.encode("utf-8", "replace").decode())


def _id(scene: Scene) -> Any:
    """The ``id`` of a scene."""
    if isinstance(scene, Mapping):
        return scene.get("id")
    try:
        value = json.loads(scene) if isinstance(scene, str) and '"id"' in scene else None
    except ValueError:
        value = None
    return value.get("id") if isinstance(value, dict) else None


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

    Raises :class:`SceneError` for an unknown name and for the first row that is out of its limits or has a gap, as a masked entry.
    """
    # A list may have masked rows.
    is_masked = isinstance(values, (np.ma.MaskedArray, list, tuple))
    matrix = np.ma.array(values, dtype=np.float64) if is_masked else np.asarray(values, dtype=np.float64)
    if matrix.ndim != 2:
        raise SceneError(f"values has {matrix.ndim} dimensions; allowed: 2, (scenes, names)")
    names = list(names)
    for row, column in np.argwhere(np.ma.getmaskarray(matrix))[:1]:
        name = names[column] if column < len(names) else f"column {column}"
        raise SceneError(f"row {row} of values: {name} is masked; allowed: a number")
    matrix = np.ascontiguousarray(np.ma.getdata(matrix))
    return _native.matrix(_text(template), names, matrix, list(outputs), _threads(threads))


def map(  # noqa: A001 - the name of the command
    scene: Scene,
    *,
    x: Mapping[str, Any],
    y: Mapping[str, Any] | None = None,
    grid: Mapping[str, Any] | None = None,
    show: str = "greatest_strain",
    all: bool = False,  # noqa: A002 - the name of the option
    threads: int | None = None,
) -> dict[str, Any]:
    """Solves a map: one or two numbers of a scene varied over a grid.

    ``x``, ``y``: ``{"field", "from", "to", "count"}``; ``grid``: ``{"nodes_per_side", "tolerance"}``; ``show``: the quantity of the
    contour lines; ``all``: solves every point, else up to 70, and interpolates the others. Returns the map as its file has it
    (docs/formats.md, ``map/1``), and in ``values`` the quantities as arrays of shape (y, x), with one axis (x,), NaN where a scene has no
    shape.
    """
    given = {"x": x, "y": y, "grid": grid, "show": show, "all": all}
    options = {name: value for name, value in given.items() if value is not None}
    found = _object(_native.map(_text(scene), _text(options), _threads(threads)))
    rows = [axis["count"] for axis in reversed(found["axes"])]
    points = _columns([point["values"] for point in found["points"]])
    return found | {"values": {name: values.reshape(rows) for name, values in points.items()}}


def bands(scene: Scene, *, threads: int | None = None, **choices: Any) -> dict[str, Any]:
    """Bands of a result by what is unknown about a person.

    ``choices``: ``samples`` (16 to 16384), ``seed``, ``importance_rows``, ``grid``, ``unknowns`` (docs/formats.md). Returns the report
    of the command ``bands``: ``bands`` with percentiles and ``importance``, the assumptions, and ``profile`` with the arrays ``s_mm`` of
    shape (points,) and ``r_mm``, ``z_mm`` of shape (points, 3): 10th, 50th and 90th percentile.
    """
    report = _object(_native.bands(_text(scene), _text(choices), _threads(threads)))
    return report | {"profile": _columns(report["profile"])}


def times(scene: Scene, *, threads: int | None = None) -> dict[str, Any]:
    """A scene of layered tissue on the table, a week and six months after its operation.

    Returns the file of the command ``times`` (docs/formats.md, ``times/1``): ``times``, a list of three, each with ``when``, ``relaxed``,
    ``grown``, ``fold_drop_mm`` and ``left_out``, and in ``values`` by the names of :func:`quantities` the ``value`` and its ``range``.

    Raises :class:`SceneError` with one line for a sheet and for a scene out of its limits.
    """
    return _object(_native.times(_text(scene), _threads(threads)))


def curve(
    path_or_table: str | os.PathLike[str] | bytes | npt.ArrayLike, unit: str | None = None, strain: str | None = None
) -> dict[str, Any]:
    """The curve of a raw tensile test.

    ``path_or_table``: the path of a table of any locale, its bytes, or an array of shape (samples, 2), strains and stresses.
    ``unit``: of the stresses, ``"kpa"``, ``"mpa"`` or ``"pa"``; ``strain``: ``"fraction"`` or ``"percent"``; default: by the header, else by
    the size of the numbers (docs/command-line.md, ``curve``).

    Returns ``curve`` (for ``layers[k].curve`` of a scene), ``notes`` (what was recognised, left out and converted), ``rms_kpa`` (distance of
    the samples from the curve) and ``samples`` of shape (samples, 2): strain [-], stress [kPa].

    Raises :class:`SceneError` with one line for a table that is no test.
    """
    if isinstance(path_or_table, bytes):
        content = path_or_table
    elif isinstance(path_or_table, (str, os.PathLike)):
        with open(path_or_table, "rb") as file:
            content = file.read()
    else:
        table: npt.NDArray[np.float64] = np.ma.filled(np.ma.asarray(path_or_table, dtype=float), np.nan)
        if table.ndim != 2 or table.shape[1] != 2:
            raise SceneError(f"the table has the shape {table.shape}; allowed: (samples, 2)")
        gaps = np.flatnonzero(~np.isfinite(table).all(axis=1))
        if gaps.size:
            raise SceneError(f"row {gaps[0]} of the table is {table[gaps[0]].tolist()}; allowed: two finite numbers")
        content = json.dumps(table.tolist()).encode()
    found = _native.curve(content, unit, strain)
    return found | {"curve": _object(found["curve"])}


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


class Body(NamedTuple):
    """The surface of a body."""

    positions: npt.NDArray[np.float64]
    """Positions of the vertices [mm], shape (vertices, 3), in the axes of the file."""
    triangles: npt.NDArray[np.uint32]
    """Vertices of each triangle, counter-clockwise seen from outside, shape (triangles, 3)."""
    unit: str
    """Unit of the file's lengths, by the extent of the surface: ``"mm"``, ``"cm"`` or ``"m"``."""
    notes: list[str]
    """What was dropped, split or turned."""


class Fitted(NamedTuple):
    """A fitted side of a body."""

    scene: dict[str, Any]
    """The scene, with the implant and the skin of the opening plan, as of the command ``scan``; its ``body`` has the place."""
    quality: dict[str, Any]
    """Figures of the fit (docs/command-line.md, ``scan``) and ``warnings``."""


class Deformed(NamedTuple):
    """A body over an implant."""

    result: dict[str, Any]
    """The result of the scene, as of :func:`solve`."""
    positions: npt.NDArray[np.float64]
    """Positions of the same vertices [mm], shape (vertices, 3); those outside of the patch keep their bits."""


def read_body(path_or_bytes: str | os.PathLike[str] | bytes) -> Body:
    """Reads the surface of a body: PLY, STL, OBJ or GLB, cleaned.

    Raises :class:`SceneError` with one line for a file that is no surface.
    """
    if isinstance(path_or_bytes, bytes):
        content, name = path_or_bytes, ""
    else:
        name = os.fspath(path_or_bytes)
        with open(path_or_bytes, "rb") as file:
            content = file.read()
    found = _native.read_body(content, name)
    return Body(found["positions"], found["triangles"], found["unit"], found["notes"])


def propose_marks(positions: npt.ArrayLike, triangles: npt.ArrayLike) -> dict[str, list[float]]:
    """Proposes marks of a body by its shape, for a surgeon to correct: points [mm] by their names, of both sides.

    On torsos of known marks nipples are within 15 mm, the others mostly within 25 mm.

    Raises :class:`SceneError` with one line for a surface without two breasts.
    """
    return _object(_native.propose_marks(*_surface(positions, triangles)))


def fit_body(
    positions: npt.ArrayLike,
    triangles: npt.ArrayLike,
    marks: Mapping[str, Sequence[float]],
    side: str,
    cover_mm: float = 10.0,
) -> Fitted:
    """Fits a side of a body, as the command ``scan`` does.

    ``positions`` [mm] of shape (vertices, 3), ``triangles`` of shape (triangles, 3); ``marks``: points [mm] by their names, those of ``scan``;
    ``side``: ``"left"`` or ``"right"``, the patient's; ``cover_mm``: thickness of the tissue beside the breast, 6 to 30 mm.

    Raises :class:`SceneError` with one line for marks or a surface that do not fit.
    """
    found = _native.fit_body(*_surface(positions, triangles), _text(marks), side, float(cover_mm))
    return Fitted(_object(found["scene"]), found["quality"])


def deform(scene: Scene, positions: npt.ArrayLike, triangles: npt.ArrayLike) -> Deformed:
    """Solves a scene of :func:`fit_body`; returns the positions of the body's vertices over the implant.

    Raises :class:`SceneError` as :func:`solve` does, and for a scene without ``body``; ``RuntimeError`` for a scene without a shape.
    """
    found = _native.deform(_text(scene), *_surface(positions, triangles))
    return Deformed(_result(found["result"]), found["positions"])


def _surface(
    positions: npt.ArrayLike, triangles: npt.ArrayLike
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.int64]]:
    """The arrays of a surface."""
    points: npt.NDArray[np.float64] = np.ma.filled(np.ma.asarray(positions, dtype=float), np.nan)
    corners = np.asarray(triangles)
    for name, array in (("positions", points), ("triangles", corners)):
        if array.ndim != 2 or array.shape[1] != 3:
            raise SceneError(f"{name} has the shape {array.shape}; allowed: (number, 3)")
    if not np.issubdtype(corners.dtype, np.integer):
        raise SceneError(f"triangles has numbers of type {corners.dtype}; allowed: whole numbers")
    return np.ascontiguousarray(points), np.ascontiguousarray(corners, dtype=np.int64)
