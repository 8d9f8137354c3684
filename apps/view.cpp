/// A cloud, a scene or what was found in it, as a page to turn it in.
#include <fmt/format.h>

#include "program.hpp"
#include "tubebin/core/atomic_file.hpp"
#include "tubebin/results/viewed_scenes.hpp"

namespace {

using namespace tubebin;

constexpr const char* kExamples = R"(
Examples:
  view scan.ply
      a cloud, coloured by its labels, or by height where it has none
  view dataset/A10/007
      a scene of a data set, packed or not, with its tubes' true centrelines
  view one
      what `model_tubes CLOUD --output one` found: truth, found and errors at a switch
  view results --html worst.html
      the worst scenes of `model_tubes DATASET --output results`

The page is one file that opens in any browser with WebGL, without a network. Drag to turn, click a tube for its numbers.
Exit codes: 0 done; 1 input or output failed; 2 wrong usage.)";

}  // namespace

int main(int argc, char** argv) {
  std::string input;
  std::string html = "view.html";
  CLI::App app("Shows a point cloud, a scene or found tubes in 3D: writes a page for the browser.");
  app.footer(kExamples);
  app.set_version_flag("--version", "tubebin " TUBEBIN_VERSION);
  app.add_option("FILE|SCENE|RESULTS", input,
                 "A cloud (PCD or PLY), a scene of a data set or of a pack, or a folder of model_tubes")
      ->required();
  app.add_option("--html", html, "The page")->type_name("FILE")->capture_default_str();
  return run_program("view", app, argc, argv, [&] {
    write_file_atomically(html, evaluation::format_view_page(results::viewed_scenes(input)));
    fmt::print("{}\n", html);
    return static_cast<int>(ExitCode::done);
  });
}
