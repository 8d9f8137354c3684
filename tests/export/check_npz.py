"""Compare an export as NPZ arrays with its data set."""
import numpy as np

from exported_scenes import scenes_of


def check(dataset, export):
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
