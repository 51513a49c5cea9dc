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


def volume_material():
    material = bpy.data.materials.new("cut")
    material.use_nodes = True
    nodes, link = material.node_tree.nodes, material.node_tree.links.new
    nodes.clear()
    out = nodes.new("ShaderNodeOutputMaterial")
    attribute = nodes.new("ShaderNodeAttribute")
    attribute.attribute_name = "h_min"
    logarithm = nodes.new("ShaderNodeMath")
    logarithm.operation = "LOGARITHM"
    logarithm.inputs[1].default_value = math.e
    scale = nodes.new("ShaderNodeMapRange")
    scale.inputs["From Min"].default_value = math.log(COARSEST)
    scale.inputs["From Max"].default_value = math.log(FINEST)
    ramp = nodes.new("ShaderNodeValToRGB")
    elements = ramp.color_ramp.elements
    while len(elements) < len(RAMP):
        elements.new(0.5)
    for element, (position, colour) in zip(elements, RAMP):
        element.position = position
        element.color = (*colour, 1)
    place = nodes.new("ShaderNodeTexCoord")
    split = nodes.new("ShaderNodeSeparateXYZ")
    behind = nodes.new("ShaderNodeMath")
    behind.operation = "GREATER_THAN"
    behind.inputs[1].default_value = 0
    ratio = nodes.new("ShaderNodeAttribute")
    ratio.attribute_name = "anisotropy"
    inside = nodes.new("ShaderNodeMath")
    inside.operation = "GREATER_THAN"
    inside.inputs[1].default_value = 0.99
    shown = nodes.new("ShaderNodeMath")
    shown.operation = "MULTIPLY"
    opacity = nodes.new("ShaderNodeMath")
    opacity.operation = "MULTIPLY"
    opacity.inputs[1].default_value = OPACITY
    emission = nodes.new("ShaderNodeEmission")
    absorption = nodes.new("ShaderNodeVolumeAbsorption")
    absorption.inputs["Color"].default_value = (0, 0, 0, 1)
    both = nodes.new("ShaderNodeAddShader")
    link(attribute.outputs["Fac"], logarithm.inputs[0])
    link(logarithm.outputs[0], scale.inputs["Value"])
    link(scale.outputs[0], ramp.inputs["Fac"])
    link(place.outputs["Object"], split.inputs["Vector"])
    link(split.outputs["Y"], behind.inputs[0])
    link(ratio.outputs["Fac"], inside.inputs[0])
    link(behind.outputs[0], shown.inputs[0])
    link(inside.outputs[0], shown.inputs[1])
    link(shown.outputs[0], opacity.inputs[0])
    link(ramp.outputs["Color"], emission.inputs["Color"])
    link(opacity.outputs[0], emission.inputs["Strength"])
    link(opacity.outputs[0], absorption.inputs["Density"])
    link(emission.outputs[0], both.inputs[0])
    link(absorption.outputs[0], both.inputs[1])
    link(both.outputs[0], out.inputs["Volume"])
    return material


def text_material():
    material = bpy.data.materials.new("text")
    material.use_nodes = True
    nodes = material.node_tree.nodes
    nodes.clear()
    emission = nodes.new("ShaderNodeEmission")
    emission.inputs["Color"].default_value = (0.02, 0.02, 0.02, 1)
    out = nodes.new("ShaderNodeOutputMaterial")
    material.node_tree.links.new(emission.outputs[0], out.inputs["Surface"])
    return material


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
    cut, ink = volume_material(), text_material()
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
