#include "scan/pixel_noise.hpp"

#include <cmath>

#include "tubebin/core/random.hpp"

namespace tubebin::scan {
namespace {

/// Beyond this many standard deviations a Gaussian filter has nothing left that matters.
constexpr double kFilterReach = 4.0;

/// Of unit energy, so that it keeps the variance of white noise.
std::vector<double> gaussian_filter(double sigma) {
  const int reach = static_cast<int>(std::ceil(kFilterReach * sigma));
  std::vector<double> weights;
  double energy = 0.0;
  for (int k = -reach; k <= reach; ++k) {
    weights.push_back(sigma > 0.0 ? std::exp(-k * k / (2.0 * sigma * sigma)) : 1.0);
    energy += weights.back() * weights.back();
  }
  for (double& weight : weights) weight /= std::sqrt(energy);
  return weights;
}

/// `in` has as many more values along the filtered axis as the filter has weights beyond one. Line l's value i is at
/// l * line_stride + i * stride; the lines of `out` are `length` long and written one after the other.
std::vector<double> filter_lines(const std::vector<double>& in, std::size_t lines, std::size_t line_stride,
                                 std::size_t length, std::size_t stride, const std::vector<double>& weights) {
  std::vector<double> out;
  out.reserve(lines * length);
  for (std::size_t line = 0; line < lines; ++line) {
    for (std::size_t i = 0; i < length; ++i) {
      double sum = 0.0;
      for (std::size_t k = 0; k < weights.size(); ++k) sum += weights[k] * in[line * line_stride + (i + k) * stride];
      out.push_back(sum);
    }
  }
  return out;
}

}  // namespace

PixelNoise::PixelNoise(std::uint64_t seed, NoiseStream stream)
    : seed_(derive_seed({seed, static_cast<std::uint64_t>(stream)})) {}

double PixelNoise::uniform(int column, int row, std::uint64_t draw) const {
  const std::uint64_t bits =
      derive_seed({seed_, static_cast<std::uint64_t>(column), static_cast<std::uint64_t>(row), draw});
  return static_cast<double>(bits >> 11) * 0x1.0p-53;
}

double PixelNoise::uniform(int column, int row) const { return uniform(column, row, 0); }

double PixelNoise::normal(int column, int row) const {
  const double radius = std::sqrt(-2.0 * std::log(1.0 - uniform(column, row, 0)));
  return radius * std::cos(2.0 * std::numbers::pi * uniform(column, row, 1));
}

std::vector<double> correlated_normals(const PixelNoise& noise, const scene::PixelWindow& window,
                                       double correlation_length) {
  const std::vector<double> filter = gaussian_filter(correlation_length / 2.0);
  const int reach = static_cast<int>(filter.size()) / 2;
  std::vector<double> white;
  for (int row = window.y - reach; row < window.y + window.height + reach; ++row)
    for (int column = window.x - reach; column < window.x + window.width + reach; ++column)
      white.push_back(noise.normal(column, row));
  const auto width = static_cast<std::size_t>(window.width), height = static_cast<std::size_t>(window.height);
  const std::size_t rows = height + filter.size() - 1;
  const std::vector<double> along_rows = filter_lines(white, rows, width + filter.size() - 1, width, 1, filter);
  const std::vector<double> column_by_column = filter_lines(along_rows, width, 1, height, width, filter);
  std::vector<double> row_by_row(width * height);
  for (std::size_t column = 0; column < width; ++column)
    for (std::size_t row = 0; row < height; ++row)
      row_by_row[row * width + column] = column_by_column[column * height + row];
  return row_by_row;
}

}  // namespace tubebin::scan
