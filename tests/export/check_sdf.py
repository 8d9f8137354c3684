"""Compare an export as Gazebo worlds with its data set, and with published worlds."""
import xml.etree.ElementTree as ElementTree

import numpy as np

from exported_meshes import distance_to_triangles, load_stl
from exported_scenes import published_name, scenes_of


# Where elements stand in the published .world files; of what they have, these are what a settled scene needs.
PART = ["collision/pose", "collision/geometry", "collision/max_contacts"] + [
    "collision/surface/" + leaf for leaf in
    ["friction/ode/mu", "friction/ode/mu2", "contact/ode/kp", "contact/ode/kd", "contact/ode/max_vel",
     "contact/ode/min_depth"]]
WORLD = ["gravity", "magnetic_field", "atmosphere", "scene/ambient", "scene/background", "scene/shadows",
         "physics/max_step_size", "physics/real_time_factor", "physics/real_time_update_rate", "physics/max_contacts",
         "physics/ode/solver/type", "physics/ode/solver/iters", "physics/ode/solver/sor",
         "physics/ode/solver/use_dynamic_moi_rescaling", "physics/ode/constraints/contact_max_correcting_vel",
         "physics/ode/constraints/contact_surface_layer", "physics/ode/constraints/cfm", "physics/ode/constraints/erp"]
CAMERA = ["horizontal_fov", "image/width", "image/height", "image/format", "clip/near", "clip/far", "depth_camera/output"]
TUBE = ["static", "pose", "link/inertial/pose", "link/inertial/mass", "link/visual/pose", "link/visual/geometry",
        "link/visual/material/ambient"] + [
            "link/inertial/inertia/" + key for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")] + [
                "link/" + leaf for leaf in PART]
BIN = ["static", "link/collision/geometry/box/size"] + ["link/" + leaf for leaf in PART]
# What the published files lack: a lamp, and a diffuse colour and looks of the bin to see by.
ADDED = {"light", "light/pose", "light/diffuse", "light/direction", "model/link/visual/geometry/box",
         "model/link/visual/geometry/box/size", "model/link/visual/material/diffuse"}


def element_paths(element, prefix=""):
    for child in element:
        path = prefix + child.tag
        yield path
        yield from element_paths(child, path + "/")


def rotation(roll, pitch, yaw):
    about = [(1, 2, roll), (2, 0, pitch), (0, 1, yaw)]
    whole = np.eye(3)
    for i, j, angle in about:
        turn = np.eye(3)
        turn[i, i] = turn[j, j] = np.cos(angle)
        turn[i, j], turn[j, i] = -np.sin(angle), np.sin(angle)
        whole = turn @ whole
    return whole


def pose_of(element):
    values = [float(value) for value in element.findtext("pose").split()]
    return rotation(*values[3:]), np.array(values[:3])


def check(dataset, export, *published_worlds):
    pipes, in_bores = False, 0
    published = [set(element_paths(ElementTree.parse(path).find("world"))) for path in published_worlds]
    for _, name, scene in scenes_of(dataset, export):
        root = ElementTree.parse(f"{export}/{published_name(name, 'gazebo_worlds', '.world')}").getroot()
        assert root.tag == "sdf" and root.get("version") == "1.7" and root.find("world").get("name") == "default"
        world = root.find("world")
        for paths in published:
            assert set(element_paths(world)) <= paths | ADDED, sorted(set(element_paths(world)) - paths - ADDED)
        assert not [path for path in WORLD if world.find(path) is None]
        models = {model.get("name"): model for model in world.findall("model")}
        around = ["surroundings"] if "surroundings" in scene.truth else []
        assert set(models) == {"scanner", "bin", *around, *(str(tube["label"]) for tube in scene.truth["tubes"])}
        camera = models["scanner"].find("link/sensor[@type='depth']/camera")
        assert not [path for path in CAMERA if camera.find(path) is None]
        turn, place = pose_of(models["scanner"])
        assert np.allclose(place, scene.truth["scanner"]["position"])
        optical = np.array(scene.truth["scanner"]["pose"]["rotation"])
        assert np.allclose(turn[:, 0], optical[:, 2]) and np.allclose(turn[:, 2], -optical[:, 1])
        assert not [path for path in BIN if models["bin"].find(path) is None]
        shapes = [shape for name in ["bin", *around] for shape in models[name].findall("link/visual")]
        background = scene.xyz[scene.seen & (scene.label == 0)].astype(float)[::7]
        assert np.abs(outside_of(shapes, background)).max(initial=0) < 1e-5, name
        folder = f"{export}/{published_name(name, 'gazebo_worlds', '')}".rsplit("/", 1)[0]
        for tube in scene.truth["tubes"]:
            where = f"{name}, tube {tube['label']}"
            model = models[str(tube["label"])]
            check_tube(model, tube, where)
            pipes |= tube["wall_thickness"] > 0
            in_bores += check_looks(model, scene.xyz[scene.seen & (scene.label == tube["label"])], folder, where)
    assert in_bores > 0 or not pipes, "no point of the scans lies in a bore"


def check_looks(model, points, folder, where):
    """The scanned points lie on what Gazebo shows. Returns how many of them lie deep within what tubes collide with."""
    turn, place = pose_of(model)
    points = (points.astype(float) - place) @ turn
    depth = -outside_of(model.findall("link/collision"), points)
    visuals = model.findall("link/visual")
    meshes = [visual.findtext("geometry/mesh/uri") for visual in visuals if visual.find("geometry/mesh") is not None]
    if not meshes:
        assert np.abs(outside_of(visuals, points)).max(initial=0) < 1e-5, where
        return 0
    assert len(meshes) == len(visuals) == 1, where
    triangles = load_stl(f"{folder}/{meshes[0]}")
    chosen = np.concatenate([np.flatnonzero(depth > 1e-3)[:200], np.flatnonzero(depth <= 1e-3)[::20]])
    assert max((distance_to_triangles(point, triangles) for point in points[chosen]), default=0) < 2e-4, where
    return (depth > 1e-3).sum()


def outside_of(parts, points):
    """How far points lie outside of the union of boxes, cylinders and balls; below 0 within."""
    nearest = np.full(len(points), np.inf)
    for part in parts:
        turn, place = pose_of(part)
        local = (points - place) @ turn
        if part.find("geometry/sphere") is not None:
            outside = np.linalg.norm(local, axis=1) - float(part.findtext("geometry/sphere/radius"))
        elif part.find("geometry/box") is not None:
            beyond = np.abs(local) - np.array(part.findtext("geometry/box/size").split(), float) / 2
            outside = np.linalg.norm(np.maximum(beyond, 0), axis=1) + np.minimum(beyond.max(axis=1), 0)
        else:
            beside = np.hypot(local[:, 0], local[:, 1]) - float(part.findtext("geometry/cylinder/radius"))
            beyond = np.abs(local[:, 2]) - float(part.findtext("geometry/cylinder/length")) / 2
            outside = np.hypot(np.maximum(beside, 0), np.maximum(beyond, 0)) + np.minimum(np.maximum(beside, beyond), 0)
        nearest = np.minimum(nearest, outside)
    return nearest


def check_tube(model, tube, where):
    assert not [path for path in TUBE if model.find(path) is None], where
    turn, place = pose_of(model)
    nodes = np.array(tube["nodes_in_world"])
    cylinders = [part for part in model.findall("link/collision") if part.find("geometry/cylinder") is not None]
    spheres = [part for part in model.findall("link/collision") if part.find("geometry/sphere") is not None]
    assert len(cylinders) == len(tube["cylinders"]), where
    for part, cylinder in zip(cylinders, tube["cylinders"]):
        part_turn, part_place = pose_of(part)
        half = part_turn @ [0, 0, float(part.findtext("geometry/cylinder/length")) / 2]
        ends = np.array([part_place - half, part_place + half]) @ turn.T + place
        assert np.allclose(ends, nodes[[cylinder["node_a"], cylinder["node_b"]]], atol=1e-7), where
    shared = [node for i, node in enumerate(nodes)
              if sum(i in (c["node_a"], c["node_b"]) for c in tube["cylinders"]) != 1]
    centers = np.array([pose_of(part)[1] for part in spheres]).reshape(-1, 3) @ turn.T + place
    assert np.allclose(centers, np.reshape(shared, (-1, 3)), atol=1e-7), where
    assert abs(float(model.findtext("link/inertial/mass")) - tube["mass"]) < 1e-6, where
