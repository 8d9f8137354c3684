"""How far do the tubes of finished piles move in a second of MuJoCo? check_rest.py DATASET

DATASET is generate_dataset's, of set A's or set B's tubes in any bin. Tubes are the exact surfaces: flat cylinders at
the ends, capsules between; friction and resistance to rolling and spinning are those of the simulation.

Two things in it are MuJoCo's own. Its friction is soft: what it holds creeps; a second pass ("noslip") takes that away. Its
contacts are springs, which bear nothing until bodies overlap by as much as their load wants: a pile from elsewhere begins
with a jolt. Strong damping for the first 0.2 s lets the springs take up their loads without it; movement counts from the
start all the same.
"""

import argparse
import json
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import mujoco
import numpy as np

import compare
import mujoco_peer
import tubes

ROLLING_RESISTANCE = 0.0015  # metres, PhysicsOptions' default
MILLIMETRES = 1e3


@dataclass(frozen=True)
class Solver:
    """Contacts as stiff as the time step allows: solref's time constant is two steps. With a shorter step they throw apart
    what overlaps by a tenth of a millimetre."""

    noslip_iterations: int
    starts_damped: bool
    time_step: float = 0.002  # seconds
    impratio: float = 100.0


DAMPED_TIME = 0.2  # seconds
DAMPING = np.array([5.0] * 3 + [0.05] * 3)  # N s/m and N m s/rad: a tube stops within 25 ms


def bin_xml(inner: dict) -> str:
    """The floor and the walls of scene.json's bin."""
    x, y, height, wall = inner["length"] / 2, inner["width"] / 2, inner["height"], inner["wall_thickness"]
    boxes = [((0, 0, -wall / 2), (x + wall, y + wall, wall / 2))]
    for side in (-1, 1):
        boxes.append(((side * (x + wall / 2), 0, height / 2), (wall / 2, y + wall, height / 2)))
        boxes.append(((0, side * (y + wall / 2), height / 2), (x, wall / 2, height / 2)))
    numbers = mujoco_peer.numbers
    return "".join(f'<geom type="box" pos="{numbers(at)}" size="{numbers(half)}"/>' for at, half in boxes)


def scene_xml(inner: dict, bodies: list[tubes.Body], solver: Solver) -> str:
    rolling = ROLLING_RESISTANCE
    return f"""
    <mujoco>
      <option timestep="{solver.time_step}" integrator="implicitfast" cone="elliptic" impratio="{solver.impratio}"
        noslip_iterations="{solver.noslip_iterations}" tolerance="1e-10"/>
      <size memory="1G"/>
      <default><geom condim="6" friction="{tubes.FRICTION} {rolling} {rolling}"
        solref="{2 * solver.time_step} 1"/></default>
      <worldbody>{bin_xml(inner)}{"".join(mujoco_peer.tube_xml(body) for body in bodies)}</worldbody>
    </mujoco>"""


def movement(scene: Path, solver: Solver, seconds: float) -> np.ndarray:
    """Per tube how far any of its nodes is from where it was, metres."""
    before = compare.read_tubes_txt(scene / "tubes.txt")
    bodies = [tubes.make_body(nodes) for nodes in before]
    inner = json.loads((scene / "scene.json").read_text())["bin"]
    world = mujoco_peer.World(scene_xml(inner, bodies, solver))
    if solver.starts_damped:
        own_damping = world.model.dof_damping.copy()
        world.model.dof_damping[:] = np.tile(DAMPING, len(bodies))
        mujoco.mj_step(world.model, world.data, nstep=round(DAMPED_TIME / solver.time_step))
        world.model.dof_damping[:] = own_damping
    mujoco.mj_step(world.model, world.data, nstep=round(seconds / solver.time_step))
    after = mujoco_peer.MuJoCoPeer().nodes_in_world(world, bodies)
    return np.array([np.linalg.norm(b - a, axis=1).max() for a, b in zip(before, after)])


def row(name: str, moved: np.ndarray) -> str:
    moved = moved * MILLIMETRES
    cells = [name, f"{len(moved)}", f"{np.median(moved):.2f}"]
    cells += [f"{(moved < limit).mean():.1%}" for limit in (0.5, 1.0, 5.0)]
    return f"| {' | '.join(cells)} | {moved.max():.1f} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("dataset", type=Path)
    parser.add_argument("--scenes", type=int, default=100, help="how many at most (default %(default)s)")
    parser.add_argument("--seconds", type=float, default=1.0)
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    scenes = sorted(path.parent for path in arguments.dataset.glob("**/tubes.txt"))[: arguments.scenes]
    if not scenes:
        raise SystemExit(f"check_rest: no scene in {arguments.dataset}")
    print("| passes against slip | start | tubes | median, mm | under 0.5 mm | under 1 mm | under 5 mm | largest, mm |")
    print("| ---: | --- | ---: | ---: | ---: | ---: | ---: | ---: |")
    with ProcessPoolExecutor(arguments.jobs) as pool:
        for solver in (Solver(0, False), Solver(20, False), Solver(20, True)):
            move = partial(movement, solver=solver, seconds=arguments.seconds)
            name = f"{solver.noslip_iterations} | {'damped' if solver.starts_damped else 'as it is'}"
            print(row(name, np.concatenate(list(pool.map(move, scenes)))), flush=True)


if __name__ == "__main__":
    main()
