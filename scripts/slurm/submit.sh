#!/usr/bin/env bash
# Submits a whole experiment to Slurm: generate as an array, merge, model as an array, evaluate, each after the one
# before. The folders must be seen by all nodes.
# Usage: scripts/slurm/submit.sh CONFIG.yaml DATASET RESULTS SHARDS [generate_dataset's further options...]
# Environment:
#   TUBEBIN_BIN      folder of the programs, where they are not on the PATH
#   MODEL_OPTIONS    further options of model_tubes, as "--ratios 0.1:1.0:0.1 --method both"
#   SBATCH_...       what sbatch reads by itself: SBATCH_PARTITION, SBATCH_ACCOUNT, SBATCH_TIMELIMIT, ...
set -euo pipefail
if [ $# -lt 4 ]; then
  sed -n '2,9s/^# \{0,1\}//p' "$0" >&2
  exit 2
fi
config=$(realpath "$1") dataset=$(realpath -m "$2") results=$(realpath -m "$3") shards=$4
shift 4
[ -z "${TUBEBIN_BIN:-}" ] || TUBEBIN_BIN=$(realpath "$TUBEBIN_BIN")
export TUBEBIN_BIN=${TUBEBIN_BIN:-}
task=$(dirname "$(realpath "$0")")/task.sbatch
read -ra model_options <<< "${MODEL_OPTIONS:-}"

# submit NAME SBATCH_OPTION... -- COMMAND...: prints the job's number.
submit() {
  local name=$1 options=()
  shift
  while [ "$1" != -- ]; do options+=("$1") && shift; done
  shift
  local id
  id=$(sbatch --parsable --job-name="tubebin-$name" --kill-on-invalid-dep=yes "${options[@]}" "$task" "$@")
  echo "${id%%;*}"
}

generate=$(submit generate --array="1-$shards" --output=%x-%A_%a.log -- generate_dataset "$config" --output "$dataset" "$@")
# Whatever became of the shards: merging names what is missing, and ends the chain there.
merge=$(submit merge --dependency="afterany:$generate" -- generate_dataset --merge "$dataset")
model=$(submit model --array="1-$shards" --output=%x-%A_%a.log --dependency="afterok:$merge" -- \
  model_tubes "$dataset" --output "$results" "${model_options[@]}")
evaluate=$(submit evaluate --dependency="afterany:$model" -- evaluate "$results" --html "$results/report.html")
echo "generate $generate, merge $merge, model $model, evaluate $evaluate"
