#include "tubebin/dataset/manifest.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/json_reader.hpp"
#include "jobs/append_line.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/path_status.hpp"

namespace tubebin::dataset {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const physics::DropFigures& figures) {
  return {{"steps", figures.steps},
          {"simulated_seconds", figures.simulated_seconds},
          {"redropped", figures.redropped},
          {"deepest_penetration", figures.deepest_penetration},
          {"largest_drift", figures.largest_drift}};
}

physics::DropFigures physics_from(const Json& json) {
  return {.steps = json.at("steps"),
          .simulated_seconds = json.at("simulated_seconds"),
          .redropped = json.value("redropped", 0),
          .deepest_penetration = json.at("deepest_penetration"),
          .largest_drift = json.at("largest_drift")};
}

/// Lines that programs append begin with the id, which saves parsing those of other scenes. "" where one doesn't.
std::string id_of(const std::string& line) {
  constexpr std::string_view start = R"({"id":")";
  if (!line.starts_with(start)) return "";
  return line.substr(start.size(), line.find('"', start.size()) - start.size());
}

std::vector<std::string> list_shard_files(const std::string& folder) {
  const std::string shards_folder = folder + "/" + kShardsFolder;
  std::vector<std::string> files;
  for (const std::string& name : names_in_folder(shards_folder))
    if (name.ends_with(".jsonl")) files.push_back(shards_folder + "/" + name);
  return files;
}

/// A new file that no other process writes to, whatever its host.
ConfinedPath make_shard_file(const OutputFolder& folder, const std::string& shard) {
  for (int number = 0;; ++number) {
    ConfinedPath name = ConfinedPath(kShardsFolder) / fmt::format("{}.{}-{}.jsonl", shard, process_name(), number);
    if (create_atomically(folder.make_entry(name), "")) return name;
  }
}

}  // namespace

std::string format_manifest_record(const ManifestRecord& record) {
  Json rejected = Json::array();
  for (const jobs::FailedAttempt& attempt : record.rejected)
    rejected.push_back({{"attempt", attempt.attempt}, {"reason", attempt.reason}, {"detail", attempt.detail}});
  Json files = Json::object();
  for (const auto& [name, file] : record.files) files[name.str()] = {{"bytes", file.bytes}, {"xxh128", file.xxh128}};
  Json json = {{"id", record.id.str()}, {"tubes", record.tubes},     {"seed", record.seed},
               {"rejected", rejected},  {"seconds", record.seconds}, {"physics", to_json(record.physics)},
               {"files", files}};
  if (record.pack) json["pack"] = {{"file", record.pack->str()}, {"end", record.pack_end}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

ManifestRecord parse_manifest_record(const std::string& line) {
  ManifestRecord record;
  try {
    const Json json = parse_ordered_json(line, "not a record of a scene");
    record.id = ConfinedPath::parse(json.at("id").get_ref<const std::string&>(), "id");
    record.tubes = json.at("tubes");
    record.seed = json.at("seed");
    for (const Json& attempt : json.at("rejected"))
      record.rejected.push_back({attempt.at("attempt"), attempt.at("reason"), attempt.at("detail")});
    record.seconds = json.at("seconds").get<std::map<std::string, double>>();
    record.physics = physics_from(json.at("physics"));
    for (const auto& [name, file] : json.at("files").items())
      record.files[ConfinedPath::parse_name(name, "files")] = {.bytes = file.at("bytes"), .xxh128 = file.at("xxh128")};
    if (json.contains("pack")) {
      record.pack = ConfinedPath::parse_name(json["pack"].at("file").get_ref<const std::string&>(), "pack/file");
      record.pack_end = json["pack"].at("end");
    }
  } catch (const nlohmann::json::exception& error) {
    throw_io_error("not a record of a scene: {}", error.what());
  }
  return record;
}

Manifest::Manifest(const std::string& folder) { read_all(folder, nullptr); }

Manifest::Manifest(const OutputFolder& folder) : output_(folder) { read_all(folder.path(), nullptr); }

Manifest::Manifest(const OutputFolder& folder, const jobs::Shard& shard, const std::vector<SceneId>& scenes)
    : output_(folder), shard_name_(shard.name()) {
  std::set<std::string> wanted;
  for (const SceneId& id : scenes) wanted.insert(id.name());
  read_all(folder.path(), &wanted);
  file_ = {};
  complete_bytes_ = 0;
}

void Manifest::read_all(const std::string& folder, const std::set<std::string>* wanted) {
  complete_bytes_ = read(folder + "/" + kFile, wanted);
  for (const std::string& file : list_shard_files(folder)) read(file, wanted);
}

std::size_t Manifest::read(const std::string& path, const std::set<std::string>* wanted) {
  if (!path_exists(path)) return 0;
  const std::string text = read_file(path);
  std::size_t begin = 0;
  for (int line_number = 1; begin < text.size(); ++line_number) {
    const std::size_t end = text.find('\n', begin);
    if (end == std::string::npos) break;  // a kill cut this line short: its scene is not recorded
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    if (wanted != nullptr && !wanted->contains(id_of(line))) continue;
    try {
      ManifestRecord record = parse_manifest_record(line);
      ManifestRecord& known = records_[record.id];
      if (!known.pack || record.pack) known = std::move(record);
    } catch (const IoError& error) {
      damaged_lines_.push_back(fmt::format("{}:{}: {}", path, line_number, error.what()));
    }
  }
  return begin;
}

const ManifestRecord* Manifest::find(const std::string& id) const {
  const auto found = records_.find(id);
  return found == records_.end() ? nullptr : &found->second;
}

void Manifest::append(const ManifestRecord& record) {
  if (file_.is_folder_itself()) file_ = make_shard_file(output_.value(), shard_name_);
  complete_bytes_ = jobs::append_line(output_.value(), file_, complete_bytes_, format_manifest_record(record));
  records_[record.id] = record;
}

void Manifest::rewrite_without(const std::set<std::string>& ids) {
  std::erase_if(records_, [&](const auto& entry) { return ids.contains(entry.first); });
  std::string text;
  for (const auto& [id, record] : records_) text += format_manifest_record(record) + '\n';
  replace_all(text);
}

void Manifest::rewrite(const std::vector<SceneId>& scenes) {
  std::string text;
  std::map<std::string, ManifestRecord> kept;
  for (const SceneId& id : scenes)
    if (auto record = records_.extract(id.name())) {
      text += format_manifest_record(record.mapped()) + '\n';
      kept.insert(std::move(record));
    }
  records_ = std::move(kept);
  replace_all(text);
}

void Manifest::replace_all(const std::string& text) {
  file_ = kFile;
  write_atomically(output_.value().make_entry(file_), text);
  if (const FolderEntry shards = output_->find_entry(kShardsFolder); shards.folder.get() >= 0) remove_entry(shards);
  complete_bytes_ = text.size();
  damaged_lines_.clear();
}

}  // namespace tubebin::dataset
