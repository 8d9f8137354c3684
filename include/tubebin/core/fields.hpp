/// One description of an options struct serves for reading it from YAML, writing it back, and documenting it:
/// a `describe(Fields&, Options&)` beside the struct names each field once, with its limits and its effect.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "tubebin/core/distribution.hpp"

namespace tubebin {

/// Closed interval of the values that a number may take. NaN is never inside.
struct Limits {
  double min = -std::numeric_limits<double>::max();
  double max = std::numeric_limits<double>::max();
};

/// A visitor over the fields of an options struct. `unit` is "" for a pure number; `doc` says what it does.
class Fields {
 public:
  virtual ~Fields() = default;

  /// A key that earlier versions had; `why` says of it why it went.
  virtual void removed(const char* /*key*/, const char* /*why*/) {}

  /// The numbers that are described from here on may be left open, to be drawn: `distributions` says which are.
  virtual void randomized(Distributions& /*distributions*/) {}

  virtual void number(const char* key, double& value, Limits limits, const char* unit, const char* doc) = 0;
  virtual void integer(const char* key, int& value, Limits limits, const char* unit, const char* doc) = 0;
  virtual void seed(const char* key, std::uint64_t& value, const char* doc) = 0;
  virtual void flag(const char* key, bool& value, const char* doc) = 0;
  virtual void text(const char* key, std::string& value, const char* doc) = 0;
  virtual void vector(const char* key, Vec3& value, Limits limits, const char* unit, const char* doc) = 0;
  /// One that may be missing.
  virtual void vector(const char* key, std::optional<Vec3>& value, Limits limits, const char* unit, const char* doc) {
    if (value) vector(key, *value, limits, unit, doc);
  }
  virtual void integers(const char* key, std::vector<int>& value, Limits limits, const char* doc) = 0;
  /// `value` is an index into `names`.
  virtual void choice(const char* key, int& value, const std::vector<std::string>& names, const char* doc) = 0;
  /// A nested mapping; `describe_inner` describes its fields.
  virtual void group(const char* key, const char* doc, const std::function<void(Fields&)>& describe_inner) = 0;
  /// A list of mappings. `describe_element(fields, i)` describes the i-th, for i = size that of a new one.
  virtual void list(const char* key, const char* doc, std::size_t size, const std::function<void(std::size_t)>& resize,
                    const std::function<void(Fields&, std::size_t)>& describe_element) = 0;

  /// A list of mappings, each described by its type's `describe`.
  template <typename Element>
  void list(const char* key, std::vector<Element>& elements, const char* doc) {
    Element fresh;
    list(
        key, doc, elements.size(), [&](std::size_t size) { elements.assign(size, fresh); },
        [&](Fields& inner, std::size_t i) { describe(inner, i < elements.size() ? elements[i] : fresh); });
  }

  /// An enumeration whose values 0, 1, ... are called `names` in order.
  template <typename Enum>
  requires std::is_enum_v<Enum>
  void choice(const char* key, Enum& value, const std::vector<std::string>& names, const char* doc) {
    int index = static_cast<int>(value);
    choice(key, index, names, doc);
    value = static_cast<Enum>(index);
  }
};

}  // namespace tubebin
