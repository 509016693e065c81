# Operator and robot on two hosts, which are two networks on this machine, joined by a cable; source it, do not run it.
# Needs $programs, $root and the folder $out. Processes to be ended with the script are in `others` and $robot.

others=() robot='' hand='' host='' waits=600

# two_hosts: this network is the operator's, with the interface `operator`; the robot's has the interface `robot`.
two_hosts() {
  unshare -n sleep infinity &
  host=$!
  others+=("$host")
  until [ "$(readlink /proc/self/ns/net)" != "$(readlink "/proc/$host/ns/net")" ]; do :; done
  ip link add operator type veth peer name robot netns "$host"
  ip address add 10.77.0.2/24 dev operator
  ip link set operator up
  at_robot ip link set lo up
  at_robot ip address add 10.77.0.1/24 dev robot
  at_robot ip link set robot up
  rig_at robot robot 10.77.0.2
  rig_at operator operator 10.77.0.1
  rig_at watcher robot 10.77.0.1
}
at_robot() { nsenter -t "$host" -n "$@"; }
# rig_at NAME INTERFACE PEER: the rig as that host, or a program of its own there, has it.
rig_at() {
  mkdir "$out/$1"
  cp "$root/configs/minerva.yaml" "$root/configs/arm.urdf" "$out/$1"
  printf 'link:\n  domain: 7\n  interface: %s\n  peers: [%s]\n' "$2" "$3" >>"$out/$1/minerva.yaml"
}

serve() {
  nsenter -t "$host" -n "$programs/foresight" robot "$out/robot/minerva.yaml" --mock --no-cameras --serve --home \
    >>"$out/robot.out" 2>>"$out/robot.err" &
  robot=$!
}
take_hand() {
  [ -z "$hand" ] || kill -KILL "$hand" 2>/dev/null || true
  : >"$out/hand"
  "$programs/line_hand" "$out/operator/minerva.yaml" move >"$out/hand" 2>&1 &
  hand=$!
  others+=("$hand")
}
# watch_joints: beside the robot, so that whatever the cable does, all motion is seen.
watch_joints() {
  nsenter -t "$host" -n "$programs/line_hand" "$out/watcher/minerva.yaml" watch >"$out/watch.csv" 2>"$out/watch.err" &
  others+=("$!")
}

# said WORDS: how often the operator's program has.
said() { grep -c "^$1\$" "$out/hand" || true; }
# wait_for TIMES WORDS: until the operator's program has said so that often; $waits tenths of a second at most.
wait_for() {
  for _ in $(seq "$waits"); do
    [ "$(said "$2")" -lt "$1" ] || return 0
    sleep 0.1
  done
  echo "the operator's program did not say '$2' for the ${1}th time; last it said:"
  tail -3 "$out/hand"
  tail -3 "$out/robot.err"
  return 1
}
# says_now WORDS: until this is the last that it said; as long at most.
says_now() {
  for _ in $(seq "$waits"); do
    [ "$(tail -1 "$out/hand")" != "$1" ] || return 0
    sleep 0.1
  done
  echo "the operator's program says '$(tail -1 "$out/hand")', not '$1'"
  return 1
}
# motion_after INSTANT: for how long the elbow was in motion after it, in ms, by the robot's own stamps.
motion_after() {
  awk -F, -v t="$1" '{ if (NR > 1 && ($2 - last > 2e-4 || last - $2 > 2e-4) && $1 > t) moved = $1; last = $2 }
    END { printf "%.0f\n", (moved > t ? (moved - t) / 1e6 : 0) }' "$out/watch.csv"
}
# motion_seen_after INSTANT: the same of a robot whose program has stood still, and how long until it was heard again, in
# ms. What it did until then is not seen; where it had come to meanwhile is no motion at the instant at which that is heard.
motion_seen_after() {
  awk -F, -v t="$1" '$1 > t { if (heard && ($2 - last > 2e-4 || last - $2 > 2e-4)) moved = $1; if (!heard) heard = $1; last = $2 }
    END { printf "%.0f %.0f\n", (moved ? (moved - t) / 1e6 : 0), (heard ? (heard - t) / 1e6 : -1) }' "$out/watch.csv"
}
# at_rest: until nothing has moved for half a second; a minute at most.
at_rest() {
  sleep 1  # joint states come late on a busy machine
  for _ in $(seq 120); do
    sleep 0.5
    [ "$(motion_after "$(($(date +%s%N) - 500000000))")" -ne 0 ] || return 0
  done
  echo "the robot does not come to rest"
  return 1
}
# in_motion SINCE: until the elbow has moved; the operator presses again now and then, as on a busy machine set-points may
# expire before the arm has set off.
in_motion() {
  local tenths
  for tenths in $(seq "$((waits / 3))"); do
    [ "$(motion_after "$1")" -eq 0 ] || return 0
    [ $((tenths % 40)) -ne 0 ] || kill -USR1 "$hand"
    sleep 0.1
  done
  echo "nothing moves; the operator's program said:"
  tail -3 "$out/hand"
  return 1
}
