"""What the checks of all export formats read: the data set's scenes, and files that several formats have."""
import json
import sys

import numpy as np


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


def published_name(name, folder, extension):
    group, case = name.rsplit("/", 1)
    return f"{group}/{folder}/{int(case)}{extension}"
