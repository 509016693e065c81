# Part of scripts/test-line, which sources it: either program is killed and started anew, on two hosts.

hosts_up
kill_operators() {
  local round begin instant rest
  for round in $(seq "$rounds"); do
    begin=$(date +%s%N)
    take_hand
    wait_for 1 follows && in_motion "$begin" || return 1
    sleep "0.$((1 + round % 7))"
    instant=$(date +%s%N)
    kill -KILL "$hand"
    wait "$hand" 2>/dev/null
    at_rest || return 1
    rest=$(motion_after "$instant")
    echo "moved for $(motion_after "$begin") ms, killed, at rest after $rest ms"
    # 100 to 250 ms until the last set-point has expired, 150 ms, and what stopping takes.
    in_time "$rest" 600 || return 1
  done
}
check "the operator's program killed $rounds times: the robot comes to rest each time, and follows the next one" kill_operators
cat "$out/last"

kill_robots() {
  local round begin moved
  take_hand
  for round in $(seq "$rounds"); do
    wait_for "$round" follows || return 1
    sleep 0.5
    kill -KILL "$robot"
    wait "$robot" 2>/dev/null
    begin=$(date +%s%N)
    serve
    # It holds the switch all the while: that is no consent to what a new robot does.
    wait_for "$round" "must let go" || return 1
    sleep 1
    moved=$(motion_after "$begin")
    echo "killed and started anew: moved for $moved ms under a switch that was held all the while"
    [ "$moved" -eq 0 ] || return 1
    kill -USR1 "$hand"
  done
}
check "the robot's program killed $rounds times: it moves only once the operator has let go and pressed anew" kill_robots
cat "$out/last"
