#!/bin/bash
# Makes docs/images/sharper-*.jpg: for each step of docs/sharper.md a part of a view without it, with it, and what the camera saw
# then; below, how far both views are off (four times, grey: not at all). Prints the figures of the table there.
set -euo pipefail
cd "$(dirname "$0")/../.."
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/views"
foresight=build/release/bin/foresight

# A head that goes to and fro, 30 cm in 1.2 s: t x y z qx qy qz qw.
awk 'BEGIN {
  for (t = 0; t < 8; t += 0.05)
    printf "%.2f %.4f %.4f %.4f -0.755043 0.610389 -0.150536 0.186211\n",
      t, -0.5 + 0.04 * sin(0.97 * t), 0.12 + 0.15 * sin(2.618 * t), 0.52 + 0.03 * sin(1.378 * t)
}' >"$folder/path.txt"

# render NAME OPTION...: a run.
render() {
  "$foresight" synth "$folder/$1" --size 480x360 --no-distortion --no-truth "${@:2}"
}

# replay RUN NAME OPTION...: its views, half a second after their newest images.
replay() {
  "$foresight" replay "$folder/$1" --delay-ms 500 --out "$folder/views/$2" "${@:3}" | grep -m1 dB
}

# step NAME RUN IMAGE X Y OLD NEW: the part of the view at X, Y of the replays OLD and NEW.
step() {
  local part=200:150:$4:$5
  ffmpeg -loglevel error -y -i "$folder/views/$6/predicted/$3.png" -i "$folder/views/$7/predicted/$3.png" -i "$folder/$2/rgb/$3.png" \
    -filter_complex "
    [0]format=rgb24,crop=$part,split=2[b1][b2]; [1]format=rgb24,crop=$part,split=2[a1][a2];
    [2]format=rgb24,crop=$part,split=3[t1][t2][t3];
    [b2][t2]blend=all_expr='clip(128+4*(A-B),0,255)'[be]; [a2][t3]blend=all_expr='clip(128+4*(A-B),0,255)'[ae];
    [b1][a1][t1]hstack=3[top]; color=gray:200x150:d=1,format=rgb24[none];
    [be][ae][none]hstack=3:shortest=1[low]; [top][low]vstack,scale=1200:-1:flags=neighbor" \
    -frames:v 1 -q:v 7 "docs/images/sharper-$1.jpg"
}

render lab --rate 8 --frames 32
replay lab lab
replay lab textures --no-projection
replay lab hard --no-silhouettes
step projection lab 000022 143 135 textures lab
step silhouettes lab 000010 280 10 hard lab

for drift in 0 0.6; do
  run=swaying-$drift
  render "$run" --rate 20 --frames 100 --still --head-path "$folder/path.txt" --gloss 0.03 --exposure-drift "$drift"
  echo "exposure drift $drift"
  replay "$run" "$run-both" --images 8
  replay "$run" "$run-newest"
  replay "$run" "$run-uneven" --images 8 --no-exposure
  replay "$run" "$run-neither" --no-exposure
done
step images swaying-0 000052 168 187 swaying-0-newest swaying-0-both
step exposure swaying-0.6 000079 52 85 swaying-0.6-uneven swaying-0.6-both
