#include "core/number_fields.hpp"

#include <fmt/format.h>

namespace tubebin {
namespace {

class NumberFinder : public Fields {
 public:
  using Fields::vector;
  std::map<std::string, NumberField> found;

  void number(const char* key, double& value, Limits limits, const char*, const char*) override {
    found[prefix_ + key] = {.number = &value, .whole = nullptr, .limits = limits};
  }
  void integer(const char* key, int& value, Limits limits, const char*, const char*) override {
    found[prefix_ + key] = {.number = nullptr, .whole = &value, .limits = limits};
  }
  void seed(const char*, std::uint64_t&, const char*) override {}
  void flag(const char*, bool&, const char*) override {}
  void text(const char*, std::string&, const char*) override {}
  void vector(const char* key, Vec3& value, Limits limits, const char* unit, const char* doc) override {
    for (int i = 0; i < 3; ++i) number(fmt::format("{}[{}]", key, i).c_str(), value[i], limits, unit, doc);
  }
  void integers(const char*, std::vector<int>&, Limits, const char*) override {}
  void choice(const char*, int&, const std::vector<std::string>&, const char*) override {}
  void group(const char* key, const char*, const std::function<void(Fields&)>& describe_inner) override {
    const std::string outer = prefix_;
    prefix_ += std::string(key) + ".";
    describe_inner(*this);
    prefix_ = outer;
  }
  void list(const char* key, const char*, std::size_t size, const std::function<void(std::size_t)>&,
            const std::function<void(Fields&, std::size_t)>& describe_element) override {
    for (std::size_t i = 0; i < size; ++i)
      group(fmt::format("{}[{}]", key, i).c_str(), "", [&](Fields& fields) { describe_element(fields, i); });
  }

 private:
  std::string prefix_;
};

}  // namespace

std::map<std::string, NumberField> number_fields(const std::function<void(Fields&)>& describe) {
  NumberFinder finder;
  describe(finder);
  return std::move(finder.found);
}

}  // namespace tubebin
