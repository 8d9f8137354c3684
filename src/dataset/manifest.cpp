#include "tubebin/dataset/manifest.hpp"

#include <fcntl.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "file_descriptor.hpp"
#include "tubebin/core/atomic_file.hpp"

namespace tubebin {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(const DropFigures& figures) {
  return {{"steps", figures.steps},
          {"simulated_seconds", figures.simulated_seconds},
          {"deepest_penetration", figures.deepest_penetration},
          {"largest_drift", figures.largest_drift}};
}

DropFigures physics_from(const Json& json) {
  return {.steps = json.at("steps"),
          .simulated_seconds = json.at("simulated_seconds"),
          .deepest_penetration = json.at("deepest_penetration"),
          .largest_drift = json.at("largest_drift")};
}

}  // namespace

std::string format_manifest_record(const ManifestRecord& record) {
  Json rejected = Json::array();
  for (const FailedAttempt& attempt : record.rejected)
    rejected.push_back({{"attempt", attempt.attempt}, {"reason", attempt.reason}, {"detail", attempt.detail}});
  Json files = Json::object();
  for (const auto& [name, file] : record.files) files[name] = {{"bytes", file.bytes}, {"xxh128", file.xxh128}};
  const Json json = {{"id", record.id},      {"tubes", record.tubes},     {"seed", record.seed},
                     {"rejected", rejected}, {"seconds", record.seconds}, {"physics", to_json(record.physics)},
                     {"files", files}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

ManifestRecord parse_manifest_record(const std::string& line) {
  ManifestRecord record;
  try {
    const Json json = Json::parse(line);
    record.id = json.at("id");
    record.tubes = json.at("tubes");
    record.seed = json.at("seed");
    for (const Json& attempt : json.at("rejected"))
      record.rejected.push_back({attempt.at("attempt"), attempt.at("reason"), attempt.at("detail")});
    record.seconds = json.at("seconds").get<std::map<std::string, double>>();
    record.physics = physics_from(json.at("physics"));
    for (const auto& [name, file] : json.at("files").items())
      record.files[name] = {.bytes = file.at("bytes"), .xxh128 = file.at("xxh128")};
  } catch (const nlohmann::json::exception& error) {
    throw_io_error("not a record of a scene: {}", error.what());
  }
  return record;
}

FileRecord record_bytes(std::string_view bytes) {
  const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
  return {.bytes = bytes.size(), .xxh128 = fmt::format("{:016x}{:016x}", hash.high64, hash.low64)};
}

Manifest::Manifest(const std::string& folder) : path_(folder + "/manifest.jsonl") {
  if (!std::filesystem::exists(path_)) return;
  const std::string text = read_file(path_);
  std::size_t begin = 0;
  for (int line_number = 1; begin < text.size(); ++line_number) {
    const std::size_t end = text.find('\n', begin);
    if (end == std::string::npos) return;  // a kill cut this line short: its scene is not recorded
    try {
      ManifestRecord record = parse_manifest_record(text.substr(begin, end - begin));
      records_[record.id] = std::move(record);
    } catch (const IoError& error) {
      damaged_lines_.push_back(fmt::format("{}:{}: {}", path_, line_number, error.what()));
    }
    begin = complete_bytes_ = end + 1;
  }
}

const ManifestRecord* Manifest::find(const std::string& id) const {
  const auto found = records_.find(id);
  return found == records_.end() ? nullptr : &found->second;
}

void Manifest::append(const ManifestRecord& record) {
  const FileDescriptor file(open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666));
  const auto fail = [&] { throw_io_error("{}: cannot be written: {}", path_, std::strerror(errno)); };
  if (file.get() < 0) fail();
  const std::string line = format_manifest_record(record) + '\n';
  const auto end = static_cast<off_t>(complete_bytes_);
  if (ftruncate(file.get(), end) != 0) fail();  // what a kill left after the last complete line
  errno = ENOSPC;                               // what a short write means
  if (pwrite(file.get(), line.data(), line.size(), end) != static_cast<ssize_t>(line.size())) {
    const int cause = errno;
    if (ftruncate(file.get(), end) == 0) errno = cause;
    fail();
  }
  complete_bytes_ += line.size();
  records_[record.id] = record;
}

void Manifest::rewrite_without(const std::set<std::string>& ids) {
  std::erase_if(records_, [&](const auto& entry) { return ids.contains(entry.first); });
  std::string text;
  for (const auto& [id, record] : records_) text += format_manifest_record(record) + '\n';
  write_file_atomically(path_, text);
  complete_bytes_ = text.size();
  damaged_lines_.clear();
}

}  // namespace tubebin
