#!/usr/bin/env bash
# The mission server and a simulated robot for every name in a mission file, at once: ./run.sh [FILE.json]
# Needs missionfsm on PATH. PORT, DURATION (seconds that a mission takes) and OPTIONS (of dispatch) come from outside.
set -euo pipefail
file=${1:-$(dirname "$0")/walkthrough.json}
port=${PORT:-9998}
names=$(python3 -c 'import json, sys; print("\n".join({m["robot"]: 0 for m in json.load(open(sys.argv[1]))["missions"]}))' "$file")
robots=()
trap 'kill "${robots[@]}" 2>/dev/null; wait' EXIT
while read -r name; do
    missionfsm robot --name "$name" --port "$port" --duration "${DURATION:-1}" >/dev/null 2>&1 &
    robots+=($!)
done <<<"$names"
# shellcheck disable=SC2086 - options are several words
missionfsm dispatch "$file" --port "$port" ${OPTIONS:-}
