"""Depth images as real scanners have them, and over other ground: each takes depths (metres, of pixels), which of them are measured,
which are a tube's, the focal length (pixels) and a random generator, and returns depths and which are measured."""
import numpy as np
from scipy import ndimage


def smooth_noise(shape, pixels, random):
    """Noise of standard deviation 1 that neighbours so many pixels apart share."""
    noise = ndimage.gaussian_filter(random.normal(size=shape), pixels)
    return noise / noise.std()


def missing(depth, measured, tubes, focal, random):
    """Glare and dark paint: a twelfth of the picture has no data, in patches some ten pixels wide."""
    patches = smooth_noise(depth.shape, 4, random)
    return depth, measured & (patches < np.quantile(patches, 11 / 12))


def shadow(depth, measured, tubes, focal, random):
    """No data where a projector 0.3 m to the right of the camera gives no light: what is nearer, farther right in the same row,
    reaches as far to the left as the projector sees it."""
    seen = np.where(measured, np.arange(depth.shape[1]) - focal * 0.3 / np.where(measured, depth, 1.0), np.inf)
    nearest = np.minimum.accumulate(seen[:, ::-1], axis=1)[:, ::-1]
    return depth, measured & (seen < nearest + 1.0)


def dark(depth, measured, tubes, focal, random):
    """Dark or glossy tubes: they have no data where they are seen at more than 55 degrees, nor beside an edge."""
    height, width = depth.shape
    row, column = np.mgrid[:height, :width] + 0.5
    rays = np.stack([(column - width / 2) / focal, (row - height / 2) / focal, np.ones_like(depth)], -1)
    points = rays * np.where(measured, depth, np.nan)[..., None]
    normals = np.cross(np.gradient(points, axis=0), np.gradient(points, axis=1))
    lengths = np.linalg.norm(normals, axis=-1) * np.linalg.norm(rays, axis=-1)
    is_seen = np.abs((normals * rays).sum(-1)) > np.cos(np.radians(55)) * lengths  # false where a neighbour has no data
    return depth, measured & (is_seen | ~tubes)


def ripples(depth, measured, tubes, focal, random):
    """Noise of a fifth of the points' spacing that neighbours three pixels apart share, as patterns of light leave it."""
    return depth + 0.2 * depth / focal * smooth_noise(depth.shape, 3, random), measured


def noise(depth, measured, tubes, focal, random):
    """Normal noise of 1 mm, of each pixel by itself."""
    return depth + 0.001 * random.normal(size=depth.shape), measured


def smeared(depth, measured, tubes, focal, random):
    """Each pixel is a mean of what lies within half a pixel of it: points in the air along all edges."""
    known = ndimage.gaussian_filter(measured.astype(float), 0.5)
    return ndimage.gaussian_filter(np.where(measured, depth, 0.0), 0.5) / np.maximum(known, 1e-9), measured


def liner(depth, measured, tubes, focal, random):
    """A crumpled liner lies on all that is no tube: 2 mm up and down (one standard deviation), folds some twelve pixels wide."""
    return depth + np.where(tubes, 0.0, 0.002 * smooth_noise(depth.shape, 12, random)), measured


ARTEFACTS = {artefact.__name__: artefact for artefact in (missing, shadow, dark, ripples, noise, smeared, liner)}


def with_artefact(image, artefact, random):
    """The depth image, as field_table.py has it, with the artefact."""
    step, start = image['depth_step'], image['depth_of_0']
    depth, measured = start + image['depth'] * step, image['depth'] > 0
    focal = image['depth'].shape[1] / 2 / np.tan(image['hfov'] / 2)
    depth, measured = ARTEFACTS[artefact](depth, measured, image['label'] > 0, focal, random)
    depth = np.where(measured, np.round((depth - start) / step), 0)
    return {**image, 'depth': np.clip(depth, 0, np.iinfo(image['depth'].dtype).max).astype(image['depth'].dtype)}
