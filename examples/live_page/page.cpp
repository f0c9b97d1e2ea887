#include "examples/live_page/page.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "examples/support/report_style.hpp"
#include "skinctl/guard/faults.hpp"

namespace live_page {
namespace {

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// What the page says of reasons, and the effect of each.
std::string reasons() {
  nlohmann::json all;
  for (const skinctl::Fault& f : skinctl::faults)
    all[f.name] = {{"words", skinctl::describe(f.reason)},
                   {"effect", skinctl::name(std::max(f.motion, f.torque))}};
  return "export const reasons = " + all.dump() + ";\n";
}

}  // namespace

void put_page(adapters::live::ServerOptions& options) {
  const std::filesystem::path folder = LIVE_PAGE_FOLDER;
  for (const char* name : {"index.html", "place.html"})
    options.files[std::string("/") + name] = {"text/html; charset=utf-8", read(folder / name)};
  options.files["/"] = options.files["/index.html"];
  options.files["/style.css"] = {"text/css; charset=utf-8", read(folder / "style.css")};
  options.files["/report.css"] = {"text/css; charset=utf-8", examples::report_style};
  for (const char* name : {"app.js", "cdr.js", "charts.js", "place.js", "replay.js", "robot.js", "skin.js",
                           "stream.js", "surface.js", "timeline.js"})
    options.files[std::string("/") + name] = {"text/javascript; charset=utf-8", read(folder / name)};
  options.files["/reasons.js"] = {"text/javascript; charset=utf-8", reasons()};
  // Where Debian's libjs-three puts it. Without it the page shows everything but the robot, and says so.
  options.folders["/three/"] = "/usr/share/javascript/three";
}

}  // namespace live_page
