"""Ten tubes in a bin with PyBullet: one compound body a tube, TinyRenderer for the labelled image.

The settings are the fastest found that pass generate_dataset's gates: PyBullet's own time step and iterations,
sleeping bodies, and the damping and rolling friction that bring tubes to rest. TinyRenderer draws round shapes with
facets, so its depth is not exact.
"""

from dataclasses import dataclass

import numpy as np
import pybullet as bullet

import job
import tubes

TIME_STEP = 1.0 / 240.0
FRICTION = np.sqrt(tubes.FRICTION)  # Bullet multiplies the coefficients of the two that touch
TUBE_DYNAMICS = {
    "lateralFriction": FRICTION,
    "rollingFriction": 0.003,
    "linearDamping": 0.1,
    "angularDamping": 0.3,
    "activationState": bullet.ACTIVATION_STATE_ENABLE_SLEEPING,
    "sleepThreshold": 0.1,
}


def quaternion_from_z(axis: np.ndarray) -> np.ndarray:
    """x, y, z, w of the shortest turn that takes +z to the unit vector `axis`."""
    quaternion = np.array([-axis[1], axis[0], 0.0, 1.0 + axis[2]])
    norm = np.linalg.norm(quaternion)
    return quaternion / norm if norm > 1e-9 else np.array([1.0, 0.0, 0.0, 0.0])


def quaternion(rotation: np.ndarray) -> np.ndarray:
    """x, y, z, w of a rotation matrix, by the turn of its z axis and what is left about it."""
    first = quaternion_from_z(rotation[:, 2])
    unturned = np.array(bullet.getMatrixFromQuaternion(first)).reshape(3, 3).T @ rotation
    about_z = np.arctan2(unturned[1, 0], unturned[0, 0]) / 2.0
    return np.array(bullet.multiplyTransforms([0, 0, 0], first, [0, 0, 0], [0, 0, np.sin(about_z), np.cos(about_z)])[1])


def tube_shapes(nodes: np.ndarray) -> dict:
    """The tube's exact surface from few shapes: the end cylinders flat, and capsules between, which hold the joints."""
    axes = np.diff(nodes, axis=0)
    lengths = np.linalg.norm(axes, axis=1)
    count = len(lengths)
    inner = [0 < i < count - 1 for i in range(count)]
    return {
        "shapeTypes": [bullet.GEOM_CAPSULE if capsule else bullet.GEOM_CYLINDER for capsule in inner],
        "radii": [tubes.RADIUS] * count,
        "lengths": lengths.tolist(),
        "positions": ((nodes[1:] + nodes[:-1]) / 2.0).tolist(),
        "orientations": [quaternion_from_z(axis).tolist() for axis in axes / lengths[:, None]],
    }


@dataclass
class World:
    """The tubes' body ids and the simulated time."""

    tubes: list[int]
    now: float = 0.0


class PyBulletPeer:
    """One client a process; each scene resets it."""

    def __init__(self) -> None:
        bullet.connect(bullet.DIRECT)

    def build(self, bodies: list[tubes.Body]) -> World:
        bullet.resetSimulation()
        bullet.setGravity(0.0, 0.0, -9.81)
        bullet.setPhysicsEngineParameter(fixedTimeStep=TIME_STEP, deterministicOverlappingPairs=1)
        for center, half in tubes.bin_boxes():
            shape = bullet.createCollisionShape(bullet.GEOM_BOX, halfExtents=half)
            bullet.changeDynamics(bullet.createMultiBody(0.0, shape, basePosition=center), -1, lateralFriction=FRICTION)
        return World([self.add_tube(body) for body in bodies])

    @staticmethod
    def add_tube(body: tubes.Body) -> int:
        shapes = tube_shapes(body.nodes)
        frames = {"Positions": shapes.pop("positions"), "Orientations": shapes.pop("orientations")}
        collision = bullet.createCollisionShapeArray(
            **shapes, **{f"collisionFrame{name}": value for name, value in frames.items()}
        )
        visual = bullet.createVisualShapeArray(
            **shapes, **{f"visualFrame{name}": value for name, value in frames.items()}
        )
        identifier = bullet.createMultiBody(tubes.MASS, collision, visual, body.position, quaternion(body.rotation))
        bullet.changeDynamics(identifier, -1, localInertiaDiagonal=body.inertia, **TUBE_DYNAMICS)
        return identifier

    def step(self, world: World) -> tuple[float, float, float]:
        bullet.stepSimulation()
        world.now += TIME_STEP
        velocities = np.array([bullet.getBaseVelocity(tube) for tube in world.tubes])
        speed, angular_speed = np.linalg.norm(velocities, axis=2).max(axis=0)
        return world.now, speed, angular_speed

    def run_on(self, world: World, seconds: float) -> None:
        self.set_activation(world, bullet.ACTIVATION_STATE_WAKE_UP | bullet.ACTIVATION_STATE_DISABLE_SLEEPING)
        for _ in range(round(seconds / TIME_STEP)):
            bullet.stepSimulation()
        world.now += seconds
        self.set_activation(world, bullet.ACTIVATION_STATE_ENABLE_SLEEPING)

    @staticmethod
    def set_activation(world: World, state: int) -> None:
        for tube in world.tubes:
            bullet.changeDynamics(tube, -1, activationState=state)

    def centers(self, world: World) -> np.ndarray:
        return np.array([bullet.getBasePositionAndOrientation(tube)[0] for tube in world.tubes])

    def nodes_in_world(self, world: World, bodies: list[tubes.Body]) -> list[np.ndarray]:
        nodes = []
        for tube, body in zip(world.tubes, bodies):
            position, orientation = bullet.getBasePositionAndOrientation(tube)
            rotation = np.array(bullet.getMatrixFromQuaternion(orientation)).reshape(3, 3)
            nodes.append(body.nodes @ rotation.T + position)
        return nodes

    def deepest_penetration(self, world: World) -> float:
        return max((-contact[8] for contact in bullet.getContactPoints()), default=0.0)

    def render(self, world: World, window: job.Window) -> tuple[np.ndarray, np.ndarray]:
        view = bullet.computeViewMatrix([0.0, 0.0, job.SCANNER_HEIGHT], [0.0, 0.0, 0.0], [0.0, 1.0, 0.0])
        projection = self.projection(window)
        _, _, _, buffer, bodies = bullet.getCameraImage(
            window.width, window.height, view, projection, shadow=0, renderer=bullet.ER_TINY_RENDERER
        )
        near, far = job.RANGE_MIN, job.RANGE_MAX
        depth = far * near / (far - (far - near) * np.asarray(buffer))
        depth[np.asarray(bodies) < 0] = 0.0
        label = np.maximum(np.asarray(bodies) - (world.tubes[0] - 1), 0)
        return depth, label

    @staticmethod
    def projection(window: job.Window) -> tuple[float, ...]:
        """Of the window, moved by half a pixel each way, since TinyRenderer samples a pixel at its corner."""
        scale = job.RANGE_MIN / job.FOCAL_LENGTH
        left, right = (scale * (side * window.width / 2.0 + 0.5) for side in (-1, 1))
        bottom, top = (scale * (side * window.height / 2.0 + 0.5) for side in (-1, 1))
        return bullet.computeProjectionMatrix(left, right, bottom, top, job.RANGE_MIN, job.RANGE_MAX)


if __name__ == "__main__":
    job.main(PyBulletPeer, __doc__)
