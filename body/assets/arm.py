"""Makes arm.bin: the right shoulder and the stump of the arm that are drawn beside the built-in torso.

python3 body/assets/arm.py TORSO.ply body/assets/torso.bin body/assets/arm.bin

TORSO.ply: the trunk with its arms in the torso's coordinates (binary little-endian, x y z as float, faces of three corners), from the MakeHuman base
mesh. The arm begins with the trunk's own border at x = -172 mm. Sections of the arm by planes that lean from this border outwards follow, then half a
dome over the last one. No other packages.
"""

import math
import struct
import sys

UNIT_MM = 0.05
BORDER_MM, BACK_MM, ARMPIT_MM = -172.0, 22.0, 398.0
# The last section: its distance from the midline at the armpit, and how much farther out it is for each mm up.
LAST_MM, LEAN = 175.0, 0.37
# Parts of the way from the border to the last section, and edges of each section.
SECTIONS = ((0.45, 20), (1.0, 18))
# The dome: height, then the angle from the rim to the middle and the edges of each ring.
DOME_MM, RINGS = 18.0, ((26, 16), (52, 10))


def sub(a, b):
    return tuple(p - q for p, q in zip(a, b))


def add(a, b, by=1.0):
    return tuple(p + by * q for p, q in zip(a, b))


def distance(a, b):
    return math.sqrt(sum(p * p for p in sub(a, b)))


def read_ply(path):
    data = open(path, "rb").read()
    at = data.index(b"end_header\n") + 11
    words = data[:at].decode().split()
    vertices, faces = (int(words[words.index(name) + 1]) for name in ("vertex", "face"))
    points = [struct.unpack_from("<3f", data, at + 12 * k) for k in range(vertices)]
    at += 12 * vertices
    return points, [struct.unpack_from("<3i", data, at + 13 * k + 1) for k in range(faces)]


def read_half(path):
    """The format of body/src/half.rs."""
    data = open(path, "rb").read()
    vertices, count = struct.unpack_from("<2H", data)
    at = 4

    def number():
        nonlocal at
        value = shift = 0
        while True:
            byte = data[at]
            at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    following, triangles = 0, []
    for _ in range(3 * count):
        back = number()
        triangles.append(following - back)
        following += back == 0
    triangles = [tuple(triangles[k : k + 3]) for k in range(0, 3 * count, 3)]
    signed = lambda value: (value >> 1) ^ -(value & 1)
    apart = [[signed(number()) for _ in range(vertices)] for _ in range(3)]
    places = []
    for triangle in triangles:
        for k, corner in enumerate(triangle):
            if corner == len(places):
                base = predicted(places, triangle, k)
                places.append([base[axis] + apart[axis][corner] for axis in range(3)])
    return [tuple(UNIT_MM * value for value in place) for place in places], triangles


def predicted(places, triangle, k):
    """What the differences of a vertex count from: the corner before, of a third corner the middle of both."""
    known = [places[c] if c < len(places) else None for c in triangle[:2]]
    if k == 2 and known[0] and known[1]:
        return [(a + b) // 2 for a, b in zip(*known)]
    if k == 1 and known[0]:
        return known[0]
    return places[-1] if places else [0, 0, 0]


def half(points, triangles):
    """The bytes of body/src/half.rs."""
    out, new, order = bytearray(), {}, []

    def number(value):
        while value > 127:
            out.append(value & 127 | 128)
            value >>= 7
        out.append(value)

    for corner in (corner for triangle in triangles for corner in triangle):
        if corner in new:
            number(len(order) - new[corner])
        else:
            number(0)
            new[corner] = len(order)
            order.append(corner)
    places, apart = [], []
    for triangle in ([new[corner] for corner in triangle] for triangle in triangles):
        for k, corner in enumerate(triangle):
            if corner == len(places):
                base = predicted(places, triangle, k)
                place = [round(value / UNIT_MM) for value in points[order[corner]]]
                apart.append([a - b for a, b in zip(place, base)])
                places.append(place)
    for axis in range(3):
        for way in apart:
            number(2 * way[axis] if way[axis] >= 0 else -2 * way[axis] - 1)
    return struct.pack("<2H", len(places), len(triangles)) + bytes(out)


def clipped(points, triangles, value):
    """The part of a surface with value(point) <= 0."""
    points, values, cuts, found = list(points), [value(point) for point in points], {}, []
    for triangle in triangles:
        corners = []
        for a, b in zip(triangle, triangle[1:] + triangle[:1]):
            if values[a] <= 0:
                corners.append(a)
            if values[a] * values[b] < 0:
                low, high = sorted((a, b))
                if (low, high) not in cuts:
                    cuts[low, high] = len(points)
                    way = sub(points[high], points[low])
                    points.append(add(points[low], way, values[low] / (values[low] - values[high])))
                corners.append(cuts[low, high])
        found += [(corners[0], *corners[k : k + 2]) for k in range(1, len(corners) - 1)]
    return points, [triangle for triangle in found if len(set(triangle)) == 3]


def border(points, triangles, is_on):
    """The longest line of a surface's border above 450 mm whose points are on a section, from the shoulder to the armpit."""
    edges = {edge for a, b, c in triangles for edge in ((a, b), (b, c), (c, a))}
    edges = [(a, b) for a, b in edges if (b, a) not in edges]
    after = {a: b for a, b in edges if is_on(points[a]) and is_on(points[b])}
    best = []
    for start in sorted(set(after) - set(after.values())):
        line = [start]
        while line[-1] in after:
            line.append(after[line[-1]])
        if max(points[k][1] for k in line) > 450 and len(line) > len(best):
            best = line
    return [points[k] for k in best]


def spread(line, count):
    """Points at equal distances along a line."""
    lengths = [distance(a, b) for a, b in zip(line, line[1:])]
    found = []
    for k in range(count + 1):
        way, at = sum(lengths) * k / count, 0
        while at < len(lengths) - 1 and way > lengths[at]:
            way -= lengths[at]
            at += 1
        part = min(way / lengths[at], 1.0)
        found.append(add(line[at], sub(line[at + 1], line[at]), part))
    return found


def strip(points, outer, inner):
    """Triangles between two lines, by the shorter diagonals."""
    i = j = 0
    found = []
    while i < len(outer) - 1 or j < len(inner) - 1:
        can_outer, can_inner = i < len(outer) - 1, j < len(inner) - 1
        if can_outer and can_inner:
            across = [(outer[i + 1], inner[j]), (outer[i], inner[j + 1])]
            can_outer = distance(*map(points.__getitem__, across[0])) <= distance(*map(points.__getitem__, across[1]))
        if can_outer:
            found.append((outer[i + 1], outer[i], inner[j]))
            i += 1
        else:
            found.append((outer[i], inner[j], inner[j + 1]))
            j += 1
    return found


def main(ply, trunk, arm):
    rim = border(*read_half(trunk), lambda q: abs(q[0] - BORDER_MM) < 0.01)
    body = clipped(*clipped(*read_ply(ply), lambda q: q[0]), lambda q: BACK_MM - q[2])
    points, triangles, outer, line = list(rim), [], list(range(len(rim))), rim

    def ring(line, count):
        nonlocal outer
        first = len(points)
        points.extend(spread(line, count))
        inner = list(range(first, len(points)))
        triangles.extend(strip(points, outer, inner))
        outer = inner

    for part, count in SECTIONS:
        beyond = lambda q: -q[0] + BORDER_MM - part * (LAST_MM + BORDER_MM + LEAN * (q[1] - ARMPIT_MM))
        # The hip, below, is no arm.
        cut = clipped(*body, lambda q: beyond(q) if q[1] > 370 else -1.0)
        line = border(*cut, lambda q: abs(beyond(q)) < 0.01 and q[1] > 385)
        ring(line, count)
    length = math.hypot(1.0, LEAN)
    out = (-1.0 / length, -LEAN / length, 0.0)
    middle = tuple(0.5 * (a + b) for a, b in zip(line[0], line[-1]))
    for degrees, count in RINGS:
        angle = math.radians(degrees)
        base = add(middle, out, DOME_MM * math.sin(angle))
        ring([add(base, sub(point, middle), math.cos(angle)) for point in line], count)
    points.append(add(middle, out, DOME_MM))
    triangles += [(b, a, len(points) - 1) for a, b in zip(outer, outer[1:])]
    open(arm, "wb").write(half(points, triangles))


main(*sys.argv[1:])
