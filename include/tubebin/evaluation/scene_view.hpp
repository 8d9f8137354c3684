/// A cloud to turn in a browser, offline: ground truth, what was found and which points are wrong, at a switch; the tubes'
/// centrelines; a tube's numbers at a click.
#pragma once

#include <span>
#include <string>

#include "tubebin/evaluation/scene_picture.hpp"

namespace tubebin::evaluation {

/// Most points that a view shows; of more, every so many are taken.
constexpr std::size_t kMostViewedPoints = 50'000;

struct SceneView {
  std::string title;
  LabelledPoints points;
};

/// A page of its own. Throws IoError where a view has no finite point.
std::string format_view_page(std::span<const SceneView> views);

/// The view inside a page that has kViewStyle and view_script().
std::string view_figure(const SceneView& view);
std::string view_style();
/// Once a page, after the figures.
std::string view_script();

}  // namespace tubebin::evaluation
