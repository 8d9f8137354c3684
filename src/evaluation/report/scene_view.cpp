#include "tubebin/evaluation/scene_view.hpp"

#include <fmt/format.h>

#include "evaluation/report/page_head.hpp"
#include "evaluation/report/view_data.hpp"
#include "tubebin/core/error.hpp"
#include "tubebin/evaluation/table.hpp"

extern const char* const kViewCss;      // data/report/view.css
extern const char* const kViewJs;       // data/report/view.js
extern const char* const kRegl;         // third_party/regl/regl.min.js
extern const char* const kReglLicense;  // third_party/regl/LICENSE

namespace tubebin::evaluation {
namespace {

/// Inside a script element, where "</script" or "<!--" would end or change it.
std::string script_json(const OrderedJson& json) {
  std::string text;
  for (const char c : json.dump()) c == '<' ? text += "\\u003c" : text += c;
  return text;
}

}  // namespace

std::string view_figure(const SceneView& view) {
  try {
    return fmt::format(
        "<figure class=\"view\" data-title=\"{}\">\n<script type=\"application/json\">{}</script>\n"
        "</figure>\n",
        escape_html(view.title), script_json(view_data(view.points)));
  } catch (const IoError& error) {
    throw IoError(view.title + ": " + error.what());
  }
}

std::string view_style() { return kViewCss; }

std::string view_script() {
  return fmt::format("<script>\n/* regl 2.1.1\n{}*/\n{}</script>\n<script>\n{}</script>\n", kReglLicense, kRegl,
                     kViewJs);
}

std::string format_view_page(std::span<const SceneView> views) {
  std::string html = page_head("tubebin view", view_style());
  html += "<main class=\"views\">\n";
  for (const SceneView& view : views)
    html += fmt::format("<h1>{}</h1>\n{}", escape_html(view.title), view_figure(view));
  return html + "</main>\n" + view_script() + "</body>\n</html>\n";
}

}  // namespace tubebin::evaluation
