/// Opens pages in headless Chromium, which draws WebGL by software, and looks at them with scripts.
#pragma once

#include <gmock/gmock.h>

#include "support/commands.hpp"
#include "support/synthetic_results.hpp"
#include "tubebin/core/atomic_file.hpp"

namespace tubebin::testing {

class BrowserTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v chromium >/dev/null 2>&1") != 0) GTEST_SKIP() << "no chromium here";
  }

  /// The document after the page's scripts have run, in a window of 1280 by 900 pixels.
  std::string dom(const std::string& page) const {
    const std::string log = (folder_.path() / "browser.log").string();
    const CommandResult result = run_command(
        fmt::format("chromium --headless --no-sandbox --use-gl=angle --use-angle=swiftshader "
                    "--enable-unsafe-swiftshader --disable-quic --no-first-run "
                    "--disable-background-networking --disable-component-update --disable-sync "
                    "--allow-file-access-from-files --window-size=1280,900 --user-data-dir={0}/profile "
                    "--virtual-time-budget=5000 --enable-logging=stderr {3} --dump-dom file://{0}/{1} 2>{2}",
                    folder_.path().string(), page, log, is_dark_ ? "--blink-settings=preferredColorScheme=0" : ""));
    EXPECT_EQ(result.exit_code, 0) << read_file(log);
    EXPECT_THAT(read_file(log), ::testing::Not(::testing::HasSubstr("CONSOLE")));
    return result.output;
  }

  /// What `script` puts into `result`, evaluated beside `page`, the document of the file, in a frame of that width.
  nlohmann::json evaluate_in_frame(const std::string& file, int width, const std::string& script) const {
    write_text(folder_.path() / "frame.html", fmt::format(R"html(<!DOCTYPE html><body>
<iframe id="frame" src="{}" style="width:{}px;height:900px;border:0"></iframe><script>
document.getElementById("frame").addEventListener("load", (event) => {{
  const page = event.target.contentDocument, result = {{}};
  {}
  document.body.dataset.result = encodeURIComponent(JSON.stringify(result));
}});
</script></body>)html",
                                                          file, width, script));
    const std::string html = dom("frame.html");
    const std::string start = "data-result=\"";
    const std::size_t at = html.find(start);
    if (at == std::string::npos) throw std::runtime_error("the script did not run: " + html.substr(0, 10'000));
    const std::string encoded = html.substr(at + start.size(), html.find('"', at + start.size()) - at - start.size());
    std::string text;
    for (std::size_t i = 0; i < encoded.size(); ++i)
      if (encoded[i] == '%') text += static_cast<char>(std::stoi(encoded.substr(i + 1, 2), nullptr, 16)), i += 2;
      else text += encoded[i];
    return nlohmann::json::parse(text);
  }

  /// axe-core finds nothing to mend on the page, on a phone in dark mode and on a desk in light. Skips without axe-core.
  void expect_accessible(const std::string& file) {
    const CommandResult axe = run_command(
        "python3 -c 'import axe_core_python; print(axe_core_python.__path__[0], end=\"/axe.min.js\")' 2>&1");
    if (axe.exit_code != 0) GTEST_SKIP() << axe.output;
    for (const int width : {390, 1280}) {
      is_dark_ = width == 390;
      const nlohmann::json found = evaluate_in_frame(file, width,
                                                     fmt::format(R"js(
  for (const details of page.querySelectorAll("details")) details.open = true;
  const script = page.createElement("script"), view = event.target.contentWindow;
  script.src = "{}";
  script.onload = () => view.axe.run(page).then(({{ passes, violations }}) => {{
    const found = {{ passes: passes.length,
                    violations: violations.map(({{ help, nodes }}) => [help, ...nodes.map(({{ html }}) => html)]) }};
    document.body.dataset.result = encodeURIComponent(JSON.stringify(found));
  }});
  page.head.append(script);)js",
                                                                 "file://" + axe.output));
      EXPECT_GT(found.value("passes", 0), 10);
      EXPECT_EQ(found["violations"], nlohmann::json::array()) << file << " of " << width << " pixels";
    }
  }

  TemporaryFolder folder_;
  bool is_dark_ = false;
};

}  // namespace tubebin::testing
