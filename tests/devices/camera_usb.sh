#!/bin/bash
# In the guest: a pair of emulated USB cameras that show the run in /out/lab. Argument: the folder of the built programs.
# The recording goes to /out/usb-cameras.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/checks.sh"
programs=$1
lab=/out/lab
export FORESIGHT_PICTURES=$lab
mkfifo /tmp/never && exec 9<>/tmp/never

check "pictures and faults" gtest "$programs/camera_test" 'UsbCameras.*'
echo 1 >/sys/module/uvcvideo/parameters/nodrop
check "damaged frames, where uvcvideo passes them on" gtest "$programs/camera_test" UsbCameras.DamagedFramesAreSeen

is_there() { grep -qx "$1" /sys/class/video4linux/*/device/../serial; }
# plug_in PORT SERIAL IMAGES: returns when its video device is there.
plug_in() {
  "$programs/usb_camera" "$1" "$2" "$3" <&9 >/dev/null &
  patience=60 eventually is_there "$2"
}
check "the left camera is plugged in" plug_in 0 left $lab/rgb
check "the right camera is plugged in" plug_in 1 right $lab/rgb_right
check "the pair is recorded as a run" exits 0 "$programs/foresight" record /out/usb-cameras --left serial:left \
  --right serial:right --camera $lab/camera.yaml --camera-right $lab/camera_right.yaml --scene $lab/scene.yaml \
  --pose 0 0 0 0 0 0 1 --format mjpeg --rate 10 --count 12
check "  with all images of both sides" recorded /out/usb-cameras
finish
