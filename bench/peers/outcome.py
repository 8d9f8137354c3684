"""Measures a settled scene from its tubes' endpoints alone, the same way for every program: how deep solids overlap.

A tube is the union of its cylinders, flat at both ends, and of spheres at its inner joints.
"""

import numpy as np

import tubes

SAMPLE_SPACING = 0.0005  # metres on a tube's end; between samples a depth is missed by under 0.003 mm
CIRCLE = np.linspace(0.0, 2.0 * np.pi, 160, endpoint=False)


def end_surface(end: np.ndarray, inward: np.ndarray) -> np.ndarray:
    """Points on a flat end and on the side within a radius of it; `inward` is the end's neighbour on the centreline."""
    length = np.linalg.norm(end - inward)
    axis = (end - inward) / length
    across = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
    across /= np.linalg.norm(across)
    ring = tubes.RADIUS * (np.cos(CIRCLE)[:, None] * across + np.sin(CIRCLE)[:, None] * np.cross(axis, across))
    steps = np.linspace(0.0, 1.0, 1 + int(tubes.RADIUS / SAMPLE_SPACING))[:, None, None]
    cap = end + steps * ring
    side = end + ring - steps * min(tubes.RADIUS, length) * axis
    return np.concatenate([cap, side]).reshape(-1, 3)


def depth_inside(points: np.ndarray, tube: np.ndarray) -> np.ndarray:
    """How deep each point lies in the tube; negative outside of it."""
    deepest = np.full(len(points), -np.inf)
    for a, b in zip(tube[:-1], tube[1:]):
        length = np.linalg.norm(b - a)
        along = (points - a) @ (b - a) / length
        from_axis = np.linalg.norm(points - a - along[:, None] * (b - a) / length, axis=1)
        deepest = np.maximum(deepest, np.minimum(tubes.RADIUS - from_axis, np.minimum(along, length - along)))
    for joint in tube[1:-1]:
        deepest = np.maximum(deepest, tubes.RADIUS - np.linalg.norm(points - joint, axis=1))
    return deepest


def shortened(tube: np.ndarray) -> np.ndarray:
    """The centreline without a radius at either end: where capsules and the flat-ended tube have one surface."""
    cut = tube.copy()
    for end, inner in ((0, 1), (-1, -2)):
        axis = tube[inner] - tube[end]
        cut[end] += axis * min(1.0, tubes.RADIUS / np.linalg.norm(axis)) * (1.0 - 1e-9)
    return cut


def depth_between(a: np.ndarray, b: np.ndarray) -> float:
    """How deep two tubes overlap: along their sides by their centrelines' distance, at the ends by surface points."""
    if tubes.segment_distances(a, b).min() > 2.0 * tubes.RADIUS:
        return -np.inf
    sides = 2.0 * tubes.RADIUS - tubes.segment_distances(shortened(a), shortened(b)).min()
    ends = [
        depth_inside(end_surface(tube[end], tube[inner]), other).max()
        for tube, other in ((a, b), (b, a))
        for end, inner in ((0, 1), (-1, -2))
    ]
    return max(sides, *ends)


def depth_in_bin(tube: np.ndarray) -> float:
    """How deep a tube overlaps the floor or a wall: spheres along its centreline, surface points at its ends."""
    inner = shortened(tube)
    steps = np.linspace(0.0, 1.0, 2 + int(tubes.LENGTH / SAMPLE_SPACING))
    spheres = np.concatenate([a + steps[:, None] * (b - a) for a, b in zip(inner[:-1], inner[1:])])
    ends = np.concatenate([end_surface(tube[end], tube[neighbour]) for end, neighbour in ((0, 1), (-1, -2))])
    deepest = -np.inf
    for center, half in tubes.bin_boxes():
        outside = np.linalg.norm(np.maximum(np.abs(spheres - center) - half, 0.0), axis=1)
        inside = (half - np.abs(ends - center)).min(axis=1)
        deepest = max(deepest, tubes.RADIUS - outside.min(), inside.max())
    return deepest


def deepest_penetration(nodes: list[np.ndarray]) -> float:
    """Metres, over all pairs of tubes and each tube and the bin; zero where nothing overlaps."""
    between = [depth_between(a, b) for i, a in enumerate(nodes) for b in nodes[:i]]
    return max(0.0, *between, *(depth_in_bin(tube) for tube in nodes))
