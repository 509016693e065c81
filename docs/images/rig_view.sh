#!/bin/bash
# Makes docs/images/rig_view.jpg and, with a rig of a KUKA iiwa7 as its argument, rig_view_iiwa7.jpg.
set -euo pipefail
cd "$(dirname "$0")/../.."
view() { build/release/bin/foresight rig view "$1" --out "$2" --size 1180x760 --zoom "$3" --joints "$4"; }
view configs/minerva.yaml docs/images/rig_view.jpg 1 shoulder_pitch=0.5,elbow=0.9,wrist_pitch=0.6,finger=0.03
[ $# -eq 0 ] || view "$1" docs/images/rig_view_iiwa7.jpg 1 iiwa_joint_2=0.7,iiwa_joint_4=-1.2,iiwa_joint_6=0.7
