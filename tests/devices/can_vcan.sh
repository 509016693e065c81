#!/bin/bash
# In the guest: SocketCAN on vcan, against can-utils. Argument: the folder of the built programs.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/checks.sh"
programs=$1
foresight=$programs/foresight

check "scan without any interface says how to make one" exits 1 "$foresight" can scan
check "  and names vcan" has /tmp/exits.log "ip link add dev vcan0 type vcan"
ip link add dev vcan0 mtu 72 type vcan
check "an interface that is down cannot be used" exits 1 "$foresight" can scan
check "  and scan says what to type" has /tmp/exits.log "ip link set vcan0 up"
check "opening it says so too" exits 2 "$foresight" can send vcan0 123#11
check "  with errno and cure" has /tmp/exits.log "it is down (errno 100, ENETDOWN); run \`ip link set vcan0 up\`"
ip link set vcan0 up
check "scan finds one that can be used" exits 0 "$foresight" can scan
check "  with kind and state" has /tmp/exits.log "vcan0: error-active, vcan, FD"

# The unit tests skip where there is no CAN: here none of them may.
check "unit tests of SocketCAN" "$programs/can_test" --gtest_brief=1 --gtest_filter='SocketCan*:KernelFrame*:NoAllocation*' \
  --gtest_output=xml:/tmp/can_test.xml
check "  none skipped but the ones for no CAN and for bus-off" \
  test "$(grep -c 'result="skipped"' /tmp/can_test.xml)" = 2

listen vcan0 /tmp/ours.log "$foresight" can dump vcan0 --fd --count 7 --seconds 20 --log /tmp/ours.candump
for frame in 123#DEADBEEF 1F334455#11 123#R5 7FF# 321##1112233445566778899AABBCC 18DAF110##000 20000040#0000000000000000; do
  cansend vcan0 "$frame"
done
wait "$listener"
check "our dump ends after --count frames" test $? = 0
for text in "123#DEADBEEF" "1F334455#11" "123#R5" "7FF#" "321##1112233445566778899AABBCC" "18DAF110##000" \
  "20000040#0000000000000000"; do
  check "our dump reads cansend's $text" has /tmp/ours.log " vcan0 $text"
  check "  and logs it" has /tmp/ours.candump " vcan0 $text R"
done
check "an error frame arrives as bus-off" has /tmp/ours.log "vcan0 is bus-off"

# candump writes logs where it stands.
cd /tmp || exit 1
listen vcan0 /tmp/theirs.log stdbuf -oL candump -L vcan0,0:0,#FFFFFFFF
for frame in 123#DEADBEEF 1F334455#11 123#R5 321##1112233445566778899AABBCC; do
  check "we send $frame" "$foresight" can send vcan0 "$frame"
  check "  and candump reads it" eventually grep -qE " vcan0 ${frame/\#\#1/##[15]}" /tmp/theirs.log
done
stop_listening

listen vcan0 /tmp/replayed.log stdbuf -oL candump -L vcan0
check "a log of ours is replayed" exits 0 "$foresight" can replay /tmp/ours.candump vcan0
check "  but for its error frame" has /tmp/exits.log "6 frames sent"
check "  and candump reads it" eventually grep -q " vcan0 18DAF110##" /tmp/replayed.log
stop_listening
check "canplayer takes our log" canplayer -I /tmp/ours.candump vcan0=vcan0

listen vcan0 /tmp/filtered.log "$foresight" can dump vcan0 --filter 580:780 --count 1 --seconds 20
for frame in 123#11 601#22 583#33; do cansend vcan0 "$frame"; done
wait "$listener"
check "a filter lets only its frames through" test "$(cut -d' ' -f3 /tmp/filtered.log)" = "583#33"

# Times: ours and candump's of the same frame, both from the kernel's stamp.
listen vcan0 /tmp/our_stamp.log "$foresight" can dump vcan0 --count 1 --seconds 20
ours=$listener
listen vcan0 /tmp/stamps.log stdbuf -oL candump -ta -L vcan0
cansend vcan0 111#22
wait "$ours"
eventually test -s /tmp/stamps.log
stop_listening
check "our time of a frame is candump's within 0.1 ms" awk -F'[()]' '
  {at[NR] = $2} END {d = at[1] - at[2]; print "      apart: " d * 1e6 " us"; exit !(NR == 2 && d < 1e-4 && d > -1e-4)}' \
  /tmp/our_stamp.log /tmp/stamps.log

# A burst: nothing is lost, and how fast it went is told.
listen vcan0 /tmp/burst.log "$foresight" can dump vcan0 --count 20000 --seconds 60
cangen vcan0 -g 0 -n 20000 -I i -L 8 -p 10 2>/tmp/cangen.log || cat /tmp/cangen.log
wait "$listener"
check "20,000 frames without a gap are all read" test "$(grep -c ' vcan0 ' /tmp/burst.log)" = 20000
awk -F'[()]' 'NR == 1 {first = $2} / vcan0 / {last = $2} END {printf "      %.0f frames/s\n", NR / (last - first)}' \
  /tmp/burst.log
finish
