#!/bin/bash
# Makes docs/images/lab.jpg: the lab from a fixed place, 3 s after the start. Needs ImageMagick.
set -euo pipefail
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
for tenth in $(seq 0 30); do
  echo "$((tenth / 10)).$((tenth % 10)) -1.02 -0.16 0.6 -0.612410 0.578097 -0.370143 0.392113"
done >"$folder/head.txt"
build/release/bin/foresight synth "$folder/run" --frames 4 --rate 1 --size 1200x760 --no-distortion \
  --head-path "$folder/head.txt" --no-truth
convert "$folder/run/rgb/000003.png" -quality 88 docs/images/lab.jpg
