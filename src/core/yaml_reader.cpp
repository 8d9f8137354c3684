#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numeric>
#include <set>
#include <sstream>

#include "core/limits_text.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/core/text_scan.hpp"
#include "tubebin/core/yaml.hpp"

namespace tubebin {
namespace {

constexpr int kMaxIncludeDepth = 8;
constexpr auto kIncludeKey = "include";

std::string place_of(const std::string& file, const YAML::Mark& mark) {
  return fmt::format("{}:{}:{}", file, mark.line + 1, mark.column + 1);
}

std::string valid_range(Limits limits, const char* unit) {
  return limits_text(limits) + (*unit ? fmt::format(" {}", unit) : "");
}

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
  Reader(const YAML::Node& node, std::string file, std::string prefix, KeyPlaces& places)
      : node_(node), file_(std::move(file)), prefix_(std::move(prefix)), places_(places) {
    check_keys_once();
  }

  void number(const char* key, double& value, Limits limits, const char* unit, const char*) override {
    if (const YAML::Node found = find(key)) value = to_number(found, path(key), limits, unit);
  }
  void integer(const char* key, int& value, Limits limits, const char* unit, const char*) override {
    if (const YAML::Node found = find(key)) value = to_integer(found, path(key), limits, unit);
  }
  void seed(const char* key, std::uint64_t& value, const char*) override {
    const YAML::Node found = find(key);
    if (!found) return;
    const std::string text = scalar(found, path(key), "a whole number from 0 to 18446744073709551615");
    const auto number = tubebin::to_number<std::uint64_t>(text);
    if (!number) fail(found, path(key), text, "a whole number from 0 to 18446744073709551615");
    value = *number;
  }
  void flag(const char* key, bool& value, const char*) override {
    const YAML::Node found = find(key);
    if (!found) return;
    const std::string text = scalar(found, path(key), "true or false");
    if (!YAML::convert<bool>::decode(found, value)) fail(found, path(key), text, "true or false");
  }
  void text(const char* key, std::string& value, const char*) override {
    if (const YAML::Node found = find(key)) value = scalar(found, path(key), "a text");
  }
  void vector(const char* key, Vec3& value, Limits limits, const char* unit, const char*) override {
    const YAML::Node found = find(key);
    if (!found) return;
    if (!found.IsSequence() || found.size() != 3)
      fail(found, path(key), dump(found), "a list of three numbers, as [0.1, 0.2, 0.3]");
    for (int i = 0; i < 3; ++i) value[i] = to_number(found[i], fmt::format("{}[{}]", path(key), i), limits, unit);
  }
  void integers(const char* key, std::vector<int>& value, Limits limits, const char*) override {
    const YAML::Node found = find(key);
    if (!found) return;
    if (!found.IsSequence() || found.size() == 0)
      fail(found, path(key), dump(found), "a list of whole numbers, as [1, 5, 10]");
    value.clear();
    for (std::size_t i = 0; i < found.size(); ++i)
      value.push_back(to_integer(found[i], fmt::format("{}[{}]", path(key), i), limits, ""));
  }
  void choice(const char* key, int& value, const std::vector<std::string>& names, const char*) override {
    const YAML::Node found = find(key);
    if (!found) return;
    const std::string valid = fmt::format("one of {}", fmt::join(names, ", "));
    const std::string text = scalar(found, path(key), valid);
    const auto name = std::find(names.begin(), names.end(), text);
    if (name == names.end()) fail(found, path(key), text, valid);
    value = static_cast<int>(name - names.begin());
  }
  void group(const char* key, const char*, const std::function<void(Fields&)>& describe_inner) override {
    const YAML::Node found = find(key);
    if (!found) return;
    if (!found.IsMap()) fail(found, path(key), dump(found), "a mapping of keys to values");
    Reader inner(found, file_, path(key), places_);
    describe_inner(inner);
    inner.reject_unknown_keys();
  }

  void list(const char* key, const char*, std::size_t, const std::function<void(std::size_t)>& resize,
            const std::function<void(Fields&, std::size_t)>& describe_element) override {
    const YAML::Node found = find(key);
    if (!found) return;
    if (!found.IsSequence() || found.size() == 0) fail(found, path(key), dump(found), "a list of mappings");
    resize(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
      const std::string element_path = fmt::format("{}[{}]", path(key), i);
      places_.set(element_path, place_of(file_, found[i].Mark()));
      if (!found[i].IsMap()) fail(found[i], element_path, dump(found[i]), "a mapping of keys to values");
      Reader inner(found[i], file_, element_path, places_);
      describe_element(inner, i);
      inner.reject_unknown_keys();
    }
  }

  void accept(const char* key) { known_.insert(key); }

  void reject_unknown_keys() const {
    for (const auto& entry : node_) {
      const std::string key = entry.first.as<std::string>();
      if (known_.contains(key)) continue;
      throw_config_error("{}: {}: unknown key{}; valid here: {}", place_of(file_, entry.first.Mark()), path(key),
                         suggestion(key), fmt::join(known_, ", "));
    }
  }

 private:
  std::string path(const std::string& key) const { return prefix_.empty() ? key : prefix_ + "." + key; }

  /// Null counts as a value that is wrong, not as a missing key.
  YAML::Node find(const char* key) {
    known_.insert(key);
    const YAML::Node found = node_[key];
    if (!found) return YAML::Node(YAML::NodeType::Undefined);
    places_.set(path(key), place_of(file_, found.Mark()));
    return found;
  }

  void check_keys_once() const {
    std::set<std::string> seen;
    for (const auto& entry : node_) {
      if (!entry.first.IsScalar())
        throw_config_error("{}: a key must be a plain word", place_of(file_, entry.first.Mark()));
      const std::string key = entry.first.as<std::string>();
      if (!seen.insert(key).second)
        throw_config_error("{}: {}: the key stands here a second time", place_of(file_, entry.first.Mark()), path(key));
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

  static std::string dump(const YAML::Node& node) {
    if (node.IsNull()) return "nothing";
    std::ostringstream out;
    out << node;
    std::string text = out.str();
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text.size() > 60 ? text.substr(0, 57) + "..." : text;
  }

  [[noreturn]] void fail(const YAML::Node& node, const std::string& key_path, const std::string& value,
                         const std::string& valid) const {
    throw_config_error("{}: {}: '{}' is not valid; valid: {}", place_of(file_, node.Mark()), key_path, value, valid);
  }

  std::string scalar(const YAML::Node& node, const std::string& key_path, const std::string& valid) const {
    if (!node.IsScalar()) fail(node, key_path, dump(node), valid);
    return node.Scalar();
  }

  double to_number(const YAML::Node& node, const std::string& key_path, Limits limits, const char* unit) const {
    const std::string valid = valid_range(limits, unit);
    const std::string text = scalar(node, key_path, valid);
    const auto value = tubebin::to_number<double>(text);
    if (!value || !(*value >= limits.min && *value <= limits.max)) fail(node, key_path, text, valid);
    return *value;
  }

  int to_integer(const YAML::Node& node, const std::string& key_path, Limits limits, const char* unit) const {
    limits.min = std::max<double>(limits.min, std::numeric_limits<int>::min());
    limits.max = std::min<double>(limits.max, std::numeric_limits<int>::max());
    const std::string valid = "a whole number, " + valid_range(limits, unit);
    const std::string text = scalar(node, key_path, valid);
    const auto value = tubebin::to_number<int>(text);  // 010 is ten, as on the command line, and not YAML 1.1's eight
    if (!value || *value < limits.min || *value > limits.max) fail(node, key_path, text, valid);
    return *value;
  }

  const YAML::Node node_;
  std::string file_;
  std::string prefix_;
  KeyPlaces& places_;
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
  Reader reader(root, name, "", places);
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
