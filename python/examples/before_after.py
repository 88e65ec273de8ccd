"""Draws a body before and after an implant beside each other.

python before_after.py BODY.ply MARKS.json left PICTURE.png

MARKS.json as of the command `scan`; with - the marks are proposed by the shape. Needs PyVista (pip install pyvista).
"""

import json
import sys
from pathlib import Path

import implant_preview as ip

if len(sys.argv) != 5:
    sys.exit(__doc__)
mesh, marks, side, picture = sys.argv[1:]

import pyvista as pv  # noqa: E402

body = ip.read_body(mesh)
scale = {"mm": 1, "cm": 10, "m": 1000}[body.unit]
if marks == "-":
    points = ip.propose_marks(body.positions, body.triangles)
else:
    points = {name: [scale * x for x in at] for name, at in json.loads(Path(marks).read_text()).items()}
fitted = ip.fit_body(body.positions, body.triangles, points, side)
for warning in fitted.quality["warnings"]:
    print(warning)
after = ip.deform(fitted.scene, body.positions, body.triangles)
print(f"skin stretch up to {100 * after.result['strain']['max_principal']:.0f} %")

plotter = pv.Plotter(shape=(1, 2), off_screen=True, window_size=(1600, 1000))
for column, (name, positions) in enumerate([("before", body.positions), ("after", after.positions)]):
    plotter.subplot(0, column)
    surface = pv.PolyData.from_regular_faces(positions, body.triangles)
    plotter.add_mesh(surface, color="#d9a58b", smooth_shading=True, specular=0.15)
    plotter.add_text(name, font_size=14)
    # From the front, turned by 30 degrees; the head of a file with y up is above.
    plotter.camera_position = "xy"
    plotter.camera.azimuth = 30 if side == "left" else -30
plotter.link_views()
plotter.screenshot(picture)
