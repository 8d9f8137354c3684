"""Tubes by Algorithms 1 to 3 of the paper (Section 3), spawned above the bin: what both peers simulate.

Metres, radians and kilograms; world frame: origin at the centre of the bin's floor, z up, x along its length.
"""

from dataclasses import dataclass

import numpy as np

RADIUS = 0.0125
LENGTH = 0.5
CYLINDER_LENGTH_MIN = 0.02
CYLINDER_COUNT_MIN, CYLINDER_COUNT_MAX = 5, 10
BEND_ANGLE_MIN, BEND_ANGLE_MAX = np.radians([0.0, 30.0])  # set A
MASS = 0.055
FRICTION = 1.16  # of the published simulation, tube on tube
BIN_LENGTH, BIN_WIDTH, BIN_HEIGHT, WALL_THICKNESS = 0.55, 0.37, 0.20, 0.02


def use_full_bin() -> None:
    """The bin of config/full_bin.yaml instead of the paper's."""
    global BIN_LENGTH, BIN_WIDTH, BIN_HEIGHT
    BIN_LENGTH, BIN_WIDTH, BIN_HEIGHT = 1.0, 0.8, 0.6


SPAWN_CLEARANCE = 0.005
SPAWN_TRIES = 200
SPAWN_LIFT = 0.02


def generate_lengths(count: int, random: np.random.Generator) -> np.ndarray:
    """Algorithm 2, with continuous lengths as the published files have them."""
    lengths, remaining = [], LENGTH
    for i in range(count - 1):
        longest = remaining - (count - 1 - i) * CYLINDER_LENGTH_MIN
        lengths.append(random.uniform(CYLINDER_LENGTH_MIN, longest))
        remaining -= lengths[-1]
    return np.array([*lengths, remaining])


def rotate_from_z_to(direction: np.ndarray, vector: np.ndarray) -> np.ndarray:
    """Algorithm 3, line 11: the rotation that takes +z to `direction` about their cross product (Rodrigues)."""
    x, y, cosine = direction
    sine_squared = x * x + y * y
    if sine_squared == 0.0:  # along z; against it, half a turn about x
        return vector * (1.0, np.sign(cosine), np.sign(cosine))
    cross = np.array([-y, x, 0.0])  # z cross direction; its length is the sine of the angle
    return (
        vector * cosine + np.cross(cross, vector) + cross * (cross @ vector) * (1.0 - cosine) / sine_squared
    )


def generate_endpoints(lengths: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Algorithm 3 before its random translation: cylinder i runs from row i to row i + 1."""
    endpoints, direction = [np.zeros(3)], np.array([0.0, 0.0, 1.0])
    for i, length in enumerate(lengths):
        phi = random.uniform(0.0, 2.0 * np.pi)
        theta = random.uniform(0.0, np.pi) if i == 0 else random.uniform(BEND_ANGLE_MIN, BEND_ANGLE_MAX)
        spherical = np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
        direction = rotate_from_z_to(direction, spherical)
        direction /= np.linalg.norm(direction)
        endpoints.append(endpoints[-1] + length * direction)
    return np.array(endpoints)


def generate_tube(random: np.random.Generator) -> np.ndarray:
    """Algorithm 1 for one tube: the endpoints of its cylinders, first one at the origin."""
    count = int(random.integers(CYLINDER_COUNT_MIN, CYLINDER_COUNT_MAX, endpoint=True))
    return generate_endpoints(generate_lengths(count, random), random)


def segment_distances(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Distance between each segment of polyline `a` and each of polyline `b`, as a matrix.

    Closest points of two segments: the unconstrained optimum clamped once each way (Ericson, Real-Time Collision
    Detection, Section 5.1.9).
    """
    p, u = a[:-1, None], np.diff(a, axis=0)[:, None]
    q, v = b[None, :-1], np.diff(b, axis=0)[None]
    r = p - q
    uu, vv, uv = (u * u).sum(-1), (v * v).sum(-1), (u * v).sum(-1)
    ur, vr = (u * r).sum(-1), (v * r).sum(-1)
    denominator = uu * vv - uv * uv
    s = np.clip((uv * vr - ur * vv) / np.maximum(denominator, 1e-12 * uu * vv), 0.0, 1.0)
    t = np.clip((uv * s + vr) / vv, 0.0, 1.0)
    s = np.clip((uv * t - ur) / uu, 0.0, 1.0)
    return np.linalg.norm(r + s[..., None] * u - t[..., None] * v, axis=-1)


def spawn(tube: np.ndarray, spawned: list[np.ndarray], random: np.random.Generator) -> np.ndarray:
    """Algorithm 3's random translation: above the bin, where the tube falls into it, clear of `spawned` tubes.

    A turn about z comes with it, since not every tube fits between the walls at every heading.
    """
    half_inner = np.array([BIN_LENGTH, BIN_WIDTH]) / 2.0 - RADIUS - SPAWN_CLEARANCE
    for _ in range(SPAWN_TRIES):
        yaw = random.uniform(0.0, 2.0 * np.pi)
        turn = np.array([[np.cos(yaw), -np.sin(yaw), 0.0], [np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]])
        turned = tube @ turn.T
        low, high = turned.min(axis=0), turned.max(axis=0)
        room = half_inner - (high - low)[:2] / 2.0
        if (room >= 0.0).all():
            break
    else:
        raise RuntimeError("a tube fits between the bin's walls at no heading")
    center = random.uniform(-room, room)
    shift = np.array([*(center - (low + high)[:2] / 2.0), BIN_HEIGHT + RADIUS + SPAWN_CLEARANCE - low[2]])
    placed = turned + shift
    while any(segment_distances(placed, other).min() < 2.0 * RADIUS + SPAWN_CLEARANCE for other in spawned):
        placed[:, 2] += SPAWN_LIFT
    return placed


def spawn_tubes(count: int, random: np.random.Generator) -> list[np.ndarray]:
    """`count` tubes above the bin: per tube the endpoints of its cylinders in the world."""
    placed: list[np.ndarray] = []
    for _ in range(count):
        placed.append(spawn(generate_tube(random), placed, random))
    return placed


@dataclass
class Body:
    """A tube as a rigid body: its endpoints in the frame of its centre of mass and principal axes."""

    nodes: np.ndarray
    inertia: np.ndarray  # principal moments
    position: np.ndarray
    rotation: np.ndarray  # 3 x 3, world from body


def make_body(tube: np.ndarray) -> Body:
    """Mass properties of solid cylinders, mass in proportion to length (the joints' wedges are left out)."""
    axes = np.diff(tube, axis=0)
    lengths = np.linalg.norm(axes, axis=1)
    masses = MASS * lengths / lengths.sum()
    centers = (tube[1:] + tube[:-1]) / 2.0
    center = masses @ centers / MASS
    inertia = np.zeros((3, 3))
    for mass, length, axis, offset in zip(masses, lengths, axes / lengths[:, None], centers - center):
        across = mass * (3.0 * RADIUS**2 + length**2) / 12.0
        along = mass * RADIUS**2 / 2.0
        inertia += across * np.eye(3) + (along - across) * np.outer(axis, axis)
        inertia += mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))
    moments, rotation = np.linalg.eigh(inertia)
    rotation[:, 2] *= np.sign(np.linalg.det(rotation))
    return Body((tube - center) @ rotation, moments, center, rotation)


def bin_boxes() -> list[tuple[np.ndarray, np.ndarray]]:
    """Centre and half extents of the floor and the four walls."""
    x, y, wall = BIN_LENGTH / 2.0, BIN_WIDTH / 2.0, WALL_THICKNESS / 2.0
    outer_y, middle = y + 2.0 * wall, BIN_HEIGHT / 2.0
    boxes = [((0.0, 0.0, -wall), (x + 2.0 * wall, outer_y, wall))]
    boxes += [((side * (x + wall), 0.0, middle), (wall, outer_y, middle)) for side in (-1, 1)]
    boxes += [((0.0, side * (y + wall), middle), (x, wall, middle)) for side in (-1, 1)]
    return [(np.array(center), np.array(half)) for center, half in boxes]
