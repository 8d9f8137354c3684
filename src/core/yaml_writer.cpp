#include <sstream>

#include "core/limits_text.hpp"
#include "tubebin/core/yaml.hpp"

namespace tubebin {
namespace {

/// Shortest decimal text that reads back to the same double.
std::string shortest(double value) { return fmt::format("{}", value); }

std::string yaml_quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    const bool control = static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
    if (c == '"' || c == '\\') out += '\\';
    out += control ? fmt::format("\\x{:02x}", static_cast<unsigned>(c)) : std::string(1, c);
  }
  return out + '"';
}

/// Turns each field into its key, value text, unit, valid values and doc; subclasses lay them out.
class TextFields : public Fields {
 public:
  using Fields::vector;
  void randomized(Distributions& distributions) override { distributions_ = &distributions; }
  void number(const char* key, double& value, Limits limits, const char* unit, const char* doc) override {
    entry(key, number_text(key, shortest(value)), unit, limits_text(limits), doc);
  }
  void integer(const char* key, int& value, Limits limits, const char* unit, const char* doc) override {
    entry(key, number_text(key, fmt::format("{}", value)), unit, limits_text(limits), doc);
  }
  void seed(const char* key, std::uint64_t& value, const char* doc) override {
    entry(key, fmt::format("{}", value), "", limits_text({.min = 0.0}), doc);
  }
  void flag(const char* key, bool& value, const char* doc) override {
    entry(key, value ? "true" : "false", "", "true, false", doc);
  }
  void text(const char* key, std::string& value, const char* doc) override {
    entry(key, yaml_quoted(value), "", "text", doc);
  }
  void vector(const char* key, Vec3& value, Limits limits, const char* unit, const char* doc) override {
    std::vector<std::string> numbers;
    for (int i = 0; i < 3; ++i) numbers.push_back(number_text(fmt::format("{}[{}]", key, i), shortest(value[i])));
    entry(key, fmt::format("[{}]", fmt::join(numbers, ", ")), unit, limits_text(limits), doc);
  }
  void integers(const char* key, std::vector<int>& value, Limits limits, const char* doc) override {
    entry(key, fmt::format("[{}]", fmt::join(value, ", ")), "", limits_text(limits), doc);
  }
  void choice(const char* key, int& value, const std::vector<std::string>& names, const char* doc) override {
    entry(key, names.at(static_cast<std::size_t>(value)), "", fmt::format("{}", fmt::join(names, ", ")), doc);
  }

 protected:
  virtual void entry(const std::string& key, const std::string& value, const std::string& unit,
                     const std::string& valid, const std::string& doc) = 0;

  const std::string& prefix() const { return prefix_; }
  /// Calls `describe_inner` with `key` in the paths of what it describes.
  void within(const std::string& key, const std::function<void()>& describe_inner) {
    const std::string outer = prefix_;
    prefix_ += key + ".";
    describe_inner();
    prefix_ = outer;
  }

 private:
  /// The number, or what it is drawn from.
  std::string number_text(const std::string& key, const std::string& number) const {
    if (distributions_ == nullptr) return number;
    const auto found = distributions_->find(prefix_ + key);
    return found == distributions_->end() ? number : found->second.text();
  }

  std::string prefix_;  // of key paths: "tube."
  const Distributions* distributions_ = nullptr;
};

class YamlText : public TextFields {
 public:
  void group(const char* key, const char* doc, const std::function<void(Fields&)>& describe_inner) override {
    begin(key, doc);
    indent_ += "  ";
    within(key, [&] { describe_inner(*this); });
    indent_.resize(indent_.size() - 2);
  }
  void list(const char* key, const char* doc, std::size_t size, const std::function<void(std::size_t)>&,
            const std::function<void(Fields&, std::size_t)>& describe_element) override {
    if (size == 0) return;
    begin(key, doc);
    indent_ += "    ";
    for (std::size_t i = 0; i < size; ++i) {
      const std::size_t dash = out_.size() + indent_.size() - 2;
      within(fmt::format("{}[{}]", key, i), [&] { describe_element(*this, i); });
      out_[dash] = '-';
    }
    indent_.resize(indent_.size() - 4);
  }
  const std::string& str() const { return out_; }

 protected:
  void entry(const std::string& key, const std::string& value, const std::string& unit, const std::string&,
             const std::string& doc) override {
    out_ += fmt::format("{}{}: {}  # {}{}\n", indent_, key, value, unit.empty() ? "" : unit + "; ", doc);
  }

 private:
  void begin(const char* key, const char* doc) { out_ += fmt::format("{}{}:  # {}\n", indent_, key, doc); }

  std::string out_;
  std::string indent_;
};

/// Shown in a Markdown table as it is: no HTML, no end of the cell.
std::string escape_markdown(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '<' || c == '|') out += '\\';
    out += c;
  }
  return out;
}

class MarkdownTable : public TextFields {
 public:
  using TextFields::vector;
  void vector(const char* key, std::optional<Vec3>&, Limits limits, const char* unit, const char* doc) override {
    entry(key, "none", unit, limits_text(limits), doc);
  }
  void group(const char* key, const char*, const std::function<void(Fields&)>& describe_inner) override {
    within(key, [&] { describe_inner(*this); });
  }
  void list(const char* key, const char*, std::size_t size, const std::function<void(std::size_t)>&,
            const std::function<void(Fields&, std::size_t)>& describe_element) override {
    group((std::string(key) + "[]").c_str(), "", [&](Fields& fields) { describe_element(fields, size); });
  }
  std::string str() const {
    return "| key | default | unit | valid | effect |\n| --- | --- | --- | --- | --- |\n" + out_.str();
  }

 protected:
  void entry(const std::string& key, const std::string& value, const std::string& unit, const std::string& valid,
             const std::string& doc) override {
    out_ << fmt::format("| `{}{}` | {} | {} | {} | {} |\n", prefix(), key, value, unit, valid, escape_markdown(doc));
  }

 private:
  std::ostringstream out_;
};

class KeyValueList : public TextFields {
 public:
  void group(const char* key, const char*, const std::function<void(Fields&)>& describe_inner) override {
    within(key, [&] { describe_inner(*this); });
  }
  void list(const char* key, const char*, std::size_t size, const std::function<void(std::size_t)>&,
            const std::function<void(Fields&, std::size_t)>& describe_element) override {
    for (std::size_t i = 0; i < size; ++i)
      group(fmt::format("{}[{}]", key, i).c_str(), "", [&](Fields& fields) { describe_element(fields, i); });
  }
  std::vector<KeyValue> values;

 protected:
  void entry(const std::string& key, const std::string& value, const std::string&, const std::string&,
             const std::string&) override {
    values.push_back({prefix() + key, value});
  }
};

}  // namespace

std::string write_yaml(const std::function<void(Fields&)>& describe) {
  YamlText writer;
  describe(writer);
  return writer.str();
}

std::vector<KeyValue> list_fields(const std::function<void(Fields&)>& describe) {
  KeyValueList fields;
  describe(fields);
  return fields.values;
}

std::string document_fields(const std::function<void(Fields&)>& describe) {
  MarkdownTable table;
  describe(table);
  return table.str();
}

}  // namespace tubebin
