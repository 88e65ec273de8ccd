#!/usr/bin/env bash
# Scenes through a Slurm array: sbatch --array=0-99 slurm.sh SCENES.jsonl FOLDER
# Task k solves every hundredth line; a task that was ended goes on by --skip-done. All results: cat FOLDER/*.jsonl.
# The exit codes 2 and 3 are lines of invalid scenes and of scenes without convergence: the lines are there.
#SBATCH --cpus-per-task=4
#SBATCH --requeue
set -euo pipefail
mkdir -p "$2"
out="$2/$SLURM_ARRAY_TASK_ID.jsonl"
awk -v k="$SLURM_ARRAY_TASK_ID" -v n="$SLURM_ARRAY_TASK_COUNT" '(NR - 1) % n == k' "$1" |
  implant-preview simulate - --lines --unordered --fields status,contact_force_n,strain.max_principal \
    --out "$out" --skip-done "$out" || [ $? = 2 -o $? = 3 ]
