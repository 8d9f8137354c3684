"""Compare an export in the COCO format with its data set."""
import numpy as np

from exported_scenes import box_of, need, scenes_of


def check(dataset, export):
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
