#include "tubebin/modeling/model_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tubebin/core/version.hpp"

namespace tubebin::modeling {
namespace {

using Json = nlohmann::ordered_json;

class JsonFields : public Fields {
 public:
  void number(const char* key, double& value, Limits, const char*, const char*) override { json_[key] = value; }
  void integer(const char* key, int& value, Limits, const char*, const char*) override { json_[key] = value; }
  void seed(const char* key, std::uint64_t& value, const char*) override { json_[key] = value; }
  void flag(const char* key, bool& value, const char*) override { json_[key] = value; }
  void text(const char* key, std::string& value, const char*) override { json_[key] = value; }
  void vector(const char* key, Vec3& value, Limits, const char*, const char*) override {
    json_[key] = {value.x(), value.y(), value.z()};
  }
  void integers(const char* key, std::vector<int>& value, Limits, const char*) override { json_[key] = value; }
  void choice(const char* key, int& value, const std::vector<std::string>& names, const char*) override {
    json_[key] = names.at(static_cast<std::size_t>(value));
  }
  void group(const char* key, const char*, const std::function<void(Fields&)>& describe_inner) override {
    JsonFields inner;
    describe_inner(inner);
    json_[key] = inner.json_;
  }
  void list(const char* key, const char*, std::size_t size, const std::function<void(std::size_t)>&,
            const std::function<void(Fields&, std::size_t)>& describe_element) override {
    json_[key] = Json::array();
    for (std::size_t i = 0; i < size; ++i) {
      JsonFields inner;
      describe_element(inner, i);
      json_[key].push_back(inner.json_);
    }
  }
  const Json& json() const { return json_; }

 private:
  Json json_ = Json::object();
};

Json options_json(const std::function<void(Fields&)>& describe_options) {
  JsonFields fields;
  describe_options(fields);
  return fields.json();
}

/// To a tenth of a micrometre: below what a scanner tells, and short in the file.
double rounded(double metres) { return std::round(metres * 1e7) / 1e7; }

Json place(const Vec3& p) { return {rounded(p.x()), rounded(p.y()), rounded(p.z())}; }

Json tube_json(const TubeModel& tube, std::size_t label, cloud::Color color, std::size_t points) {
  Json cylinders = Json::array(), joints = Json::array();
  for (std::size_t p = 0; p < tube.paths.size(); ++p) {
    const auto& [nodes, bridged] = tube.paths[p];
    for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
      cylinders.push_back({{"path", p},
                           {"start", place(nodes[k])},
                           {"end", place(nodes[k + 1])},
                           {"radius", rounded(tube.radius)},
                           {"length", rounded((nodes[k + 1] - nodes[k]).norm())},
                           {"bridged", bool(bridged[k])}});
      if (k > 0) joints.push_back({{"position", place(nodes[k])}, {"radius", rounded(tube.radius)}});
    }
  }
  return {{"label", label},
          {"color", fmt::format("#{:06x}", color)},
          {"length", rounded(tube.length())},
          {"points", points},
          {"cylinders", cylinders},
          {"joints", joints}};
}

Json seconds_json(const StageSeconds& seconds) {
  return {{"filtering", seconds.filtering}, {"segmentation", seconds.segmentation}, {"fitting", seconds.fitting},
          {"joining", seconds.joining},     {"labeling", seconds.labeling},         {"total", seconds.total()}};
}

}  // namespace

std::string format_model_json(const ModelingResult& result, const std::vector<cloud::Color>& colors,
                              const std::function<void(Fields&)>& describe_options, bool with_seconds) {
  std::vector<std::size_t> points(result.tubes.size() + 1, 0);
  for (const cloud::Label label : result.labels) ++points[label];
  Json tubes = Json::array();
  for (std::size_t k = 0; k < result.tubes.size(); ++k)
    tubes.push_back(tube_json(result.tubes[k], k + 1, colors.at(k + 1), points[k + 1]));
  Json json = {{"format", "tubebin model 1"},
               {"tool_version", tool_version()},
               {"units", "metres, in the cloud's world frame"},
               {"filtered_points", result.labels.size()},
               {"unlabeled_points", points[0]},
               {"radius", rounded(result.radius)},
               {"tube_length", rounded(result.tube_length)},
               {"noise", rounded(result.noise)},
               {"spacing", rounded(result.spacing)},
               {"tubes", tubes},
               {"options", options_json(describe_options)}};
  if (with_seconds) json["seconds"] = seconds_json(result.seconds);
  return json.dump() + "\n";
}

std::string format_options_json(const std::function<void(Fields&)>& describe_options) {
  return options_json(describe_options).dump();
}

std::string format_times_json(const StageSeconds& seconds, double read_seconds) {
  Json json = {{"read", read_seconds}};
  json.update(seconds_json(seconds));
  return json.dump() + "\n";
}

}  // namespace tubebin::modeling
