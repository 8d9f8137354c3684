#include "tubebin/core/distribution.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "tubebin/core/yaml.hpp"

namespace tubebin {
namespace {

using ::testing::HasSubstr;
using Form = Distribution::Form;

constexpr int kDraws = 100'000;

struct Moments {
  double low = 0.0, high = 0.0, mean = 0.0, variance = 0.0;
};

/// Of many draws, of which a function is taken.
Moments moments_of(const Distribution& distribution, const std::function<double(double)>& function) {
  Random random(11);
  Moments result{.low = INFINITY, .high = -INFINITY};
  double sum = 0.0, squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double drawn = distribution.draw(random);
    EXPECT_GE(drawn, distribution.low());
    EXPECT_LE(drawn, distribution.high());
    const double value = function(drawn);
    result.low = std::min(result.low, value);
    result.high = std::max(result.high, value);
    sum += value;
    squares += value * value;
  }
  result.mean = sum / kDraws;
  result.variance = squares / kDraws - result.mean * result.mean;
  return result;
}

/// A mean of kDraws numbers is off by more than five of its standard deviations once in two million.
double mean_tolerance(double variance) { return 5.0 * std::sqrt(variance / kDraws); }

double itself(double value) { return value; }

TEST(Distribution, UniformHasTheMeanAndTheVarianceOfItsRange) {
  const Moments found = moments_of({.form = Form::uniform, .numbers = {-1.0, 3.0}}, itself);
  EXPECT_NEAR(found.mean, 1.0, mean_tolerance(16.0 / 12.0));
  EXPECT_NEAR(found.variance, 16.0 / 12.0, 0.02);
  EXPECT_LT(found.low, -0.99);
  EXPECT_GT(found.high, 2.99);
}

TEST(Distribution, LogarithmsOfLogUniformAreUniform) {
  const double span = std::log(100.0);
  const Moments found =
      moments_of({.form = Form::log_uniform, .numbers = {0.01, 1.0}}, [](double value) { return std::log(value); });
  EXPECT_NEAR(found.mean, -span / 2.0, mean_tolerance(span * span / 12.0));
  EXPECT_NEAR(found.variance, span * span / 12.0, 0.03);
}

TEST(Distribution, NormalIsCutOffAtThreeStandardDeviations) {
  // The variance of a standard normal deviate within +-3 is 1 - 2 * 3 phi(3) / (2 Phi(3) - 1).
  const double density = std::exp(-4.5) / std::sqrt(2.0 * std::numbers::pi);
  const double variance = 1.0 - 6.0 * density / std::erf(3.0 / std::sqrt(2.0));
  const Moments found = moments_of({.form = Form::normal, .numbers = {5.0, 2.0}}, itself);
  EXPECT_NEAR(found.mean, 5.0, mean_tolerance(4.0 * variance));
  EXPECT_NEAR(found.variance, 4.0 * variance, 0.06);
  EXPECT_GT(found.high, 10.5);
}

TEST(Distribution, ChoiceAndWholeNumbersAreEachAsLikely) {
  for (const Distribution& distribution :
       {Distribution{.form = Form::choice, .numbers = {2.0, 3.0, 4.0}},
        Distribution{.form = Form::uniform, .numbers = {2.0, 4.0}, .is_whole = true}}) {
    const Moments found = moments_of(distribution, itself);
    EXPECT_NEAR(found.mean, 3.0, mean_tolerance(2.0 / 3.0));
    EXPECT_NEAR(found.variance, 2.0 / 3.0, 0.01);
    Random random(1);
    for (int i = 0; i < 100; ++i) EXPECT_EQ(std::fmod(distribution.draw(random), 1.0), 0.0);
  }
}

struct DrawnOptions {
  double radius = 1.0;
  int count = 7;
  Vec3 place = Vec3::Zero();
  Distributions distributions;
};

void describe(Fields& fields, DrawnOptions& options) {
  fields.randomized(options.distributions);
  fields.number("radius", options.radius, {0.5, 10.0}, "m", "of it");
  fields.integer("count", options.count, {1, 9}, "", "of them");
  fields.vector("place", options.place, {-10.0, 10.0}, "m", "of all");
}

std::function<void(Fields&)> fields_of(DrawnOptions& options) {
  return [&](Fields& fields) { describe(fields, options); };
}

TEST(DistributionYaml, ReadsBackAsItIsWritten) {
  DrawnOptions options;
  read_yaml_text(
      "radius: {log_uniform: [1, 2.5], per: tube}\ncount: {choice: [2, 9]}\nplace: [0, {normal: [1, 0.1]}, 2]\n", "o",
      fields_of(options));
  EXPECT_EQ(options.distributions.size(), 3u);
  const std::string text = write_yaml(fields_of(options));
  EXPECT_THAT(text, HasSubstr("radius: {log_uniform: [1, 2.5], per: tube}  #"));
  EXPECT_THAT(text, HasSubstr("place: [0, {normal: [1, 0.1]}, 2]  #"));
  DrawnOptions back;
  read_yaml_text(text, "o", fields_of(back));
  EXPECT_EQ(write_yaml(fields_of(back)), text);
}

TEST(DistributionYaml, ANumberReplacesWhatAnIncludedFileDraws) {
  DrawnOptions options;
  read_yaml_text("radius: {uniform: [1, 2]}\n", "included", fields_of(options));
  read_yaml_text("radius: 3\n", "own", fields_of(options));
  EXPECT_TRUE(options.distributions.empty());
  EXPECT_EQ(options.radius, 3.0);
}

TEST(DistributionYaml, NamesPlaceValueAndWhatIsValid) {
  const auto problem = [](const std::string& text) -> std::string {
    DrawnOptions options;
    try {
      read_yaml_text(text, "o", fields_of(options));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "accepted";
  };
  EXPECT_EQ(problem("radius: {uniform: [0.1, 2]}\n"),
            "o:1:20: radius.uniform[0]: '0.1' is not valid; valid: 0.5 to 10 m");
  EXPECT_THAT(problem("radius: {uniform: [2, 1]}\n"), HasSubstr("o:1:19: radius.uniform: '[2, 1]'"));
  EXPECT_THAT(problem("radius: {uniform: [2]}\n"), HasSubstr("a list of two numbers"));
  EXPECT_THAT(problem("radius: {normal: [1, 0.2]}\n"), HasSubstr("stay within 0.5 to 10 m"));
  EXPECT_THAT(problem("radius: {normal: [1, -0.1]}\n"), HasSubstr("radius.normal[1]: '-0.1'"));
  EXPECT_THAT(problem("radius: {choice: []}\n"), HasSubstr("a list of numbers"));
  EXPECT_THAT(problem("radius: {unifrom: [1, 2]}\n"), HasSubstr("valid: {uniform: [low, high]}"));
  EXPECT_THAT(problem("radius: {uniform: [1, 2], choice: [1]}\n"), HasSubstr("valid: {uniform: [low, high]}"));
  EXPECT_THAT(problem("radius: {uniform: [1, 2], per: bin}\n"), HasSubstr("radius.per: 'bin'"));
  EXPECT_THAT(problem("radius: {per: tube}\n"), HasSubstr("valid: {uniform: [low, high]}"));
  EXPECT_THAT(problem("count: {normal: [5, 1]}\n"), HasSubstr("since the number is a whole one"));
  EXPECT_THAT(problem("count: {uniform: [1, 2.5]}\n"), HasSubstr("count.uniform[1]: '2.5'"));
  EXPECT_THAT(problem("place: [{log_uniform: [-1, 2]}, 0, 0]\n"),
              HasSubstr("place[0].log_uniform: '[-1, 2]' is not valid; valid: numbers above 0"));
}

}  // namespace
}  // namespace tubebin
