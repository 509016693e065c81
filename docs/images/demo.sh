#!/bin/bash
# Makes docs/images/demo.jpg from what scripts/demo leaves: one instant, delayed, predicted and seen. Needs ImageMagick.
set -euo pipefail
cd "$(dirname "$0")/../.."
demo=build/demo
panel() { # TEXT IMAGE
  convert "$2" -alpha off -background white -resize 480x -gravity northwest -splice 0x26 \
    -pointsize 17 -annotate +2+4 "$1" miff:-
}
{
  panel "what arrives: 500 ms old" "$demo/lab/rgb/000033.png"
  panel "what Foresight shows" "$demo/out/predicted/000048.png"
  panel "what the camera sees now" "$demo/lab/rgb/000048.png"
} | montage miff:- -tile 3x1 -geometry +4+2 -quality 88 docs/images/demo.jpg
