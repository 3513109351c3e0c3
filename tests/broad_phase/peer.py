"""How long ipctk's bounding volume hierarchy takes for the same candidates, on one thread.

    pip install ipctk==1.6.1
    export MUSLIN_MESHES=$(mktemp -d)
    cargo test -p muslin-tests --test broad_phase --release -- --ignored --nocapture long_form
    python3 tests/broad_phase/peer.py $MUSLIN_MESHES

The boxes are those of the Rust side: ipctk inflates each one by the whole radius that it is given, so it is given half
of the thickness. Its candidates stay in C++: to make Python's objects of them takes longer than to find them.
"""

import statistics
import sys
import time

import ipctk
import numpy

RUNS = 9


def read(path):
    vertices, triangles = [], []
    with open(path, encoding="ascii") as file:
        for line in file:
            kind, *numbers = line.split()
            if kind == "v":
                vertices.append([float(x) for x in numbers])
            else:
                triangles.append([int(corner) - 1 for corner in numbers])
    return numpy.asfortranarray(vertices), numpy.asfortranarray(numpy.array(triangles, dtype=numpy.int32))


ipctk.set_num_threads(1)
print("triangles  thickness  median ms   least ms  candidates")
for cells in [71, 100, 224, 387, 707]:
    vertices, triangles = read(f"{sys.argv[1]}/crumpled-{cells}.obj")
    edges = numpy.asfortranarray(ipctk.edges(triangles).astype(numpy.int32))
    mesh = ipctk.CollisionMesh(vertices, edges, triangles)
    for thickness in [0.05, 0.25]:
        times = []
        for _ in range(RUNS):
            started = time.perf_counter()
            candidates = ipctk.Candidates()
            candidates.build(mesh, vertices, thickness / 2, ipctk.LBVH())
            times.append(1e3 * (time.perf_counter() - started))
        middle, least = statistics.median(times), min(times)
        print(f"{len(triangles):9}  {100 * thickness:7.0f} %  {middle:9.2f}  {least:9.2f}  {len(candidates):10}")
