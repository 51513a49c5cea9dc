# SPDX-License-Identifier: Apache-2.0
"""Run in Blender by blender_test.sh: are its grids, places and values those that were exported?"""
import math
import os
import sys

import bpy

FLOATS = {"density", "h_min", "h_max", "h_mean", "anisotropy"}
VECTORS = {"sizes", "e1", "metric_diag", "metric_off"}


def check(holds, what):
    if not holds:
        raise AssertionError(what)
    print("ok:", what)


def import_volume(path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.object.volume_import(filepath=path)
    volume = bpy.context.object
    check(volume.data.grids.load(), "%s is read" % os.path.basename(path))
    return volume


def check_grids(volume, voxel, floats, vectors, others):
    grids = {grid.name: grid for grid in volume.data.grids}
    check(set(grids) == floats | vectors | set(others), "grids: " + ", ".join(sorted(grids)))
    for name in floats:
        check((grids[name].data_type, grids[name].channels) == ("FLOAT", 1), name + " is a number")
    for name in vectors:
        check((grids[name].data_type, grids[name].channels) == ("VECTOR_FLOAT", 3),
              name + " is a vector")
    for name, data_type in others.items():
        check(grids[name].data_type == data_type, "%s is of type %s" % (name, data_type))
    matrix = grids["h_min"].matrix_object
    low = -1 + voxel / 2
    wanted = [[voxel, 0, 0, low], [0, voxel, 0, low], [0, 0, voxel, low], [0, 0, 0, 1]]
    check(all(abs(matrix[r][c] - wanted[r][c]) < 1e-6 for r in range(4) for c in range(4)),
          "the first voxel's centre lies half a voxel within [-1, 1]^3")
    # Blender counts whole leaves, of 8^3 voxels.
    edge = (8 * math.ceil(round(2 / voxel) / 8) - 1) * voxel
    check(all(abs(d - edge) < 1e-5 for d in volume.dimensions),
          "dimensions: from the first centre to the last one")


def isosurface(volume, grid, threshold):
    """Places where Blender finds `grid` to be `threshold`, off the faces of the domain."""
    mesh = bpy.data.meshes.new("isosurface")
    shape = bpy.data.objects.new("isosurface", mesh)
    bpy.context.scene.collection.objects.link(shape)
    modifier = shape.modifiers.new("isosurface", "VOLUME_TO_MESH")
    modifier.object = volume
    modifier.grid_name = grid
    modifier.threshold = threshold
    modifier.resolution_mode = "GRID"
    evaluated = shape.evaluated_get(bpy.context.evaluated_depsgraph_get())
    places = [v.co.copy() for v in evaluated.to_mesh().vertices]
    bpy.data.objects.remove(shape)
    return [p for p in places if max(abs(p.x), abs(p.y), abs(p.z)) < 0.95]


def check_values(volume, voxel):
    """h = 0.06 + 0.25 | r - 0.8 |, up to what the spacing of the sources adds."""
    for h in (0.1, 0.16):
        places = isosurface(volume, "h_min", h)
        radii = [p.length for p in places]
        distance = (h - 0.06) / 0.25
        error = max(min(abs(r - 0.8 - distance), abs(r - 0.8 + distance)) for r in radii)
        check(len(places) > 1000 and error < voxel,
              "h_min is %g at %d places whose radii are right within %.3f" %
              (h, len(places), error))


def attribute_material(name):
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    nodes, link = material.node_tree.nodes, material.node_tree.links.new
    nodes.clear()
    attribute = nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = name
    shader = nodes.new("ShaderNodeVolumePrincipled")
    shader.inputs["Density Attribute"].default_value = ""
    shader.inputs["Density"].default_value = 0
    shader.inputs["Emission Strength"].default_value = 1
    link(attribute.outputs["Fac"], shader.inputs["Emission Strength"])
    link(shader.outputs[0], nodes.new("ShaderNodeOutputMaterial").inputs["Volume"])
    return material


def check_picture(volume, material, path):
    """The volume must show, and nothing beside it."""
    scene = bpy.context.scene
    volume.data.materials.clear()
    volume.data.materials.append(material)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = 4
    camera.location = (0, 0, 5)
    scene.collection.objects.link(camera)
    scene.camera = camera
    light = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
    light.data.energy = 5
    scene.collection.objects.link(light)
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 4
    scene.cycles.use_denoising = False
    scene.cycles.volume_step_rate = 4
    size = 48
    scene.render.resolution_x = scene.render.resolution_y = size
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    check(os.path.getsize(path) > 0, os.path.basename(path) + " is rendered")
    picture = bpy.data.images.load(path)
    pixels = list(picture.pixels)
    grey = [sum(pixels[4 * i:4 * i + 3]) / 3 for i in range(size * size)]
    inside = [grey[y * size + x] for y in range(16, 32) for x in range(16, 32)]
    outside = [grey[y * size + x] for y in range(8) for x in range(size)]
    check(sum(inside) / len(inside) > sum(outside) / len(outside) + 0.05,
          "%s shows the volume" % os.path.basename(path))


def check_bricks(volume):
    """A grid a level, whose vertices lie on those of 4^3 cells in each part of the domain."""
    grids = {grid.name: grid for grid in volume.data.grids}
    check(len(grids) > 2 and all(name.startswith("length_") for name in grids),
          "grids of bricks: " + ", ".join(sorted(grids)))
    for name, grid in grids.items():
        edge = 2 / 4 / 2 ** int(name.removeprefix("length_"))
        wanted = [[edge, 0, 0, -1], [0, edge, 0, -1], [0, 0, edge, -1], [0, 0, 0, 1]]
        check(grid.data_type == "FLOAT" and
              all(abs(grid.matrix_object[r][c] - wanted[r][c]) < 1e-6
                  for r in range(4) for c in range(4)),
              "%s is of numbers, %g apart from the domain's low corner on" % (name, edge))


def main(folder):
    coarse = import_volume(os.path.join(folder, "all.vdb"))
    check_grids(coarse, 0.1, FLOATS, VECTORS, {"sources": "POINTS"})
    voxel = 0.03125
    volume = import_volume(os.path.join(folder, "sphere.vdb"))
    check_grids(volume, voxel, {"density", "h_min"}, set(), {})
    check_values(volume, voxel)
    untouched = bpy.data.materials.new("untouched")
    untouched.use_nodes = True
    nodes = untouched.node_tree.nodes
    nodes.clear()
    principled = nodes.new("ShaderNodeVolumePrincipled")  # looks for `density`, as it comes
    untouched.node_tree.links.new(principled.outputs[0],
                                  nodes.new("ShaderNodeOutputMaterial").inputs["Volume"])
    check_picture(volume, untouched, os.path.join(folder, "density.png"))
    check_picture(volume, attribute_material("h_min"), os.path.join(folder, "h_min.png"))
    tiles = import_volume(os.path.join(folder, "tiles.vdb"))
    check([grid.name for grid in tiles.data.grids] == ["length"], "tiles are lengths alone")
    edge = 2 - tiles.data.grids[0].matrix_object[0][0]
    check(edge > 1.9 and all(abs(d - edge) < 1e-5 for d in tiles.dimensions),
          "tiles fill the domain, from the first centre to the last one")
    check_picture(tiles, attribute_material("length"), os.path.join(folder, "tiles.png"))
    check_bricks(import_volume(os.path.join(folder, "bricks.vdb")))


main(sys.argv[sys.argv.index("--") + 1])
