#include "results/setting_names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "tubebin/core/error.hpp"

namespace tubebin::results {
namespace {

using Json = nlohmann::ordered_json;
/// Each option by its key ("greedy_joining.gap_max") as a text.
using OptionTexts = std::map<std::string, std::string>;

constexpr std::size_t kOptionsInName = 2;

std::string text_of(const std::string& key, const Json& value) {
  const bool is_estimated = (key == "radius" || key == "tube_length") && value == 0.0;
  return is_estimated ? "estimated" : value.is_string() ? value.get<std::string>() : value.dump();
}

void add_texts(const std::string& prefix, const Json& object, OptionTexts& texts) {
  for (const auto& [key, value] : object.items())
    if (value.is_object()) add_texts(prefix + key + ".", value, texts);
    else texts[prefix + key] = text_of(prefix + key, value);
}

/// With the version and the seed beside the options.
OptionTexts option_texts(const ResultsIndex& index) {
  Json conditions = Json::parse(index.conditions());
  OptionTexts texts;
  add_texts("", conditions["options"], texts);
  conditions.erase("options");
  add_texts("", conditions, texts);
  return texts;
}

/// The keys whose texts are not the same in all.
std::set<std::string> differing_keys(const std::vector<OptionTexts>& all) {
  std::map<std::string, std::set<std::string>> values;
  std::map<std::string, std::size_t> holders;
  for (const OptionTexts& texts : all)
    for (const auto& [key, text] : texts) {
      values[key].insert(text);
      ++holders[key];
    }
  std::set<std::string> keys;
  for (const auto& [key, texts] : values)
    if (texts.size() > 1 || holders[key] < all.size()) keys.insert(key);
  return keys;
}

std::string texts_of(const OptionTexts& texts, const std::set<std::string>& keys) {
  std::vector<std::string> parts;
  for (const std::string& key : keys) {
    const auto text = texts.find(key);
    parts.push_back(fmt::format("{}: {}", key, text == texts.end() ? "none" : text->second));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

template <typename Value>
bool share_one(const std::vector<Value>& a, const std::vector<Value>& b) {
  const std::set<Value> values(a.begin(), a.end());
  return std::any_of(b.begin(), b.end(), [&](const Value& value) { return values.contains(value); });
}

bool ask_for_one_run(const ResultsIndex& a, const ResultsIndex& b) {
  return share_one(a.methods, b.methods) && share_one(a.ratios, b.ratios) && share_one(a.scenes, b.scenes);
}

/// Whether two are to have the same run, but made under different conditions.
bool are_compared(const std::vector<IndexedFolder>& folders, const std::vector<std::string>& conditions) {
  for (std::size_t i = 0; i < folders.size(); ++i)
    for (std::size_t j = i + 1; j < folders.size(); ++j)
      if (conditions[i] != conditions[j] && ask_for_one_run(folders[i].index, folders[j].index)) return true;
  return false;
}

}  // namespace

std::vector<std::string> setting_names(const std::vector<IndexedFolder>& folders,
                                       const std::vector<std::string>& given) {
  if (!given.empty() && given.size() != folders.size())
    throw_config_error("--name is there {} times for {} folders; give each folder one name, in the same order",
                       given.size(), folders.size());
  if (!given.empty()) return given;
  std::vector<std::string> conditions;
  for (const IndexedFolder& folder : folders) conditions.push_back(folder.index.conditions());
  std::vector<std::string> names(folders.size());
  if (!are_compared(folders, conditions)) return names;

  std::vector<OptionTexts> texts;
  for (const IndexedFolder& folder : folders) texts.push_back(option_texts(folder.index));
  const std::set<std::string> keys = differing_keys(texts);
  std::map<std::string, std::string> name_of_conditions;
  for (std::size_t i = 0; i < folders.size(); ++i)
    names[i] =
        name_of_conditions
            .try_emplace(conditions[i], keys.size() > kOptionsInName ? folders[i].folder : texts_of(texts[i], keys))
            .first->second;
  return names;
}

std::string describe_difference(const ResultsIndex& a, const ResultsIndex& b) {
  const std::vector<OptionTexts> texts = {option_texts(a), option_texts(b)};
  const std::set<std::string> keys = differing_keys(texts);
  return texts_of(texts[0], keys) + " and " + texts_of(texts[1], keys);
}

}  // namespace tubebin::results
