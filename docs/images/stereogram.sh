#!/bin/bash
# Makes docs/images/stereogram_pattern.jpg, of the built-in lab as a synthetic run has it.
set -euo pipefail
cd "$(dirname "$0")/../.."
run=$(mktemp -d)
trap 'rm -rf "$run"' EXIT
build/release/bin/foresight synth "$run/lab" --frames 4 --size 320x240 >/dev/null
build/release/bin/foresight stereogram "$run/lab" --image 1 --size 720x448 --eye-distance 184 --cursor 360 224 \
  --pattern "$run/lab/$(sed -n 's/.* //p' "$run/lab/rgb.txt" | tail -1)" --out docs/images/stereogram_pattern.jpg
