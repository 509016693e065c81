#!/bin/bash
# In the guest: operator and robot on two networks, joined by a cable on which the kernel delays, loses, doubles and
# reorders packets (netem), both ways. The drives are emulated, in the robot's program, at 50 Hz: the emulated processor
# has no time for more. Argument: the folder of the built programs.
set -uo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
programs=$1
out=$(mktemp -d)
. "$here/checks.sh"
. "$root/tests/link/two_hosts.sh"

# cable OPTIONS...: what netem does in either direction from now on.
cable() {
  tc qdisc replace dev operator root netem limit 10000 "$@" && at_robot tc qdisc replace dev robot root netem limit 10000 "$@"
}
words() { printf '      %s\n' "$*"; }
# round_trip LEAST MOST: of the line as `link status` tells it, in ms.
round_trip() {
  "$programs/foresight" link status --rig "$out/operator/minerva.yaml" --seconds 8 >"$out/status" 2>&1
  sed -n 's/^/      /; /round trip/p' "$out/status"
  awk -v least="$1" -v most="$2" '{ for (i = 1; i < NF; ++i) if ($i == "trip") trip = $(i + 1) }
    END { exit !(trip >= least && trip <= most) }' "$out/status"
}
# rests SINCE MS: the elbow came to rest within so long, and stays there.
rests() {
  sleep 2
  local after
  after=$(motion_after "$1")
  words "at rest after $after ms"
  [ "$after" -le "$2" ]
}
# follows_anew: the operator lets go and presses, and the robot moves.
follows_anew() {
  local begin
  kill -USR1 "$hand"
  says_now follows || return 1
  begin=$(date +%s%N)
  in_motion "$begin"
}
now_ns() { date +%s%N; }

two_hosts
sed -i 's/^control:.*/control: {rate_hz: 50, command_age_s: 0.3, feedback_age_s: 0.1, ramp_s: 0.5}/' "$out"/*/minerva.yaml
cable delay 40ms
serve
for _ in {1..60}; do grep -q "written and read back" "$out/robot.err" && break; sleep 1; done
watch_joints
told() { round_trip 80 130 || round_trip 80 130 || round_trip 80 130; }  # a guest that is held up, again
check "40 ms each way: the line's round trip is told" told

begin=$(now_ns)
take_hand
check "the robot follows" wait_for 1 follows
check "  and moves" in_motion "$begin"
since=$(now_ns)
kill -KILL "$hand"
wait "$hand" 2>/dev/null
check "the operator's program is killed: the robot comes to rest" rests "$since" 900

begin=$(now_ns)
cable delay 40ms 10ms 25% distribution normal loss 3% 25% duplicate 2% reorder 2% 50%
take_hand
check "jitter, loss, doubles, overtaking: the robot follows" wait_for 1 follows
check "  and moves" in_motion "$begin"

let_go=$(said "must let go")
since=$(now_ns)
cable delay 40ms loss 100%
check "the cable carries nothing: the robot comes to rest" rests "$since" 900
since=$(now_ns)
cable delay 40ms
check "it does again after 2 s: the switch, held all the while, must be let go of" wait_for $((let_go + 1)) "must let go"
check "  nothing has moved" rests "$since" 0
check "  until another press" follows_anew

let_go=$(said "must let go")
cable delay 2000ms
since=$(now_ns)
sleep 4
cable delay 40ms
check "all comes two seconds late, then at once: the robot rests until another press" wait_for $((let_go + 1)) "must let go"
moved=$(motion_after $((since + 900000000)))
check "  no late set-point moved it ($moved ms)" [ "$moved" -eq 0 ]
check "  and follows then" follows_anew

kill -INT "$robot"
wait "$robot"
kill "${others[@]}" 2>/dev/null
finish
