#!/usr/bin/env bash
# Scenes through GNU parallel: parallel.sh SCENES.jsonl RESULTS.jsonl [options of parallel, as --sshloginfile hosts]
# The exit codes 2 and 3 are lines of invalid scenes and of scenes without convergence: the lines are there.
set -euo pipefail
scenes="$1" results="$2"
shift 2
parallel --pipe -N 500 --line-buffer --retries 3 "$@" \
  'implant-preview simulate - --lines --unordered --fields status,contact_force_n,strain.max_principal || [ $? = 2 -o $? = 3 ]' \
  <"$scenes" >"$results"
