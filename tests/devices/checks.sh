# Shared by the checks that run in the guest; source it, do not run it.
failures=0

# check TEXT COMMAND...: says whether COMMAND succeeds.
check() {
  local text=$1
  shift
  if "$@"; then
    printf 'ok    %s\n' "$text"
  else
    printf 'FAIL  %s\n' "$text"
    failures=$((failures + 1))
  fi
}

# has FILE TEXT: FILE has TEXT; else shows the file.
has() {
  grep -qF -- "$2" "$1" && return 0
  printf '      no "%s" in:\n' "$2"
  sed 's/^/      | /' "$1"
  return 1
}

# eventually COMMAND...: within $patience seconds, or 5.
eventually() {
  local try
  for ((try = 0; try < ${patience:-5} * 10; ++try)); do
    "$@" >/dev/null 2>&1 && return 0
    sleep 0.1
  done
  "$@"
}

# listeners INTERFACE: how many receivers the kernel has on it. Starting a program takes seconds in the guest: only this
# says that it listens.
listeners() { cat /proc/net/can/rcvlist_{all,fil,sff,eff} | grep -c "^ *$1 "; }
more_listeners() { [ "$(listeners "$1")" -gt "$2" ]; }

# listen INTERFACE LOG COMMAND...: starts COMMAND and returns when it listens; $listener is its process.
listen() {
  local interface=$1 log=$2 before try
  shift 2
  before=$(listeners "$interface")
  "$@" >"$log" 2>&1 3>&- &
  listener=$!
  for try in {1..150}; do
    more_listeners "$interface" "$before" && return 0
    sleep 0.1
  done
  printf '      nobody listens: %s\n' "$*"
}
stop_listening() { kill -INT "$listener" 2>/dev/null; wait "$listener" 2>/dev/null; }

# exits CODE COMMAND...
exits() {
  local expected=$1 code=0
  shift
  "$@" >/tmp/exits.log 2>&1 || code=$?
  [ "$code" = "$expected" ] && return 0
  printf '      exit code %s instead of %s:\n' "$code" "$expected"
  sed 's/^/      | /' /tmp/exits.log
  return 1
}

# gtest PROGRAM FILTER: there are such tests, all pass, and none skips.
gtest() {
  "$1" --gtest_filter="$2" --gtest_brief=1 >/tmp/gtest.log 2>&1 && ! grep -qE 'SKIPPED|] 0 tests' /tmp/gtest.log &&
    sed -n 's/^\[==========\] \(.*ran\. .*\)/      \1/p; s/^noticed /      &/p' /tmp/gtest.log && return 0
  sed 's/^/      | /' /tmp/gtest.log
  return 1
}

# recorded FOLDER: what `foresight record` has just written has as many images on both sides as it said, and 8 at least.
recorded() {
  local pairs images
  sed 's/^/      /' /tmp/exits.log
  pairs=$(sed -n 's/^record: \([0-9]*\) pairs.*/\1/p' /tmp/exits.log)
  for images in rgb rgb_right; do [ "$(grep -vc '^#' "$1/$images.txt")" = "$pairs" ] || return 1; done
  [ "$pairs" -ge 8 ]
}

# finish: ends with what the checks said.
finish() {
  [ "$failures" = 0 ] || printf '%s checks failed\n' "$failures"
  exit $((failures > 0))
}
