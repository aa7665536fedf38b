"""What meshio makes of mesh files, for meshio_peer_test.cpp.

    meshio_peer.py read FILE...           prints for each: nodes of a tet, tets, points, volume
    meshio_peer.py write FILE FOLDER      writes what FILE holds in every format that meshio knows and Pliant reads
"""

import pathlib
import sys

import meshio
import numpy


def tets(mesh):
    return [block.data for block in mesh.cells if block.type in ("tetra", "tetra10")]


def volume(mesh):
    total = 0.0
    for block in tets(mesh):
        a, b, c, d = (mesh.points[block[:, k]] for k in range(4))
        total += numpy.einsum("ij,ij->i", numpy.cross(b - a, c - a), d - a).sum() / 6
    return total


def read(names):
    for name in names:
        mesh = meshio.read(name)
        blocks = tets(mesh)
        print(blocks[0].shape[1], sum(len(b) for b in blocks), len(mesh.points), repr(float(volume(mesh))))


def write(name, folder):
    mesh = meshio.read(name)
    folder = pathlib.Path(folder)
    linear = tets(mesh)[0].shape[1] == 4
    region = {"region": [numpy.concatenate([numpy.asarray(r).reshape(-1).astype("int32") for r in mesh.cell_data["region"]])]}
    points = mesh.points.astype(float)  # VTK's bytes run the other way
    plain = meshio.Mesh(points, [("tetra" if linear else "tetra10", tets(mesh)[0])], cell_data=region)
    for file, kind, options in (
        ("text.vtk", "vtk", {"binary": False}),
        ("binary.vtk", "vtk", {"binary": True}),
        ("ascii.vtu", "vtu", {"binary": False}),
        ("binary.vtu", "vtu", {"binary": True, "compression": None}),
        ("zlib.vtu", "vtu", {"binary": True, "compression": "zlib"}),
        ("deck.inp", "abaqus", {}),
    ):
        meshio.write(folder / file, plain, kind, **options)
    if linear:
        reference = region["region"][0] + 1
        marked = meshio.Mesh(plain.points, plain.cells, cell_data={"medit:ref": [reference]})
        meshio.write(folder / "text.mesh", marked, "medit")
        meshio.write(folder / "pair.node", plain, "tetgen")
    tags = region["region"][0].astype("int32") + 1
    tagged = meshio.Mesh(plain.points, plain.cells, cell_data={"gmsh:physical": [tags], "gmsh:geometrical": [tags]})
    meshio.write(folder / "text2.msh", tagged, "gmsh22", binary=False)
    meshio.write(folder / "binary2.msh", tagged, "gmsh22", binary=True)
    meshio.write(folder / "text4.msh", plain, "gmsh", binary=False)
    meshio.write(folder / "binary4.msh", plain, "gmsh", binary=True)


if __name__ == "__main__":
    if sys.argv[1] == "read":
        read(sys.argv[2:])
    else:
        write(*sys.argv[2:])
