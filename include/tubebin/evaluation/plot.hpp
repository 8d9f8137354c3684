/// Line plots as SVG: colours that colour-blind people tell apart (Okabe & Ito 2008), and a marker and a line
/// style of its own for every series, so that they also read in black and white.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tubebin::evaluation {

struct PlotPoint {
  double x = 0.0;
  double y = 0.0;
  double low = 0.0;  ///< of the interval; equal to y: none
  double high = 0.0;
};

/// How a series is drawn.
enum class SeriesStyle {
  measured,  ///< filled markers, solid line
  second,    ///< filled markers, dashed line
  paper      ///< hollow markers, dotted line
};

struct PlotSeries {
  std::string name;
  int color = 0;  ///< index of hue and marker; series that belong together share one
  SeriesStyle style = SeriesStyle::measured;
  std::vector<PlotPoint> points;  ///< in order of x
  bool joined = true;             ///< by a line
};

struct Plot {
  std::string name;  ///< of its file, without extension
  std::string title;
  std::string x_label;
  std::string y_label;
  bool log_y = false;
  std::vector<PlotSeries> series;
};

/// A complete SVG document, readable on its own and inside HTML.
std::string format_svg(const Plot& plot);

/// Positions of five or so ticks in steps of 1, 2 or 5 times a power of ten that cover [low, high].
std::vector<double> linear_ticks(double low, double high);

}  // namespace tubebin::evaluation
