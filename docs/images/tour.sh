#!/bin/bash
# Makes docs/images/tour-*.jpg: the operator's window in each of its views, as keys choose them, over a slow line.
#
# A robot of the mock lab and a seat are two programs on this host; the window is on a screen of its own. Needs Xvfb,
# xdotool and ffmpeg (scripts/setup). About two minutes.
set -euo pipefail
cd "$(dirname "$0")/../.."
foresight=$PWD/build/release/bin/foresight
folder=$(mktemp -d)
children=()
end() {
  for child in "${children[@]}"; do kill "$child" 2>/dev/null || true; done
  wait 2>/dev/null || true
  rm -rf "$folder"
}
trap end EXIT

sed -e "s|urdf: arm.urdf|urdf: $PWD/configs/arm.urdf|" -e "s|rate_hz: 10|rate_hz: 5|" configs/minerva.yaml >"$folder/rig.yaml"
echo "link: {interface: lo, domain: $((1 + $$ % 99)), round_trip_s: 2}" >>"$folder/rig.yaml"
echo "{up: {delay_ms: 300}, down: {delay_ms: 300}}" >"$folder/line.yaml"

mkfifo "$folder/display"
Xvfb -displayfd 3 -screen 0 1000x700x24 -nolisten tcp 3>"$folder/display" 2>/dev/null &
children+=($!)
read -r number <"$folder/display"
export DISPLAY=:$number

"$foresight" robot "$folder/rig.yaml" --mock --serve --line "$folder/line.yaml" >/dev/null 2>&1 &
children+=($!)
(cd "$folder" && exec "$foresight" operator "$folder/rig.yaml" --mock --rate-hz 6 --font-scale 0.8) 2>"$folder/said" &
children+=($!)

fail() {
  echo "tour.sh: $1; the seat said last:" >&2
  tail -5 "$folder/said" >&2
  exit 1
}
says() { # WORDS: waits until the seat has said so
  for _ in $(seq 600); do
    grep -qF "$1" "$folder/said" && return
    sleep 0.2
  done
  fail "never '$1'"
}
shows() { # WORDS: waits until the window shows that view, and it counts
  for _ in $(seq 300); do
    last=$(grep "operator: shown:" "$folder/said" | tail -1)
    case $last in
      *"cannot be trusted"*) ;;
      *"$1"*) sleep 1 && return ;;
    esac
    sleep 0.2
  done
  fail "the window never showed '$1'"
}
press() { xdotool key --delay 300 "$@"; }
picture() { # NAME
  rm -f "$folder/foresight-001.png"
  press p
  for _ in $(seq 100); do
    [ -s "$folder/foresight-001.png" ] && break
    sleep 0.2
  done
  sleep 0.5
  ffmpeg -v error -y -i "$folder/foresight-001.png" -vf scale=640:-1:flags=area -q:v 5 "docs/images/tour-$1.jpg"
}
follows() { # holds the switch, anew where the robot does not follow the first press
  for _ in $(seq 5); do
    xdotool keydown shift
    for _ in $(seq 20); do
      case $(grep "operator: in command:" "$folder/said" | tail -1) in *"the robot follows"*) return ;; esac
      sleep 0.2
    done
    xdotool keyup shift
    sleep 1
  done
  fail "the robot never followed"
}
drive() { # SECONDS KEY
  follows
  xdotool keydown "$2"
  sleep "$1"
  xdotool keyup "$2" keyup shift
  sleep 2
}

says "in command:   you"
xdotool search --sync --name Foresight windowsize --sync 1000 700 windowmove 0 0 windowfocus
press e
sleep 3
press h
says "next:   ready"
drive 1.2 Down
press F1
sleep 1
follows
xdotool keydown w
sleep 3
picture predicted
xdotool keyup w keyup shift
press Tab Tab Tab
shows "drag the border"
picture split
press F2 F2 F2
shows "spectacles, grey"
picture anaglyph
press F3
shows "from beside"
picture from-beside
press F3 F4
shows wireframe
press F4
shows "as it will be; age"
picture age
press F4 F4
shows "wrong how often"
picture errors
press F4
shows "as it will be"
press b
shows stripe
picture stripes
kill -STOP "${children[1]}"
says "as prediction cannot be trusted"
sleep 1
picture lost
kill -CONT "${children[1]}"
press q
