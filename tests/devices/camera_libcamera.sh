#!/bin/bash
# In the guest: the emulated USB cameras of camera_usb.sh, through libcamera. Argument: the folder of the built programs.
# /out/lab is the run that they show; the recording goes to /out/libcamera.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/checks.sh"
programs=$1
lab=/out/lab
export FORESIGHT_PICTURES=$lab LIBCAMERA_LOG_LEVELS='*:ERROR'
mkfifo /tmp/never && exec 9<>/tmp/never

# name_the_controller: libcamera names a USB camera after the firmware's node (ACPI) of the controller above it. The
# emulated one has none, and sysfs takes no new files: so /sys/devices/platform becomes a folder in memory, with all that
# it had, and a node.
name_the_controller() {
  local real=/sys/devices/platform kept=/run/platform device
  mkdir -p $kept
  mount --bind $real $kept && mount -t tmpfs platform $real || return 1
  for device in "$kept"/*/; do
    device=$(basename "$device")
    mkdir $real/"$device" && mount --bind "$kept/$device" "$real/$device" || return 1
  done
  mkdir $real/firmware_node && echo '\_SB_.VHCI' >$real/firmware_node/path
}

# start_udevd: libcamera looks for cameras in its data base, and hears of new ones from it. Of its rules only those that
# name nodes: all of them take 6 s.
start_udevd() {
  mount -t tmpfs rules /etc/udev && mkdir /etc/udev/rules.d || return 1
  cp /lib/udev/rules.d/{50-udev-default,60-persistent-v4l}.rules /etc/udev/rules.d
  mount -t tmpfs rules /lib/udev/rules.d
  /lib/systemd/systemd-udevd --daemon >/dev/null 2>&1 && udevadm settle -t 20
}

check "the controller has a firmware node" name_the_controller
check "udevd runs" start_udevd
check "pictures, pairs, a hang, unplug with and without word of it, return" gtest "$programs/camera_test" 'LibcameraUsb.*'

ids() { "$programs/foresight" doctor | tee /tmp/doctor.log | sed -n 's/^ok .* libcamera  *\(.*\) (.*)$/\1/p' | sort; }
both_are_listed() {
  mapfile -t id < <(ids)
  [ ${#id[@]} = 2 ]
}
plug_in() { "$programs/usb_camera" "$1" "$2" "$3" <&9 >/dev/null & }
is_there() { grep -qx "$1" /sys/class/video4linux/*/device/../serial; }
plug_in 0 left $lab/rgb
patience=60 eventually is_there left
plug_in 1 right $lab/rgb_right
patience=60 eventually is_there right
udevadm settle -t 20
check "foresight doctor shows both" both_are_listed
sed -n 's/^.* libcamera /      /p' /tmp/doctor.log
check "the pair is recorded as a run" exits 0 "$programs/foresight" record /out/libcamera --left "libcamera:${id[0]:-}" \
  --right "libcamera:${id[1]:-}" --camera $lab/camera.yaml --camera-right $lab/camera_right.yaml \
  --scene $lab/scene.yaml --pose 0 0 0 0 0 0 1 --format mjpeg --rate 30 --count 12
check "  with all images of both sides" recorded /out/libcamera
finish
