"""Compare an export in the BOP format with its data set."""
import json

import numpy as np

from exported_meshes import distance_to_triangles, load_ply
from exported_scenes import box_of, by_number, image_of, need, scenes_of


def check(dataset, export, crop=""):
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
