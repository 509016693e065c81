#!/bin/bash
# In the guest: the robot side on the kernel's buses, the drives in processes of their own. The rigs are the examples of
# configs/ on vcan0 (arm) and vcan1 (head), at 50 Hz: the emulated processor has no time for more. Arguments: the folder
# of the built programs, and powercube or cia402. What was said on the buses goes to /out, for `can explain`, for which
# the emulated processor is slow.
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$here/checks.sh"
foresight=$1/foresight
configs=$here/../../configs
mkdir -p /tmp/rig && cp "$configs/arm.urdf" /tmp/rig/ && cd /tmp || exit 1
declare -A input=([arm]=4 [head]=5) bus=([arm]=vcan0 [head]=vcan1) drives=()
mkfifo /tmp/never && exec 9<>/tmp/never
nap() { read -rt "$1" -u 9; }  # starting `sleep` takes longer than most naps
now_ms() { now=$((${EPOCHREALTIME/./} / 1000)); }

for interface in vcan0 vcan1; do ip link add dev $interface type vcan && ip link set $interface up; done

cat >motion.csv <<'MOTION'
time_s,shoulder_yaw,shoulder_pitch,upper_arm_roll,elbow,forearm_roll,wrist_pitch,wrist_roll,finger,pan,tilt
0,0,0,0,0,0,0,0,0,0,0
2,0.6,0.2,0.3,0.4,0.5,0.3,0.6,0.02,0.8,-0.4
3,0.5,0.2,0.2,0.4,0.4,0.3,0.5,0.02,0.6,-0.3
MOTION
# To and fro, for a minute.
yaw=(-0.4 0.4) elbow=(0 0.6) pan=(0 0.9)
{
  echo time_s,shoulder_yaw,elbow,pan
  for i in {0..40}; do echo "$((i * 3 / 2)).$((i * 3 % 2 * 5)),${yaw[i % 2]},${elbow[i % 2]},${pan[i % 2]}"; done
} >sweep.csv

# start_drives: both racks, with lines for them on ${input[..]} and their words in NAME.out. In real time, though not
# before the robot's loop: hardware does not wait for what else this machine does.
start_drives() {
  local name
  for name in arm head; do
    rm -f $name.in && mkfifo $name.in && : >$name.out
    chrt --fifo 50 "$foresight" sim drives --rig "$rig" --can "${bus[$name]}" <$name.in >>$name.out 2>&1 &
    drives[$name]=$!
    eval "exec ${input[$name]}>$name.in"
    eventually grep -q "drives on" $name.out
  done
}
stop_drives() {
  local name
  for name in arm head; do
    echo quit >&"${input[$name]}"
    wait "${drives[$name]}"
    eval "exec ${input[$name]}>&-"
  done
}
restart_drives() { stop_drives && start_drives && forget; }
tell() { echo "$2" >&"${input[$1]}"; }

# table NAME: $rows, one a drive: name node position velocity brake lowest highest fastest hardest.
table() {
  local try
  : >"$1.out"
  tell "$1" show
  for try in {1..500}; do
    mapfile -t rows <"$1.out"
    [ ${#rows[@]} -gt 1 ] && [ -z "${rows[-1]}" ] && break
    nap 0.01
  done
  rows=("${rows[@]:1:${#rows[@]}-2}")
}
tables() {
  local all
  table arm && all=("${rows[@]}") && table head && rows=("${all[@]}" "${rows[@]}")
}
positions() { tables && printf '%s\n' "${rows[@]}" | awk '{print $1, $3}'; }

at_rest() {
  local row velocity
  tables
  for row in "${rows[@]}"; do
    read -r _ _ _ velocity _ <<<"$row"
    [[ $velocity == *0.000* ]] || return 1
  done
}
# The sweep passes some speed with the yaw: up to 30 s from now.
in_motion() {
  local try velocity
  for try in {1..600}; do
    table arm
    read -r _ _ _ velocity _ <<<"${rows[0]}"
    [[ $velocity =~ ^-?0\.[3-9] ]] && return 0
    kill -0 "$robot" 2>/dev/null || break
    nap 0.03
  done
  sed 's/^/      | /' robot.log
  return 1
}
# rests_within MS: all shafts, from $since on; $took is how long it took.
rests_within() {
  local try
  for ((try = 0; try < 200; ++try)); do
    at_rest && break
    nap 0.01
  done
  now_ms
  took=$((now - since))
  printf '      at rest after %s ms\n' $took
  [ $took -le "$1" ]
}
stays_at_rest() {
  local before
  before=$(positions)
  nap 1
  [ "$before" = "$(positions)" ]
}
brakes_closed() {
  tables
  printf '%s\n' "${rows[@]}" | awk '$1 != "finger" && $5 != "closed" {print "      open: " $0; open = 1} END {exit open}'
}
all_brakes_closed() { tables && ! printf '%s\n' "${rows[@]}" | grep -v " closed "; }
# Since the last "forget".
stood_still() {
  tables
  printf '%s\n' "${rows[@]}" | awk '$7 - $6 > 0.004 || $8 > 0.1 {print "      " $0; bad = 1} END {exit bad}'
}
# near NAME=POSITION...: where the shafts are.
near() {
  positions | awk -v wanted="$*" 'BEGIN {n = split(wanted, pairs, " "); for (i = 1; i <= n; ++i) {split(pairs[i], p, "="); at[p[1]] = p[2]}}
    $1 in at {d = $2 - at[$1]; if (d < 0) d = -d; if (d > 0.003) {print "      " $1 " at " $2 ", not " at[$1]; bad = 1}} END {exit bad}'
}
# within_limits TIMES: since the last "forget", no shaft was beyond the rig's positions or faster than TIMES its velocity.
within_limits() {
  tables
  { sed 's/[{},:]/ /g' "$rig"; echo -; printf '%s\n' "${rows[@]}"; } | awk -v times="$1" '
    $1 == "-" && NF == 1 {drives = 1; next}
    !drives {for (i = 1; i < NF; ++i) {if ($i == "name") name = $(i + 1); if ($i == "min") low[name] = $(i + 1)
             if ($i == "max") high[name] = $(i + 1); if ($i == "velocity") most[name] = $(i + 1)}; next}
    {room = 0.02 * (high[$1] - low[$1])
     if ($6 < low[$1] - room || $7 > high[$1] + room || $8 > times * most[$1] || !($1 in most)) {print "      " $0; bad = 1}}
    END {exit bad}'
}
forget() { tell arm forget; tell head forget; }

# Without the rig's mock cameras: drawing the lab would starve the drives of an emulated processor.
start_robot() { "$foresight" robot "$rig" --no-cameras --home --follow "$1" >robot.log 2>&1 4>&- 5>&- & robot=$!; }
# The robot begins the sweep. Again where the guest was held up, on a busy machine, for about as long as the drives'
# watchdogs allow: they stop the robot then, as they should.
held_up() { awk '/^  loop:/ && $(NF - 1) > 60 {late = 1} END {exit !late}' robot.log; }
set_moving() {
  local attempt
  for attempt in first second last; do
    start_robot sweep.csv
    in_motion && return 0
    [ $attempt != last ] && held_up || return 1
    printf '      the guest was held up; again\n'
    wait "$robot"
  done
}
robot_ends() { local code=0; wait "$robot" || code=$?; [[ $code =~ ^($1)$ ]] && return 0; printf '      exit code %s:\n' "$code"; sed 's/^/      | /' robot.log; return 1; }
says() { grep -qF -- "$1" robot.log && { grep -F "follow:" robot.log | sed 's/^/      /'; return 0; }; has robot.log "$1"; }
# follows FILE: to its end.
follows() {
  local attempt
  for attempt in first second last; do
    start_robot "$1"
    robot_ends 0 && return 0
    [ $attempt != last ] && held_up || return 1
    printf '      the guest was held up; again\n'
  done
}
# stops_because TEXT: the running robot stops after what happened at $since, and ends with this reason.
stops_because() {
  check "  every shaft comes to rest" rests_within 1000
  check "  the program ends" robot_ends 1
  check "  with the reason: $1" says "$1"
  check "  within its limits" within_limits 1.5
}

# run_protocol PROTOCOL RIG, with $foreign frames of another master.
run_protocol() {
  local protocol=$1 log=$1.candump frame recorder before t
  say() { printf '%s s  %s: %s\n' "$SECONDS" "$protocol" "$*"; }
  rig=/tmp/rig/$protocol.yaml
  sed -e 's/name: arm, interface: mock/name: arm, interface: vcan0/; s/name: head, interface: mock/name: head, interface: vcan1/' \
    -e 's/^control:.*/control: {rate_hz: 50, command_age_s: 0.3, feedback_age_s: 0.1, ramp_s: 0.5}/' "$configs/$2" >"$rig"
  start_drives
  candump -L vcan0 vcan1 >"$log" 2>candump.err 4>&- 5>&- &
  recorder=$!

  say "home, enable, follow, stop"
  forget
  check "the robot follows a file" follows motion.csv
  check "  to its end" says "follow: done"
  check "  where the shafts are too" near shoulder_yaw=0.5 shoulder_pitch=0.2 upper_arm_roll=0.2 elbow=0.4 forearm_roll=0.4 \
    wrist_pitch=0.3 wrist_roll=0.5 finger=0.02 pan=0.6 tilt=-0.3
  check "  within all limits" within_limits 1.05
  check "  brakes closed" brakes_closed
  sed -n 's/^  loop/      loop/p' robot.log

  say "the program is killed"
  check "the arm moves" set_moving
  now_ms && since=$now && kill -9 "$robot"
  # 0.1 s of watchdog, at most 0.6 rad/s at 2 rad/s^2, and what it takes to ask: half of it in a guest that is held up.
  check "the drives' watchdogs stop all shafts" rests_within 1000
  wait "$robot" 2>/dev/null
  check "  which stay at rest" stays_at_rest
  # A CiA 402 drive holds the joint in the state "quick stop active", without a brake.
  [ "$protocol" = cia402 ] || check "  with brakes closed" all_brakes_closed
  forget && before=$(positions)
  { echo "time_s,$(awk '{printf "%s%s", (NR > 1 ? "," : ""), $1}' <<<"$before")"
    for t in 0 1; do echo "$t,$(awk '{printf "%s%s", (NR > 1 ? "," : ""), $2}' <<<"$before")"; done
  } >hold.csv
  check "started again, the robot takes over" follows hold.csv
  check "  and holds" says "follow: done"
  check "  without a jump" stood_still
  [ "$protocol" = powercube ] || restart_drives

  say "the program is asked to end"
  check "the arm moves" set_moving
  kill -TERM "$robot"
  check "the program stops it and ends" robot_ends 130
  check "  as interrupted" says "follow: interrupted"
  check "  at rest" at_rest
  check "  with brakes closed" brakes_closed
  check "  within all limits" within_limits 1.05

  say "a drive falls silent"
  check "the arm moves" set_moving
  now_ms && since=$now && tell arm "silent elbow"
  stops_because "joint elbow"
  tell arm "recover elbow"

  say "another master"
  for frame in $foreign; do
    check "the arm moves" set_moving
    now_ms && since=$now && cansend vcan0 "$frame"
    stops_because "another master"
  done
  kill -INT $recorder && wait $recorder
  cp "$log" /out/
  [ "$protocol" = powercube ] || restart_drives

  say "10,000 random frames"
  forget
  check "the arm moves" set_moving
  check "cangen sends them" cangen vcan0 -n 10000 -g 5 -c 25
  kill -TERM "$robot" 2>/dev/null
  check "  the robot stops with a reason, or goes on until it is asked to end" robot_ends '1|130'
  check "  and says so" grep -E "follow: (stopped: .|interrupted)" robot.log
  check "  every shaft rests" at_rest
  check "  and was within its limits" within_limits 1.55
  [ "$protocol" = powercube ] || restart_drives

  say "the interface goes down"
  check "the arm moves" set_moving
  now_ms && since=$now && ip link set vcan0 down
  check "the drives' watchdogs stop all shafts" rests_within 1000
  check "  the robot stops" robot_ends 1
  check "  with the reason: down" says "down"
  ip link set vcan0 up
  check "  the shafts stay at rest when it is up again" stays_at_rest
  check "  and the robot can be started again" follows motion.csv

  say "a drive loses its power"
  check "the arm moves" set_moving
  now_ms && since=$now && tell arm "reset elbow"
  stops_because "joint elbow"
  stop_drives
}

case $2 in
  powercube) foreign=0C1#0A3C && run_protocol powercube minerva.yaml ;;  # a host's question
  cia402) foreign="000#0100 080#" && run_protocol cia402 cia402.yaml ;;  # an NMT start for all, and SYNC
  *) check "protocol $2" false ;;
esac
finish
