"""Compare an export in the published data set's PLY and text files with its data set."""
import numpy as np

from exported_scenes import published_name, scenes_of


def check(dataset, export):
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
