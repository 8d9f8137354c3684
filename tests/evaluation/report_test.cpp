#include <gmock/gmock.h>

#include <regex>

#include "support/synthetic_results.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/evaluation/html_report.hpp"
#include "tubebin/evaluation/paper_figures.hpp"
#include "tubebin/evaluation/result_plots.hpp"
#include "tubebin/results/results_folder.hpp"

namespace tubebin::evaluation {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;
using testing::TemporaryFolder;

Evaluation synthetic_evaluation(const testing::SyntheticSweep& sweep) {
  TemporaryFolder folder;
  testing::write_synthetic_sweep(folder.path(), sweep);
  return results::read_results({(folder.path() / "results").string()}, {});
}

/// The paper's own conditions, with few cases.
testing::SyntheticSweep paper_sweep() {
  testing::SyntheticSweep sweep;
  sweep.tubes = {1, 2, 5, 10, 15, 20};
  sweep.ratios = {0.1, 0.3, 0.6, 0.7, 1.0};
  return sweep;
}

/// Opening tags and closing tags pair up.
void expect_balanced(const std::string& markup) {
  std::vector<std::string> open;
  const std::regex tag("<(/?)([a-z0-9]+)([^>]*)>");
  for (std::sregex_iterator it(markup.begin(), markup.end(), tag), end; it != end; ++it) {
    const std::string name = (*it)[2];
    const std::string rest = (*it)[3];
    if (name == "meta" || name == "link" || name == "img" || rest.ends_with("/")) continue;
    if ((*it)[1].length() == 0) {
      open.push_back(name);
    } else {
      ASSERT_FALSE(open.empty()) << "</" << name << ">";
      EXPECT_EQ(open.back(), name);
      open.pop_back();
    }
  }
  EXPECT_THAT(open, ::testing::IsEmpty());
}

TEST(Ticks, CoverTheRangeInRoundSteps) {
  EXPECT_THAT(linear_ticks(0.0, 1.0), ElementsAre(0.0, 0.2, 0.4, ::testing::DoubleEq(0.6), 0.8, 1.0));
  const std::vector<double> ticks = linear_ticks(0.893, 0.987);
  EXPECT_LE(ticks.front(), 0.893);
  EXPECT_GE(ticks.back(), 0.987);
}

TEST(Plot, DrawsEveryPointOfEverySeries) {
  Plot plot{"p", "A & B", "x", "y", false, {}};
  plot.series.push_back({"one", 0, SeriesStyle::measured, {{1, 2, 1.5, 2.5}, {2, 3, 3, 3}}});
  plot.series.push_back({"two", 0, SeriesStyle::paper, {{1, 4, 4, 4}}, false});
  const std::string svg = format_svg(plot);
  expect_balanced(svg);
  EXPECT_THAT(svg, HasSubstr("A &amp; B"));
  const std::regex circle("<circle");
  EXPECT_EQ(std::distance(std::sregex_iterator(svg.begin(), svg.end(), circle), {}),
            5);                                                        // three points, two in the legend
  EXPECT_THAT(svg, HasSubstr("fill=\"#ffffff\" stroke=\"#0072B2\""));  // the paper's are hollow
}

TEST(Plot, OnePointAndConstantValuesGiveFiniteCoordinates) {
  for (const bool log : {false, true}) {
    Plot plot{"p", "t", "x", "y", log, {{"one", 0, SeriesStyle::measured, {{1, 0.5, 0.5, 0.5}}}}};
    EXPECT_THAT(format_svg(plot), AllOf(Not(HasSubstr("nan")), Not(HasSubstr("inf"))));
  }
}

TEST(PaperPlots, ShowOursAndThePapers) {
  const Evaluation evaluation = synthetic_evaluation(paper_sweep());
  const GenerationSeconds generation = {{"A", {{1, {0.1, 0.2}}, {10, {0.4}}}}};
  const std::vector<Plot> plots = paper_plots(summarize(evaluation.runs), generation);
  ASSERT_THAT(plots, SizeIs(4));
  EXPECT_EQ(plots[0].name, "figure_8");
  ASSERT_THAT(plots[0].series, SizeIs(3));
  EXPECT_THAT(plots[0].series[1].points, SizeIs(6));
  EXPECT_DOUBLE_EQ(plots[0].series[2].points[0].y, 0.867);
  EXPECT_EQ(plots[1].name, "figure_9");
  EXPECT_EQ(plots[2].name, "table_1");
  EXPECT_EQ(plots[3].name, "table_2_centerline");
  EXPECT_THAT(plots[3].series, SizeIs(10));
}

TEST(ResultPlots, ShowWhatWasMeasuredAlone) {
  const std::vector<GroupSummary> groups = summarize(synthetic_evaluation(paper_sweep()).runs);
  const std::vector<Plot> plots = result_plots(groups);
  ASSERT_THAT(plots, SizeIs(4));
  EXPECT_EQ(plots[0].name, "recall_by_tubes");
  for (const Plot& plot : plots) {
    EXPECT_THAT(plot.series, SizeIs(2));  // sets A and B
    EXPECT_THAT(format_svg(plot), AllOf(Not(HasSubstr("paper")), Not(HasSubstr("Figure"))));
  }
  EXPECT_THAT(plots[0].series[1].points, SizeIs(6));
  EXPECT_THAT(plots[3].series[1].points, SizeIs(5));
}

TEST(ResultPlots, OneRatioMakesNoPlotByRatio) {
  testing::SyntheticSweep sweep;
  sweep.ratios = {0.3};
  const std::vector<Plot> plots = result_plots(summarize(synthetic_evaluation(sweep).runs));
  ASSERT_THAT(plots, SizeIs(2));
  EXPECT_EQ(plots[1].name, "seconds_by_tubes");
}

TEST(PaperFigures, AreThePapers) {
  EXPECT_DOUBLE_EQ(paper_figures().generation_seconds.at("A").at(20), 28.10);
  EXPECT_DOUBLE_EQ(paper_figures().generation_seconds.at("B").at(1), 2.68);
  EXPECT_THAT(paper_figures().generation_seconds.at("B"), SizeIs(16));
  EXPECT_DOUBLE_EQ(paper_figures().modelling_seconds.at(1.0).at(10), 1.65);
  EXPECT_THAT(paper_figures().modelling_seconds, SizeIs(10));
}

Verdict verdict_of(const std::vector<Claim>& claims, const std::string& start) {
  for (const Claim& claim : claims)
    if (claim.statement.starts_with(start)) return claim.verdict;
  ADD_FAILURE() << start;
  return Verdict::not_measured;
}

/// The synthetic runs were made to show all that the paper found.
TEST(Claims, HoldForRunsThatWereMadeToShowThem) {
  const std::vector<Claim> claims = modelling_claims(synthetic_evaluation(paper_sweep()).runs, "centerline");
  for (const char* start :
       {"Micro-recall falls linearly", "On set B one tube", "Micro-recall rises", "Above a ratio of 0.6",
        "Above a ratio of 0.7", "Modelling time rises with the downsampling ratio (set A)",
        "Modelling time rises with the number of tubes (set B"})
    EXPECT_EQ(verdict_of(claims, start), Verdict::confirmed) << start;
  EXPECT_EQ(verdict_of(claims, "Set A is consistently"), Verdict::confirmed);
  EXPECT_EQ(verdict_of(claims, "On set B micro-recall falls from one to ten"), Verdict::confirmed);
}

TEST(Claims, FailWhereTheOppositeIsTrue) {
  std::vector<RunScore> runs = synthetic_evaluation(paper_sweep()).runs;
  for (RunScore& run : runs) {
    run.micro_recall = 1.5 - run.micro_recall;
    run.seconds = 1.0 - *run.seconds;
  }
  for (const Claim& claim : modelling_claims(runs, "centerline")) {
    if (claim.statement.starts_with("Above a ratio") || claim.statement.starts_with("On set B micro-recall falls"))
      continue;  // flat is flat in both directions
    EXPECT_EQ(claim.verdict, Verdict::not_confirmed) << claim.statement;
  }
}

TEST(Claims, AreNotMeasuredWithoutTheirConditions) {
  testing::SyntheticSweep sweep;
  sweep.sets = {"C"};
  for (const Claim& claim : modelling_claims(synthetic_evaluation(sweep).runs, "centerline"))
    EXPECT_EQ(claim.verdict, Verdict::not_measured) << claim.statement;
  for (const Claim& claim : generation_claims({})) EXPECT_EQ(claim.verdict, Verdict::not_measured);
}

TEST(Claims, OfTheGenerator) {
  GenerationSeconds seconds;
  for (const auto& [set, by_tubes] : paper_figures().generation_seconds)
    for (const auto& [tubes, value] : by_tubes) seconds[set][tubes] = {value};
  for (const Claim& claim : generation_claims(seconds)) EXPECT_EQ(claim.verdict, Verdict::confirmed) << claim.here;
  EXPECT_THAT(generation_claims(seconds)[1].here, HasSubstr("-4.8 %"));
  std::swap(seconds["A"], seconds["B"]);
  EXPECT_EQ(generation_claims(seconds)[1].verdict, Verdict::not_confirmed);
}

TEST(Report, IsSelfContainedAndWellFormed) {
  const Evaluation evaluation = synthetic_evaluation(paper_sweep());
  std::string html = format_html_report({evaluation});
  html = std::regex_replace(html, std::regex("http://www.w3.org/2000/svg"), "");
  EXPECT_THAT(html, AllOf(Not(HasSubstr("http:")), Not(HasSubstr("https:")), Not(HasSubstr("url("))));
  html = std::regex_replace(html, std::regex("<style>[^<]*</style>|<script>[^]*</script>|<!DOCTYPE html>"), "");
  expect_balanced(html);
}

TEST(Report, NamesThePaperWhereItIsAskedForAlone) {
  const Evaluation evaluation = synthetic_evaluation(paper_sweep());
  const GenerationSeconds generation;
  const std::string general = format_html_report({evaluation});
  const std::string compared = format_html_report({evaluation, &generation});
  for (const char* words : {"Figure 8", "Figure 9", "Table 2", "confirmed", "Hollow markers", "paper"}) {
    EXPECT_THAT(general, Not(HasSubstr(words)));
    EXPECT_THAT(compared, HasSubstr(words));
  }
}

TEST(Report, EscapesWhatFilesSay) {
  Evaluation evaluation = synthetic_evaluation({});
  evaluation.notes.push_back("<script>alert(1)</script>");
  EXPECT_THAT(format_html_report({evaluation}), Not(HasSubstr("<script>alert")));
}

TEST(Report, PicturesTheWorstRunsOfDifferentScenes) {
  const Evaluation evaluation = synthetic_evaluation(paper_sweep());
  const std::vector<const RunScore*> runs = pictured_runs(evaluation.runs);
  ASSERT_THAT(runs, SizeIs(3));
  EXPECT_EQ(runs[0]->key.name(), "B20/001 centerline 0.1");
  EXPECT_EQ(runs[1]->key.name(), "B20/002 centerline 0.1");
  EXPECT_EQ(runs[2]->key.name(), "B15/001 centerline 0.1");
}

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++count;
  return count;
}

TEST(Report, ShowsTheWorstAndTheChosenScenesInThreeDimensions) {
  const Evaluation evaluation = synthetic_evaluation(paper_sweep());
  const ReadPoints read = [](const RunScore&) {
    return LabelledPoints{{{0.0F, 0.0F, 0.1F}, {0.1F, 0.0F, 0.1F}}, {1, 2}, {1, 1}, {}};
  };
  const std::string html = format_html_report({evaluation, nullptr, read, {"A5/002"}});
  EXPECT_EQ(occurrences(html, "<figure class=\"view\""), 4U);
  EXPECT_EQ(occurrences(html, "<figure class=\"view\" data-title=\"A5/002 centerline 0.1\""), 1U);
  EXPECT_EQ(occurrences(html, "Permission is hereby granted"),
            1U);  // the library that draws them, once, and its license
  EXPECT_EQ(occurrences(format_html_report({evaluation}), "Permission is hereby granted"), 0U);
  EXPECT_THROW(format_html_report({evaluation, nullptr, read, {"A5/999"}}), ConfigError);
}

TEST(ScenePicture, ShowsTubesLabelsAndErrors) {
  LabelledPoints points;
  for (int i = 0; i < 400; ++i) {
    points.points.emplace_back(0.001F * static_cast<float>(i % 200), i < 200 ? 0.0F : 0.05F, 0.01F);
    points.truth.push_back(i < 200 ? 1 : 2);
    points.predicted.push_back(i < 200 ? 7 : i < 300 ? 8 : kNullId);
  }
  const ScenePicture picture = draw_scene(points);
  EXPECT_GT(picture.width, picture.height);
  for (const std::string& png : {picture.truth, picture.labels, picture.errors}) EXPECT_THAT(png, HasSubstr("PNG"));
  EXPECT_NE(picture.truth, picture.labels);
  points.predicted = points.truth;
  EXPECT_EQ(draw_scene(points).truth, draw_scene(points).labels);  // matched labels take their tube's colour
}

}  // namespace
}  // namespace tubebin::evaluation
