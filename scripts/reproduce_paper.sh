#!/usr/bin/env bash
# Repeats the paper's experiments and writes docs/reproduction.md: sets A and B (1 to 15 and 20 tubes, 20 cases each: 640
# clouds), every cloud modelled at ten downsampling ratios by both methods, and everything set beside the paper.
#
# Usage: scripts/reproduce_paper.sh [--output DIR] [--cases N] [--slow-cases N] [--jobs N] [--published DIR]
#   --output DIR      where clouds and results go, under 3 GB (default: results_reproduction)
#   --cases N         cases for each number of tubes (default: 20, as in the paper)
#   --slow-cases N    cases that region_growing models (default: as --cases)
#   --jobs N          worker processes (default: one for each core); times are cleanest with no more than cores
#   --published DIR   also compare with scenes of the published data set: a folder of its tube_configurations files,
#                     named as A10_1.txt (set A, ten tubes, case 1)
# After an interruption the same command goes on where it stopped.
set -euo pipefail
root=$(realpath "$(dirname "$0")/..")
output=results_reproduction
cases=20
slow_cases=
published=
jobs=$(nproc)
while [ $# -gt 0 ]; do
  case $1 in
    --output) output=$2 ;;
    --cases) cases=$2 ;;
    --slow-cases) slow_cases=$2 ;;
    --jobs) jobs=$2 ;;
    --published) published=$(realpath "$2") ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) echo "$0: unknown option $1; see --help" >&2; exit 2 ;;
  esac
  [ $# -ge 2 ] || { echo "$0: $1 needs a value" >&2; exit 2; }
  shift 2
done
slow_cases=${slow_cases:-$cases}
bin=$root/build/bin
ratios=0.1:1.0:0.1
mkdir -p "$output"
output=$(realpath "$output")
seconds=$output/seconds.tsv
touch "$seconds"

# part NAME COMMAND...: runs the command and adds what it took to what the part took before.
# A command that finished with some scenes named as failed (exit 3) does not end the reproduction.
part() {
  local name=$1 start=$EPOCHREALTIME status=0
  shift
  echo "== $name" >&2
  "$@" || status=$?
  awk -v a="$start" -v b="$EPOCHREALTIME" -v name="$name" 'BEGIN { printf "%s\t%.1f\n", name, b - a }' >> "$seconds"
  [ $status -eq 0 ] || [ $status -eq 3 ] || exit $status
}

build() {
  cmake -S "$root" -B "$root/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DTUBEBIN_BENCH=ON > /dev/null
  cmake --build "$root/build" --target generate_dataset model_tubes evaluate piles_table
}

generate() {  # SET
  printf 'include: %s\noutput:\n  format: pcd_compressed\n' "$root/config/set_$1.yaml" > "$output/set_$1.yaml"
  "$bin/generate_dataset" "$output/set_$1.yaml" --output "$output/dataset_$1" --cases "$cases" --jobs "$jobs"
}

model() {  # SET METHOD CASES
  "$bin/model_tubes" "$output/dataset_$1" --output "$output/$2_$1" --method "$2" --ratios "$ratios" --cases "$3" \
    --jobs "$jobs"
}

evaluate() {
  local status=0
  "$bin/evaluate" "$output"/{centerline,region_growing}_{a,b} --paper --format markdown \
    --html "$output/report.html" --plots "$root/docs/reproduction" > "$output/tables.md" || status=$?
  [ $status -eq 0 ] || [ $status -eq 3 ] || return $status
  "$bin/evaluate" "$output"/{centerline,region_growing}_{a,b} --format csv --quiet > "$root/docs/reproduction/groups.csv" ||
    [ $? -eq 3 ]
  return $status
}

# The published scenes, scanned and modelled, and their piles beside ours in the same bin.
published_scenes() {
  local set status=0
  for set in a b; do
    printf 'include: %s\nscanner:\n  region: tubes\n' "$root/config/published_$set.yaml" > "$output/published_$set.yaml"
    "$bin/generate_dataset" "$output/published_$set.yaml" --output "$output/published_$set" --tubes 1,5,10,15,20 \
      --cases "$cases" --jobs "$jobs" > /dev/null || [ $? -eq 3 ] || return 1
  done
  "$root/build/bench/piles_table" "$published" "$output/published_scenes" "$output/published_a" "$output/published_b" \
    > "$output/piles.md" || return 1
  "$bin/model_tubes" "$output/published_scenes" --output "$output/published_results" --method both --ratios 0.3,1.0 \
    --jobs "$jobs" || [ $? -eq 3 ] || return 1
  "$bin/evaluate" "$output/published_results" --format markdown > "$output/published.md" || status=$?
  return $status
}

# The parts in the order of their first run, each with all its time.
time_table() {
  echo "| part | time |"
  echo "| --- | ---: |"
  awk -F '\t' '!($1 in sum) { order[++n] = $1 } { sum[$1] += $2; all += $2 }
    function text(s) { return s < 120 ? sprintf("%.1f s", s) : sprintf("%.1f min", s / 60) }
    END { for (i = 1; i <= n; ++i) printf "| %s | %s |\n", order[i], text(sum[order[i]]); printf "| all | %s |\n", text(all) }' \
    "$seconds"
}

figure() {  # NAME CAPTION
  if [ -f "$root/docs/reproduction/$1.svg" ]; then printf '![%s](reproduction/%s.svg)\n\n' "$2" "$1"; fi
}

write_document() {
  local document=$root/docs/reproduction.md
  {
    cat << EOF
# The paper, reproduced

Leão, Costa, Sousa, Reis, Veiga: Using Simulation to Evaluate a Tube Perception Algorithm for Bin Picking (Robotics
2022, 11, 46), its experiments repeated from nothing. \`scripts/reproduce_paper.sh\` made this page; its numbers are
measured, its verdicts computed ([docs/metrics.md](metrics.md) says how).

- Sets A and B as the paper's text gives them: 1 to 15 and 20 tubes, $cases cases each.
- Every cloud modelled at the downsampling ratios 0.1 to 1.0 by \`centerline\`, the default method, and the first
  $slow_cases cases of each number of tubes by \`region_growing\`, the paper's method (Section 4).
- Machine: $(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -1), $(nproc) cores, $jobs worker processes.
  The paper's times are from an Intel i7-8750H.
- tubebin $("$bin/evaluate" --version | awk '{ print $NF }'); the groups' means with all measures are in
  [reproduction/groups.csv](reproduction/groups.csv).

## Times

$(time_table)

## Figures

EOF
    figure figure_8 "Micro-recall by number of tubes"
    figure figure_9 "Micro-recall by downsampling ratio"
    figure table_1 "Seconds to generate a test case"
    figure table_2_centerline "Seconds to model a cloud, centerline"
    figure table_2_region_growing "Seconds to model a cloud, region_growing"
    if [ -f "$root/docs/reproduction_notes.md" ]; then cat "$root/docs/reproduction_notes.md"; echo; fi
    echo "## Tables and claims"
    echo
    cat "$output/tables.md"
    if [ -n "$published" ]; then
      echo
      echo "## The published scenes"
      echo
      echo "$(find "$published" -name '*.txt' | wc -l) scenes that the paper's authors settled with Gazebo, scanned and modelled"
      echo "here. Set C's tubes branch, which \`region_growing\` does not model."
      echo
      cat "$output/published.md"
      echo
      echo "### Do our piles look like theirs?"
      echo
      echo "Ours are from \`config/published_a.yaml\` and \`config/published_b.yaml\`: the published bin and tubes, our physics."
      echo "A tube touches another where their surfaces are less than 0.25 mm apart."
      echo
      cat "$output/piles.md"
    fi
  } > "$document.tmp"
  mv "$document.tmp" "$document"
}

part "build" build
part "generate set A" generate a
part "generate set B" generate b
part "model set A, centerline" model a centerline "$cases"
part "model set B, centerline" model b centerline "$cases"
part "model set A, region_growing" model a region_growing "$slow_cases"
part "model set B, region_growing" model b region_growing "$slow_cases"
part "evaluate" evaluate
if [ -n "$published" ]; then part "published scenes" published_scenes; fi
write_document

echo
time_table
echo
echo "Disk: $(du -sh "$output" | cut -f1) in $output"
echo "Written: $root/docs/reproduction.md, docs/reproduction/*.svg; report with pictures: $output/report.html"
