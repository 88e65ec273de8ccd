"""Sobol indices of the skin's greatest stretch by SALib, beside those of the command `bands`."""

import sys

import implant_preview as ip
from SALib.analyze import sobol as analysis
from SALib.sample import sobol as sampling

ROWS = 64 if "--quick" in sys.argv else 512
GRID = {"nodes_per_side": 33, "tolerance": 1e-3}

scene = ip.opening_scene()
scene["solver"] = GRID
# The projection of an implant that yields is a result, no unknown.
scene["implant"].pop("fill")
radius = scene["chest"]["radius_across_mm"]
projection = scene["implant"]["projection_mm"]
# The unknown, its number of the scene, and the range of both.
varied = {
    "skin_strain_scale": ("strain_scale", (0.7, 1.3), (0.5 * 0.7, 0.5 * 1.3)),
    "chest_radius": ("chest.radius_across_mm", (-25, 25), (radius - 25, radius + 25)),
    "projection": ("implant.projection_mm", (-0.1, 0.1), (0.9 * projection, 1.1 * projection)),
}
unknowns = {unknown: None for unknown in ("skin_thickness", "skin_stress_scale", "cover_thickness", "pocket_radius",
                                          "fat_stress_scale", "fat_poisson_ratio")}
for unknown, (_, (least, most), _) in varied.items():
    unknowns[unknown] = {"uniform": {"least": least, "most": most}}

report = ip.bands(scene, samples=max(ROWS, 16), importance_rows=ROWS, grid=GRID, unknowns=unknowns)
stretch = next(band for band in report["bands"] if band["quantity"] == "greatest_strain")

names = [number for number, _, _ in varied.values()]
problem = {"num_vars": len(names), "names": names, "bounds": [bounds for _, _, bounds in varied.values()]}
x = sampling.sample(problem, ROWS, calc_second_order=False, seed=1)
y = ip.solve_matrix(scene, names, x, outputs=["greatest_strain"])[:, 0]
found = analysis.analyze(problem, y, calc_second_order=False, conf_level=0.6827, seed=1)

print("unknown             first order: SALib       bands    total: SALib       bands")
is_far = False
for k, unknown in enumerate(varied):
    ours = stretch["importance"][unknown]
    pairs = []
    for theirs, own, error in (("S1", "first_order", 0), ("ST", "total", 1)):
        errors = (found[theirs + "_conf"][k], ours["standard_error"][error])
        is_far |= abs(found[theirs][k] - ours[own]) > 3 * (errors[0] ** 2 + errors[1] ** 2) ** 0.5 + 0.01
        pairs.append(f"{found[theirs][k]:6.3f} ± {errors[0]:.3f}  {ours[own]:6.3f} ± {errors[1]:.3f}")
    print(f"{unknown:20s}{'  '.join(pairs)}")
sys.exit("the indices differ by more than three standard errors" if is_far else 0)
