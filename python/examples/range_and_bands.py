"""Draws the range of implants of the opening plan, and the bands of its profile, as range_and_bands.png."""

import sys

import implant_preview as ip
import matplotlib.pyplot as plt

plt.switch_backend("agg")
COUNT, SAMPLES = (9, 64) if "--quick" not in sys.argv else (3, 16)

scene = ip.opening_scene()
width = {"field": "base_width_mm", "from": 110, "to": 140, "count": COUNT}
volume = {"field": "volume_ml", "from": 150, "to": 300, "count": COUNT}
found = ip.map(scene, x=width, y=volume)
report = ip.bands(scene, samples=SAMPLES, importance_rows=0)

figure, (left, right) = plt.subplots(1, 2, figsize=(11, 4.5), layout="constrained")
at = [[point["at"][axis] for point in found["points"]] for axis in (0, 1)]
strain = found["values"]["greatest_strain"]
x, y = (sorted(set(values)) for values in at)
lines = left.contour(x, y, 100 * strain, colors="black", linewidths=0.8)
left.contourf(x, y, 100 * strain, levels=lines.levels, cmap="YlOrRd")
left.clabel(lines, fmt="%.0f %%")
left.set(xlabel="width (mm)", ylabel="volume (ml)", title="Greatest stretch of the skin")

profile = report["profile"]
low, middle, high = (profile["z_mm"][:, k] for k in range(3))
r = profile["r_mm"][:, 1]
right.fill_between(r, low, high, alpha=0.3, label="10th to 90th percentile")
right.plot(r, middle, label="median")
right.set(xlabel="distance from the axis (mm)", ylabel="height of the skin (mm)", title="Profile of the skin", aspect="equal")
right.legend()
figure.savefig("range_and_bands.png", dpi=110)
print("range_and_bands.png")
