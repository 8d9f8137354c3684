#!/usr/bin/env python3
"""Writes config/tub.stl, the bin of config/mesh_bin.yaml: a tub of one sheet, whose walls lean, whose edges are round all around,
and whose rim is flat. Usage: scripts/make_tub.py > config/tub.stl"""
import math
import struct
import sys

LENGTH, WIDTH, HEIGHT = 0.55, 0.37, 0.20  # metres, of the inner space at the floor and of the rim above it
DRAFT = math.radians(8.0)  # by which the walls lean outward
FILLET = 0.04  # metres, radius between the floor and the walls
RIM = 0.025  # metres, width
CORNER = 0.06  # metres, radius of the upright corners at the floor
CORNER_STEPS = FILLET_STEPS = 4


def ring(outward, z):
    """Points around the tub, so far outward (metres) of the inner space's outline."""
    points = []
    for corner in range(4):
        x = (LENGTH / 2 - CORNER) * (1, -1, -1, 1)[corner]
        y = (WIDTH / 2 - CORNER) * (1, 1, -1, -1)[corner]
        for step in range(CORNER_STEPS + 1):
            angle = math.pi / 2 * (corner + step / CORNER_STEPS)
            radius = CORNER + outward
            points.append((x + radius * math.cos(angle), y + radius * math.sin(angle), z))
    return points


def rings():
    """From the floor outward and up."""
    bend = math.pi / 2 - DRAFT
    start = -FILLET * math.tan(bend / 2)  # where the fillet begins so that the wall's plane meets the outline at the floor
    for step in range(FILLET_STEPS + 1):
        angle = bend * step / FILLET_STEPS
        yield ring(start + FILLET * math.sin(angle), FILLET * (1 - math.cos(angle)))
    wall_top = HEIGHT * math.tan(DRAFT)
    yield ring(wall_top, HEIGHT)
    yield ring(wall_top + RIM, HEIGHT)


def triangles():
    around = list(rings())
    for a, b in zip(around[0], around[0][1:] + around[0][:1]):
        yield (0.0, 0.0, 0.0), a, b
    for inner, outer in zip(around, around[1:]):
        for i, _ in enumerate(inner):
            j = (i + 1) % len(inner)
            yield inner[i], outer[i], outer[j]
            yield inner[i], outer[j], inner[j]


def main():
    faces = list(triangles())
    stl = b"tub".ljust(80) + struct.pack("<I", len(faces))
    for corners in faces:
        numbers = [1000.0 * number for corner in corners for number in corner]  # millimetres
        stl += struct.pack("<12fH", 0.0, 0.0, 0.0, *numbers, 0)
    sys.stdout.buffer.write(stl)


main()
