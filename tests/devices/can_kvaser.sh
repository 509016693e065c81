#!/bin/bash
# In the guest: a controller with bit rate, restart-ms and counters (QEMU's Kvaser card, the kernel's SJA1000 driver), two
# ends of one emulated bus. Argument: the folder of the built programs.
set -uo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/checks.sh"
programs=$1
foresight=$programs/foresight

check "the driver finds two channels" eventually ip link show can1
check "scan says how to bring them up" exits 1 "$foresight" can scan
check "  in these words: ip link set can0 up type can bitrate 1000000" has /tmp/exits.log "ip link set can0 up type can bitrate 1000000"
for interface in can0 can1; do ip link set "$interface" up type can bitrate 500000 restart-ms 250; done
check "scan reads them" exits 0 "$foresight" can scan
check "  bit rate" has /tmp/exits.log "can0: error-active, can, 500 kbit/s"
check "  restart-ms" has /tmp/exits.log "restarts 250 ms after bus-off"
check "  error counters" has /tmp/exits.log "error counters 0 tx 0 rx"
check "FD is refused with what to type" exits 2 "$foresight" can dump can0 --fd --seconds 1
check "  in these words: dbitrate 4000000 fd on" has /tmp/exits.log "dbitrate 4000000 fd on"

listen can1 /tmp/dump.log "$foresight" can dump can1 --count 100 --seconds 30
for i in {1..100}; do printf '(%d.%06d) can0 %03X#%02X\n' 0 $((i * 5000)) $((256 + i)) "$i"; done >/tmp/hundred.candump
check "100 frames go out at their pace" exits 0 "$foresight" can replay /tmp/hundred.candump can0
sed 's/^/      /' /tmp/exits.log
wait "$listener"
check "  and arrive on the other channel" test "$(grep -c ' can1 ' /tmp/dump.log)" = 100
check "  as they were" diff <(cut -d' ' -f3 /tmp/hundred.candump) <(cut -d' ' -f3 /tmp/dump.log)
check "scan counts them" exits 0 "$foresight" can scan
check "  sent" has /tmp/exits.log "sent 100 (0 dropped)"
check "  received" has /tmp/exits.log "received 100 (0 dropped)"
ip link set can0 down
ip link set can0 up type can restart-ms 0
check "without restart-ms, scan says how to set it" exits 0 "$foresight" can scan
check "  in these words: stays bus-off" has /tmp/exits.log "stays bus-off"
finish
