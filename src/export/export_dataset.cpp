#include "tubebin/export/export_dataset.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <nlohmann/json.hpp>

#include "export/formats.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/file_record.hpp"
#include "tubebin/core/version.hpp"
#include "tubebin/dataset/dataset_folder.hpp"
#include "tubebin/dataset/manifest.hpp"
#include "tubebin/jobs/atomic_folder.hpp"
#include "tubebin/jobs/worker_pool.hpp"
#include "tubebin/results/cloud_files.hpp"

namespace tubebin::exports {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kIndexFormat = "tubebin export 1";

/// The settings of the drop, which Gazebo goes on with; of a data set without a configuration, the defaults.
physics::PhysicsOptions physics_of(const std::string& dataset) {
  return fs::exists(dataset + "/config.yaml") ? dataset::read_dataset_config(dataset).physics
                                              : physics::PhysicsOptions{};
}

const std::map<std::string, std::function<std::unique_ptr<ExportFormat>(const std::string& dataset)>>& formats() {
  static const std::map<std::string, std::function<std::unique_ptr<ExportFormat>(const std::string&)>> formats = {
      {"bop", [](const std::string&) { return bop_format(); }},
      {"coco", [](const std::string&) { return coco_format(); }},
      {"npz", [](const std::string&) { return npz_format(); }},
      {"ply", [](const std::string&) { return ply_format(); }},
      {"sdf", [](const std::string& dataset) { return sdf_format(physics_of(dataset)); }}};
  return formats;
}

/// One line of the output's index: a scene, and what it was made from.
struct IndexLine {
  std::string scene;
  std::size_t tubes = 0;
  std::string scene_json_xxh128;

  friend bool operator==(const IndexLine&, const IndexLine&) = default;
};

struct Source {
  IndexLine line;
  results::CloudFile cloud;
};

std::vector<Source> list_sources(const scene::DatasetFiles& dataset) {
  if (!fs::exists(dataset.dataset()))
    throw_io_error("{}: is no data set: not a folder and not a pack", dataset.dataset());
  std::vector<Source> sources;
  for (const results::CloudFile& cloud : results::find_clouds(dataset)) {
    if (cloud.scene == ".") throw_io_error("{}: is a single scene; give the folder of its data set", dataset.dataset());
    const std::string text = dataset.read(cloud.scene, "scene.json");
    const std::size_t tubes =
        scene::parse_scene_json(text, dataset.place(cloud.scene, "scene.json")).scene.tubes.size();
    sources.push_back({{cloud.scene, tubes, record_bytes(text).xxh128}, cloud});
  }
  return sources;
}

std::vector<IndexLine> read_index(const std::string& path, const std::string& format) try {
  const Json index = Json::parse(read_file(path));
  const auto expect = [&](const char* key, const std::string& wanted) {
    if (const std::string held = index.at(key); held != wanted)
      throw_config_error("{}: this export has {} {}, not {}; choose another --output", path, key, held, wanted);
  };
  expect("format", kIndexFormat);
  expect("export", format);
  expect("tool_version", tool_version());
  std::vector<IndexLine> lines;
  for (const Json& scene : index.at("scenes"))
    lines.push_back({scene.at("scene"), scene.at("tubes"), scene.at("scene_json_xxh128")});
  return lines;
} catch (const Json::exception& error) {
  throw_io_error("{}: is no index of an export: {}", path, error.what());
}

std::string format_index(const std::vector<Source>& sources, const std::string& format) {
  Json scenes = Json::array();
  for (const Source& source : sources)
    scenes.push_back({{"scene", source.line.scene},
                      {"tubes", source.line.tubes},
                      {"scene_json_xxh128", source.line.scene_json_xxh128}});
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
  if (!fs::exists(output) || fs::exists(output + "/index.json")) return;
  for (const fs::directory_entry& entry : fs::directory_iterator(output))
    if (const std::string name = entry.path().filename(); !name.starts_with('.') && !name.starts_with("index.json."))
      throw_config_error("{}: holds files, but no export (index.json is missing); choose a new or empty folder",
                         output);
}

/// Writes the index that says what the output is made from, and returns the scenes in its order.
std::vector<Source> settle_index(const scene::DatasetFiles& dataset, const ExportOptions& options) {
  const std::string path = options.output + "/index.json";
  std::vector<Source> sources = list_sources(dataset);
  if (fs::exists(path)) {
    sources = continue_index(path, read_index(path, options.format), std::move(sources));
  }
  write_file_atomically(path, format_index(sources, options.format));
  return sources;
}

std::vector<SceneEntry> number_scenes(const std::vector<Source>& sources) {
  std::vector<SceneEntry> entries;
  int first_object = 1;
  for (const Source& source : sources) {
    const int tubes = static_cast<int>(source.line.tubes);
    entries.push_back({source.line.scene, static_cast<int>(entries.size()) + 1, first_object, tubes});
    first_object += tubes;
  }
  return entries;
}

void write_below(const std::string& output, const Files& files) {
  for (const auto& [name, bytes] : files) {
    const std::string path = output + "/" + name;
    fs::create_directories(fs::path(path).parent_path());
    write_file_atomically(path, bytes);
  }
}

/// In a worker process.
jobs::AttemptResult export_one(const ExportFormat& format, const scene::DatasetFiles& dataset,
                               const std::string& output, const Source& source, const SceneEntry& entry) {
  SceneFiles files;
  try {
    const auto& [scene, cloud] = source.cloud;
    files = format.export_scene(
        {entry, scene::parse_scene_json(dataset.read(scene, "scene.json"), dataset.place(scene, "scene.json")),
         cloud::parse_cloud(dataset.read(scene, cloud), dataset.place(scene, cloud))});
  } catch (const IoError& error) {
    return jobs::failed_attempt("unreadable", error.what());  // this scene's fault: the others go on
  }
  write_below(output, files.beside);
  const std::string path = output + "/" + format.scene_path(entry);
  if (const auto alone = files.scene.find(""); alone != files.scene.end()) {
    fs::create_directories(fs::path(path).parent_path());
    write_file_atomically(path, alone->second);
    return jobs::successful_attempt("");
  }
  return jobs::successful_attempt([finish = jobs::begin_whole_folder(path, files.scene)] {
    finish();
    return std::string();
  });
}

void remove_unfinished(const std::string& output) {
  std::vector<fs::path> unfinished;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(output))
    if (entry.is_directory() && jobs::is_unfinished_folder(entry.path().string())) unfinished.push_back(entry.path());
  for (const fs::path& path : unfinished) fs::remove_all(path);
}

}  // namespace

std::vector<std::string> export_format_names() {
  std::vector<std::string> names;
  for (const auto& [name, make] : formats()) names.push_back(name);
  return names;
}

ExportReport export_dataset(const ExportOptions& options, jobs::Progress::Style progress_style) try {
  const auto start = std::chrono::steady_clock::now();
  const auto known = formats().find(options.format);
  if (known == formats().end())
    throw_config_error("--format {}: unknown; one of {}", options.format, fmt::join(export_format_names(), ", "));
  refuse_if_no_export(options.output);
  const scene::DatasetFiles dataset(options.dataset);
  if (!fs::exists(options.output)) list_sources(dataset);  // leaves no folder where there is nothing to export
  fs::create_directories(options.output);
  const jobs::FolderLock lock(options.output);
  const std::vector<Source> sources = settle_index(dataset, options);
  const std::vector<SceneEntry> entries = number_scenes(sources);
  const std::unique_ptr<ExportFormat> format = known->second(options.dataset);
  remove_unfinished(options.output);

  const auto is_complete = [&](const SceneEntry& entry) {
    return fs::exists(options.output + "/" + format->scene_path(entry));
  };
  std::vector<std::size_t> missing;
  for (std::size_t i = 0; i < entries.size(); ++i)
    if (!is_complete(entries[i])) missing.push_back(i);
  ExportReport report{.scenes = entries.size(), .complete_before = entries.size() - missing.size(), .failed = {}};
  jobs::Progress progress(missing.size(), "scenes", progress_style);
  const jobs::PoolEvents events{
      .on_finished =
          [&](const jobs::JobOutcome& outcome) {
            progress.count_done();
            if (outcome.succeeded) return;
            const jobs::FailedAttempt& last = outcome.failed.back();
            report.failed.push_back(fmt::format("{}: {}", entries[outcome.job].name, last.for_people()));
          },
      .on_tick = [&] { progress.show(); }};
  const jobs::PoolReport pool = jobs::run_jobs(
      missing, {.workers = options.jobs, .attempts_max = 1, .attempt_time_limit = options.time_limit},
      [&](std::size_t job, int) { return export_one(*format, dataset, options.output, sources[job], entries[job]); },
      events);
  report.made = pool.succeeded;
  report.signal = pool.signal;
  if (report.signal == 0) {
    std::vector<SceneEntry> complete;
    std::ranges::copy_if(entries, std::back_inserter(complete), is_complete);
    write_below(options.output, format->summarize(complete, options.output));
  }
  report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return report;
} catch (const fs::filesystem_error& error) {
  throw_io_error("{}", error.what());
} catch (const Json::exception& error) {
  throw_io_error("{}: holds a damaged file: {}", options.output, error.what());
}

}  // namespace tubebin::exports
