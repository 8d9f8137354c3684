#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <optional>
#include <set>
#include <sstream>

#include "core/yaml_value.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/text_scan.hpp"
#include "tubebin/core/yaml.hpp"

namespace tubebin {
namespace {

constexpr int kMaxIncludeDepth = 8;
constexpr auto kIncludeKey = "include";

/// Levenshtein distance, to suggest the key that was probably meant.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

/// Reads one mapping; nested mappings get a reader of their own.
class Reader : public Fields {
 public:
  using Fields::vector;
  Reader(YamlValue mapping, KeyPlaces& places, Distributions* distributions = nullptr)
      : mapping_(std::move(mapping)), places_(places), distributions_(distributions) {
    check_keys_once();
  }

  void removed(const char* key, const char* why) override {
    const YamlValue found = mapping_.at(key);
    if (found.node)
      throw_config_error("{}: {}: is no key any more, since it {}; remove it", found.place(), found.key_path, why);
  }
  void randomized(Distributions& distributions) override { distributions_ = &distributions; }
  void number(const char* key, double& value, Limits limits, const char* unit, const char*) override {
    if (const auto found = find(key)) read_number(*found, value, limits, unit);
  }
  void integer(const char* key, int& value, Limits limits, const char* unit, const char*) override {
    if (const auto found = find(key)) read_number(*found, value, limits, unit);
  }
  void seed(const char* key, std::uint64_t& value, const char*) override {
    constexpr auto kValid = "a whole number from 0 to 18446744073709551615";
    const auto found = find(key);
    if (!found) return;
    const auto number = to_number<std::uint64_t>(found->text(kValid));
    if (!number) found->fail(kValid);
    value = *number;
  }
  void flag(const char* key, bool& value, const char*) override {
    const auto found = find(key);
    if (found && (!found->node.IsScalar() || !YAML::convert<bool>::decode(found->node, value)))
      found->fail("true or false");
  }
  void text(const char* key, std::string& value, const char*) override {
    if (const auto found = find(key)) value = found->text("a text");
  }
  void vector(const char* key, Vec3& value, Limits limits, const char* unit, const char*) override {
    const auto found = find(key);
    if (!found) return;
    if (!found->node.IsSequence() || found->size() != 3) found->fail("a list of three numbers, as [0.1, 0.2, 0.3]");
    for (std::size_t i = 0; i < 3; ++i)
      read_number(found->element(i), value[static_cast<Eigen::Index>(i)], limits, unit);
  }
  void vector(const char* key, std::optional<Vec3>& value, Limits limits, const char* unit, const char* doc) override {
    known_.insert(key);
    if (!mapping_.at(key).node) return;
    if (!value) value = Vec3::Zero();
    vector(key, *value, limits, unit, doc);
  }
  void integers(const char* key, std::vector<int>& value, Limits limits, const char*) override {
    const auto found = find(key);
    if (!found) return;
    if (!found->node.IsSequence() || found->size() == 0) found->fail("a list of whole numbers, as [1, 5, 10]");
    value.assign(found->size(), 0);
    for (std::size_t i = 0; i < found->size(); ++i) found->element(i).read(value[i], limits, "");
  }
  void choice(const char* key, int& value, const std::vector<std::string>& names, const char*) override {
    const auto found = find(key);
    if (!found) return;
    const std::string valid = fmt::format("one of {}", fmt::join(names, ", "));
    const auto name = std::find(names.begin(), names.end(), found->text(valid));
    if (name == names.end()) found->fail(valid);
    value = static_cast<int>(name - names.begin());
  }
  void group(const char* key, const char*, const std::function<void(Fields&)>& describe_inner) override {
    if (const auto found = find(key)) read_mapping(*found, describe_inner);
  }

  void list(const char* key, const char*, std::size_t, const std::function<void(std::size_t)>& resize,
            const std::function<void(Fields&, std::size_t)>& describe_element) override {
    const auto found = find(key);
    if (!found) return;
    if (!found->node.IsSequence() || found->size() == 0) found->fail("a list of mappings");
    if (distributions_ != nullptr)
      std::erase_if(*distributions_, [&](const auto& entry) { return entry.first.starts_with(found->key_path + "["); });
    resize(found->size());
    for (std::size_t i = 0; i < found->size(); ++i) {
      const YamlValue element = found->element(i);
      places_.set(element.key_path, element.place());
      read_mapping(element, [&](Fields& inner) { describe_element(inner, i); });
    }
  }

  void accept(const char* key) { known_.insert(key); }

  void reject_unknown_keys() const {
    for (const auto& entry : mapping_.node) {
      const std::string key = entry.first.as<std::string>();
      if (known_.contains(key)) continue;
      throw_config_error("{}: {}: unknown key{}; valid here: {}", place_of(mapping_.file, entry.first.Mark()),
                         mapping_.at(key).key_path, suggestion(key), fmt::join(known_, ", "));
    }
  }

 private:
  /// Null counts as a value that is wrong, not as a missing key.
  std::optional<YamlValue> find(const char* key) {
    known_.insert(key);
    const YamlValue found = mapping_.at(key);
    if (!found.node) return std::nullopt;
    places_.set(found.key_path, found.place());
    return found;
  }

  void read_mapping(const YamlValue& value, const std::function<void(Fields&)>& describe_inner) {
    if (!value.node.IsMap()) value.fail("a mapping of keys to values");
    Reader inner(value, places_, distributions_);
    describe_inner(inner);
    inner.reject_unknown_keys();
  }

  /// A number, or what it is drawn from.
  template <typename Number>
  void read_number(const YamlValue& from, Number& value, Limits limits, const char* unit) {
    if (distributions_ == nullptr) return from.read(value, limits, unit);
    distributions_->erase(from.key_path);
    if (!from.node.IsMap()) return from.read(value, limits, unit);
    const Distribution distribution = read_distribution(from, limits, unit, std::is_integral_v<Number>);
    value = static_cast<Number>(distribution.low());
    distributions_->emplace(from.key_path, distribution);
    places_.set(from.key_path, from.place());
  }

  void check_keys_once() const {
    std::set<std::string> seen;
    for (const auto& entry : mapping_.node) {
      const std::string place = place_of(mapping_.file, entry.first.Mark());
      if (!entry.first.IsScalar()) throw_config_error("{}: a key must be a plain word", place);
      const std::string key = entry.first.as<std::string>();
      if (!seen.insert(key).second)
        throw_config_error("{}: {}: the key stands here a second time", place, mapping_.at(key).key_path);
    }
  }

  std::string suggestion(const std::string& key) const {
    const auto nearest = std::min_element(known_.begin(), known_.end(), [&](const auto& a, const auto& b) {
      return edit_distance(key, a) < edit_distance(key, b);
    });
    // Up to a third of the letters may be wrong; beyond that a suggestion is a guess.
    if (nearest == known_.end() || edit_distance(key, *nearest) > std::max<std::size_t>(2, key.size() / 3)) return "";
    return fmt::format(", did you mean '{}'?", *nearest);
  }

  const YamlValue mapping_;
  KeyPlaces& places_;
  Distributions* distributions_;  // nothing where numbers can't be drawn
  std::set<std::string> known_;
};

/// Notes where documents start.
struct DocumentStarts final : YAML::EventHandler {
  std::vector<YAML::Mark> marks;

  void OnDocumentStart(const YAML::Mark& mark) override { marks.push_back(mark); }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {}
  void OnMapEnd() override {}
};

/// YAML::LoadAll would never return from some texts (a comma alone).
YAML::Node parse(const std::string& text, const std::string& name) {
  YAML::Node root;
  try {
    root = YAML::Load(text);
    std::istringstream stream(text);
    YAML::Parser parser(stream);
    DocumentStarts starts;
    for (int document = 0; document < 2; ++document) parser.HandleNextDocument(starts);
    if (root.IsMap() && starts.marks.size() > 1)
      throw_config_error("{}: another YAML document starts here; valid: one, without another '---'",
                         place_of(name, starts.marks[1]));
  } catch (const YAML::Exception& error) {
    throw_config_error("{}: not valid YAML: {}", place_of(name, error.mark), error.msg);
  }
  if (!root.IsDefined() || root.IsNull()) throw_config_error("{}: the file is empty; expected keys and values", name);
  if (!root.IsMap())
    throw_config_error("{}: expected a mapping of keys to values at the top", place_of(name, root.Mark()));
  return root;
}

/// Far above any configuration; a node takes a few hundred bytes of memory and two of a file.
constexpr std::uint64_t kBytesMax = 1 << 20;

std::string read_limited(const std::string& path) try {
  return read_file(path, kBytesMax);
} catch (const IoError& error) {
  throw_config_error("{}", error.what());
}

void read_root(const YAML::Node& root, const std::string& name, KeyPlaces& places, bool may_include,
               const std::function<void(Fields&)>& describe) {
  places.set("", name);
  Reader reader({root, name, ""}, places);
  if (may_include) reader.accept(kIncludeKey);
  describe(reader);
  reader.reject_unknown_keys();
}

void read_with_includes(const std::string& path, int depth, KeyPlaces& places,
                        const std::function<void(Fields&)>& describe) {
  const YAML::Node root = parse(read_limited(path), path);
  if (const YAML::Node include = root[kIncludeKey]) {
    const std::string place = place_of(path, include.Mark());
    if (!include.IsScalar()) throw_config_error("{}: include: expected the name of one YAML file", place);
    if (depth >= kMaxIncludeDepth)
      throw_config_error("{}: include: more than {} files deep; does a file include itself?", place, kMaxIncludeDepth);
    read_with_includes((std::filesystem::path(path).parent_path() / include.Scalar()).string(), depth + 1, places,
                       describe);
  }
  read_root(root, path, places, true, describe);
}

}  // namespace

std::string KeyPlaces::find(const std::string& key_path) const {
  std::string key = key_path;
  while (true) {
    if (const auto found = places_.find(key); found != places_.end()) return found->second;
    if (key.empty()) return "";
    const std::size_t dot = key.rfind('.');
    key = dot == std::string::npos ? "" : key.substr(0, dot);
  }
}

void KeyPlaces::fail(const std::string& key_path, const std::string& problem) const {
  throw_config_error("{}: {}: {}", find(key_path), key_path, problem);
}

KeyPlaces read_yaml_file(const std::string& path, const std::function<void(Fields&)>& describe) {
  KeyPlaces places;
  read_with_includes(path, 0, places, describe);
  return places;
}

KeyPlaces read_yaml_text(const std::string& text, const std::string& name,
                         const std::function<void(Fields&)>& describe) {
  KeyPlaces places;
  read_root(parse(text, name), name, places, false, describe);
  return places;
}

}  // namespace tubebin
