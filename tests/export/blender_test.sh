#!/usr/bin/env bash
# Opens an exported file in Blender: blender_test.sh CONTROLSPACE BLENDER. Without Blender it is
# skipped (status 77).
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
controlspace=$1
blender=$2
if ! command -v "$blender" >/dev/null; then
    echo "skipped: no Blender (tests/run --blender installs it)"
    exit 77
fi
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# The exact field of the sphere: 0.06 on it, growing by a quarter of the distance.
"$controlspace" export -o "$folder/sphere.vdb" --structures direct --h 0.03 --g-r 1.25 \
    --voxel 0.03125 --tolerance 0
"$controlspace" export -o "$folder/all.vdb" --voxel 0.1 --half \
    --grids density,h_min,h_max,h_mean,anisotropy,sizes,e1,metric_diag,metric_off,sources
"$controlspace" build ball:0.3,0.3,0.3,r=0.05,h=0.01 -o "$folder/tiles.vdb" \
    --domain -1 1 -1 1 -1 1 --within 1.2
"$controlspace" build ball:0.3,0.3,0.3,r=0.05,h=0.01 -o "$folder/bricks.vdb" \
    --structures openvdb-bricks --domain -1 1 -1 1 -1 1 --within 1.2
"$blender" -b --factory-startup --python-exit-code 1 --python "$here/blender_check.py" -- "$folder"
