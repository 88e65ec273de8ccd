// A body by formula.

/** Centre of the left breast of a trunk on the chest [mm], unit vector to the patient's left along the skin, and normal. */
function breastAxes() {
  const [sin, cos] = [Math.sin(0.62), Math.cos(0.62)];
  const length = Math.hypot(148 * cos, 110 * sin);
  const left = [(148 * cos) / length, 0, (-110 * sin) / length];
  return { center: [148 * sin, 0, 110 * cos], left, normal: [-left[2], 0, left[0]] };
}

const along = (from, ...steps) => from.map((x, axis) => steps.reduce((sum, [by, way]) => sum + by * way[axis], x));
const dot = (a, b) => a.reduce((sum, x, axis) => sum + x * b[axis], 0);

/** A trunk with two breasts of 60 mm as an ASCII PLY [mm], x to the left, y to the head, and the marks of its left breast. */
export function trunk(around = 160, rows = 120) {
  const { center, left, normal } = breastAxes();
  const [points, faces] = [[], []];
  for (let row = 0; row <= rows; row += 1) {
    const y = -300 + (530 * row) / rows;
    const narrow = 1 - (y / 450) ** 2;
    for (let k = 0; k < around; k += 1) {
      const angle = (2 * Math.PI * (k + 0.5)) / around - Math.PI;
      const point = [148 * Math.sin(angle) * narrow, y, 110 * Math.cos(angle) * narrow];
      const mirror = [Math.sign(point[0]), 1, 1];
      const from = point.map((x, axis) => x * mirror[axis] - center[axis]);
      const part = Math.max(0, 1 - (dot(from, left) / 62) ** 2 - (y / 68) ** 2) ** 2;
      const height = dot(from, normal) > -60 ? 60 * part : 0;
      points.push(point.map((x, axis) => Math.fround(x + height * normal[axis] * mirror[axis])));
      if (row === rows) continue;
      const [a, b] = [row * around + k, row * around + ((k + 1) % around)];
      faces.push([a, b, b + around], [a, b + around, a + around]);
    }
  }
  const head = `ply\nformat ascii 1.0\nelement vertex ${points.length}\nproperty float x\nproperty float y\nproperty float z
element face ${faces.length}\nproperty list uchar int vertex_indices\nend_header\n`;
  const lines = [...points.map((point) => point.join(" ")), ...faces.map((face) => `3 ${face.join(" ")}`)];
  const nipple = along(center, [60, normal]);
  const marks = {
    sternal_notch: [0, 150, 98],
    navel: [0, -230, 81],
    nipple_left: nipple,
    nipple_right: [-nipple[0], nipple[1], nipple[2]],
    fold_left: along(center, [-68, [0, 1, 0]]),
    upper_left: along(center, [68, [0, 1, 0]]),
    medial_left: along(center, [-62, left]),
    lateral_left: along(center, [62, left]),
  };
  return { ply: `${head}${lines.join("\n")}\n`, points, faces, marks };
}
