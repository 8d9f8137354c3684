#!/usr/bin/env bash
# Makes many scenes of one tube in shards, one shard after the other, and prints how memory grows and how long a start takes
# when all is there: the figures of docs/scale_out.md.
# Usage: scripts/long_run.sh BIN_DIR FOLDER [SCENES [SHARDS]]     FOLDER is new; default: 20000 scenes in 4 shards
set -euo pipefail
bin=$(realpath "$1") folder=$2 scenes=${3:-20000} shards=${4:-4}
mkdir "$folder"
cat > "$folder/long.yaml" << CONFIG
set: L
seed: 7
tubes: [1]
cases: $scenes
tube: {length: 0.2, cylinder_count_max: 6}
scanner: {width: 160, height: 100}
CONFIG
generate() { "$bin/generate_dataset" "$folder/long.yaml" --output "$folder/data" --jobs 2 --quiet "$@" > /dev/null; }
resident() { awk '/VmRSS/ { printf "%.1f ", $2 / 1024 }' "/proc/$1/status" 2> /dev/null || true; }

echo "shard scenes | resident MB: process that hands out, workers"
for shard in $(seq "$shards"); do
  generate --shard "$shard/$shards" &
  shell=$!
  while kill -0 $shell 2> /dev/null; do
    sleep 5
    for process in $(pgrep --parent $shell || true); do
      made=$(cat "$folder"/data/manifest.parts/"$(printf %05d "$shard")"-of-* 2> /dev/null | wc -l)
      echo "$shard $made | $(resident "$process")$(for worker in $(pgrep --parent "$process"); do resident "$worker"; done)"
    done
  done
  wait $shell
done

exec 2>&1 # where `time` writes
TIMEFORMAT='%R s (%U user, %S system)'
echo -n "start of a shard when all is there: " && time generate --shard "1/$shards"
echo -n "merge: " && time "$bin/generate_dataset" --merge "$folder/data" --jobs 2 --quiet > /dev/null
echo -n "start of the whole when all is there: " && time generate
echo "most entries in a folder: $(find "$folder/data" -mindepth 1 -printf '%h\n' | sort | uniq -c | sort -rn | head -n 1)"
du -sh "$folder/data"
