#include "tubebin/evaluation/plot.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "tubebin/evaluation/table.hpp"

namespace tubebin::evaluation {
namespace {

// SVG units; the picture scales to the page.
constexpr double kWidth = 760.0;
constexpr double kPlotHeight = 340.0;
constexpr double kLeft = 74.0;
constexpr double kRight = 16.0;
constexpr double kTop = 44.0;
constexpr double kBelowAxis = 56.0;  // tick labels and axis title
constexpr double kLegendRow = 24.0;
constexpr int kLegendColumns = 2;
constexpr double kMarker = 5.0;

/// Okabe & Ito (2008), without yellow, which is faint on paper.
constexpr std::array<const char*, 7> kPalette = {"#0072B2", "#D55E00", "#009E73", "#CC79A7",
                                                 "#E69F00", "#56B4E9", "#000000"};

const char* color_of(const PlotSeries& series) {
  return kPalette[static_cast<std::size_t>(series.color) % kPalette.size()];
}

const char* dashes_of(SeriesStyle style) {
  switch (style) {
    case SeriesStyle::measured:
      return "none";
    case SeriesStyle::second:
      return "9 5";
    case SeriesStyle::paper:
      return "2 4";
  }
  return "none";
}

struct Range {
  double low = std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::lowest();
  void include(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

/// From data to SVG coordinates.
struct PlotAxis {
  double low = 0.0;
  double high = 1.0;
  double start = 0.0;  ///< SVG coordinate of low
  double end = 1.0;    ///< SVG coordinate of high
  bool log = false;
  std::vector<double> ticks;

  double place(double value) const {
    const auto scaled = [&](double v) { return log ? std::log10(v) : v; };
    return start + (end - start) * (scaled(value) - scaled(low)) / (scaled(high) - scaled(low));
  }
};

std::vector<double> log_ticks(double low, double high) {
  std::vector<double> ticks;
  const bool few_decades = high / low < 2000.0;
  for (double decade = std::pow(10.0, std::floor(std::log10(low))); decade <= high * 1.0001; decade *= 10.0)
    for (const double step : few_decades ? std::vector<double>{1.0, 2.0, 5.0} : std::vector<double>{1.0})
      if (step * decade >= low * 0.9999 && step * decade <= high * 1.0001) ticks.push_back(step * decade);
  return ticks;
}

/// The x values that occur, if they are few enough to be all named.
std::vector<double> x_ticks(const Plot& plot, Range range) {
  constexpr std::size_t most = 16;
  std::set<double> values;
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& point : series.points) values.insert(point.x);
  if (values.size() <= most) return {values.begin(), values.end()};
  return linear_ticks(range.low, range.high);
}

PlotAxis x_axis(const Plot& plot) {
  Range range;
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& point : series.points) range.include(point.x);
  const double margin = range.high > range.low ? 0.03 * (range.high - range.low) : 0.5;
  return {range.low - margin, range.high + margin, kLeft, kWidth - kRight, false, x_ticks(plot, range)};
}

PlotAxis y_axis(const Plot& plot) {
  Range range;
  for (const PlotSeries& series : plot.series)
    for (const PlotPoint& point : series.points) {
      range.include(plot.log_y ? std::max(point.low, 1e-9) : point.low);
      range.include(point.high);
    }
  PlotAxis axis{range.low, range.high, kTop + kPlotHeight, kTop, plot.log_y, {}};
  if (plot.log_y) {
    axis.low = range.low / 1.15;
    axis.high = range.high * 1.15;
    axis.ticks = log_ticks(axis.low, axis.high);
  } else {
    if (range.high - range.low < 1e-9) {
      axis.low -= 0.01;
      axis.high += 0.01;
    }
    axis.ticks = linear_ticks(axis.low, axis.high);
    axis.low = axis.ticks.front();
    axis.high = axis.ticks.back();
  }
  return axis;
}

/// Shapes by colour index, so that hue is never the only difference.
std::string marker(double x, double y, const PlotSeries& series) {
  const std::string paint =
      fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"1.6\"",
                  series.style == SeriesStyle::paper ? "#ffffff" : color_of(series), color_of(series));
  const double r = kMarker;
  const auto polygon = [&](const std::vector<std::pair<double, double>>& corners) {
    std::string points;
    for (const auto& [dx, dy] : corners) points += fmt::format("{:.1f},{:.1f} ", x + dx * r, y + dy * r);
    return fmt::format("<polygon points=\"{}\" {}/>", points, paint);
  };
  switch (series.color % 6) {
    case 0:
      return fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" {}/>", x, y, r, paint);
    case 1:
      return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" {}/>", x - 0.9 * r,
                         y - 0.9 * r, 1.8 * r, 1.8 * r, paint);
    case 2:
      return polygon({{0.0, -1.2}, {1.1, 0.8}, {-1.1, 0.8}});
    case 3:
      return polygon({{0.0, -1.3}, {1.3, 0.0}, {0.0, 1.3}, {-1.3, 0.0}});
    case 4:
      return polygon({{0.0, 1.2}, {1.1, -0.8}, {-1.1, -0.8}});
    default:
      return polygon({{-0.4, -1.2},
                      {0.4, -1.2},
                      {0.4, -0.4},
                      {1.2, -0.4},
                      {1.2, 0.4},
                      {0.4, 0.4},
                      {0.4, 1.2},
                      {-0.4, 1.2},
                      {-0.4, 0.4},
                      {-1.2, 0.4},
                      {-1.2, -0.4},
                      {-0.4, -0.4}});
  }
}

std::string text(double x, double y, const char* anchor, const std::string& content, const char* extra = "") {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y, anchor, extra,
                     escape_html(content));
}

std::string line(double x1, double y1, double x2, double y2, const std::string& attributes) {
  return fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" {}/>\n", x1, y1, x2, y2,
                     attributes);
}

/// A tick's number without the rounding of its computation.
std::string tick_label(double value) { return fmt::format("{}", std::round(value * 1e6) / 1e6); }

std::string axes_svg(const Plot& plot, const PlotAxis& x, const PlotAxis& y) {
  std::string svg;
  for (const double tick : y.ticks) {
    svg += line(x.start, y.place(tick), x.end, y.place(tick), "stroke=\"#d9d9d9\"");
    svg += text(x.start - 8.0, y.place(tick) + 5.0, "end", tick_label(tick));
  }
  for (const double tick : x.ticks) {
    svg += line(x.place(tick), y.start, x.place(tick), y.start + 5.0, "stroke=\"#333333\"");
    svg += text(x.place(tick), y.start + 21.0, "middle", tick_label(tick));
  }
  svg += line(x.start, y.start, x.end, y.start, "stroke=\"#333333\"");
  svg += line(x.start, y.start, x.start, y.end, "stroke=\"#333333\"");
  svg += text(0.5 * (x.start + x.end), y.start + 44.0, "middle", plot.x_label);
  const double middle = 0.5 * (y.start + y.end);
  svg += fmt::format(
      "<text x=\"18\" y=\"{0:.1f}\" text-anchor=\"middle\" transform=\"rotate(-90 18 {0:.1f})\">{1}</text>\n", middle,
      escape_html(plot.y_label));
  return svg;
}

std::string series_svg(const PlotSeries& series, const PlotAxis& x, const PlotAxis& y) {
  std::string svg = fmt::format("<g class=\"series\"><title>{}</title>\n", escape_html(series.name));
  std::string path;
  for (const PlotPoint& point : series.points) {
    const double px = x.place(point.x);
    path += fmt::format("{}{:.1f} {:.1f}", path.empty() ? "M" : "L", px, y.place(point.y));
    if (point.high <= point.low) continue;
    const double low = y.place(y.log ? std::max(point.low, y.low) : point.low);
    const double high = y.place(point.high);
    const std::string stroke = fmt::format("stroke=\"{}\" stroke-width=\"1.2\"", color_of(series));
    svg += line(px, low, px, high, stroke) + line(px - 3.0, low, px + 3.0, low, stroke) +
           line(px - 3.0, high, px + 3.0, high, stroke);
  }
  if (series.joined && series.points.size() > 1)
    svg += fmt::format("<path d=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\" stroke-dasharray=\"{}\"/>\n",
                       path, color_of(series), dashes_of(series.style));
  for (const PlotPoint& point : series.points) svg += marker(x.place(point.x), y.place(point.y), series) + "\n";
  return svg + "</g>\n";
}

std::string legend_svg(const Plot& plot, double top) {
  std::string svg;
  const double column = (kWidth - kLeft - kRight) / kLegendColumns;
  for (std::size_t i = 0; i < plot.series.size(); ++i) {
    const PlotSeries& series = plot.series[i];
    const std::size_t row = i / kLegendColumns;
    const double left = kLeft + column * static_cast<double>(i % kLegendColumns);
    const double y = top + kLegendRow * (0.5 + static_cast<double>(row));
    if (series.joined)
      svg += line(left, y, left + 40.0, y,
                  fmt::format("stroke=\"{}\" stroke-width=\"2\" stroke-dasharray=\"{}\"", color_of(series),
                              dashes_of(series.style)));
    svg += marker(left + 20.0, y, series) + "\n" + text(left + 50.0, y + 5.0, "start", series.name);
  }
  return svg;
}

}  // namespace

std::vector<double> linear_ticks(double low, double high) {
  constexpr double wanted = 5.0;
  const double raw = std::max(high - low, 1e-12) / wanted;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10.0 * power;
  for (const double factor : {5.0, 2.0, 1.0})
    if (factor * power >= raw * 0.9999) step = factor * power;
  std::vector<double> ticks;
  const double first = std::floor(low / step + 1e-9);
  const double last = std::ceil(high / step - 1e-9);
  for (double i = first; i <= last + 0.5; ++i) ticks.push_back(i * step);
  return ticks;
}

std::string format_svg(const Plot& plot) {
  const PlotAxis x = x_axis(plot);
  const PlotAxis y = y_axis(plot);
  const double legend_top = kTop + kPlotHeight + kBelowAxis;
  const std::size_t legend_rows = (plot.series.size() + kLegendColumns - 1) / kLegendColumns;
  const double height = legend_top + kLegendRow * static_cast<double>(legend_rows) + 8.0;
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" role=\"img\" "
      "aria-label=\"{2}\" "
      "font-family=\"Helvetica, Arial, sans-serif\" font-size=\"15\" fill=\"#222222\">\n"
      "<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#ffffff\"/>\n",
      kWidth, height, escape_html(plot.title));
  svg += text(kLeft, 24.0, "start", plot.title, " font-weight=\"bold\" font-size=\"16\"");
  svg += axes_svg(plot, x, y);
  for (const PlotSeries& series : plot.series) svg += series_svg(series, x, y);
  return svg + legend_svg(plot, legend_top) + "</svg>\n";
}

}  // namespace tubebin::evaluation
