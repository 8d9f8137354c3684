// The scan's stages: Embree's tree, the rays of the bin's window, the whole image, and growth with tubes and
// pixels. Tubes lie where tests/scan/random_scene.hpp throws them: as many a pixel as in a settled scene,
// without physics.
#include <benchmark/benchmark.h>

#include "scan/random_scene.hpp"
#include "scan/ray_caster.hpp"
#include "tubebin/scan/scanner.hpp"

namespace tubebin {
namespace {

scene::Scene scene_of(int tubes, scene::ScanRegion region) {
  scene::Scene scene = testing::random_scene(tubes, 1);
  scene.scanner.region = region;
  return scene;
}

void report_pixels(benchmark::State& state, const scan::Scan& result) {
  state.counters["rays"] = result.window.width * result.window.height;
  state.counters["rays/s"] =
      benchmark::Counter(result.window.width * result.window.height, benchmark::Counter::kIsIterationInvariantRate);
}

void BM_BuildTree(benchmark::State& state) {
  const scene::Scene scene = scene_of(static_cast<int>(state.range(0)), scene::ScanRegion::bin);
  for (auto _ : state)
    benchmark::DoNotOptimize(
        scan::RayCaster(scan::scene_solids(scene), scene.scanner.range_min, scene.scanner.range_max));
}
BENCHMARK(BM_BuildTree)->ArgName("tubes")->Arg(1)->Arg(10)->Arg(100)->Unit(benchmark::kMillisecond);

void BM_ScanBinWindow(benchmark::State& state) {
  const scene::Scene scene = scene_of(static_cast<int>(state.range(0)), scene::ScanRegion::bin);
  for (auto _ : state) benchmark::DoNotOptimize(scan::scan(scene).cloud.points.data());
  report_pixels(state, scan::scan(scene));
}
BENCHMARK(BM_ScanBinWindow)
    ->ArgName("tubes")
    ->Arg(0)
    ->Arg(1)
    ->Arg(5)
    ->Arg(10)
    ->Arg(20)
    ->Arg(50)
    ->Arg(100)
    ->Unit(benchmark::kMillisecond);

void BM_ScanTubesAlone(benchmark::State& state) {
  const scene::Scene scene = scene_of(10, scene::ScanRegion::tubes);
  for (auto _ : state) benchmark::DoNotOptimize(scan::scan(scene).cloud.points.data());
  report_pixels(state, scan::scan(scene));
}
BENCHMARK(BM_ScanTubesAlone)->Unit(benchmark::kMillisecond);

void BM_ScanFullImage(benchmark::State& state) {
  const scene::Scene scene = scene_of(10, scene::ScanRegion::full);
  for (auto _ : state) benchmark::DoNotOptimize(scan::scan(scene).cloud.points.data());
  report_pixels(state, scan::scan(scene));
}
BENCHMARK(BM_ScanFullImage)->Unit(benchmark::kMillisecond);

/// Every ray of the image meets the bin or a tube; the image grows.
void BM_ScanPixels(benchmark::State& state) {
  scene::Scene scene = scene_of(10, scene::ScanRegion::full);
  const int width = static_cast<int>(state.range(0));
  testing::look_closely(scene.scanner, width, width * 5 / 8);
  scene.scanner.horizontal_fov_deg = 14.0;
  for (auto _ : state) benchmark::DoNotOptimize(scan::scan(scene).cloud.points.data());
  report_pixels(state, scan::scan(scene));
}
BENCHMARK(BM_ScanPixels)->ArgName("width")->Arg(240)->Arg(480)->Arg(960)->Arg(1920)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tubebin
