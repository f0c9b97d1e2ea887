#include "examples/live_page/page.hpp"

#include <filesystem>
#include <fstream>
#include <iterator>

namespace live_page {
namespace {

std::string read(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

void put_page(adapters::live::ServerOptions& options) {
  const std::filesystem::path folder = LIVE_PAGE_FOLDER;
  for (const char* name : {"index.html", "place.html"})
    options.files[std::string("/") + name] = {"text/html; charset=utf-8", read(folder / name)};
  options.files["/"] = options.files["/index.html"];
  options.files["/style.css"] = {"text/css; charset=utf-8", read(folder / "style.css")};
  for (const char* name : {"app.js", "cdr.js", "charts.js", "place.js", "replay.js", "robot.js", "skin.js",
                           "stream.js", "surface.js", "timeline.js"})
    options.files[std::string("/") + name] = {"text/javascript; charset=utf-8", read(folder / name)};
  // Where Debian's libjs-three puts it. Without it the page shows everything but the robot, and says so.
  options.folders["/three/"] = "/usr/share/javascript/three";
}

}  // namespace live_page
