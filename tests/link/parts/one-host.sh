# Part of scripts/test-line, which sources it: a served robot and everybody who looks at it, on this machine alone.

cp "$root/configs/minerva.yaml" "$root/configs/arm.urdf" "$out"
printf 'link:\n  domain: 5\n' >>"$out/minerva.yaml"

follow_file() {
  "$programs/foresight" robot "$out/minerva.yaml" --mock --serve --home --follow "$out/motion.csv" >"$out/robot.out" 2>"$out/robot.err" &
  robot=$!
}
# It homes first: it is where the file wants it when the elbow says so.
arrived() {
  for _ in $(seq 100); do
    kill -0 "$robot" || break
    timeout 10 "$programs/foresight" link listen joint_states --domain 5 --count 1 2>/dev/null | grep -q '0\.39\|0\.40' &&
      return 0
    sleep 1
  done
  cat "$out/robot.err"
  return 1
}
follow_file
following=yes
check "the robot serves, and goes where it shall" arrived
check "link status sees the robot" bash -c "'$programs/foresight' link status --domain 5 | grep 'robot minerva'"
for topic in joint_states tf left/image_raw/compressed foresight/frames foresight/robot_state diagnostics; do
  check "link rate $topic" foresight link rate "$topic" --domain 5 --seconds 3
  cat "$out/last"
done
check "link listen reads the robot's state" bash -c \
  "timeout 60 '$programs/foresight' link listen foresight/robot_state --domain 5 --count 3 | grep \"label: 'following'\""
check "a topic that nobody writes is told" bash -c \
  "'$programs/foresight' link rate joint_stats --domain 5 2>&1 | grep \"did you mean 'rt/joint_states'\""
check "an interface that there is not is told" bash -c \
  "'$programs/foresight' link status --interface eth9 2>&1 | grep \"there is no network interface 'eth9'\""

# What is started to be stopped is the program itself: of a function, $! would be the shell around it.
# overruns: of the control loop, as it says itself.
overruns() { foresight link listen foresight/robot_state --domain 5 --count 1 | awk '/overruns/ {print $2}'; }
stopped_reader() {
  local before after reader
  "$programs/foresight" link listen foresight/frames --domain 5 >/dev/null 2>&1 &
  reader=$!
  sleep 2
  kill -STOP $reader
  before=$(overruns)
  foresight link rate foresight/frames --domain 5 --seconds 5
  after=$(overruns)
  kill -KILL $reader
  echo "overruns before $before, after $after"
  foresight link listen foresight/robot_state --domain 5 --count 1 | grep "label: 'following'"
}
check "a reader that is stopped holds up nobody" stopped_reader
cat "$out/last"

# Recordings: of the running robot; one of a recorder that is killed; played on another domain; as a run.
rig=$out/minerva.yaml
check "a line is recorded" foresight record --line "$out/line.mcap" --rig "$rig" --mock --seconds 5
cat "$out/last"
killed() {
  "$programs/foresight" record --line "$out/killed.mcap" --rig "$rig" --mock 2>/dev/null &
  local recorder=$!
  sleep 3
  kill -KILL $recorder
  wait $recorder 2>/dev/null || true
  foresight export-run "$out/killed.mcap" --out "$out/killed" 2>&1 | grep 'the recording is cut: the file ends'
}
check "a killed recorder leaves a file that opens, and says that it is cut" killed
if [ -n "${FORESIGHT_MCAP_READER:-}" ]; then
  decoded() { node "$FORESIGHT_MCAP_READER" "$out/line.mcap" | tee "$out/decoded" && grep -q 'elbow=0\.\(39\|40\)' "$out/decoded"; }
  check "a reader of others decodes the recording" decoded
  cat "$out/last"
  check "and that of the killed recorder" node "$FORESIGHT_MCAP_READER" "$out/killed.mcap" --cut
fi
check "a recording is not played beside a robot" bash -c \
  "'$programs/foresight' play '$out/line.mcap' --domain 5 2>&1 | grep \"cannot be played beside 'robot minerva'\""
played() {
  "$programs/foresight" play "$out/line.mcap" --domain 6 &
  local player=$!
  foresight link rate foresight/frames --domain 6 --seconds 2 || return 1
  foresight link listen joint_states --domain 6 --count 1 | grep '0\.39\|0\.40' || return 1
  wait $player
}
check "it is played where no robot is" played
cat "$out/last"
exported() {
  foresight export-run "$out/line.mcap" --out "$out/run" || return 1
  foresight replay "$out/run" --report "$out/run.json" --delay-ms 0 2>&1 | tee "$out/replayed"
  awk '/image times: predicted/ { good = $5 >= 35 } END { exit !good }' "$out/replayed"  # dB
}
check "a run is made of it, and replayed" exported
cat "$out/last"

if [ -n "${FORESIGHT_LISTENER:-}" ]; then
  stranger() {
    "$FORESIGHT_LISTENER" 5 8 set-points && foresight link listen foresight/robot_state --domain 5 --count 1 >"$out/state" &&
      grep "label: 'following'" "$out/state" && foresight link listen joint_states --domain 5 --count 1 >"$out/joints" &&
      cat "$out/joints" && grep -q '0\.39\|0\.40' "$out/joints"
  }
  check "Fast DDS reads joints, transforms and pictures; its set-points move nothing" stranger
  cat "$out/last"
  cp "$out/last" "$out/heard"
  check "its elbow and pan are where the file put them" \
    grep -E 'elbow=0\.(399|400|401).* pan=0\.(299|300|301)' "$out/heard"
fi

following=''
end_robot
sed 's/domain: 5/domain: 6\n  coding: h264/' "$out/minerva.yaml" >"$out/thin.yaml"
printf 'up: {delay_ms: 20, rate_kbps: 2000, loss: 0.01}\ndown: {delay_ms: 20, rate_kbps: 2000}\n' >"$out/line.yaml"
"$programs/foresight" robot "$out/thin.yaml" --mock --serve --line "$out/line.yaml" >"$out/robot.out" 2>"$out/robot.err" &
robot=$!
thin_line() {
  for _ in $(seq 20); do  # the mock lab is lit first
    foresight link status --domain 6 --seconds 5 >"$out/status" && cat "$out/status" && grep -q '(h264)' "$out/status" &&
      return 0
    kill -0 "$robot" || return 1
  done
  return 1
}
check "coded pairs cross a thin line" thin_line
grep -E '^(clock|pairs|age|lost) ' "$out/last" || true
end_robot
