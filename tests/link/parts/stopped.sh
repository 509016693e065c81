# Part of scripts/test-line, which sources it: either program is stopped and continued, on two hosts.

hosts_up
[ -n "$hand" ] || take_hand
stop_ms=734  # 150 ms, and what stopping from full speed takes (control_test tells it)

# pause_each WHOSE: the operator's or the robot's program is stopped while the robot moves, and goes on two seconds later,
# the switch held all the while: it brakes, and then rests until another press.
pause_each() {
  local whose=$1 round begin instant rest heard let_go
  for round in $(seq "$rounds"); do
    says_now follows && begin=$(date +%s%N) && in_motion "$begin" || return 1
    let_go=$(said "must let go")
    sleep "0.$((1 + round % 7))"
    local stopped=$hand
    [ "$whose" = operator ] || stopped=$robot
    instant=$(date +%s%N)
    kill -STOP "$stopped"
    sleep 2
    rest=$(motion_after "$instant")
    [ "$whose" = robot ] || in_time "$rest" 600 || { echo "at rest after $rest ms only"; return 1; }
    begin=$(date +%s%N)
    kill -CONT "$stopped"
    wait_for $((let_go + 1)) "must let go" || return 1
    sleep 1
    heard=0
    [ "$whose" = operator ] || read -r rest heard < <(motion_seen_after "$begin")  # its clock went on while it stood still
    in_time "$rest" "$stop_ms" || { echo "at rest $rest ms after it went on only"; return 1; }
    [ "$heard" -ge 0 ] || { echo "the robot is not heard any more"; return 1; }
    instant=$(motion_after $((begin + (heard > stop_ms ? heard : stop_ms) * 1000000 + 1000000)))
    echo "stopped in motion, at rest after $rest ms; then moved for $instant ms under a switch that was held all the while"
    [ "$whose" = operator ] || echo "  heard again after $heard ms"
    [ "$instant" -eq 0 ] || return 1
    [ "$whose" = robot ] || [ "$(motion_after "$begin")" -eq 0 ] || return 1
    kill -USR1 "$hand"
  done
}
check "the operator's program stopped $rounds times: the robot rests until another press" pause_each operator
cat "$out/last"
check "the robot's program stopped $rounds times: it rests until another press" pause_each robot
cat "$out/last"
