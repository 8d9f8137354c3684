#include "tubebin/export/export_dataset.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "core/json_reader.hpp"
#include "export/formats.hpp"
#include "export/object_numbers.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/file_record.hpp"
#include "tubebin/core/path_status.hpp"
#include "tubebin/core/version.hpp"
#include "tubebin/dataset/dataset_folder.hpp"
#include "tubebin/dataset/manifest.hpp"
#include "tubebin/jobs/atomic_folder.hpp"
#include "tubebin/jobs/batch.hpp"
#include "tubebin/results/cloud_files.hpp"
#include "tubebin/scene/input_hashes.hpp"

namespace tubebin::exports {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kIndex = "index.json";
constexpr const char* kIndexFormat = "tubebin export 1";

/// With the settings of the drop, which Gazebo goes on with; of a data set without a configuration, the defaults.
dataset::DatasetConfig config_of(const std::string& dataset) {
  return path_exists(dataset + "/config.yaml") ? dataset::read_dataset_config(dataset) : dataset::DatasetConfig{};
}

ImageRegion region_of(const ExportOptions& options) { return options.crop ? ImageRegion::bin : ImageRegion::full; }

using MakeFormat = std::function<std::unique_ptr<ExportFormat>(const ExportOptions& options)>;

const std::map<std::string, MakeFormat>& formats() {
  static const std::map<std::string, MakeFormat> formats = {
      {"bop", [](const ExportOptions& options) { return bop_format(region_of(options)); }},
      {"coco", [](const ExportOptions& options) { return coco_format(region_of(options)); }},
      {"npz", [](const ExportOptions& options) { return npz_format(options.normals); }},
      {"ply", [](const ExportOptions&) { return ply_format(); }},
      {"sdf", [](const ExportOptions& options) { return sdf_format(config_of(options.dataset)); }}};
  return formats;
}

void check(const ExportOptions& options) {
  if (!formats().contains(options.format))
    throw_config_error("--format {}: unknown; one of {}", options.format, fmt::join(export_format_names(), ", "));
  if (options.crop && options.format != "bop" && options.format != "coco")
    throw_config_error("--crop: {} has no images; it goes with bop and coco", options.format);
  if (options.normals && options.format != "npz")
    throw_config_error("--normals: {} has none; it goes with npz", options.format);
}

/// The format and what was chosen with it, as the index has it.
std::string described(const ExportOptions& options) {
  return options.format + (options.crop ? " --crop" : "") + (options.normals ? " --normals" : "");
}

/// One line of the output's index: a scene, and what it was made from.
struct IndexLine {
  std::string scene;
  std::size_t tubes = 0;
  scene::InputHashes made_from;

  friend bool operator==(const IndexLine&, const IndexLine&) = default;
};

struct Source {
  IndexLine line;
  results::CloudFile cloud;
  std::vector<ObjectIdentity> tubes;
};

std::vector<Source> list_sources(const scene::DatasetFiles& dataset, const scene::DatasetHashes& hashes) {
  if (!path_exists(dataset.dataset()))
    throw_io_error("{}: is no data set: not a folder and not a pack", dataset.dataset());
  std::vector<Source> sources;
  for (const results::CloudFile& cloud : results::find_clouds(dataset)) {
    if (cloud.scene == ".") throw_io_error("{}: is a single scene; give the folder of its data set", dataset.dataset());
    const std::string text = dataset.read(cloud.scene, "scene.json");
    std::vector<ObjectIdentity> tubes;
    for (const scene::PlacedTube& placed :
         scene::parse_scene_json(text, dataset.place(cloud.scene, "scene.json")).scene.tubes)
      tubes.push_back(identify(placed.tube));
    sources.push_back({{cloud.scene, tubes.size(), hashes.of(cloud.scene)}, cloud, std::move(tubes)});
  }
  return sources;
}

std::vector<IndexLine> read_index(const std::string& path, const std::string& format) try {
  const Json index = parse_ordered_json(read_file(path), path);
  const auto expect = [&](const char* key, const std::string& wanted) {
    if (const std::string held = index.at(key); held != wanted)
      throw_config_error("{}: this export has {} {}, not {}; choose another --output", path, key, held, wanted);
  };
  expect("format", kIndexFormat);
  expect("export", format);
  expect("tool_version", tool_version());
  std::vector<IndexLine> lines;
  for (const Json& scene : index.at("scenes"))
    lines.push_back({ConfinedPath::parse(scene.at("scene").get_ref<const std::string&>(), path),
                     scene.at("tubes"),
                     {.cloud_xxh128 = scene.at("cloud_xxh128"), .scene_json_xxh128 = scene.at("scene_json_xxh128")}});
  return lines;
} catch (const Json::exception& error) {
  throw_io_error("{}: is no index of an export: {}", path, error.what());
}

std::string format_index(const std::vector<Source>& sources, const std::string& format) {
  Json scenes = Json::array();
  for (const Source& source : sources)
    scenes.push_back({{"scene", source.line.scene},
                      {"tubes", source.line.tubes},
                      {"scene_json_xxh128", source.line.made_from.scene_json_xxh128},
                      {"cloud_xxh128", source.line.made_from.cloud_xxh128}});
  return Json{{"format", kIndexFormat}, {"export", format}, {"tool_version", tool_version()}, {"scenes", scenes}}.dump(
             1) +
         "\n";
}

/// The sources in the order of what `output` holds already, so that scenes keep their numbers; new ones follow.
std::vector<Source> continue_index(const std::string& path, const std::vector<IndexLine>& held,
                                   std::vector<Source> sources) {
  std::vector<Source> ordered;
  for (const IndexLine& line : held) {
    const auto source = std::ranges::find(sources, line.scene, [](const Source& s) { return s.line.scene; });
    if (source == sources.end() || source->line != line)
      throw_config_error("{}: was made from another data set: scene {} {}; choose another --output", path, line.scene,
                         source == sources.end() ? "is not in this one" : "is another one there");
    ordered.push_back(std::move(*source));
    sources.erase(source);
  }
  std::ranges::move(sources, std::back_inserter(ordered));
  return ordered;
}

/// A folder with other things in it was hardly meant.
void refuse_if_no_export(const std::string& output) {
  if (!path_exists(output) || path_exists(output + "/index.json")) return;
  const auto is_foreign = [](const std::string& name) { return !name.starts_with('.'); };
  if (std::ranges::any_of(names_in_folder(output), is_foreign))
    throw_config_error("{}: holds files, but no export (index.json is missing); choose a new or empty folder", output);
}

/// Writes the index that says what the output is made from, and returns the scenes in its order.
std::vector<Source> update_index(const scene::DatasetFiles& dataset, const scene::DatasetHashes& hashes,
                                 const OutputFolder& output, const std::string& format) {
  const std::string path = output.place(kIndex);
  std::vector<Source> sources = list_sources(dataset, hashes);
  if (path_exists(path)) sources = continue_index(path, read_index(path, format), std::move(sources));
  write_atomically(output.make_entry(kIndex), format_index(sources, format));
  return sources;
}

std::vector<SceneEntry> number_scenes(const std::vector<Source>& sources) {
  std::vector<SceneEntry> entries;
  ObjectNumbers objects;
  int first_tube = 1;
  for (const Source& source : sources) {
    std::vector<TubeNumbers> tubes;
    for (const ObjectIdentity& tube : source.tubes) tubes.push_back(objects.number(tube));
    first_tube += static_cast<int>(tubes.size());
    entries.push_back({source.line.scene, static_cast<int>(entries.size()) + 1,
                       first_tube - static_cast<int>(tubes.size()), std::move(tubes)});
  }
  return entries;
}

/// In a worker process.
jobs::AttemptResult export_one(const ExportFormat& format, const scene::DatasetFiles& dataset,
                               const scene::DatasetHashes& hashes, const OutputFolder& output, const Source& source,
                               const SceneEntry& entry) {
  SceneFiles files;
  try {
    const auto& [scene, cloud] = source.cloud;
    const std::string bytes = dataset.read(scene, cloud), text = dataset.read(scene, "scene.json");
    hashes.require_recorded(scene, {record_bytes(bytes).xxh128, record_bytes(text).xxh128});
    scene::SceneRecord record = scene::parse_scene_json(text, dataset.place(scene, "scene.json"));
    load_mesh(record.scene.bin, dataset.dataset());
    cloud::Cloud points = scene::parse_scene_cloud(bytes, dataset.place(scene, cloud), record);
    scene::require_same_scene(record, points, scene, dataset.place(scene, "scene.json"));
    files = format.export_scene({entry, std::move(record), std::move(points)});
  } catch (const IoError& error) {
    return jobs::failed_attempt("unreadable", error.what());  // this scene's fault: the others go on
  }
  write_all_atomically(output, files.beside);
  const ConfinedPath path = format.scene_path(entry);
  if (const auto alone = files.scene.find(""); alone != files.scene.end()) {
    write_atomically(output.make_entry(path), alone->second);
    return jobs::successful_attempt("");
  }
  return jobs::successful_attempt([finish = jobs::begin_whole_folder(output, path, files.scene)] {
    finish();
    return std::string();
  });
}

/// What killed runs left, in all folders that scenes and the files beside them go to.
void remove_all_unfinished(const OutputFolder& output, const ConfinedPath& folder = {}) {
  jobs::remove_unfinished(output, folder);
  for (const std::string& name : names_in(output.open(folder)))
    if (!name.starts_with('.') && output.has_folder(folder / name)) remove_all_unfinished(output, folder / name);
}

}  // namespace

std::vector<std::string> export_format_names() {
  std::vector<std::string> names;
  for (const auto& [name, make] : formats()) names.push_back(name);
  return names;
}

ExportReport export_dataset(const ExportOptions& options, jobs::Progress::Style progress_style) try {
  const auto start = std::chrono::steady_clock::now();
  check(options);
  refuse_if_no_export(options.output);
  const scene::DatasetFiles dataset(options.dataset);
  const scene::DatasetHashes hashes(dataset);
  if (!path_exists(options.output)) list_sources(dataset, hashes);  // leaves no folder where there is nothing to export
  const OutputFolder output(options.output);
  const jobs::FolderLock lock(output);
  const std::vector<Source> sources = update_index(dataset, hashes, output, described(options));
  const std::vector<SceneEntry> entries = number_scenes(sources);
  const std::unique_ptr<ExportFormat> format = formats().at(options.format)(options);
  remove_all_unfinished(output);

  const auto is_complete = [&](const SceneEntry& entry) {
    const ConfinedPath path = format->scene_path(entry);
    return output.has_file(path) || output.has_folder(path);
  };
  ExportReport report{.scenes = entries.size(), .failed = {}};
  const auto work = [&](std::size_t job, int) {
    return export_one(*format, dataset, hashes, output, sources[job], entries[job]);
  };
  std::vector<std::size_t> made;
  const jobs::BatchReport done =
      jobs::run_batch({.size = entries.size(),
                       .noun = "scenes",
                       .pool = {.workers = options.jobs, .attempts_max = 1, .attempt_time_limit = options.time_limit},
                       .progress = progress_style,
                       .is_done = [&](std::size_t job) { return is_complete(entries[job]); },
                       .work = work,
                       .on_finished =
                           [&](const jobs::JobOutcome& outcome) {
                             if (outcome.succeeded) return made.push_back(outcome.job);
                             report.failed.push_back(
                                 fmt::format("{}: {}", entries[outcome.job].name, outcome.failed.back().for_people()));
                           }});
  for (const std::size_t i : made)
    if (!is_complete(entries[i])) report.failed.push_back(entries[i].name + ": was removed after it was made");
  report.complete_before = done.done_before;
  report.made = done.made;
  report.signal = done.signal;
  if (report.signal == 0) {
    write_atomically(output.make_entry(kIndex), format_index(sources, options.format));  // should it be gone
    std::vector<SceneEntry> complete;
    std::ranges::copy_if(entries, std::back_inserter(complete), is_complete);
    write_all_atomically(output, format->summarize(complete, options.output));
  }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
} catch (const Json::exception& error) {
  throw_io_error("{}: holds a damaged file: {}", options.output, error.what());
}

}  // namespace tubebin::exports
