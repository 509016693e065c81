# Shared by the scripts in this folder; source it, do not run it.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
script=${0##*/}

say() { printf '\n== %s: %s\n' "$script" "$*" >&2; }
fail() { printf '%s: %s\n' "$script" "$*" >&2; exit 1; }
# The comment at the head of the calling script is its help text.
usage() { sed -n '2,/^[^#]/{s/^# \{0,1\}//p}' "$0"; }

# Compilers need about 1.5 GB each; FORESIGHT_JOBS overrides.
jobs() {
  local cores memory
  cores=$(nproc)
  memory=$(awk '/^MemAvailable/ {print int($2 / 1572864)}' /proc/meminfo)
  [ "$memory" -ge 1 ] || memory=1
  echo "${FORESIGHT_JOBS:-$((cores < memory ? cores : memory))}"
}

# build_preset NAME [TARGET]: configures the CMake preset NAME and builds it, or one target of it. FORESIGHT_UNITY=ON
# joins files where nothing is built yet: a third less to do then, but more after each change of one.
build_preset() {
  local unity=()
  [ -z "${FORESIGHT_UNITY:-}" ] || [ -e "$root/build/$1/CMakeCache.txt" ] || unity=("-DFORESIGHT_UNITY=$FORESIGHT_UNITY")
  say "building ${2:-all} of preset $1 with $(jobs) jobs"
  (cd "$root" && cmake --preset "$1" "${unity[@]}" >/dev/null &&
    cmake --build --preset "$1" --parallel "$(jobs)" ${2:+--target "$2"}) ||
    fail "the build of preset $1 failed; the first error above says why"
}
