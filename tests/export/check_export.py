#!/usr/bin/env python3
"""Compare an export with the data set that it was made from, with nothing of this project's own code.

usage: check_export.py FORMAT DATASET EXPORT [PUBLISHED_WORLD...]
exit code: 0 they agree, 1 they don't (the first difference is named), 77 a package that the check needs is missing
"""
import json
import sys
import xml.etree.ElementTree as ElementTree

try:
    import numpy as np
except ImportError as error:
    print(error)
    sys.exit(77)


def need(name):
    """The module, or the end of the program where it is missing."""
    try:
        return __import__(name, fromlist=["_"])
    except ImportError as error:
        print(error)
        sys.exit(77)


class Scene:
    def __init__(self, folder):
        self.truth = json.load(open(f"{folder}/scene.json"))
        data = open(f"{folder}/cloud.pcd", "rb").read()
        body = data.split(b"DATA binary\n", 1)[1]
        points = np.frombuffer(body, [("xyz", "<f4", 3), ("rgb", "<u4"), ("label", "<u4")])
        window = self.truth["scanner"]["window"]
        self.window = [window[key] for key in ("x", "y", "width", "height")]
        self.shape = (window["height"], window["width"])
        self.xyz = points["xyz"].reshape(*self.shape, 3)
        self.rgb = points["rgb"].reshape(self.shape)
        self.label = points["label"].reshape(self.shape)
        self.seen = np.isfinite(self.xyz[..., 0])
        self.folder = folder

    def in_image(self, values, nothing=0):
        """A window's values in the full image."""
        x, y, width, height = self.window
        image = np.full((self.truth["scanner"]["height"], self.truth["scanner"]["width"]), nothing, values.dtype)
        image[y:y + height, x:x + width] = values
        return image

    def tube_image(self, k):
        return self.in_image(self.seen & (self.label == k)).astype(bool)


def scenes_of(dataset, export):
    for number, line in enumerate(json.load(open(f"{export}/index.json"))["scenes"], 1):
        yield number, line["scene"], Scene(f"{dataset}/{line['scene']}")


def box_of(mask):
    rows, columns = np.nonzero(mask)
    return [columns.min(), rows.min(), np.ptp(columns) + 1, np.ptp(rows) + 1] if rows.size else [-1] * 4


def image_of(path):
    return np.array(need("PIL.Image").open(path))


def by_number(path):
    """A JSON file whose keys are numbers."""
    return {int(key): value for key, value in json.load(open(path)).items()}


def load_ply(path):
    """Vertices, normals and triangles."""
    header, body = open(path, "rb").read().split(b"end_header\n", 1)
    vertices, faces = (int(header.split(b"element " + name)[1].split()[0]) for name in (b"vertex", b"face"))
    points = np.frombuffer(body, "<f4", 6 * vertices).reshape(-1, 6).astype(float)
    corners = np.frombuffer(body[24 * vertices:], [("count", "u1"), ("corners", "<i4", 3)], faces)
    assert (corners["count"] == 3).all() and corners["corners"].max() < vertices
    return {"pts": points[:, :3], "normals": points[:, 3:], "faces": corners["corners"]}


def check_bop(dataset, export, crop=""):
    kinds = []
    models_info = by_number(f"{export}/models/models_info.json")
    assert by_number(f"{export}/models_eval/models_info.json") == models_info
    targets = json.load(open(f"{export}/test_targets_bop19.json"))
    visible_enough, objects = [], set()
    for number, name, scene in scenes_of(dataset, export):
        folder = f"{export}/test/{number:06d}"
        camera = json.load(open(f"{folder}/scene_camera.json"))["0"]
        K, R = np.reshape(camera["cam_K"], (3, 3)), np.reshape(camera["cam_R_w2c"], (3, 3))
        depth = image_of(f"{folder}/depth/000000.png") * camera["depth_scale"]
        assert image_of(f"{folder}/rgb/000000.png").shape == (*depth.shape, 3)
        scanner = scene.truth["scanner"]
        middle = np.array([scanner["width"], scanner["height"]]) / 2  # of the full image, where the optical axis is
        x, y = (middle - K[:2, 2]).round().astype(int)
        height, width = depth.shape

        def cut(full):
            return full[y:y + height, x:x + width]

        assert (x > 0) == (depth.shape != (scanner["height"], scanner["width"])) == (crop == "crop"), name
        assert np.array_equal(depth > 0, cut(scene.in_image(scene.seen))), name
        rows, columns = np.nonzero(depth)
        xyz = cut(scene.in_image(scene.xyz[..., 0])), cut(scene.in_image(scene.xyz[..., 1])), cut(
            scene.in_image(scene.xyz[..., 2]))
        in_camera = 1000 * np.stack([c[rows, columns] for c in xyz], 1).astype(float) @ R.T + camera["cam_t_w2c"]
        image = in_camera @ K.T
        assert np.abs(image[:, :2] / image[:, 2:] - np.stack([columns, rows], 1) - 0.5).max() < 1e-3, name
        assert np.abs(in_camera[:, 2] - depth[rows, columns]).max() <= 0.501 * camera["depth_scale"], name
        poses = json.load(open(f"{folder}/scene_gt.json"))["0"]
        infos = json.load(open(f"{folder}/scene_gt_info.json"))["0"]
        assert len(poses) == len(infos) == len(scene.truth["tubes"])
        instances = {}
        for k, (pose, info, tube) in enumerate(zip(poses, infos, scene.truth["tubes"])):
            where = f"{name}, tube {k + 1}"
            kind = tube.get("kind", "tube")
            kinds += [kind] if kind not in kinds else []
            number_of_object = pose["obj_id"]
            assert (number_of_object - 1) // 1000000 == kinds.index(kind), where
            objects.add(number_of_object)
            whole = image_of(f"{folder}/mask/000000_{k:06d}.png") > 0
            visible = image_of(f"{folder}/mask_visib/000000_{k:06d}.png") > 0
            assert np.array_equal(visible, cut(scene.tube_image(k + 1))), where
            assert not (visible & ~whole).any(), where
            assert info["px_count_all"] == whole.sum() and info["px_count_visib"] == visible.sum(), where
            if not crop:
                assert info["px_count_all"] == tube["amodal_pixels"], where
                assert info["px_count_visib"] == tube["visible_pixels"], where
                assert abs(info["visib_fract"] - tube["visible_fraction"]) < 1e-12, where
            assert info["px_count_valid"] == (whole & (depth > 0)).sum(), where
            assert info["bbox_obj"] == box_of(whole) and info["bbox_visib"] == box_of(visible), where
            if info["visib_fract"] >= 0.1:
                instances[number_of_object] = instances.get(number_of_object, 0) + 1
            path = f"models/obj_{number_of_object:06d}.ply"
            assert open(f"{export}/{path}", "rb").read() == open(f"{export}/models_eval{path[6:]}", "rb").read()
            model = load_ply(f"{export}/{path}")
            check_model(model, models_info[number_of_object], pose, K, whole, where)
            points = 1000 * scene.xyz[scene.seen & (scene.label == k + 1)].astype(float) @ R.T + camera["cam_t_w2c"]
            points = (points - pose["cam_t_m2c"]) @ np.reshape(pose["cam_R_m2c"], (3, 3))
            off = [distance_to_triangles(point, model["pts"][model["faces"]]) for point in points[::20]]
            assert max(off, default=0) < 0.25, (where, "mm between a scanned point and the mesh", max(off))
            check_symmetries(model["pts"], models_info[number_of_object], tube, where)
        visible_enough += [{"im_id": 0, "inst_count": count, "obj_id": number_of_object, "scene_id": number}
                           for number_of_object, count in sorted(instances.items())]
    assert set(models_info) == objects
    assert targets == visible_enough
    sensor = json.load(open(f"{export}/camera.json"))
    assert [sensor["width"], sensor["height"]] == [width, height]
    assert [sensor["fx"], sensor["fy"], sensor["cx"], sensor["cy"]] == [K[0, 0], K[1, 1], K[0, 2], K[1, 2]]


def check_symmetries(points, info, tube, where):
    """Every symmetry takes the axes of the tube's cylinders, or the ball's centre, to themselves."""
    nodes = 1000 * np.array(tube["nodes"], float).reshape(-1, 3)
    ends = np.array([(c["node_a"], c["node_b"]) for c in tube["cylinders"]], int).reshape(-1, 2)
    straight = len(nodes) > 1 and np.linalg.matrix_rank(nodes - nodes[0], tol=1e-3) == 1
    ring = len(nodes) > 2 and (np.bincount(ends.ravel(), minlength=len(nodes)) == 2).all()
    continuous, discrete = info.get("symmetries_continuous", []), info.get("symmetries_discrete", [])
    assert [len(continuous), len(discrete)] == ([3, 0] if len(nodes) == 1 else [1, 1] if straight or ring else [0, 0]), where
    motions = [(np.reshape(motion, (4, 4))[:3, :3], np.reshape(motion, (4, 4))[:3, 3]) for motion in discrete]
    for symmetry in continuous:
        axis, offset = np.array(symmetry["axis"]), np.array(symmetry["offset"])
        assert abs(np.linalg.norm(axis) - 1) < 1e-9, where
        for angle in (0.3, 1.0, 2.5):
            cross = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
            turn = np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
            motions.append((turn, offset - turn @ offset))
    sagitta = 0.0
    if ring:
        radius = np.linalg.norm(nodes[0] - nodes.mean(0))
        sagitta = radius * (1 - np.cos(np.pi / len(nodes)))
    for turn, shift in motions:
        for node in nodes @ turn.T + shift:
            assert distance_to_axes(node, nodes, ends) <= sagitta + 1e-3, where


def distance_to_axes(point, nodes, ends):
    if not len(ends):
        return np.linalg.norm(nodes - point, axis=1).min()
    a, b = nodes[ends[:, 0]], nodes[ends[:, 1]]
    along = np.clip(((point - a) * (b - a)).sum(1) / ((b - a) ** 2).sum(1), 0, 1)[:, None]
    return np.linalg.norm(a + along * (b - a) - point, axis=1).min()


def check_model(model, info, pose, K, whole, where):
    points = model["pts"]
    assert np.allclose(points.min(0), [info[f"min_{axis}"] for axis in "xyz"], atol=1e-3), where
    assert np.allclose(np.ptp(points, 0), [info[f"size_{axis}"] for axis in "xyz"], atol=1e-3), where
    outer = points[need("scipy.spatial").ConvexHull(points).vertices]
    diameter = max(np.sqrt(((outer - point) ** 2).sum(1).max()) for point in outer)
    assert abs(diameter - info["diameter"]) < 1e-2, where
    assert np.allclose(np.linalg.norm(model["normals"], axis=1), 1, atol=1e-5), where
    image = (points @ np.reshape(pose["cam_R_m2c"], (3, 3)).T + pose["cam_t_m2c"]) @ K.T
    pixels = image[:, :2] / image[:, 2:]
    x, y, width, height = box_of(whole)
    is_cut = x == 0 or y == 0 or x + width == whole.shape[1] or y + height == whole.shape[0]
    if not is_cut:  # the mesh reaches all around the silhouette's pixels, and beyond them by tips thinner than a pixel
        beyond = np.concatenate([[x, y] - pixels.min(0) + 0.5, pixels.max(0) - [x + width - 0.5, y + height - 0.5]])
        assert beyond.min() > -0.05 and beyond.max() < 2.0, (where, beyond)


def check_coco(dataset, export):
    """Through pycocotools."""
    coco = need("pycocotools.coco").COCO(f"{export}/annotations.json")
    categories = {category["id"]: category["name"] for category in coco.loadCats(coco.getCatIds())}
    for number, name, scene in scenes_of(dataset, export):
        image = coco.loadImgs([number])[0]
        assert image["scene"] == name and open(f"{export}/{image['file_name']}", "rb").read(4) == b"\x89PNG"
        annotations = coco.loadAnns(coco.getAnnIds(imgIds=[number]))
        visible = [tube["label"] for tube in scene.truth["tubes"] if tube["visible_pixels"] > 0]
        assert [annotation["label"] for annotation in annotations] == visible, name
        for annotation in annotations:
            where = f"{name}, tube {annotation['label']}"
            tube = scene.truth["tubes"][annotation["label"] - 1]
            assert categories[annotation["category_id"]] == tube.get("kind", "tube"), where
            mask = coco.annToMask(annotation) == 1
            whole = coco.annToMask({**annotation, "segmentation": annotation["amodal_segmentation"]}) == 1
            assert np.array_equal(mask, scene.tube_image(annotation["label"])), where
            assert annotation["area"] == mask.sum() == tube["visible_pixels"], where
            assert annotation["amodal_area"] == whole.sum() == tube["amodal_pixels"], where
            assert annotation["bbox"] == box_of(mask) and annotation["amodal_bbox"] == box_of(whole), where
            assert not (mask & ~whole).any(), where
    ids = coco.getAnnIds()
    assert len(set(ids)) == len(ids) == len(coco.dataset["annotations"])


def check_npz(dataset, export):
    for _, name, scene in scenes_of(dataset, export):
        arrays = np.load(f"{export}/{name}.npz")
        assert arrays.zip.testzip() is None
        truth, tubes = scene.truth, scene.truth["tubes"]
        assert np.array_equal(arrays["points"], scene.xyz, equal_nan=True), name
        assert np.array_equal(arrays["labels"], np.where(scene.seen, scene.label.astype(int), -1)), name
        assert arrays["window"].tolist() == scene.window
        assert arrays["image_size"].tolist() == [truth["scanner"]["width"], truth["scanner"]["height"]]
        pose = np.array(truth["scanner"]["pose"]["rotation"])
        assert np.array_equal(arrays["world_from_scanner"][:3, :3], pose)
        in_scanner = (scene.xyz[scene.seen] - arrays["world_from_scanner"][:3, 3]) @ arrays["world_from_scanner"][:3, :3]
        image = in_scanner @ arrays["intrinsics"].T
        rows, columns = np.nonzero(scene.seen)
        expected = np.stack([columns + scene.window[0] + 0.5, rows + scene.window[1] + 0.5], 1)
        assert np.abs(image[:, :2] / image[:, 2:] - expected).max() < 1e-3, name
        nodes = [node for tube in tubes for node in tube["nodes_in_world"]]
        assert np.allclose(arrays["nodes"], np.reshape(nodes, (-1, 3)), atol=1e-12)
        assert arrays["kind"].astype(str).tolist() == [t.get("kind", "tube") for t in tubes]
        if "normals" in arrays:
            check_normals(arrays, scene, name)
        assert arrays["tube_of_node"].tolist() == [t["label"] for t in tubes for _ in t["nodes"]]
        lengths = np.linalg.norm(arrays["nodes"][arrays["cylinders"][:, 0]] - arrays["nodes"][arrays["cylinders"][:, 1]], axis=1)
        assert abs(lengths.sum() - sum(tube["length"] for tube in tubes)) < 1e-9
        for k, tube in enumerate(tubes):
            assert np.array_equal(arrays["world_from_tube"][k, :3, :3], tube["pose"]["rotation"])
            assert np.array_equal(arrays["world_from_tube"][k, :3, 3], tube["pose"]["position"])
            assert arrays["radius"][k] == tube["radius"]
            assert arrays["visible_pixels"][k] == tube["visible_pixels"]
            assert arrays["amodal_pixels"][k] == tube["amodal_pixels"]


def check_normals(arrays, scene, where):
    """Unit vectors that look at the scanner, up on the bin's floor."""
    normals = arrays["normals"][scene.seen].astype(float)
    assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-5), where
    points = scene.xyz[scene.seen].astype(float)
    towards = scene.truth["scanner"]["position"] - points
    assert ((normals * towards).sum(1) > -1e-6).all(), where
    on_floor = (scene.label[scene.seen] == 0) & (np.abs(points[:, 2]) < 1e-6)
    assert on_floor.any() and np.allclose(normals[on_floor], [0, 0, 1]), where
    assert np.isnan(arrays["normals"][~scene.seen]).all(), where


def published_name(name, folder, extension):
    group, case = name.rsplit("/", 1)
    return f"{group}/{folder}/{int(case)}{extension}"


def check_ply(dataset, export):
    for _, name, scene in scenes_of(dataset, export):
        data = open(f"{export}/{published_name(name, 'plys', '.ply')}", "rb").read()
        header, body = data.split(b"end_header\n", 1)
        assert b"format binary_little_endian 1.0" in header
        count = int(header.split(b"element vertex ")[1].split()[0])
        points = np.frombuffer(body, [("xyz", "<f4", 3), ("rgb", "u1", 3), ("label", "<i4")], count)
        of_tubes = scene.seen & (scene.label > 0)
        assert np.array_equal(points["xyz"], scene.xyz[of_tubes]), name
        assert np.array_equal(points["label"], scene.label[of_tubes]), name
        rgb = points["rgb"].astype(int) @ [65536, 256, 1]
        assert np.array_equal(rgb, scene.rgb[of_tubes] & 0xFFFFFF), name
        text = open(f"{export}/{published_name(name, 'tube_configurations', '.txt')}").read()
        assert text == open(f"{scene.folder}/tubes.txt").read(), name


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


def check_sdf(dataset, export, *published_worlds):
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
            check_sdf_tube(model, tube, where)
            pipes |= tube["wall_thickness"] > 0
            in_bores += check_sdf_looks(model, scene.xyz[scene.seen & (scene.label == tube["label"])], folder, where)
    assert in_bores > 0 or not pipes, "no point of the scans lies in a bore"


def check_sdf_looks(model, points, folder, where):
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


def check_sdf_tube(model, tube, where):
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


if __name__ == "__main__":
    checks = {"bop": check_bop, "coco": check_coco, "npz": check_npz, "ply": check_ply, "sdf": check_sdf}
    checks[sys.argv[1]](*sys.argv[2:])
