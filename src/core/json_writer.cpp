#include "core/json_writer.hpp"

#include <cmath>
#include <stdexcept>

namespace tubebin {
namespace {

class JsonFields : public Fields {
 public:
  using Fields::vector;
  void number(const char* key, double& value, Limits, const char*, const char*) override { put(key, to_json(value)); }
  void integer(const char* key, int& value, Limits, const char*, const char*) override { put(key, value); }
  void seed(const char* key, std::uint64_t& value, const char*) override { put(key, value); }
  void flag(const char* key, bool& value, const char*) override { put(key, value); }
  void text(const char* key, std::string& value, const char*) override { put(key, value); }
  void vector(const char* key, Vec3& value, Limits, const char*, const char*) override { put(key, to_json(value)); }
  void integers(const char* key, std::vector<int>& value, Limits, const char*) override { put(key, value); }
  void choice(const char* key, int& value, const std::vector<std::string>& names, const char*) override {
    put(key, names.at(static_cast<std::size_t>(value)));
  }
  void group(const char* key, const char*, const std::function<void(Fields&)>& describe_inner) override {
    put(key, fields_to_json(describe_inner));
  }

  void list(const char* key, const char*, std::size_t size, const std::function<void(std::size_t)>&,
            const std::function<void(Fields&, std::size_t)>& describe_element) override {
    OrderedJson elements = OrderedJson::array();
    for (std::size_t i = 0; i < size; ++i)
      elements.push_back(fields_to_json([&](Fields& fields) { describe_element(fields, i); }));
    put(key, std::move(elements));
  }

  OrderedJson object = OrderedJson::object();

 private:
  void put(const char* key, OrderedJson value) { object[key] = std::move(value); }
};

}  // namespace

OrderedJson to_json(double number) {
  if (!std::isfinite(number)) throw std::invalid_argument("a number for a JSON file is not finite");
  return number;
}

OrderedJson to_json(const Vec3& vector) {
  return OrderedJson::array({to_json(vector.x()), to_json(vector.y()), to_json(vector.z())});
}

OrderedJson to_json(const Pose& pose) {
  const Quat q(pose.linear());
  OrderedJson rows = OrderedJson::array();
  for (int row = 0; row < 3; ++row) rows.push_back(to_json(Vec3(pose.linear().row(row))));
  return {{"position", to_json(Vec3(pose.translation()))},
          {"quaternion", OrderedJson::array({to_json(q.w()), to_json(q.x()), to_json(q.y()), to_json(q.z())})},
          {"rotation", std::move(rows)}};
}

OrderedJson fields_to_json(const std::function<void(Fields&)>& describe) {
  JsonFields fields;
  describe(fields);
  return std::move(fields.object);
}

std::string format_json(const OrderedJson& object) {
  std::string text = "{\n";
  const char* separator = "";
  for (const auto& [key, value] : object.items()) {
    text += separator + OrderedJson(key).dump() + ": ";
    separator = ",\n";
    if (!value.is_array() || value.empty()) {
      text += value.dump();
      continue;
    }
    text += "[\n";
    for (std::size_t i = 0; i < value.size(); ++i)
      text += "  " + value[i].dump() + (i + 1 < value.size() ? ",\n" : "\n");
    text += "]";
  }
  return text + "\n}\n";
}

}  // namespace tubebin
