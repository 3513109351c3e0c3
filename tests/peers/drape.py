"""A sheet of 64x64 vertices falls on a sphere (tests/scenes/drape.toml, 2 s) with MuJoCo's flexible bodies and with Muslin,
one thread each, native, in turns. Prints the mean cost of 1/60 s, the median of the turns, and the largest stretch in any
frame.

    pip install mujoco==4.0.0 numpy
    cargo build --release -p muslin-cli
    python3 tests/peers/drape.py
"""

import json
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

import mujoco
import numpy

ROOT = pathlib.Path(__file__).parents[2]
TURNS = int(sys.argv[1]) if len(sys.argv) > 1 else 3
COUNT, FRAMES, FRAME = 64, 120, 1 / 60
# Of the scene: the modulus and thickness whose product is its stiffness, 2000 N/m.
MODEL = """
<mujoco>
  <option timestep="{step}" gravity="0 -9.81 0" solver="CG" iterations="50" tolerance="1e-6" integrator="discrete"/>
  <size memory="2G"/>
  <worldbody>
    <geom type="sphere" size="0.3" friction="0.3" solref="0.005 1"/>
    <flexcomp name="cloth" type="grid" dim="2" count="64 64 1" spacing="{spacing} {spacing} 0.05" mass="0.2"
              radius="0.002" pos="0 0.33 0" euler="90 0 0">
      <elasticity young="5e5" poisson="0.2" thickness="0.004" damping="0.001" elastic2d="both"/>
      <contact condim="3" friction="0.3" selfcollide="{selfcollide}" solref="0.005 1"/>
    </flexcomp>
  </worldbody>
</mujoco>"""


def mujoco_sheet(steps, selfcollide):
    """Returns the mean cost of a frame in so many steps, ms, and the largest stretch of an edge of the grid."""
    text = MODEL.format(step=FRAME / steps, spacing=1 / (COUNT - 1), selfcollide=selfcollide)
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    index = numpy.arange(COUNT * COUNT).reshape(COUNT, COUNT)
    ends = [(index[:-1], index[1:]), (index[:, :-1], index[:, 1:])]
    first, second = (numpy.concatenate([pair[k].ravel() for pair in ends]) for k in range(2))
    lengths = lambda: numpy.linalg.norm(data.flexvert_xpos[first] - data.flexvert_xpos[second], axis=1)
    rest, spent, stretch = lengths(), 0.0, 0.0
    for _ in range(FRAMES):
        began = time.perf_counter()
        for _ in range(steps):
            mujoco.mj_step(model, data)
        spent += time.perf_counter() - began
        stretch = max(stretch, (lengths() / rest).max() - 1)
    return 1000 * spent / FRAMES, stretch


def muslin_sheet(error, own="true"):
    """The same of Muslin."""
    with tempfile.TemporaryDirectory() as out:
        scene = ROOT / "tests/scenes/drape.toml"
        options = ["--threads", "1", "--preview", "none", "--quiet", "--out", out, "--set", f"integrator.error={error}"]
        options += ["--set", f"contact.self={own}"]
        subprocess.run([ROOT / "target/release/muslin", "run", scene, *options], check=True)
        summary = json.loads((pathlib.Path(out) / "summary.json").read_text(encoding="utf-8"))
    stages = summary["stage_ms"]
    ms = sum(stages[stage] for stage in ["predict", "broad_phase", "narrow_phase", "response"])
    return ms * summary["steps"] / FRAMES, summary["stretch"]["max_of_all_frames"] - 1


SHEETS = {
    "Muslin, error 1 mm": lambda: muslin_sheet(0.001),
    "Muslin, error 2 mm": lambda: muslin_sheet(0.002),
    "Muslin, error 2 mm, no self-contact": lambda: muslin_sheet(0.002, "false"),
    "MuJoCo, 1 step, no self-contact": lambda: mujoco_sheet(1, "none"),
    "MuJoCo, 4 steps, no self-contact": lambda: mujoco_sheet(4, "none"),
    "MuJoCo, 1 step": lambda: mujoco_sheet(1, "auto"),
    "MuJoCo, 4 steps": lambda: mujoco_sheet(4, "auto"),
}

turns = [{name: sheet() for name, sheet in SHEETS.items()} for _ in range(TURNS)]
for name in SHEETS:
    cost = statistics.median(turn[name][0] for turn in turns)
    stretch = max(turn[name][1] for turn in turns)
    print(f"{name:36} {cost:6.1f} ms for 1/60 s, worst edge +{100 * stretch:.1f} %")
