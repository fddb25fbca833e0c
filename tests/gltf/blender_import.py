# blender -b --factory-startup --python-exit-code 1 --python blender_import.py -- FILE.glb REPORT.json
#
# Fails unless Blender's importer finds every level of the file under its name, with the triangles and
# the vertices that the command's report tells of.
import json
import sys

import bpy
import numpy

# Debian 12's importer uses a name that its NumPy has no longer.
if not hasattr(numpy, "bool"):
    numpy.bool = bool

path, report_path = sys.argv[sys.argv.index("--") + 1 :]
with open(report_path, encoding="utf-8") as file:
    levels = json.load(file)["levels"]

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.import_scene.gltf(filepath=path)
found = {o.name: o.data for o in bpy.data.objects if o.type == "MESH"}
print("found:", {name: len(mesh.polygons) for name, mesh in found.items()})
assert len(found) == len(levels), f"{len(found)} meshes for {len(levels)} levels"
for level in levels:
    names = [name for name in found if name.endswith(f"_LOD{level['level']}")]
    assert len(names) == 1, f"level {level['level']}: {names}"
    mesh = found[names[0]]
    assert all(len(polygon.vertices) == 3 for polygon in mesh.polygons)
    assert len(mesh.polygons) == level["triangles"], (names[0], len(mesh.polygons))
    assert len(mesh.vertices) == level["written_vertices"], (names[0], len(mesh.vertices))
print("all levels agree")
