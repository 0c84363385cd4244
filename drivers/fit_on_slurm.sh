#!/usr/bin/env bash
# Fits the yarn of a fabric by job arrays of Slurm. The folder of the fit must be seen by all nodes.
#
#   drivers/fit_on_slurm.sh fabric.toml /shared/fit [options of wale fit]
#
# One array answers the questions of a round, a task each; the next round asks again for what a lost task did not answer.
set -euo pipefail
fabric="$1" out="$2"
shift 2
while :; do
    mkdir -p "$out/round"
    rm -f "$out"/round/*
    wale fit "$fabric" --out "$out" "$@" --ask > "$out/round/questions"
    count="$(wc -l < "$out/round/questions")"
    [ "$count" -gt 0 ] || break
    # `--wait` ends with an error if a task did; what the others answered is taken all the same.
    sbatch --wait --array="1-$count" --cpus-per-task=1 --output=/dev/null --wrap "
        sed -n \"\${SLURM_ARRAY_TASK_ID}p\" '$out/round/questions' \
            | wale fit '$fabric' --out '$out' --answer --threads 1 > '$out/round/'\${SLURM_ARRAY_TASK_ID}.part \
            && mv '$out/round/'\${SLURM_ARRAY_TASK_ID}.part '$out/round/'\${SLURM_ARRAY_TASK_ID}.answer" || true
    cat "$out"/round/*.answer | wale fit "$fabric" --out "$out" --tell -
done
rm -rf "$out/round"
exec wale fit "$fabric" --out "$out" "$@"
