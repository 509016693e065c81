#!/bin/bash
# Makes docs/images/shadows.jpg: a view 500 ms after its newest image, with that image's shadow and with the one that
# falls then, what the camera saw then, and how far both views are off (four times, grey: not at all).
set -euo pipefail
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
foresight=build/release/bin/foresight
name=000046
"$foresight" synth "$folder/run" --frames 48 --rate 8 --size 640x480 --no-distortion --no-truth
"$foresight" replay "$folder/run" --delay-ms 500 --no-shadows --out "$folder/before"
"$foresight" replay "$folder/run" --delay-ms 500 --out "$folder/after"
ffmpeg -loglevel error -y -i "$folder/before/predicted/$name.png" -i "$folder/after/predicted/$name.png" \
  -i "$folder/run/rgb/$name.png" -filter_complex "
  [0]format=rgb24,split=2[b1][b2]; [1]format=rgb24,split=2[a1][a2]; [2]format=rgb24,split=3[t1][t2][t3];
  [b2][t2]blend=all_expr='128+4*(A-B)'[be]; [a2][t3]blend=all_expr='128+4*(A-B)'[ae];
  [b1][a1][t1]hstack=3[top]; color=gray:640x480:d=1,format=rgb24[none];
  [be][ae][none]hstack=3:shortest=1[low]; [top][low]vstack,scale=1200:-1" -frames:v 1 -q:v 3 docs/images/shadows.jpg
