"""Reads the clouds of a data set and writes labelled ones, with numpy alone."""

import pathlib
import tarfile

import numpy as np


def scenes(dataset):
    """Name ("A10/007") and cloud (see read_pcd) of each scene of a data set, loose or packed."""
    for path in sorted(pathlib.Path(dataset).glob("[!.]*/**/cloud.pcd")):
        yield path.parent.relative_to(dataset).as_posix(), read_pcd(path.read_bytes())
    for pack in sorted(pathlib.Path(dataset).glob("packs/*.tar")):  # of generate_dataset --pack
        with tarfile.open(pack) as tar:
            for member in tar:
                if member.name.endswith(".cloud.pcd"):
                    yield member.name.removesuffix(".cloud.pcd"), read_pcd(tar.extractfile(member).read())


def read_pcd(data):
    """A PCD file's points as an array with the file's fields ("x", "label"), binary or compressed."""
    header, body = data.split(b"\nDATA ", 1)
    encoding, body = body.split(b"\n", 1)
    keys = dict(line.split(maxsplit=1) for line in header.decode().splitlines() if line[0] != "#")
    kinds = (kind.lower() + size for kind, size in zip(keys["TYPE"].split(), keys["SIZE"].split()))
    fields = np.dtype(list(zip(keys["FIELDS"].split(), kinds)))
    count = int(keys["POINTS"])
    if encoding == b"binary":
        return np.frombuffer(body, fields, count)
    if encoding != b"binary_compressed":
        raise ValueError(f"DATA {encoding.decode()}: expected binary or binary_compressed")
    compressed, size = np.frombuffer(body, "<u4", 2)
    columns = decompress_lzf(body[8 : 8 + compressed], size)  # one field after the other
    points, offset = np.empty(count, fields), 0
    for name in fields.names:
        points[name] = np.frombuffer(columns, fields[name], count, offset)
        offset += count * fields[name].itemsize
    return points


def decompress_lzf(data, size):
    """Undoes the LZF compression that PCD files have: runs of new bytes, and copies of earlier ones."""
    out, i = bytearray(), 0
    while len(out) < size:
        control, i = data[i], i + 1
        if control < 32:
            out += data[i : i + control + 1]
            i += control + 1
            continue
        length = (control >> 5) + 2
        if length == 9:
            length, i = length + data[i], i + 1
        start, i = len(out) - ((control & 31) << 8) - data[i] - 1, i + 1
        copy = out[start : start + length]
        out += (copy * (length // len(copy) + 1))[:length]  # it may reach into itself
    return bytes(out)


def write_labels(path, xyz, labels):
    """Writes the points (N x 3, metres) with their labels (0: no tube) as a PCD file."""
    points = np.rec.fromarrays([*xyz.T, labels], dtype=[("x", "<f4"), ("y", "<f4"), ("z", "<f4"), ("label", "<u4")])
    header = (
        "VERSION 0.7\nFIELDS x y z label\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n"
        f"WIDTH {len(points)}\nHEIGHT 1\nPOINTS {len(points)}\nDATA binary\n"
    )
    path = pathlib.Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(header.encode() + points.tobytes())
