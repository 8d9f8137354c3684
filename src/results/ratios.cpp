#include "tubebin/results/ratios.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "tubebin/core/error.hpp"

namespace tubebin::results {
namespace {

constexpr int kRatiosMax = 1000;

double parse_ratio(std::string_view text, const std::string& all) {
  double ratio = 0.0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), ratio);
  if (error != std::errc{} || end != text.data() + text.size() || !(ratio > 0.0 && ratio <= 1.0))
    throw_config_error("--ratios {}: '{}' is no ratio above 0 and up to 1; write 0.1,0.3,1 or 0.1:1.0:0.1", all, text);
  return ratio;
}

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(separator, start), text.size());
    parts.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return parts;
}

std::vector<double> parse_ratio_list(const std::string& text) {
  std::vector<double> ratios;
  for (const std::string_view part : split(text, ',')) ratios.push_back(parse_ratio(part, text));
  return ratios;
}

std::vector<double> parse_ratio_range(const std::string& text) {
  const auto parts = split(text, ':');
  if (parts.size() != 3) throw_config_error("--ratios {}: a range is first:last:step, as 0.1:1.0:0.1", text);
  const double first = parse_ratio(parts[0], text), last = parse_ratio(parts[1], text),
               step = parse_ratio(parts[2], text);
  if (first > last) throw_config_error("--ratios {}: the first is above the last", text);
  if ((last - first) / step > kRatiosMax) throw_config_error("--ratios {}: makes more than {}", text, kRatiosMax);
  // Decimal steps, not their binary sums: 0.3, not 0.30000000000000004.
  std::vector<double> ratios;
  for (int k = 0; first + k * step <= last + 1e-9; ++k) ratios.push_back(std::round((first + k * step) * 1e9) / 1e9);
  return ratios;
}

}  // namespace

std::vector<double> parse_ratios(const std::string& text) {
  std::vector<double> ratios = text.find(':') == std::string::npos ? parse_ratio_list(text) : parse_ratio_range(text);
  std::vector<double> sorted = ratios;
  std::sort(sorted.begin(), sorted.end());
  if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
    throw_config_error("--ratios {}: {} is there twice", text, *twice);
  return ratios;
}

}  // namespace tubebin::results
