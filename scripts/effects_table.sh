#!/usr/bin/env bash
# Micro-recall of both methods as the effects of config/scanner_zivid_like.yaml are added one after the other: the table of
# docs/scanner_effects.md. The same scenes in every row; the seed is one that nothing was tuned with.
# Usage: scripts/effects_table.sh [FOLDER]     keeps data sets and results in FOLDER, and goes on where it was stopped
#        CASES=8 JOBS=2 scripts/effects_table.sh
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-$(mktemp -d)}
cases=${CASES:-20}
jobs=${JOBS:-$(nproc)}
bin=${BIN:-build/bin}
mkdir -p "$folder"

# The steps in a pixel's order of measurement, each with the key that switches it off.
steps=(lateral projector dropouts mixed range outliers quantization)
declare -A off=(
  [lateral]='lateral_noise: 0'
  [projector]='projector: {enabled: false}'
  [dropouts]='dropouts: {signal_min: 0, tube_glare_angle_deg: 0, bin_glare_angle_deg: 0}'
  [mixed]='mixed_pixels: {share: 0}'
  [range]='range_noise: {sigma: 0}'
  [outliers]='outliers: {share: 0}'
  [quantization]='quantization: 0')
declare -A name=(
  [lateral]='lateral noise' [projector]='projector' [dropouts]='drop-outs' [mixed]='mixed pixels'
  [range]='range noise' [outliers]='outliers' [quantization]='quantization: all of `scanner_zivid_like.yaml`')

measure() {  # ROW TITLE CONFIG_LINES...
  local row=$1 title=$2
  shift 2
  { echo "include: $PWD/config/scanner_zivid_like.yaml"
    echo "seed: 5150"
    echo "tubes: [10]"
    echo "cases: $cases"
    echo "scanner:"
    echo "  effects:"
    [ $# -gt 0 ] && printf '    %s\n' "$@" || echo "    reference_distance: 2.0"
    echo "output: {clean_cloud: false}"
  } > "$folder/$row.yaml"
  "$bin/generate_dataset" "$folder/$row.yaml" --output "$folder/$row" --jobs "$jobs" --quiet > /dev/null
  "$bin/model_tubes" "$folder/$row" --output "$folder/${row}_results" --method both --jobs "$jobs" --quiet > /dev/null
  "$bin/evaluate" "$folder/${row}_results" --format json 2> /dev/null > "$folder/$row.json"
  python3 - "$title" "$folder/$row.json" << 'END'
import json, sys
groups = {group["method"]: group for group in json.load(open(sys.argv[2]))["groups"]}
cells = ["{micro_recall:.4f} [{micro_recall_low:.4f}, {micro_recall_high:.4f}]".format(**groups[method])
         for method in ("centerline", "region_growing")]
print(f"| {sys.argv[1]} | {cells[0]} | {cells[1]} |", flush=True)
END
}

echo "| effects | \`centerline\` | \`region_growing\` |"
echo "| --- | ---: | ---: |"
for ((added = 0; added <= ${#steps[@]}; ++added)); do
  lines=()
  for step in "${steps[@]:added}"; do lines+=("${off[$step]}"); done
  if ((added == 0)); then title='none: exact rays'; else title="+ ${name[${steps[added - 1]}]}"; fi
  measure "$added" "$title" ${lines[@]+"${lines[@]}"}
done
measure calibrated '+ calibration error: 1 mm along x, 0.05 degrees about y, 0.1 % of the focal length' \
  'calibration: {position: [0.001, 0, 0], rotation_deg: [0, 0.05, 0], focal: 0.001}'
