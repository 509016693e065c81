# Part of scripts/test-line, which sources it: the same with keys; a stranger without.

mkdir "$out/secured"
cp "$root/configs/minerva.yaml" "$root/configs/arm.urdf" "$out/secured"
printf 'link:\n  domain: 8\n  security: keys\n' >>"$out/secured/minerva.yaml"
secured=$out/secured/minerva.yaml
check "keys are made" foresight link keys "$out/secured/keys"
"$programs/foresight" robot "$secured" --mock --serve --home --follow "$out/motion.csv" >"$out/robot.out" 2>"$out/robot.err" &
robot=$!
secured_line() {
  for _ in $(seq 30); do
    foresight link rate foresight/frames --rig "$secured" --seconds 3 && return 0
    kill -0 "$robot" || return 1
  done
  return 1
}
check "an observer's keys read what a robot's keys encrypt" secured_line
# It sees that there are programs: announcements of these are not encrypted. Topics are.
stranger_without_keys() {
  { foresight link rate joint_states --domain 8 --seconds 3 2>&1 || true; } | grep "nobody writes this topic"
}
check "who has no keys hears nothing" stranger_without_keys
check "an encrypted line is recorded" foresight record --line "$out/secured.mcap" --rig "$secured" --mock --seconds 4
cat "$out/last"
end_robot
secured_play() {
  "$programs/foresight" play "$out/secured.mcap" --rig "$secured" &
  local player=$!
  foresight link rate foresight/frames --rig "$secured" --seconds 2 || return 1
  wait $player
}
check "and played, encrypted" secured_play
check "its run is whole" foresight export-run "$out/secured.mcap" --out "$out/secured_run"
cat "$out/last"
