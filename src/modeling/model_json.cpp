#include "tubebin/modeling/model_json.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "core/json_writer.hpp"
#include "tubebin/core/version.hpp"

namespace tubebin::modeling {
namespace {

using Json = OrderedJson;

double rounded_nats(double nats) { return std::round(nats * 10.0) / 10.0; }

Json place(const Vec3& p) { return {rounded(p.x()), rounded(p.y()), rounded(p.z())}; }

/// As --bin-pose takes it.
Json bin_json(const BinFound& bin) {
  const Eigen::Matrix3d axes = bin.world_from_bin.linear();
  const auto degrees = [](double sine, double cosine) {
    return std::round(std::atan2(sine, cosine) * (180.0 / std::numbers::pi) * 1e4) / 1e4;
  };
  const Json rotation = {degrees(axes(2, 1), axes(2, 2)), degrees(-axes(2, 0), std::hypot(axes(2, 1), axes(2, 2))),
                         degrees(axes(1, 0), axes(0, 0))};
  return {{"position", place(bin.world_from_bin.translation())},
          {"rotation_deg", rotation},
          {"length", rounded(bin.length)},
          {"width", rounded(bin.width)},
          {"height", rounded(bin.height)}};
}

Json scene_json(const ModelingResult& result) {
  const SceneFound& found = result.found;
  Json radii = Json::array();
  for (std::size_t k = 0; k < result.radii.size(); ++k)
    radii.push_back({{"radius", rounded(result.radii[k])}, {"error", rounded(result.radius_errors[k])}});
  Json lengths = Json::array();
  for (const double length : result.lengths) lengths.push_back(rounded(length));
  Json json = {{"up", place(found.up)},
               {"up_is_known", found.up_is_known},
               {"viewpoint", place(found.viewpoint)},
               {"viewpoint_is_told", found.viewpoint_is_told},
               {"noise_smoothed", rounded(found.noise_smoothed)},
               {"flat_regions", found.flat_regions},
               {"wire_radius", rounded(found.wire_radius)},
               {"bin", found.bin ? bin_json(*found.bin) : Json()},
               {"radii", radii},
               {"lengths", lengths},
               {"unexplained", std::round(found.unexplained * 1e4) / 1e4},
               {"doubts", found.doubts}};
  for (const Vec3& further : found.further_viewpoints) json["further_viewpoints"].push_back(place(further));
  return json;
}

Json tube_json(const TubeModel& tube, std::size_t label, cloud::Color color, std::size_t points) {
  Json cylinders = Json::array(), joints = Json::array();
  for (std::size_t p = 0; p < tube.paths.size(); ++p) {
    const TubePath& path = tube.paths[p];
    const auto& nodes = path.nodes;
    if (tube.is_ball()) joints.push_back({{"position", place(nodes[0])}, {"radius", rounded(tube.radius)}});
    std::size_t bridge = 0;
    for (std::size_t k = 0; k + 1 < nodes.size(); ++k) {
      Json cylinder = {{"path", p},
                       {"start", place(nodes[k])},
                       {"end", place(nodes[k + 1])},
                       {"radius", rounded(tube.radius)},
                       {"length", rounded((nodes[k + 1] - nodes[k]).norm())},
                       {"bridged", bool(path.bridged[k])}};
      if (path.bridged[k] && bridge < path.bridge_odds.size())
        cylinder["log_odds"] = rounded_nats(path.bridge_odds[bridge++]);
      cylinders.push_back(std::move(cylinder));
      if (k > 0) joints.push_back({{"position", place(nodes[k])}, {"radius", rounded(tube.radius)}});
    }
  }
  double evidence = 0.0;
  for (const TubePath& path : tube.paths) evidence += path.evidence;
  Json json = {{"label", label},   {"color", fmt::format("#{:06x}", color)}, {"length", rounded(tube.length())},
               {"points", points}, {"radius", rounded(tube.radius)},         {"log_odds", rounded_nats(evidence)}};
  if (tube.whole_odds) json["whole_log_odds"] = rounded_nats(*tube.whole_odds);
  json["cylinders"] = cylinders;
  json["joints"] = joints;
  return json;
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
               {"tube_length", result.lengths.size() == 1 ? rounded(result.lengths.front()) : 0.0},
               {"noise", rounded(result.noise)},
               {"spacing", rounded(result.spacing)},
               {"scene", scene_json(result)},
               {"tubes", tubes},
               {"options", fields_to_json(describe_options)}};
  if (with_seconds) json["seconds"] = seconds_json(result.seconds);
  return json.dump() + "\n";
}

std::string format_options_json(const std::function<void(Fields&)>& describe_options) {
  return fields_to_json(describe_options).dump();
}

std::string format_times_json(const StageSeconds& seconds, double read_seconds) {
  Json json = {{"read", read_seconds}};
  json.update(seconds_json(seconds));
  return json.dump() + "\n";
}

}  // namespace tubebin::modeling
