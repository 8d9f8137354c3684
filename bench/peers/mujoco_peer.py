"""Ten tubes in a bin with MuJoCo: one free body a tube, the labelled image by mj_multiRay.

The settings are the fastest found that pass generate_dataset's gates: islands at rest sleep, a little damping keeps
tubes from rolling on, contacts are as stiff as the time step allows (solref's time constant is two steps), and elliptic
friction cones with a high impratio keep them from creeping. Rays beat the OpenGL renderer without a graphics card: that
one needs a new context a scene and two passes, and draws round shapes with facets.
"""

import mujoco
import numpy as np

import job
import tubes

TIME_STEP = 0.003
CONTACT_TIME = 2.0 * TIME_STEP
SLEEP_TOLERANCE = 0.03  # m/s
DAMPING = 0.0005  # N s/m and N m s/rad


def numbers(values) -> str:
    return " ".join(f"{value:.9g}" for value in values)


def quaternion(rotation: np.ndarray) -> np.ndarray:
    """w, x, y, z of a rotation matrix."""
    result = np.empty(4)
    mujoco.mju_mat2Quat(result, rotation.ravel())
    return result


def tube_xml(body: tubes.Body) -> str:
    """The tube's exact surface from few geoms: the end cylinders flat, and capsules between, which hold the joints."""
    last = len(body.nodes) - 2
    shapes = ["capsule" if 0 < i < last else "cylinder" for i in range(last + 1)]
    geoms = "".join(
        f'<geom type="{shape}" size="{tubes.RADIUS}" fromto="{numbers(a)} {numbers(b)}"/>'
        for shape, a, b in zip(shapes, body.nodes[:-1], body.nodes[1:])
    )
    return (
        f'<body pos="{numbers(body.position)}" quat="{numbers(quaternion(body.rotation))}">'
        f'<joint type="free" damping="{DAMPING}"/>'
        f'<inertial pos="0 0 0" mass="{tubes.MASS}" diaginertia="{numbers(body.inertia)}"/>{geoms}</body>'
    )


def scene_xml(bodies: list[tubes.Body]) -> str:
    bin_xml = "".join(
        f'<geom type="box" pos="{numbers(center)}" size="{numbers(half)}"/>' for center, half in tubes.bin_boxes()
    )
    return f"""
    <mujoco>
      <option timestep="{TIME_STEP}" integrator="implicitfast" cone="elliptic" impratio="300"
        sleep_tolerance="{SLEEP_TOLERANCE}"><flag sleep="enable"/></option>
      <default><geom friction="{tubes.FRICTION}" solref="{CONTACT_TIME} 1"/></default>
      <worldbody>
        {bin_xml}{"".join(tube_xml(body) for body in bodies)}
      </worldbody>
    </mujoco>"""


class World:
    """A scene's model and state."""

    def __init__(self, xml: str) -> None:
        self.model = mujoco.MjModel.from_xml_string(xml)
        self.data = mujoco.MjData(self.model)


class MuJoCoPeer:
    """Each scene is a model of its own."""

    def build(self, bodies: list[tubes.Body]) -> World:
        return World(scene_xml(bodies))

    def step(self, world: World) -> tuple[float, float, float]:
        mujoco.mj_step(world.model, world.data)
        velocities = world.data.qvel.reshape(-1, 2, 3)
        speed, angular_speed = np.sqrt((velocities**2).sum(axis=2).max(axis=0))
        return world.data.time, speed, angular_speed

    def run_on(self, world: World, seconds: float) -> None:
        world.model.opt.enableflags &= ~mujoco.mjtEnableBit.mjENBL_SLEEP.value
        mujoco.mj_step(world.model, world.data, nstep=round(seconds / TIME_STEP))
        world.model.opt.enableflags |= mujoco.mjtEnableBit.mjENBL_SLEEP.value

    def centers(self, world: World) -> np.ndarray:
        return world.data.qpos.reshape(-1, 7)[:, :3]

    def deepest_penetration(self, world: World) -> float:
        return -min(world.data.contact.dist, default=0.0)

    def nodes_in_world(self, world: World, bodies: list[tubes.Body]) -> list[np.ndarray]:
        mujoco.mj_kinematics(world.model, world.data)
        rotations = world.data.xmat[1:].reshape(-1, 3, 3)
        return [
            body.nodes @ rotation.T + position
            for body, rotation, position in zip(bodies, rotations, world.data.xpos[1:])
        ]

    def render(self, world: World, window: job.Window) -> tuple[np.ndarray, np.ndarray]:
        columns = np.arange(window.width) + 0.5 - window.width / 2.0
        rows = window.height / 2.0 - np.arange(window.height) - 0.5
        rays = np.empty((window.height, window.width, 3))
        rays[..., 0], rays[..., 1], rays[..., 2] = columns / job.FOCAL_LENGTH, rows[:, None] / job.FOCAL_LENGTH, -1.0
        geoms = np.empty(rays.shape[:2], np.int32)
        depth = np.empty(rays.shape[:2])
        mujoco.mj_multiRay(
            world.model,
            world.data,
            np.array([0.0, 0.0, job.SCANNER_HEIGHT]),
            rays.ravel(),
            None,
            1,
            -1,
            geoms.ravel(),
            depth.ravel(),
            None,
            geoms.size,
            1e10,
        )
        depth[geoms < 0] = 0.0
        label = np.where(geoms < 0, 0, world.model.geom_bodyid[geoms])
        return depth, label


if __name__ == "__main__":
    job.main(MuJoCoPeer, __doc__)
