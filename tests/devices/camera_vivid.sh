#!/bin/bash
# In the guest: the kernel's test driver as a stereo pair: formats, faults, a recording, and an unplug. Argument: the
# folder of the built programs. /out/lab has the calibration of two cameras; the recording goes to /out/vivid.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/checks.sh"
programs=$1
lab=/out/lab

check "frames, formats, every fault and pairs" gtest "$programs/camera_test" 'Vivid.*-*.ZUnplugged'
# At 60 Hz, whatever their phases are, the two are less than the tolerance of pairs apart.
check "the pair is recorded as a run" exits 0 "$programs/foresight" record /out/vivid \
  --left bus:platform:vivid-000 --right bus:platform:vivid-001 --camera $lab/camera.yaml \
  --camera-right $lab/camera_right.yaml --scene $lab/scene.yaml --pose 0 0 0 0 0 0 1 --rate 60 --count 12
check "  with all images of both sides" recorded /out/vivid
check "a camera that goes is lost, the other one goes on, and it returns" gtest "$programs/camera_test" 'Vivid.ZUnplugged'
finish
