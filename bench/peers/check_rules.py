"""Checks that the peers' tubes follow the paper's rules, and that the measure of their outcome is right.

Run with the peers' virtual environment: python check_rules.py. Ends with 1 at the first statement that fails.
Distributions are compared by Kolmogorov-Smirnov at a significance of 1e-4 with a fixed seed.
"""

import numpy as np

import outcome
import tubes

SAMPLES = 3000
KOLMOGOROV_CRITICAL = 2.23  # of sqrt(n) D at a significance of 1e-4


def require(statement: bool, what: str) -> None:
    if not statement:
        raise SystemExit(f"check_rules: {what}")
    print(f"ok: {what}")


def is_uniform(values: np.ndarray, low: float, high: float) -> bool:
    ranks = (np.sort(values) - low) / (high - low)
    steps = np.arange(len(ranks) + 1) / len(ranks)
    distance = max((steps[1:] - ranks).max(), (ranks - steps[:-1]).max())
    return bool(np.sqrt(len(ranks)) * distance < KOLMOGOROV_CRITICAL)


def half_turns_from_z_to(direction: np.ndarray) -> np.ndarray:
    """The rotation that takes +z to `direction` about their cross product, from two half turns."""
    middle = direction + [0.0, 0.0, 1.0]
    middle /= np.linalg.norm(middle)
    about_z, about_middle = (2.0 * np.outer(axis, axis) - np.eye(3) for axis in ([0.0, 0.0, 1.0], middle))
    return about_middle @ about_z


def check_algorithms(random: np.random.Generator) -> None:
    counts, shares, first_thetas, first_phis, bends, phis = ([] for _ in range(6))
    for _ in range(SAMPLES):
        axes = np.diff(tubes.generate_tube(random), axis=0)
        lengths = np.linalg.norm(axes, axis=1)
        directions = axes / lengths[:, None]
        counts.append(len(lengths))
        if not np.isclose(lengths.sum(), tubes.LENGTH) or lengths.min() < tubes.CYLINDER_LENGTH_MIN - 1e-9:
            raise SystemExit(f"check_rules: lengths {lengths} break Algorithm 2")
        remaining = tubes.LENGTH - np.concatenate([[0.0], np.cumsum(lengths)[:-2]])
        longest = remaining - (len(lengths) - 1 - np.arange(len(lengths) - 1)) * tubes.CYLINDER_LENGTH_MIN
        shares += list((lengths[:-1] - tubes.CYLINDER_LENGTH_MIN) / (longest - tubes.CYLINDER_LENGTH_MIN))
        first_thetas.append(np.arccos(directions[0, 2]))
        first_phis.append(np.arctan2(directions[0, 1], directions[0, 0]) % (2.0 * np.pi))
        for previous, direction in zip(directions[:-1], directions[1:]):
            unturned = half_turns_from_z_to(previous).T @ direction
            bends.append(np.arctan2(np.hypot(unturned[0], unturned[1]), unturned[2]))
            phis.append(np.arctan2(unturned[1], unturned[0]) % (2.0 * np.pi))
    each = np.bincount(counts, minlength=tubes.CYLINDER_COUNT_MAX + 1)[tubes.CYLINDER_COUNT_MIN :]
    expected = SAMPLES / len(each)
    chi_square = ((each - expected) ** 2 / expected).sum()
    require(chi_square < 25.7, "numbers of cylinders are uniform (chi square, 5 degrees of freedom)")
    require(is_uniform(np.array(shares), 0.0, 1.0), "each length is uniform between its limits (Algorithm 2, line 4)")
    require(is_uniform(np.array(first_thetas), 0.0, np.pi), "first polar angles are uniform (Algorithm 3, line 6)")
    require(is_uniform(np.array(first_phis), 0.0, 2.0 * np.pi), "first azimuths are uniform (Algorithm 3, line 4)")
    require(
        is_uniform(np.array(bends), tubes.BEND_ANGLE_MIN, tubes.BEND_ANGLE_MAX),
        "bends are uniform between their limits (Algorithm 3, line 9)",
    )
    require(is_uniform(np.array(phis), 0.0, 2.0 * np.pi), "azimuths about the previous direction are uniform (line 11)")


def check_spawn(random: np.random.Generator) -> None:
    half = np.array([tubes.BIN_LENGTH, tubes.BIN_WIDTH]) / 2.0 - tubes.RADIUS
    for _ in range(20):
        placed = tubes.spawn_tubes(10, random)
        points = np.concatenate(placed)
        if not (np.abs(points[:, :2]) < half).all() or points[:, 2].min() < tubes.BIN_HEIGHT + tubes.RADIUS:
            raise SystemExit("check_rules: a tube spawns outside the walls or below the rim")
        if outcome.deepest_penetration(placed) > 0.0:
            raise SystemExit("check_rules: spawned tubes overlap")
    print("ok: tubes spawn above the rim, between the walls, apart from each other")


def check_bodies(random: np.random.Generator) -> None:
    tube = tubes.generate_tube(random)
    body = tubes.make_body(tube)
    require(np.allclose(body.nodes @ body.rotation.T + body.position, tube), "a body's pose gives its tube back")
    straight = tubes.make_body(np.linspace([0.0, 0.0, 0.0], [0.3, 0.4, 0.0], 8))
    across = tubes.MASS * (3.0 * tubes.RADIUS**2 + 0.5**2) / 12.0
    along = tubes.MASS * tubes.RADIUS**2 / 2.0
    require(np.allclose(straight.inertia, [along, across, across]), "a straight tube has a cylinder's inertia")


def sampled_distances(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """segment_distances by brute force, 0.5 mm and less between samples of a 0.2 m segment."""
    steps = np.linspace(0.0, 1.0, 400)[:, None]
    return np.array(
        [
            [
                np.linalg.norm((p + steps * (q - p))[:, None] - (r + steps * (s - r))[None], axis=2).min()
                for r, s in zip(b[:-1], b[1:])
            ]
            for p, q in zip(a[:-1], a[1:])
        ]
    )


def check_measures(random: np.random.Generator) -> None:
    a, b = random.uniform(-0.1, 0.1, (2, 6, 3))
    error = np.abs(tubes.segment_distances(a, b) - sampled_distances(a, b)).max()
    require(error < 1e-3, "distances of segments agree with brute force")

    def line(start: list[float], end: list[float]) -> np.ndarray:
        return np.linspace(start, end, 6)

    r, lift = tubes.RADIUS, 0.1
    along_x = line([-0.25, 0.0, lift], [0.25, 0.0, lift])
    cases = {
        "crossing": (line([0.0, -0.15, lift + 2.0 * r - 0.001], [0.0, 0.15, lift + 2.0 * r - 0.001]), 0.001),
        "flat end against a side, apart": (line([0.0, r + 0.0005, lift], [0.0, 0.15, lift]), 0.0),
        "flat end in a side": (line([0.0, r - 0.0005, lift], [0.0, 0.15, lift]), 0.0005),
    }
    for name, (other, depth) in cases.items():
        measured = outcome.deepest_penetration([along_x, other])
        require(abs(measured - depth) < 2e-5, f"penetration of {name}: {measured * 1e3:.3f} mm")
    lying = line([-0.2, 0.0, r - 0.0003], [0.2, 0.0, r - 0.0003])
    require(abs(outcome.depth_in_bin(lying) - 0.0003) < 1e-5, "penetration of a lying tube and the floor")
    standing = line([0.0, 0.0, -0.0002], [0.0, 0.0, 0.4])
    require(abs(outcome.depth_in_bin(standing) - 0.0002) < 1e-5, "penetration of a flat end and the floor")


def main() -> None:
    random = np.random.default_rng(2022)
    check_algorithms(random)
    check_spawn(random)
    check_bodies(random)
    check_measures(random)


if __name__ == "__main__":
    main()
