"""A body by formula: read, marked, fitted, over an implant."""

import implant_preview as ip
import numpy as np
import pytest


def trunk(projection: float = 60.0, around: int = 160, along: int = 120):
    """A closed trunk with two breasts [mm]: x to the left, y to the head, z forwards."""
    angle = 2 * np.pi * (np.arange(around) + 0.5) / around - np.pi
    y = np.linspace(-300, 230, along + 1)
    narrow = 1 - (y / 450) ** 2
    points = np.stack(
        [
            148 * np.sin(angle)[None] * narrow[:, None],
            np.repeat(y[:, None], around, axis=1),
            110 * np.cos(angle)[None] * narrow[:, None],
        ],
        axis=-1,
    ).reshape(-1, 3)
    center = np.array([148 * np.sin(0.62), 0, 110 * np.cos(0.62)])
    left = np.array([148 * np.cos(0.62), 0, -110 * np.sin(0.62)])
    left /= np.linalg.norm(left)
    normal = np.cross(left, [0, 1, 0])
    for sign in (1, -1):
        mirror = np.array([sign, 1, 1])
        local = points * mirror - center
        height = projection * np.clip(1 - (local @ left / 62) ** 2 - (local[:, 1] / 68) ** 2, 0, None) ** 2
        points += np.where((local @ normal > -60) & (points[:, 0] * sign > 0), height, 0)[:, None] * normal * mirror
    k = np.arange(around)
    row = np.arange(along)[:, None] * around
    a, b = row + k, row + (k + 1) % around
    c, d = b + around, a + around
    triangles = np.concatenate([np.stack(t, axis=-1).reshape(-1, 3) for t in ((a, b, c), (a, c, d))])
    return points, triangles


def marks():
    """The marks of the trunk, without those of the right breast."""
    center = np.array([148 * np.sin(0.62), 0, 110 * np.cos(0.62)])
    left = np.array([148 * np.cos(0.62), 0, -110 * np.sin(0.62)])
    left /= np.linalg.norm(left)
    normal = np.cross(left, [0, 1, 0])
    nipple = center + 60 * normal
    at = lambda x, y: (center + x * left + [0, y, 0]).tolist()  # noqa: E731
    return {
        "sternal_notch": [0, 150, 98],
        "navel": [0, -230, 81],
        "nipple_left": nipple.tolist(),
        "nipple_right": (nipple * [-1, 1, 1]).tolist(),
        "fold_left": at(0, -68),
        "upper_left": at(0, 68),
        "medial_left": at(-62, 0),
        "lateral_left": at(62, 0),
    }


def ply(points, triangles) -> bytes:
    head = f"ply\nformat ascii 1.0\nelement vertex {len(points)}\nproperty double x\nproperty double y\nproperty double z\n"
    head += f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    rows = [" ".join(map(repr, p)) for p in points.tolist()] + [f"3 {a} {b} {c}" for a, b, c in triangles.tolist()]
    return (head + "\n".join(rows) + "\n").encode()


def test_a_body_is_fitted_and_lies_over_its_implant(tmp_path):
    points, triangles = trunk()
    (tmp_path / "trunk.ply").write_bytes(ply(points, triangles))
    body = ip.read_body(tmp_path / "trunk.ply")
    assert (body.unit, body.positions.shape, body.triangles.shape) == ("mm", points.shape, triangles.shape)
    assert np.array_equal(body.positions, points)
    fitted = ip.fit_body(body.positions, body.triangles, marks(), "left", cover_mm=10)
    assert 200 < fitted.quality["footprint_ml"] < 330 and fitted.scene["side"] == "left"
    scene = fitted.scene | {"solver": {"nodes_per_side": 33, "tolerance": 1e-3}}
    after = ip.deform(scene, points, triangles)
    moved = np.linalg.norm(after.positions - points, axis=1)
    assert after.result["status"] == "converged"
    assert 15 < moved.max() < 45 and (moved == 0).sum() > len(points) / 2
    # At rest every vertex keeps its bits.
    assert np.array_equal(ip.deform(scene | {"insertion": 0}, points, triangles).positions, points)


def test_marks_are_proposed():
    points, triangles = trunk()
    found, exact = ip.propose_marks(points, triangles), marks()
    assert np.linalg.norm(np.subtract(found["nipple_left"], exact["nipple_left"])) < 15
    assert ip.fit_body(points, triangles, found, "right").scene["side"] == "right"


@pytest.mark.parametrize(
    ("edit", "words"),
    [
        (lambda p, t: (p[:, :2], t), "positions has the shape"),
        (lambda p, t: (np.where(p > 220, np.nan, p), t), "positions\\[.*NaN.*allowed: numbers up to 1e7 mm"),
        (lambda p, t: (p, t + 1), "triangles\\[.*allowed: vertices 0 to"),
        (lambda p, t: (p, t[:0]), "triangles is empty"),
        (lambda p, t: (p, t * 1.0), "allowed: whole numbers"),
        (lambda p, t: (p + 900, t), "no skin within 100 mm"),
    ],
)
def test_a_bad_surface_is_one_line(edit, words):
    with pytest.raises(ip.SceneError, match=words):
        ip.fit_body(*edit(*trunk()), marks(), "left")


def test_bad_input_is_one_line():
    points, triangles = trunk(around=40, along=30)
    for arguments, words in [
        ((marks(), "middle"), 'side is "middle"'),
        ((marks(), "right"), "no marks of the right breast"),
        ((marks(), "left", 3), "cover_mm is 3; allowed: 6 to 30 mm"),
        ((marks() | {"nabel": [0, 0, 0]}, "left"), "unknown field `nabel`"),
    ]:
        with pytest.raises(ip.SceneError, match=words):
            ip.fit_body(points, triangles, *arguments)
    with pytest.raises(ip.SceneError, match="the scene has no member body"):
        ip.deform(ip.opening_scene(), points, triangles)
    with pytest.raises(ip.SceneError, match="the format of the file is unknown"):
        ip.read_body(b"no surface")
