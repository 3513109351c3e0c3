"""A sheet of 1 m, rolled up with a ripple in layers that are 1.5 edges apart, as OBJ on stdout.

    python3 tests/gpu/roll.py 707 > roll.obj        # 707 cells a side: a million triangles
    muslin detect roll.obj --thickness 0.0017 --backend gpu
"""

import math
import random
import sys

cells = int(sys.argv[1])
edge = 1.0 / cells
random.seed(cells)
angle = 0.0
for _ in range(cells + 1):
    radius = edge * (8 + 1.5 * angle / (2 * math.pi))
    for j in range(cells + 1):
        ripple = 0.2 * math.sin(37.0 * angle + 22.0 * math.pi * j / cells) + 0.05 * random.random()
        r = radius + edge * ripple
        print(f"v {r * math.cos(angle):.9g} {r * math.sin(angle):.9g} {j * edge:.9g}")
    angle += edge / radius
for i in range(cells):
    for j in range(cells):
        a = i * (cells + 1) + j + 1
        b, c = a + 1, a + cells + 1
        print(f"f {a} {b} {c}\nf {b} {c + 1} {c}")
