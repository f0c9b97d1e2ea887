// What show_skin draws.
#include <doctest/doctest.h>

#include <set>

#include "examples/show_skin/screen.hpp"
#include "examples/support/run_program.hpp"
#include "skinctl/io/skin_export.hpp"

using namespace show_skin;
using namespace std::chrono_literals;
using skinctl::CellSample;

namespace {

/// Two flat rows of three cells.
skinctl::SkinFile small() {
  skinctl::SkinFile file;
  file.links.push_back({.name = "arm"});
  skinctl::SkinFile::Patch patch;
  patch.name = "patch";
  patch.link = "arm";
  for (std::uint32_t k = 0; k < 6; ++k) {
    skinctl::SkinFile::Cell cell;
    cell.id = 10 + k;
    cell.X_RootCell.p = {0.03 * (k % 3), 0.03 * (k / 3), 0};
    patch.cells.push_back(cell);
  }
  file.patches.push_back(patch);
  return file;
}
std::string run(const std::string& arguments, int expected) {
  return examples::run_program(SHOW_SKIN_PROGRAM, arguments, expected);
}

}  // namespace

TEST_CASE("show_skin: every cell has a place of its own, next to its neighbours") {
  const auto skin = skinctl::ur5_skin_file<260>({});
  for (const auto& patch : skin.patches) {
    const Layout layout = unrolled(patch);
    std::set<std::pair<int, int>> places;
    for (const Place& p : layout.cells) {
      CHECK(p.row >= 0);
      CHECK(p.row < layout.rows);
      CHECK(p.column < layout.columns);
      places.insert({p.row, p.column});
    }
    CHECK(places.size() == patch.cells.size());
    CHECK(layout.rows * layout.columns < 12 * static_cast<int>(patch.cells.size()));
    // Cells within 1.3 pitches are neighbours on the screen, but where an unrolled patch is cut open.
    std::size_t near = 0, far = 0;
    for (std::size_t i = 0; i < patch.cells.size(); ++i)
      for (std::size_t k = 0; k < i; ++k) {
        const auto &a = patch.cells[i].X_RootCell.p, &b = patch.cells[k].X_RootCell.p;
        if (std::hypot(a.x - b.x, a.y - b.y, a.z - b.z) > 0.036) continue;
        const Place p = layout.cells[i], q = layout.cells[k];
        (std::abs(p.row - q.row) <= 2 && std::abs(p.column - q.column) <= 4 ? near : far) += 1;
      }
    CHECK_MESSAGE(far * 4 <= near, patch.name);
  }
}

TEST_CASE("show_skin: what the characters say") {
  Screen screen(small(), {.colours = false});
  CHECK(screen.draw(0ns, "status") == "status\n\npatch on arm\n? ? ?\n? ? ?\n");
  const std::vector<CellSample> samples{{.time = 1s, .cell = 10},
                                        {.time = 1s, .cell = 11, .force = {0.03f, 0, 0}},
                                        {.time = 1s, .cell = 12, .force = {0, 0.9f, 0}},
                                        {.time = 1s, .cell = 13, .proximity = 0.5f},
                                        {.time = 400ms, .cell = 14},
                                        {.time = 1s, .cell = 99},
                                        {.time = 1s, .cell = 15, .force = {2, 0, 0}}};
  screen.hear(samples);
  CHECK(screen.unknown() == 2);
  CHECK(screen.heard(1s) == 4);
  const std::string drawn = screen.draw(1s, "");
  CHECK(drawn == "\n\npatch on arm\n. 1 9\no x ?\n");
  Screen coloured(small(), {});
  coloured.hear(samples);
  const std::string colours = coloured.draw(1s, "");
  CHECK(colours.find("\x1b[38;5;16;48;5;196m9\x1b[0m") != std::string::npos);
}

TEST_CASE("show_skin: the program shows a simulated touch, and says when it is blind") {
  const std::string out = run("--seconds 1.2 --rate 5", 0);
  CHECK_MESSAGE(out.find("260 of 260 cells") != std::string::npos, out.substr(0, 300));
  bool pressed = false;
  for (const char c : {'3', '4', '5', '6', '7', '8', '9'})
    pressed = pressed || out.find(std::string(1, c) + " ") != std::string::npos;
  CHECK(pressed);
  CHECK(run("--port 0 --seconds 0.3", 4).find("0 of 260 cells") != std::string::npos);
  run("--skin /nowhere", 2);
}
