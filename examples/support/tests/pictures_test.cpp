// The committed pictures are what the programs draw.
//
// Promise: a picture of the gallery, and the README's first, shows what its program draws today
// Tried: words equal, curves within 3 of its units, in every SVG that a program draws in a moment

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "examples/support/run_program.hpp"

namespace {

namespace fs = std::filesystem;
constexpr double close = 3;  // processors round the last bit differently, and a curve's corner moves

struct Point {
  double x = 0, y = 0;
};

/// An SVG apart: its text without numbers in attributes, and the curves of all its attributes.
struct Picture {
  std::vector<std::string> words;
  std::vector<std::vector<Point>> curves;
};

/// Pairs of absolute coordinates of `M x yL x y...`, `x,y x,y...` and their like.
std::vector<Point> points_of(const std::string& text) {
  std::vector<double> all;
  for (const char* at = text.c_str(); *at != 0;) {
    char* end = nullptr;
    const double x = std::strtod(at, &end);
    if (end == at) {
      ++at;
    } else {
      all.push_back(x), at = end;
    }
  }
  std::vector<Point> out;
  for (std::size_t k = 0; k + 1 < all.size(); k += 2) out.push_back({all[k], all[k + 1]});
  return out;
}
Picture read(const fs::path& file) {
  std::ifstream in(file);
  const std::string all((std::istreambuf_iterator<char>(in)), {});
  Picture out;
  for (std::size_t at = 0; at < all.size();) {
    const bool tag = all[at] == '<';
    const std::size_t end = std::min(all.find(tag ? '>' : '<', at), all.size());
    std::string piece = all.substr(at, end - at);
    at = tag ? end + 1 : end;
    for (const char* name : {" d=\"", " points=\"", " values=\""}) {
      const std::size_t from = piece.find(name);
      if (from == std::string::npos) continue;
      const std::size_t first = piece.find('"', from) + 1, last = piece.find('"', first);
      out.curves.push_back(points_of(piece.substr(first, last - first)));
      piece.erase(first, last - first);
    }
    if (tag) {  // places of marks and labels follow the curves
      std::string kind;
      for (const char c : piece)
        if (std::isdigit(static_cast<unsigned char>(c)) == 0 && c != '.' && c != '-') kind += c;
      piece = kind;
    }
    out.words.push_back(piece);
  }
  return out;
}

double distance(Point p, Point a, Point b) {
  const double dx = b.x - a.x, dy = b.y - a.y, length2 = dx * dx + dy * dy;
  const double s = length2 > 0 ? std::clamp(((p.x - a.x) * dx + (p.y - a.y) * dy) / length2, 0.0, 1.0) : 0.0;
  return std::hypot(p.x - a.x - s * dx, p.y - a.y - s * dy);
}
/// The farthest corner of one curve from the other.
double apart(const std::vector<Point>& a, const std::vector<Point>& b) {
  double most = a.empty() == b.empty() ? 0 : 1e9;
  for (const Point& p : a) {
    double least = 1e9;
    for (std::size_t k = 0; k < b.size(); ++k)
      least = std::min(least, distance(p, b[k], b[std::min(k + 1, b.size() - 1)]));
    if (!b.empty()) most = std::max(most, least);
  }
  return most;
}

/// In words: empty if they show the same.
std::string difference(const Picture& kept, const Picture& drawn) {
  for (std::size_t k = 0; k < std::min(kept.words.size(), drawn.words.size()); ++k)
    if (kept.words[k] != drawn.words[k]) return "'" + kept.words[k] + "' is now '" + drawn.words[k] + "'";
  if (kept.words.size() != drawn.words.size() || kept.curves.size() != drawn.curves.size())
    return "other elements";
  for (std::size_t k = 0; k < kept.curves.size(); ++k) {
    const double far =
        std::max(apart(kept.curves[k], drawn.curves[k]), apart(drawn.curves[k], kept.curves[k]));
    if (far > close) return "curve " + std::to_string(k) + " by " + std::to_string(far);
  }
  return {};
}

std::string redrawn(const fs::path& program, const fs::path& kept) {
  const fs::path drawn = fs::temp_directory_path() / ("pictures_test_" + std::to_string(::getpid()) + ".svg");
  examples::run_program(program.string(), "'" + drawn.string() + "'", 0);
  const std::string said = difference(read(kept), read(drawn));
  if (!said.empty() && std::getenv("SKINCTL_DRAW_PICTURES") != nullptr)
    fs::copy_file(drawn, kept, fs::copy_options::overwrite_existing);
  fs::remove(drawn);
  return said;
}

}  // namespace

TEST_CASE("pictures: what is committed is what the programs draw") {
  std::size_t tried = 0;
  for (const auto& entry : fs::directory_iterator(PICTURES)) {
    const fs::path program = fs::path(PROGRAMS) / entry.path().stem();
    if (entry.path().extension() != ".svg" || !fs::exists(program)) continue;
    CAPTURE(entry.path().filename().string());
    ++tried;
    CHECK(redrawn(program, entry.path()) == "");
  }
  CHECK(tried >= MIN_PICTURES);
  CHECK(redrawn(fs::path(PROGRAMS) / "playground_picture", MOVING) == "");
}

TEST_CASE("pictures: a number that changed, a curve that moved and an element that is gone are seen") {
  const Picture kept{{"<path d=\"\"", "35 N"}, {{{0, 0}, {100, 50}}}};
  Picture drawn = kept;
  CHECK(difference(kept, drawn).empty());
  drawn.curves[0][1].y += 2;
  CHECK(difference(kept, drawn).empty());
  drawn.curves[0][1].y += 2;
  CHECK_FALSE(difference(kept, drawn).empty());
  drawn = kept;
  drawn.words[1] = "36 N";
  CHECK_FALSE(difference(kept, drawn).empty());
  drawn = kept;
  drawn.words.push_back("</svg");
  CHECK_FALSE(difference(kept, drawn).empty());
}
