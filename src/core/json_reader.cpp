#include "core/json_reader.hpp"

#include <algorithm>
#include <cmath>
#include <new>

#include "core/limits_text.hpp"
#include "tubebin/core/atomic_file.hpp"

namespace tubebin {
namespace {

/// Far above rounding, far below any difference that counts. A quaternion of a matrix that is just
/// orthonormal enough is a little farther from it.
constexpr double kOrthonormalTolerance = 1e-6;
constexpr double kQuaternionTolerance = 1e-5;

class FieldsFromJson : public Fields {
 public:
  using Fields::vector;
  explicit FieldsFromJson(const JsonPlace& object) : object_(object) {}

  void number(const char* key, double& value, Limits limits, const char*, const char*) override {
    value = object_.at(key).number(limits);
  }
  void integer(const char* key, int& value, Limits limits, const char*, const char*) override {
    value = object_.at(key).integer(limits);
  }
  void seed(const char* key, std::uint64_t& value, const char*) override {
    value = object_.at(key).whole(0, std::numeric_limits<std::uint64_t>::max());
  }
  void flag(const char* key, bool& value, const char*) override { value = object_.at(key).flag(); }
  void text(const char* key, std::string& value, const char*) override { value = object_.at(key).text(); }
  void vector(const char* key, Vec3& value, Limits limits, const char*, const char*) override {
    value = object_.at(key).vector(limits);
  }
  void integers(const char* key, std::vector<int>& value, Limits limits, const char*) override {
    value.clear();
    for (const JsonPlace& element : object_.at(key).elements()) value.push_back(element.integer(limits));
  }
  void choice(const char* key, int& value, const std::vector<std::string>& names, const char*) override {
    const JsonPlace place = object_.at(key);
    const auto found = std::find(names.begin(), names.end(), place.text());
    if (found == names.end()) place.fail(fmt::format("one of {}", fmt::join(names, ", ")));
    value = static_cast<int>(found - names.begin());
  }
  void group(const char* key, const char*, const std::function<void(Fields&)>& describe_inner) override {
    object_.at(key).fields(describe_inner);
  }
  void list(const char* key, const char*, std::size_t, const std::function<void(std::size_t)>& resize,
            const std::function<void(Fields&, std::size_t)>& describe_element) override {
    const std::vector<JsonPlace> elements = object_.at(key).elements();
    resize(elements.size());
    for (std::size_t i = 0; i < elements.size(); ++i)
      elements[i].fields([&](Fields& fields) { describe_element(fields, i); });
  }

 private:
  const JsonPlace& object_;
};

/// The JSON library walks values by recursion, so their depth must be bounded before it sees them.
void check_depth(std::string_view text, const std::string& name) {
  constexpr int kMaxDepth = 100;
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (in_string && text[i] == '\\') ++i;
    else if (text[i] == '"') in_string = !in_string;
    else if (!in_string && (text[i] == '[' || text[i] == '{') && ++depth > kMaxDepth)
      throw_io_error("{}: is nested more than {} deep; not valid", name, kMaxDepth);
    else if (!in_string && (text[i] == ']' || text[i] == '}')) --depth;
  }
}

}  // namespace

namespace {

template <typename Json>
Json parse_bounded(std::string_view text, const std::string& name) {
  if (text.empty()) throw_io_error("{}: the file is empty; expected JSON", name);
  if (text.size() > kJsonBytesMax)
    throw_io_error("{}: has {} bytes of JSON; valid: up to {}", name, text.size(), kJsonBytesMax);
  check_depth(text, name);
  // Json's destructor allocates, and ends the program where it can't: memory that does not last for the values runs out here.
  const std::size_t room = 8 * text.size();
  ::operator delete(::operator new(room));
  try {
    return Json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const std::string_view before = text.substr(0, error.byte > 0 ? error.byte - 1 : 0);
    const auto line = std::count(before.begin(), before.end(), '\n') + 1;
    const std::size_t line_start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
    throw_io_error("{}:{}:{}: not valid JSON", name, line, before.size() - line_start + 1);
  } catch (const nlohmann::json::exception& error) {  // a number beyond a double
    throw_io_error("{}: not valid JSON: {}", name, error.what());
  }
}

}  // namespace

nlohmann::json parse_json(std::string_view text, const std::string& name) {
  return parse_bounded<nlohmann::json>(text, name);
}

nlohmann::ordered_json parse_ordered_json(std::string_view text, const std::string& name) {
  return parse_bounded<nlohmann::ordered_json>(text, name);
}

nlohmann::ordered_json read_json(const std::string& path) {
  return parse_ordered_json(read_file(path, kJsonBytesMax), path);
}

void JsonPlace::fail(const std::string& valid) const {
  constexpr std::size_t kShown = 60;
  std::string shown = value_.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  if (shown.size() > kShown) shown = shown.substr(0, kShown - 3) + "...";
  throw_io_error("{}: {}: {} is not valid; valid: {}", file_, pointer_.empty() ? "/" : pointer_, shown, valid);
}

JsonPlace JsonPlace::at(const char* key) const {
  if (!value_.is_object()) fail("an object");
  const auto found = value_.find(key);
  if (found == value_.end()) throw_io_error("{}: {}/{}: missing", file_, pointer_, key);
  return {*found, file_, pointer_ + "/" + key};
}

std::vector<JsonPlace> JsonPlace::elements() const {
  if (!value_.is_array()) fail("a list");
  std::vector<JsonPlace> all;
  all.reserve(value_.size());
  for (std::size_t i = 0; i < value_.size(); ++i)
    all.push_back(JsonPlace(value_[i], file_, fmt::format("{}/{}", pointer_, i)));
  return all;
}

std::vector<JsonPlace> JsonPlace::elements(std::size_t count) const {
  if (!value_.is_array() || value_.size() != count) fail(fmt::format("a list of {}", count));
  return elements();
}

double JsonPlace::number(Limits limits) const {
  if (!value_.is_number()) fail(limits_text(limits));
  const auto number = value_.get<double>();
  if (!std::isfinite(number) || number < limits.min || number > limits.max) fail(limits_text(limits));
  return number;
}

std::uint64_t JsonPlace::whole(std::uint64_t min, std::uint64_t max) const {
  if (!value_.is_number_unsigned() || value_.get<std::uint64_t>() < min || value_.get<std::uint64_t>() > max)
    fail(fmt::format("a whole number from {} to {}", min, max));
  return value_.get<std::uint64_t>();
}

int JsonPlace::integer(Limits limits) const {
  const double number = value_.is_number_integer() ? this->number() : limits.min - 1.0;
  const double min = std::max<double>(limits.min, std::numeric_limits<int>::min());
  const double max = std::min<double>(limits.max, std::numeric_limits<int>::max());
  if (number < min || number > max) fail(fmt::format("a whole number from {} to {}", min, max));
  return static_cast<int>(number);
}

bool JsonPlace::flag() const {
  if (!value_.is_boolean()) fail("true or false");
  return value_.get<bool>();
}

std::string JsonPlace::text() const {
  if (!value_.is_string()) fail("a text");
  return value_.get<std::string>();
}

Vec3 JsonPlace::vector(Limits limits) const {
  const std::vector<JsonPlace> parts = elements(3);
  return {parts[0].number(limits), parts[1].number(limits), parts[2].number(limits)};
}

Pose JsonPlace::pose() const {
  const JsonPlace rotation = at("rotation");
  const JsonPlace quaternion = at("quaternion");
  Pose pose = Pose::Identity();
  pose.translation() = at("position").vector();
  const std::vector<JsonPlace> rows = rotation.elements(3);
  for (int row = 0; row < 3; ++row) pose.linear().row(row) = rows[static_cast<std::size_t>(row)].vector();
  const Eigen::Matrix3d matrix = pose.linear();
  if (!(matrix * matrix.transpose()).isIdentity(kOrthonormalTolerance) || matrix.determinant() < 0.0)
    rotation.fail("the rows of a rotation matrix");
  const std::vector<JsonPlace> q = quaternion.elements(4);
  const Quat other(q[0].number(), q[1].number(), q[2].number(), q[3].number());
  if (!other.toRotationMatrix().isApprox(matrix, kQuaternionTolerance))
    quaternion.fail("the unit quaternion [w, x, y, z] of the rotation matrix beside it");
  return pose;
}

std::map<std::string, double> JsonPlace::numbers() const {
  if (!value_.is_object()) fail("an object of numbers");
  std::map<std::string, double> all;
  for (const auto& entry : value_.items()) all[entry.key()] = at(entry.key().c_str()).number();
  return all;
}

void JsonPlace::fields(const std::function<void(Fields&)>& describe) const {
  FieldsFromJson fields(*this);
  describe(fields);
}

void JsonPlace::expect_near(double expected, double tolerance) const {
  if (!(std::abs(number() - expected) <= tolerance)) fail(fmt::format("{}, as it follows from the rest", expected));
}

}  // namespace tubebin
