#!/bin/bash
# In the guest: bus-off and recovery with the kernel's slcan driver. Argument: the folder of the built programs.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/checks.sh"
programs=$1
foresight=$programs/foresight

mkfifo /tmp/adapter
"$programs/slcan_adapter" </tmp/adapter >/tmp/line.log 2>&1 &
exec 3>/tmp/adapter
eventually test -s /tmp/line.log
interface=$(head -1 /tmp/line.log)
check "the adapter gives an interface" ip link show "$interface"
check "without bit rate, scan says how to set one" exits 1 "$foresight" can scan
check "  with what to type" has /tmp/exits.log "ip link set $interface up type can bitrate 1000000"
ip link set "$interface" up type can bitrate 1000000
check "the driver sets 1 Mbit/s (S8) and opens (O)" eventually grep -q '^O' /tmp/line.log
check "  in these words: S8" has /tmp/line.log "S8"
check "scan reads the bit rate" exits 0 "$foresight" can scan
check "  in these words: interface: error-active, can, 1000 kbit/s" has /tmp/exits.log "$interface: error-active, can, 1000 kbit/s"

check "we send" "$foresight" can send "$interface" 123#DEAD
check "  and the adapter gets it" eventually grep -q '^t1232DEAD' /tmp/line.log

listen "$interface" /tmp/dump.log "$foresight" can dump "$interface" --seconds 30 --count 2
echo "t32121122" >&3
echo "sb256000" >&3
wait "$listener"
check "what the adapter receives is read" has /tmp/dump.log "$interface 321#1122"
check "bus-off arrives as an error frame" grep -qE "$interface 2000[0-9A-F]{4}#" /tmp/dump.log
check "  and as the bus's state" has /tmp/dump.log "$interface is bus-off"
check "scan shows it" exits 1 "$foresight" can scan
check "  with what to type" has /tmp/exits.log "ip link set $interface down"
check "sending is refused, though the driver would take it" exits 1 "$foresight" can send "$interface" 123#BEEF
check "  in these words: the bus is bus-off" has /tmp/exits.log "the bus is bus-off"

check "our bus restarts it" env FORESIGHT_CAN_BUS_OFF="$interface" "$programs/can_test" --gtest_brief=1 \
  --gtest_filter='SocketCanRestart.*' --gtest_output=xml:/tmp/restart.xml
check "  in a test that was not skipped" bash -c "! grep -q 'result=\"skipped\"' /tmp/restart.xml"
check "scan shows it active again" exits 0 "$foresight" can scan
check "and we send again" "$foresight" can send "$interface" 123#CAFE
check "  and the adapter gets it" eventually grep -q '^t1232CAFE' /tmp/line.log

# Unplugged: an open bus says so and does not hang.
listen "$interface" /tmp/unplugged.log "$foresight" can dump "$interface" --seconds 4
exec 3>&-
check "a bus whose adapter is pulled out ends in time" wait "$listener"
check "  and says that it is down" has /tmp/unplugged.log "$interface is down"
finish
