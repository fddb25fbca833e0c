"""Reads cells of eight 32-bit floats and prints, for each, the components and the Euler characteristic
of the surface that scikit-image's marching cubes by Lewiner et al. give it."""

import sys

import numpy
from skimage.measure import marching_cubes


def topology(cell):
    vertices, faces, _, _ = marching_cubes(cell, 0, method="lewiner")
    faces = faces.tolist()
    root = list(range(len(vertices)))

    def find(vertex):
        while root[vertex] != vertex:
            vertex = root[vertex]
        return vertex

    edges = set()
    for face in faces:
        for a, b in zip(face, face[1:] + face[:1]):
            edges.add((min(a, b), max(a, b)))
            root[find(a)] = find(b)
    used = {vertex for face in faces for vertex in face}
    return len({find(vertex) for vertex in used}), len(used) - len(edges) + len(faces)


cells = numpy.fromfile(sys.argv[1], dtype=numpy.float32).reshape(-1, 2, 2, 2)
with open(sys.argv[2], "w") as out:
    for cell in cells:
        print(*topology(cell), file=out)
