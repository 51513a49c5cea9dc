# SPDX-License-Identifier: Apache-2.0
"""Renders volumes side by side, each cut open: blender -b --factory-startup --python THIS -- OUT FILE...

h_min of each .vdb colours its cut, on one logarithmic scale for all; anisotropy, 0 outside the
domain, says where there is a field; the name of a file stands below it.
"""
import math
import os
import sys

import bpy

WIDTH, HEIGHT, SAMPLES = 960, 350, 8
SPACING = 2.45  # between volumes of edge 2
OPACITY = 150.0  # per unit of length: a hundredth of the edge hides what is behind
COARSEST, FINEST = 0.4, 0.03  # lengths at the ends of the scale

# From coarsest to finest: dark violet to yellow, evenly spaced in lightness.
RAMP = [(0.0, (0.05, 0.01, 0.16)), (0.3, (0.25, 0.02, 0.27)), (0.55, (0.65, 0.10, 0.17)),
        (0.8, (0.95, 0.36, 0.03)), (1.0, (0.97, 0.90, 0.30))]


# Nodes of a material: {name: (type, {attribute: value}, {input: value})}, and links from outputs to
# inputs. The cut: a colour by the logarithm of h_min, where y > 0 and there is a field.
CUT = {
    "h_min": ("Attribute", {"attribute_name": "h_min"}, {}),
    "log": ("Math", {"operation": "LOGARITHM"}, {1: math.e}),
    "scale": ("MapRange", {}, {"From Min": math.log(COARSEST), "From Max": math.log(FINEST)}),
    "ramp": ("ValToRGB", {}, {}),
    "place": ("TexCoord", {}, {}),
    "split": ("SeparateXYZ", {}, {}),
    "behind": ("Math", {"operation": "GREATER_THAN"}, {1: 0}),
    "ratio": ("Attribute", {"attribute_name": "anisotropy"}, {}),
    "inside": ("Math", {"operation": "GREATER_THAN"}, {1: 0.99}),
    "shown": ("Math", {"operation": "MULTIPLY"}, {}),
    "opacity": ("Math", {"operation": "MULTIPLY"}, {1: OPACITY}),
    "emission": ("Emission", {}, {}),
    "absorption": ("VolumeAbsorption", {}, {"Color": (0, 0, 0, 1)}),
    "both": ("AddShader", {}, {}),
    "out": ("OutputMaterial", {}, {})}
CUT_LINKS = [
    ("h_min", "Fac", "log", 0), ("log", 0, "scale", "Value"), ("scale", 0, "ramp", "Fac"),
    ("place", "Object", "split", "Vector"), ("split", "Y", "behind", 0), ("ratio", "Fac", "inside", 0),
    ("behind", 0, "shown", 0), ("inside", 0, "shown", 1), ("shown", 0, "opacity", 0),
    ("ramp", "Color", "emission", "Color"), ("opacity", 0, "emission", "Strength"),
    ("opacity", 0, "absorption", "Density"), ("emission", 0, "both", 0), ("absorption", 0, "both", 1),
    ("both", 0, "out", "Volume")]
INK = {"emission": ("Emission", {}, {"Color": (0.02, 0.02, 0.02, 1)}), "out": ("OutputMaterial", {}, {})}
INK_LINKS = [("emission", 0, "out", "Surface")]


def material(nodes, links):
    made = bpy.data.materials.new("material")
    made.use_nodes = True
    tree = made.node_tree
    tree.nodes.clear()
    for name, (kind, attributes, inputs) in nodes.items():
        node = tree.nodes.new(f"ShaderNode{kind}")
        node.name = name
        for key, value in attributes.items():
            setattr(node, key, value)
        for key, value in inputs.items():
            node.inputs[key].default_value = value
    for source, output, target, place in links:
        tree.links.new(tree.nodes[source].outputs[output], tree.nodes[target].inputs[place])
    return made


def cut_material():
    made = material(CUT, CUT_LINKS)
    elements = made.node_tree.nodes["ramp"].color_ramp.elements
    while len(elements) < len(RAMP):
        elements.new(0.5)
    for element, (position, colour) in zip(elements, RAMP):
        element.position = position
        element.color = (*colour, 1)
    return made


def add(file, x, cut, ink):
    bpy.ops.object.volume_import(filepath=os.path.abspath(file))
    volume = bpy.context.object
    volume.location = (x, 0, 0)
    volume.data.materials.append(cut)
    bpy.ops.object.text_add(location=(x, 0, -1.25), rotation=(math.pi / 2, 0, 0))
    text = bpy.context.object
    text.data.body = os.path.splitext(os.path.basename(file))[0]
    text.data.size = 0.2
    text.data.align_x = "CENTER"
    text.data.materials.append(ink)


def main(out, files):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    cut, ink = cut_material(), material(INK, INK_LINKS)
    for i, file in enumerate(files):
        add(file, SPACING * (i - (len(files) - 1) / 2), cut, ink)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = SPACING * len(files) + 0.1
    camera.location = (0, -10, -0.16)
    camera.rotation_euler = (math.pi / 2, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.world = bpy.data.worlds.new("white")
    scene.world.color = (1, 1, 1)
    scene.view_settings.view_transform = "Standard"
    scene.render.engine = "CYCLES"
    scene.cycles.samples = SAMPLES
    scene.cycles.use_denoising = False
    scene.cycles.volume_step_rate = 1
    scene.render.resolution_x, scene.render.resolution_y = WIDTH, HEIGHT
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.compression = 100
    scene.render.filepath = os.path.abspath(out)
    bpy.ops.render.render(write_still=True)


arguments = sys.argv[sys.argv.index("--") + 1:]
main(arguments[0], arguments[1:])
