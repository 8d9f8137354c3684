"""What the pictures of the docs are drawn with: titles, rows of pictures, and tubes seen from above."""
import pathlib

import numpy as np
from PIL import Image, ImageDraw, ImageFont

ROOT = pathlib.Path(__file__).resolve().parents[1]
IMAGES = ROOT / "docs/images"
WHITE, GREY, INK = (255, 255, 255), (150, 150, 150), (40, 40, 40)


def font(size):
    for name in ("DejaVuSans.ttf", "LiberationSans-Regular.ttf"):
        try:
            return ImageFont.truetype(name, size)
        except OSError:
            pass
    return ImageFont.load_default()


def save(picture, name, colors=128):
    """As a PNG, of few colours where these keep it small."""
    path = IMAGES / name
    picture = picture.convert("RGB")
    (picture.quantize(colors, dither=Image.Dither.NONE) if colors else picture).save(path, optimize=True)
    print(f"{path.relative_to(ROOT)}: {path.stat().st_size // 1000} kB")


def beside(pictures, titles=None, columns=None, gap=10):
    """Pictures of one size in rows, each under its title."""
    columns = columns or len(pictures)
    rows = -(-len(pictures) // columns)
    width, height = pictures[0].size
    head = 24 if titles else 0
    sheet = Image.new("RGB", (columns * (width + gap) - gap, rows * (height + head + gap) - gap), WHITE)
    draw = ImageDraw.Draw(sheet)
    for i, picture in enumerate(pictures):
        x, y = i % columns * (width + gap), i // columns * (height + head + gap)
        sheet.paste(picture, (x, y + head))
        if titles:
            draw.text((x + 2, y + 3), titles[i], INK, font(15))
    return sheet


def surface(start, end, radius, step=0.0004):
    """Points (metres) on a cylinder's side and on the joint sphere at its end, with their normals."""
    axis = end - start
    length = np.linalg.norm(axis)
    axis = axis / length
    side = np.cross(axis, [0.0, 0.0, 1.0] if abs(axis[2]) < 0.9 else [1.0, 0.0, 0.0])
    side /= np.linalg.norm(side)
    other = np.cross(axis, side)
    angle = np.arange(0.0, 2 * np.pi, step / radius)
    ring = np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * other
    along = np.arange(0.0, length, step)
    points = (start + along[:, None] * axis)[:, None] + radius * ring[None]
    return points.reshape(-1, 3), np.broadcast_to(ring, points.shape).reshape(-1, 3)


def ball(center, radius, step=0.0004):
    count = int(4 * np.pi * (radius / step) ** 2)
    i = np.arange(count) + 0.5  # Fibonacci's spiral
    z, angle = 1 - 2 * i / count, np.pi * (1 + 5**0.5) * i
    normals = np.stack([np.cos(angle) * np.sqrt(1 - z * z), np.sin(angle) * np.sqrt(1 - z * z), z], axis=1)
    return center + radius * normals, normals


class TopView:
    """A picture of a part of the bin, seen straight from above; what is higher covers what is lower."""

    def __init__(self, x, y, width):
        self.x, self.y = x, y  # ranges, metres
        self.scale = width / (x[1] - x[0])
        self.size = (width, round((y[1] - y[0]) * self.scale))
        self.image = np.full((self.size[1], self.size[0], 3), 255, np.uint8)
        self.height = np.full((self.size[1], self.size[0]), -np.inf)

    def pixels(self, points):
        return np.stack([(points[:, 0] - self.x[0]) * self.scale, (self.y[1] - points[:, 1]) * self.scale], axis=1)

    def splat(self, points, colors, size=1):
        order = np.argsort(points[:, 2], kind="stable")
        points, colors = points[order], np.broadcast_to(colors, (len(points), 3))[order]
        column, row = np.floor(self.pixels(points)).astype(int).T
        for dx in range(size):
            for dy in range(size):
                u, v = column + dx - size // 2, row + dy - size // 2
                inside = (u >= 0) & (v >= 0) & (u < self.size[0]) & (v < self.size[1])
                u, v, z, c = u[inside], v[inside], points[inside, 2], colors[inside]
                seen = z >= self.height[v, u]
                self.image[v[seen], u[seen]] = c[seen]
                self.height[v[seen], u[seen]] = z[seen]

    def solid(self, points, normals, color):
        light = 0.45 + 0.55 * np.clip(normals @ np.array([-0.35, 0.35, 0.87]), 0, 1)
        self.splat(points, np.clip(np.outer(light, color), 0, 255).astype(np.uint8), 2)

    def cylinder(self, start, end, radius, color, joint=True):
        start, end = np.array(start), np.array(end)
        self.solid(*surface(start, end, radius), color)
        if joint:
            self.solid(*ball(start, radius), color)

    def picture(self):
        return Image.fromarray(self.image)


def pale(color, share=0.6):
    return tuple(round(share * 255 + (1 - share) * c) for c in color)


def fit(picture, size):
    """The picture, as large as fits, in the middle of a white one of the size."""
    picture = picture.copy()
    box = Image.fromarray((np.array(picture).min(axis=2) < 222).astype(np.uint8)).getbbox()  # what is not pale
    picture = picture.crop(box) if box else picture
    picture.thumbnail(size, Image.Resampling.LANCZOS)
    sheet = Image.new("RGB", size, WHITE)
    sheet.paste(picture, ((size[0] - picture.width) // 2, (size[1] - picture.height) // 2))
    return sheet
