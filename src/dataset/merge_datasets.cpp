#include "tubebin/dataset/merge_datasets.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>

#include "dataset/verify_scene.hpp"
#include "tubebin/core/path_status.hpp"
#include "tubebin/core/shell_word.hpp"
#include "tubebin/dataset/dataset_folder.hpp"
#include "tubebin/jobs/atomic_folder.hpp"
#include "tubebin/jobs/batch.hpp"
#include "tubebin/scene/dataset_files.hpp"

namespace tubebin::dataset {
namespace {

namespace fs = std::filesystem;

/// A folder that scenes come from; the first one is the output itself.
struct MergeSource {
  std::string folder;
  const Manifest* manifest;
  scene::DatasetFiles files;
};

DatasetConfig unite_configs(const std::vector<std::string>& folders) {
  DatasetConfig united = read_dataset_config(folders.front());
  require_own_version(united, folders.front());
  for (const std::string& folder : folders) {
    const DatasetConfig other = read_dataset_config(folder);
    if (const auto differing = differences(united, other); !differing.empty())
      throw_config_error("{} and {}: were made by different configurations, seeds or versions:\n  {}", folders.front(),
                         folder, fmt::join(differing, "\n  "));
    united = unite(united, other);
  }
  return united;
}

/// Those of the folders that are not the output by another name.
std::vector<std::string> other_folders(const std::string& output, const std::vector<std::string>& folders) {
  std::vector<std::string> others;
  for (const std::string& folder : folders) {
    if (!is_folder(folder)) throw_io_error("{}: is no data set: not a folder", folder);
    std::error_code error;
    if (!fs::equivalent(folder, output, error)) others.push_back(folder);
  }
  return others;
}

/// One merge: the scenes that are asked for, and where each may come from.
class Merge {
 public:
  Merge(DatasetFolder& output, const std::vector<std::string>& folders)
      : output_(output), scenes_(list_scenes(output.config())) {
    const std::string& folder = output.store().folder().path();
    sources_.push_back({folder, &output.manifest(), scene::DatasetFiles(folder)});
    for (const std::string& folder : folders) {
      manifests_.push_back(std::make_unique<Manifest>(folder));
      sources_.push_back({folder, manifests_.back().get(), scene::DatasetFiles(folder)});
    }
  }

  MergeReport run(int jobs, jobs::Progress::Style progress_style) {
    report_.scenes = scenes_.size();
    for (const MergeSource& source : sources_)
      std::ranges::copy(source.manifest->damaged_lines(), std::back_inserter(report_.problems));
    std::vector<std::string> recorded;
    for (const SceneId& scene : scenes_)
      (is_recorded(scene.name()) ? recorded : report_.missing).push_back(scene.name());
    report_.signal =
        jobs::run_batch(
            {.size = recorded.size(),
             .noun = "scenes",
             .pool = {.workers = jobs, .attempts_max = 1, .attempt_time_limit = output_.config().attempt_time_limit},
             .progress = progress_style,
             .work = [&](std::size_t job, int) { return take_scene(recorded[job]); },
             .on_finished = [&](const jobs::JobOutcome& outcome) { take_outcome(recorded[outcome.job], outcome); }})
            .signal;
    if (report_.signal == 0) conclude();
    return report_;
  }

 private:
  bool is_recorded(const std::string& scene) const {
    return std::ranges::any_of(sources_, [&](const MergeSource& s) { return s.manifest->find(scene) != nullptr; });
  }

  /// In a worker process: the first source that has the scene sound gives it to the output. Its number and what is
  /// wrong with others are the result.
  jobs::AttemptResult take_scene(const std::string& scene) const {
    std::vector<std::string> problems;
    std::optional<std::size_t> taken;
    for (std::size_t k = 0; k < sources_.size(); ++k) {
      const ManifestRecord* record = sources_[k].manifest->find(scene);
      if (record == nullptr) continue;
      std::vector<std::string> found = check_files(sources_[k].files, *record);
      if (found.empty() && taken && sources_[*taken].manifest->find(scene)->files != record->files)
        found.push_back("is not the same as in " + sources_[*taken].folder);
      if (found.empty() && !taken) taken = k;
      for (const std::string& problem : found)
        problems.push_back(fmt::format("{}/{}: {}", sources_[k].folder, scene, problem));
    }
    std::string text = fmt::format("{}\n{}", taken ? std::to_string(*taken) : "none", fmt::join(problems, "\n"));
    if (!taken || *taken == 0 || is_packed(*taken, scene)) return jobs::successful_attempt(text);
    return jobs::successful_attempt([text, arrive = link_scene(*taken, scene)] {
      arrive();
      return text;
    });
  }

  bool is_packed(std::size_t source, const std::string& scene) const {
    return sources_[source].manifest->find(scene)->pack.has_value();
  }

  std::function<void()> link_scene(std::size_t source, const std::string& scene) const {
    std::map<ConfinedPath, std::string> links;
    for (const auto& [name, file] : sources_[source].manifest->find(scene)->files)
      links[name] = fmt::format("{}/{}/{}", sources_[source].folder, scene, name);
    return jobs::begin_linked_folder(output_.store().folder(), scene, links);
  }

  void take_outcome(const std::string& scene, const jobs::JobOutcome& outcome) {
    if (!outcome.succeeded) {
      report_.problems.push_back(
          fmt::format("{}: could not be checked: {}", scene, outcome.failed.back().for_people()));
      report_.unchecked.push_back(scene);
      return;
    }
    const std::size_t end = outcome.text.find('\n');
    const std::string taken = outcome.text.substr(0, end);
    std::istringstream problems(outcome.text.substr(end + 1));
    for (std::string line; std::getline(problems, line);) report_.problems.push_back(line);
    if (taken == "none") {
      damaged_.push_back(scene);
      return;
    }
    ++report_.complete;
    if (taken != "0") record_taken(static_cast<std::size_t>(std::stoul(taken)), scene);
  }

  void record_taken(std::size_t source, const std::string& scene) {
    const ManifestRecord& record = *sources_[source].manifest->find(scene);
    if (record.pack) take_pack(source, *record.pack);
    output_.manifest().append(record);
  }

  /// Packs keep their names; shards of one call have different ones.
  void take_pack(std::size_t source, const ConfinedPath& pack) {
    const auto [owner, is_new] = pack_owner_.try_emplace(pack, source);
    const auto refuse = [&](std::size_t other) {
      throw_config_error("{} and {}: both have a pack {}, with different scenes; choose another output for one of them",
                         sources_[other].folder, sources_[source].folder, pack);
    };
    if (owner->second != source) refuse(owner->second);
    if (!is_new) return;
    for (const auto& [scene, record] : output_.manifest().records())  // of an earlier merge, or of another pack?
      if (record.pack == pack && !has_in_pack(source, record)) refuse(0);
    jobs::link_file(scene::packs_folder(sources_[source].folder) + "/" + pack.str(), output_.store().folder(),
                    ConfinedPath("packs") / pack);
  }

  bool has_in_pack(std::size_t source, const ManifestRecord& record) const {
    const ManifestRecord* there = sources_[source].manifest->find(record.id);
    return there != nullptr && there->pack == record.pack && there->pack_end == record.pack_end;
  }

  void conclude() {
    std::sort(report_.problems.begin(), report_.problems.end());
    const std::string& folder = output_.store().folder().path();
    const bool is_joined = sources_.size() > 1;
    if (is_joined && !damaged_.empty()) output_.manifest().rewrite_without({damaged_.begin(), damaged_.end()});
    // Shards may still be at work in a folder that isn't complete.
    if (is_joined || report_.complete == report_.scenes) output_.manifest().rewrite(scenes_);
    if (!damaged_.empty() && !is_joined)
      report_.commands.push_back(fmt::format("generate_dataset --verify {} --repair", shell_path(folder)));
    if (!report_.missing.empty() || (!damaged_.empty() && is_joined))
      report_.commands.push_back(
          fmt::format("generate_dataset {} --output {}", shell_path(folder + "/config.yaml"), shell_path(folder)));
    if (is_joined) report_.missing.insert(report_.missing.end(), damaged_.begin(), damaged_.end());
  }

  DatasetFolder& output_;
  std::vector<SceneId> scenes_;
  std::vector<std::unique_ptr<Manifest>> manifests_;
  std::vector<MergeSource> sources_;
  std::map<ConfinedPath, std::size_t> pack_owner_;
  std::vector<std::string> damaged_;  ///< scenes that no source has sound
  MergeReport report_;
};

}  // namespace

MergeReport merge_datasets(const std::string& output, const std::vector<std::string>& folders, int jobs,
                           jobs::Progress::Style progress) {
  const std::vector<std::string> others = other_folders(output, folders);
  DatasetFolder folder(output, unite_configs(others.empty() ? std::vector{output} : others));
  return Merge(folder, others).run(jobs, progress);
}

}  // namespace tubebin::dataset
