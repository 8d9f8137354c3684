/// The 3D view in a real browser: it turns, tells truth, found and errors apart, and tells a tube's numbers.
#include <algorithm>

#include "support/browser.hpp"
#include "tubebin/cloud/cloud_io.hpp"
#include "tubebin/scan/scanner.hpp"

namespace tubebin {
namespace {

using testing::CommandResult;
using ::testing::HasSubstr;

constexpr int kTubes = 5;

constexpr const char* kTools = R"js(
  const view = event.target.contentWindow, canvas = page.querySelector("canvas");
  const copy = document.createElement("canvas").getContext("2d", { willReadFrequently: true });
  const copied = () => {
    [copy.canvas.width, copy.canvas.height] = [canvas.width, canvas.height];
    copy.drawImage(canvas, 0, 0);
    return copy;
  };
  const pixels = () => copied().getImageData(0, 0, canvas.width, canvas.height).data;
  const differing = (a, b) => {
    let count = a.length === b.length ? 0 : Infinity;
    for (let i = 0; i < a.length; i += 4) count += a[i] !== b[i] || a[i + 1] !== b[i + 1] || a[i + 2] !== b[i + 2];
    return count;
  };
  const key = (key) => canvas.dispatchEvent(new view.KeyboardEvent("keydown", { key }));
  const point = (type, x, y) => {
    const { left, top } = canvas.getBoundingClientRect();
    canvas.dispatchEvent(new view.PointerEvent(type, { pointerId: 1, buttons: 1, clientX: left + x, clientY: top + y }));
  };
  const show = (layer) => page.querySelector(`[type=radio][value="${layer}"]`).click();
)js";

class ViewInBrowser : public testing::BrowserTest {
 protected:
  /// What model_tubes would have found: every tube by another number, and of tube 1 what has y > `wrong_beyond` as tube 5.
  void write_model(const std::string& name, float wrong_beyond) const {
    const scene::SceneRecord record = testing::synthetic_scene("A5/001", kTubes, 5);
    const cloud::Cloud scanned = scan::scan(record.scene).cloud;
    cloud::Cloud filtered;
    filtered.world_from_sensor = scanned.world_from_sensor;
    for (std::size_t i = 0; i < scanned.size(); ++i) {
      if (scanned.labels[i] == 0) continue;
      filtered.points.push_back(scanned.points[i]);
      filtered.labels.push_back(scanned.labels[i]);
    }
    filtered.width = static_cast<std::uint32_t>(filtered.size());
    cloud::Cloud labeled = filtered;
    for (std::size_t i = 0; i < labeled.size(); ++i)
      labeled.labels[i] =
          labeled.labels[i] == 1 && labeled.points[i].x() > wrong_beyond ? 1 : kTubes + 1 - labeled.labels[i];
    nlohmann::json model = testing::model_json(record);
    std::reverse(model["tubes"].begin(), model["tubes"].end());
    testing::write_text(folder_.path() / name / "model.json", model.dump());
    cloud::write_cloud(folder_ / (name + "/filtered.pcd"), filtered, cloud::CloudFormat::pcd_binary);
    cloud::write_cloud(folder_ / (name + "/labeled.pcd"), labeled, cloud::CloudFormat::pcd_binary);
    const CommandResult viewed = testing::run_command(
        fmt::format("cd {} && {}/view {} --html {}.html 2>&1", folder_.path().string(), TUBEBIN_BIN_DIR, name, name));
    ASSERT_EQ(viewed.exit_code, 0) << viewed.output;
    EXPECT_EQ(viewed.output, name + ".html\n");
  }
};

TEST_F(ViewInBrowser, TurnsAndTurnsBack) {
  write_model("right", 1.0F);
  const nlohmann::json seen = evaluate_in_frame("right.html", 400, std::string(kTools) + R"js(
  const before = pixels();
  result.all = before.length / 4;
  result.still = differing(before, pixels());
  point("pointerdown", 150, 100);
  point("pointermove", 190, 120);
  point("pointerup", 190, 120);
  const dragged = pixels();
  result.dragged = differing(before, dragged);
  key("ArrowLeft");
  result.by_key = differing(dragged, pixels());
  key("+");
  key("0");
  result.back = differing(before, pixels());)js");
  const auto share = [&](const char* name) { return seen[name].get<double>() / seen["all"].get<double>(); };
  EXPECT_EQ(seen["still"], 0);
  EXPECT_GT(share("dragged"), 0.01);
  EXPECT_GT(share("by_key"), 0.01);
  EXPECT_EQ(seen["back"], 0);
}

TEST_F(ViewInBrowser, FitsAPhoneAndIsAccessible) {
  write_model("right", 1.0F);
  const nlohmann::json seen = evaluate_in_frame("right.html", 390, R"js(
  result.width = page.documentElement.scrollWidth;
  result.controls = [...page.querySelectorAll("input, select, button, canvas")].map((control) => {
    control.focus();
    return page.activeElement === control && parseFloat(event.target.contentWindow.getComputedStyle(control).outlineWidth);
  });)js");
  EXPECT_LE(seen["width"], 390);
  EXPECT_EQ(seen["controls"], nlohmann::json(std::vector<int>(7, 3)));  // what has the focus has a frame of 3 pixels
  expect_accessible("right.html");
}

TEST_F(ViewInBrowser, AFoundTubeHasTheColorOfTheTrueOneThatItMatches) {
  write_model("right", 1.0F);
  const nlohmann::json seen = evaluate_in_frame("right.html", 400, std::string(kTools) + R"js(
  page.querySelector("[type=checkbox]").click();  // no centrelines
  show(0);
  const truth = pixels();
  show(1);
  result.found = differing(truth, pixels());
  show(2);
  result.errors = differing(truth, pixels());)js");
  EXPECT_EQ(seen["found"], 0);
  EXPECT_GT(seen["errors"], 1000);
}

TEST_F(ViewInBrowser, ShowsErrorsAndATubesNumbers) {
  write_model("wrong", 0.1F);
  const nlohmann::json seen = evaluate_in_frame("wrong.html", 400, std::string(kTools) + R"js(
  const vermilion = (data) => {
    let count = 0;
    for (let i = 0; i < data.length; i += 4)
      count += data[i] > 100 && data[i + 2] < 20 && Math.abs(data[i + 1] / data[i] - 0x5e / 0xd5) < 0.05;
    return count;
  };
  show(0);
  result.in_truth = vermilion(pixels());
  show(2);
  result.in_errors = vermilion(pixels());
  show(0);
  const places = [];  // in the middle of the canvas, upright and across
  for (let y = 0; y < canvas.clientHeight; y += 4) places.push([canvas.clientWidth / 2, y]);
  for (let x = 0; x < canvas.clientWidth; x += 4) places.push([x, canvas.clientHeight / 2]);
  const finer = canvas.width / canvas.clientWidth, before = copied();
  const color = (x, y) => before.getImageData(x * finer, y * finer, 1, 1).data.join();
  const tubes = new Set();
  for (const [x, y] of places) {
    if (tubes.size === 5 || color(x, y) === color(0, 0)) continue;
    point("pointerdown", x, y);
    point("pointerup", x, y);
    const facts = page.querySelector(".facts");
    if (!facts.textContent) continue;
    tubes.add(facts.querySelector("b").textContent);
    result[facts.querySelector("b").textContent] = facts.querySelector("dl").textContent;
  })js");
  EXPECT_EQ(seen["in_truth"], 0);
  EXPECT_GT(seen["in_errors"], 500);
  const CommandResult scored = testing::run_command(
      fmt::format("{0}/evaluate --filtered {1}/wrong/filtered.pcd --labeled {1}/wrong/labeled.pcd --format json",
                  TUBEBIN_BIN_DIR, folder_.path().string()));
  const nlohmann::json scores = nlohmann::json::parse(scored.output);
  for (const nlohmann::json& pair : scores.at("matching")) {
    const std::string tube = "tube " + pair.at("ground truth").get<std::string>();
    ASSERT_TRUE(seen.contains(tube)) << tube << " was not clicked: " << seen;
    EXPECT_THAT(seen[tube].get<std::string>(),
                ::testing::AllOf(HasSubstr(fmt::format("points{}", pair.at("points").get<int>())),
                                 HasSubstr(fmt::format("found astube {}", pair.at("label").get<std::string>())),
                                 HasSubstr(fmt::format("recall{:.4f}", pair.at("recall").get<double>()))))
        << seen;
  }
  EXPECT_LT(nlohmann::json::parse(scored.output)["micro_recall"], 1.0);
}

}  // namespace
}  // namespace tubebin
