"""Triangle meshes of exports, and distances to them."""
import numpy as np


def load_ply(path):
    """Vertices, normals and triangles."""
    header, body = open(path, "rb").read().split(b"end_header\n", 1)
    vertices, faces = (int(header.split(b"element " + name)[1].split()[0]) for name in (b"vertex", b"face"))
    points = np.frombuffer(body, "<f4", 6 * vertices).reshape(-1, 6).astype(float)
    corners = np.frombuffer(body[24 * vertices:], [("count", "u1"), ("corners", "<i4", 3)], faces)
    assert (corners["count"] == 3).all() and corners["corners"].max() < vertices
    return {"pts": points[:, :3], "normals": points[:, 3:], "faces": corners["corners"]}


def load_stl(path):
    data = open(path, "rb").read()
    count = int.from_bytes(data[80:84], "little")
    assert len(data) == 84 + 50 * count, path
    facets = np.frombuffer(data[84:], [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
    return facets["corners"].astype(float)


def distance_to_triangles(point, triangles):
    """To the planes where the point lies above a triangle, else to the edges."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normal = np.cross(b - a, c - a)
    area = np.linalg.norm(normal, axis=1)
    a, b, c, normal = a[area > 0], b[area > 0], c[area > 0], normal[area > 0] / area[area > 0, None]
    above = np.full(len(a), True)
    distance = np.full(len(a), np.inf)
    for begin, end in ((a, b), (b, c), (c, a)):
        edge = end - begin
        above &= (np.cross(edge, point - begin) * normal).sum(1) >= 0
        along = np.clip(((point - begin) * edge).sum(1) / (edge ** 2).sum(1), 0, 1)[:, None]
        distance = np.minimum(distance, np.linalg.norm(begin + along * edge - point, axis=1))
    return np.where(above, np.abs(((point - a) * normal).sum(1)), distance).min()
