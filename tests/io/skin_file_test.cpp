// Promise: a skin file says what it says, or is refused by line, patch, cell, field, value and range
// Tried: any bytes (20 000 mutations), 50 wrong files in JSON and 19 in XML each with its words; written
// and read it is the same to the bit; 10 000 cells in 0.04 s. Also: `io/skin_xml_test.cpp`

#include "skinctl/io/skin_file.hpp"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include <chrono>
#include <cstdio>
#include <filesystem>

#include "skinctl/testing/sanitized.hpp"
#include "support/wrong_text.hpp"
#include "tests/support/by_day.hpp"
#include "tests/support/comma_locale.hpp"
#include "tests/support/robot_table.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

const std::string good = R"({
  "format": "skinctl-skin-1",
  "links": [{"name": "forearm_link", "radius": 0.04, "length": 0.3, "joint_axis": [0, 1, 0]},
            {"name": "hand_link", "radius": 0, "length": 0}],
  "patches": [
    {"name": "forearm", "link": "forearm_link",
     "X_LinkRoot": {"p": [-0.03, 0.1, 0], "q": [0, 0.7071067811865476, 0, 0.7071067811865476]},
     "gains": {"force": 20, "proximity": 2.5},
     "cells": [
       {"id": 1, "X_RootCell": {"p": [0, 0, 0], "q": [0, 0, 0, 1]}, "neighbours": [2, null, null, null]},
       {"id": 2, "X_RootCell": {"p": [0, 0.03, 0], "q": [0, 0, 0, 1]}, "neighbours": [null, 3, null, 1],
        "group": 7, "threshold": 0.12, "gain": 0.5},
       {"id": 3, "X_RootCell": {"p": [0, 0.06, 0], "q": [0, 0, 0, 1]}, "neighbours": [null, null, 2, null],
        "masked": "no answer since the crash"}
     ]},
    {"name": "palm", "link": "hand_link",
     "X_LinkRoot": {"p": [0, 0.03, 0.066], "q": [0, 0, 0, 1]}, "gains": {"force": 10, "proximity": 0},
     "covariance": [1e-6,0,0,0,0,0, 1e-6,0,0,0,0, 1e-6,0,0,0, 1e-4,0,0, 1e-4,0, 1e-4],
     "cells": [{"id": 4, "X_RootCell": {"p": [0, 0, 0], "q": [0, 0, 0, 1]}}]}
  ],
  "regions": [{"name": "grip", "cells": [3, 4], "weight": 2, "force_limit": 65}]
}
)";

/// The error text; empty: there was none.
std::string complaint(const std::string& text) {
  return testing::complaint_of([&] { return parse_skin_file(text, "arm.json"); });
}
SkinFile without_lines(SkinFile file) {
  file.source.clear();
  for (auto& x : file.links) x.line = 0;
  for (auto& x : file.regions) x.line = 0;
  for (auto& patch : file.patches) {
    patch.line = 0;
    for (auto& cell : patch.cells) cell.line = 0;
  }
  return file;
}
bool same(const SkinFile& a, const SkinFile& b) {
  return a.links == b.links && a.patches == b.patches && a.regions == b.regions;
}

/// A skin with everything that a file can say.
SkinFile any_skin(oracle::Random& random) {
  SkinFile file;
  const auto pose = [&] {
    SkinPose X{{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}, {}};
    double n = 0;
    for (double& q : X.q) q = random.uniform(-1, 1), n += q * q;
    for (double& q : X.q) q /= std::sqrt(n);
    return X;
  };
  const auto covariance = [&] {
    std::vector<double> C;
    if (random.index(2) == 0) return C;
    for (int i = 0; i < 6; ++i)
      for (int j = i; j < 6; ++j)
        C.push_back(i == j ? random.uniform(0.01, 0.1) : random.uniform(-1e-3, 1e-3));
    return C;
  };
  std::uint32_t id = static_cast<std::uint32_t>(random.index(1000));
  const int patches = 1 + random.index(4);
  for (int k = 0; k < patches; ++k) {
    file.links.push_back(
        {"link \"" + std::to_string(k) + "\" \xc3\xa9", random.uniform(0, 1), random.uniform(0, 1), {}, 0});
    if (random.index(2) == 0) file.links.back().joint_axis = {0, 0, -1};
    SkinFile::Patch patch;
    patch.name = "patch\\" + std::to_string(k);
    patch.link = file.links.back().name;
    patch.X_LinkRoot = pose();
    patch.gains = {random.uniform(0, 100), random.uniform(0, 100)};
    patch.covariance = covariance();
    const bool linked = random.index(2) == 0;
    const int cells = 1 + random.index(20);
    for (int c = 0; c < cells; ++c) {
      SkinFile::Cell cell;
      cell.id = id++;
      cell.X_RootCell = pose();
      if (linked)  // a row
        cell.neighbours = {c > 0 ? cell.id - 1 : SkinFile::nobody, SkinFile::nobody,
                           c + 1 < cells ? cell.id + 1 : SkinFile::nobody, SkinFile::nobody};
      cell.group = static_cast<std::uint32_t>(random.index(65536));
      if (random.index(2) == 0) cell.threshold = random.uniform(0, 3);
      cell.gain = random.uniform(0, 100);
      cell.covariance = covariance();
      if (random.index(4) == 0) cell.masked = "because";
      patch.cells.push_back(cell);
    }
    if (random.index(2) == 0) file.regions.push_back({"region " + std::to_string(k), {id - 1}, 0.5, 140, 0});
    file.patches.push_back(patch);
  }
  return file;
}

}  // namespace

TEST_CASE("Skin file: what it says is what comes out") {
  const SkinFile file = parse_skin_file(good, "arm.json");
  CHECK(file.source == "arm.json");
  CHECK(file.cells() == 4);
  REQUIRE(file.patches.size() == 2);
  const auto& forearm = file.patches[0];
  CHECK(forearm.name == "forearm");
  CHECK(forearm.link == "forearm_link");
  CHECK(forearm.line == 6);
  CHECK(forearm.gains.force == 20);
  CHECK(forearm.gains.proximity == 2.5);
  CHECK(forearm.X_LinkRoot.p == Xyz<double>{-0.03, 0.1, 0});
  // A quarter turn about y: z comes to lie on x, x on -z.
  const Rotation<double> R = forearm.X_LinkRoot.rotation();
  CHECK(dot(R.z, Xyz<double>{1, 0, 0}) == doctest::Approx(1).epsilon(1e-15));
  CHECK(dot(R.x, Xyz<double>{0, 0, -1}) == doctest::Approx(1).epsilon(1e-15));
  CHECK(forearm.cells[0].neighbours ==
        std::vector<std::uint32_t>{2, SkinFile::nobody, SkinFile::nobody, SkinFile::nobody});
  CHECK_FALSE(forearm.cells[0].threshold.has_value());
  CHECK(forearm.cells[1].line == 11);
  CHECK(forearm.cells[1].group == 7);
  CHECK(forearm.cells[1].threshold == 0.12);
  CHECK(forearm.cells[1].gain == 0.5);
  CHECK(forearm.cells[2].masked == "no answer since the crash");
  CHECK(file.patches[1].covariance.size() == 21);
  CHECK(file.patches[1].cells[0].neighbours.empty());
  CHECK(file.links[0].joint_axis == Xyz<double>{0, 1, 0});
  REQUIRE(file.regions.size() == 1);
  CHECK(file.regions[0].cells == std::vector<std::uint32_t>{3, 4});
  CHECK(file.regions[0].force_limit == 65);
}

TEST_CASE("Skin file: quaternions are rotations, forth and back") {
  oracle::Random random(3);
  for (int k = 0; k < 1000; ++k) {
    SkinFile any = any_skin(random);
    const SkinPose& X = any.patches[0].X_LinkRoot;
    const Rotation<double> R = X.rotation();
    CHECK(rotation_error(R) <= 1e-15 * 8);
    const SkinPose again = SkinPose::of(R, X.p);
    double cosine = 0;  // q and -q are the same
    for (std::size_t i = 0; i < 4; ++i) cosine += again.q[i] * X.q[i];
    CHECK(std::abs(cosine) == doctest::Approx(1).epsilon(1e-15));
    // By definition: v + 2 w (u x v) + 2 u x (u x v).
    const Xyz<double> u{X.q[0], X.q[1], X.q[2]}, v{0.3, -0.2, 0.9}, uv = cross(u, v);
    const Xyz<double> expected = v + (2 * X.q[3]) * uv + 2.0 * cross(u, uv);
    const Xyz<double> difference = R * v - expected;
    CHECK(std::sqrt(dot(difference, difference)) <= 1e-15 * 4);
  }
}

TEST_CASE("Skin file: written and read, it is the same to the bit; written again, to the byte") {
  oracle::Random random(1);
  for (int k = 0; k < (sanitized ? 15 : 300); ++k) {
    const SkinFile file = any_skin(random);
    const std::string text = skin_file_text(file);
    const SkinFile again = without_lines(parse_skin_file(text));
    REQUIRE(same(again, file));
    REQUIRE(skin_file_text(again) == text);
    const CommaLocale comma;  // in every locale
    REQUIRE(skin_file_text(again) == text);
  }
  const SkinFile file = parse_skin_file(good);
  const auto path = std::filesystem::temp_directory_path() / "skinctl_skin_file_test.json";
  write_skin_file(file, path.string());
  CHECK(same(without_lines(read_skin_file(path.string())), without_lines(file)));
  std::filesystem::remove(path);
  CHECK_THROWS_AS(static_cast<void>(read_skin_file(path.string())), ConfigurationError);
  CHECK_THROWS_AS(static_cast<void>(read_skin_file(std::filesystem::temp_directory_path().string())),
                  ConfigurationError);
}

TEST_CASE("Skin file: each error names line, patch, cell, field, value and range") {
  struct Wrong {
    const char *from, *to, *says;
  };
  const Wrong wrong[] = {
      // The file.
      {"skinctl-skin-1", "skinctl-skin-2",
       "arm.json:2: format = \"skinctl-skin-2\", allowed: \"skinctl-skin-1\""},
      {"  \"format\": \"skinctl-skin-1\",\n", "", "arm.json:1: no format"},
      {"\"regions\"", "\"regoins\"", "arm.json:21: unknown field \"regoins\""},
      {"\"links\"", "\"links\": [], \"links\"", "arm.json:3: \"links\" occurs twice"},
      {"\"patches\": [", "\"patches\": [3, ", "arm.json:5: patches holds a number, allowed: tables"},
      {"0.06, 0]", "0.06, NaN]", "arm.json:13: no JSON: parse error at line 13"},
      {"0.06, 0]", "0.06, 1e999]", "number overflow"},
      {"]}\n  ],", "]}\n  ", "arm.json:21: no JSON: parse error at line 21"},
      // Patches.
      {"\"name\": \"forearm\", ", "", "arm.json:6: patch number 1, no name"},
      {"\"link\": \"hand_link\"", "\"link\": \"wrist\"",
       "arm.json:16: patch \"palm\", link = \"wrist\", allowed: a name of \"links\""},
      {"\"link\": \"hand_link\"", "\"link\": \"forearm_link\"",
       "arm.json:4: link \"hand_link\", no patch is on it"},
      {"\"name\": \"palm\"", "\"name\": \"forearm\"",
       "arm.json:16: patch \"forearm\", the name occurs twice"},
      {"\"force\": 20", "\"force\": -20",
       "arm.json:6: patch \"forearm\", gains.force = -20, allowed: 0 to 1000000 N"},
      {"\"force\": 20", "\"force\": \"20\"",
       "arm.json:8: patch \"forearm\", gains, force is a text, allowed: a number"},
      {", \"proximity\": 2.5", "", "arm.json:8: patch \"forearm\", gains, no proximity"},
      {"[-0.03, 0.1, 0]", "[-0.03, 0.1]",
       "arm.json:7: patch \"forearm\", X_LinkRoot, p: 2 values, allowed: 3 numbers"},
      {"[-0.03, 0.1, 0]", "[-30, 0.1, 0]",
       "arm.json:6: patch \"forearm\", X_LinkRoot.p = -30, allowed: -10 to 10 m"},
      {"[0, 0.7071067811865476, 0, 0.7071067811865476]", "[0, 0.9, 0, 0]",
       "arm.json:6: patch \"forearm\", X_LinkRoot.q: |q| = 0.9, allowed: 1 within 1e-4"},
      {"[1e-6,0,0,0,0,0,", "[1e-6,0.5,0,0,0,0,", "patch \"palm\", covariance: smallest eigenvalue = -0.4"},
      {"[1e-6,0,0,0,0,0,", "[1e-6,0,0,0,0,",
       "arm.json:18: patch \"palm\", covariance: 20 values, allowed: 21 numbers"},
      // Cells.
      {"\"id\": 3", "\"id\": 2", "arm.json:13: patch \"forearm\", cell 2, the id occurs twice"},
      {"\"id\": 3", "\"id\": 1048576",
       "arm.json:13: patch \"forearm\", cell 1048576, id = 1048576, allowed: a whole number, 0 to 1048575"},
      {"\"id\": 3", "\"id\": 1e300", "cell 1e+300, id = 1e+300, allowed: a whole number, 0 to 1048575"},
      {"\"id\": 3", "\"id\": -1", "cell -1, id = -1, allowed: a whole number, 0 to 1048575"},
      {"\"id\": 3", "\"id\": 2.5", "cell 2.5, id = 2.5, allowed: a whole number, 0 to 1048575"},
      {"\"id\": 3, ", "", "arm.json:13: patch \"forearm\", cell number 3, no id"},
      {"\"threshold\": 0.12", "\"threshold\": -1",
       "arm.json:11: patch \"forearm\", cell 2, threshold = -1, allowed: 0 to 3"},
      {"\"gain\": 0.5", "\"gain\": 101",
       "arm.json:11: patch \"forearm\", cell 2, gain = 101, allowed: 0 to 100"},
      {"\"group\": 7", "\"group\": 65536",
       "arm.json:12: patch \"forearm\", cell 2, group = 65536, allowed: a whole number, 0 to 65535"},
      {"\"group\": 7", "\"grupe\": 7", "arm.json:12: patch \"forearm\", cell 2, unknown field \"grupe\""},
      {"\"no answer since the crash\"", "\"\"", "arm.json:14: patch \"forearm\", cell 3, masked is empty"},
      {"\"no answer since the crash\"", "true", "cell 3, masked is true or false, allowed: a text"},
      {"[0, 0.06, 0], \"q\": [0, 0, 0, 1]", "[0, 0.06, 0], \"q\": [0, 0, 0, 0]",
       "arm.json:13: patch \"forearm\", cell 3, X_RootCell.q: |q| = 0, allowed: 1 within 1e-4"},
      // Neighbours.
      {"[null, null, 2, null]", "[null, null, 9, null]",
       "arm.json:11: patch \"forearm\", cell 2, neighbour at port 2 = 3, but cell 3 does not name cell 2"},
      {"[null, null, 2, null]", "[9, null, 2, null]",
       "arm.json:13: patch \"forearm\", cell 3, neighbour at port 1 = 9, allowed: an id of this file"},
      {"[null, null, 2, null]", "[3, null, 2, null]",
       "cell 3, neighbour at port 1 = 3, allowed: another cell"},
      {"[null, null, 2, null]", "[2, null, 2, null]", "cell 3, neighbour at port 3 = 2, as at port 1"},
      {"[null, null, 2, null]", "[2]",
       "cell 3, neighbours: 1 values, allowed: four, an id or null for each port"},
      {"[null, null, 2, null]", "[null, null, \"2\", null]",
       "cell 3, neighbours is a text, allowed: a whole number"},
      {", \"neighbours\": [null, null, 2, null]", "",
       "cell 2, neighbour at port 2 = 3, but cell 3 does not name cell 2"},
      {", \"neighbours\": [2, null, null, null]", "",
       "cell 2, neighbours are given, allowed: all cells of a patch have them, or none"},
      // Links and regions.
      {"\"radius\": 0.04", "\"radius\": 11",
       "arm.json:3: link \"forearm_link\", radius = 11, allowed: 0 to 10 m"},
      {"\"joint_axis\": [0, 1, 0]", "\"joint_axis\": [0, 2, 0]",
       "link \"forearm_link\", joint_axis: its length = 2"},
      {"\"cells\": [3, 4]", "\"cells\": [3, 5]",
       "arm.json:21: region \"grip\", cell 5, allowed: an id of this file"},
      {"\"cells\": [3, 4]", "\"cells\": [3, 3]", "region \"grip\", cell 3 occurs twice"},
      {"\"cells\": [3, 4]", "\"cells\": []", "region \"grip\", 0 cells, allowed: 1 to 1048576"},
      {"\"force_limit\": 65", "\"force_limit\": 0", "region \"grip\", force_limit = 0, allowed: > 0 N"},
      {"\"weight\": 2", "\"weight\": -1", "region \"grip\", weight = -1, allowed: 0 to 1000"},
      {"\"name\": \"grip\"", "\"name\": \"gr\\u0007ip\"",
       "region \"gr?ip\", name = \"gr?ip\", allowed: 1 to 128 bytes"},
  };
  CHECK(complaint(good).empty());
  for (const Wrong& w : wrong) {
    const std::string says = complaint(replaced(good, w.from, w.to));
    CHECK_MESSAGE(says.find(w.says) != std::string::npos, "expected: ", std::string(w.says),
                  "\nsaid: ", says);
  }
}

TEST_CASE("Skin file: sizes that a program builds or a stranger sends are bounded") {
  const std::string deep = replaced(good, "\"skinctl-skin-1\"", std::string(1'000'000, '['));
  CHECK(complaint(deep).find("arm.json:2: lists and tables more than 8 deep") != std::string::npos);
  const std::string flat = replaced(
      good, "\"skinctl-skin-1\"", "[0" + [] {
        std::string zeros;
        for (int i = 0; i < (1 << 21); ++i) zeros += ",0";
        return zeros;
      }() + "]");
  CHECK(complaint(flat).find("more than 2^21 values") != std::string::npos);
  CHECK(complaint(replaced(good, "forearm\"", std::string(5000, 'x') + '"')).find("5000 bytes") !=
        std::string::npos);
  CHECK(complaint(replaced(good, "forearm\"", std::string(200, 'x') + '"')).find("1 to 128 bytes") !=
        std::string::npos);
  CHECK(complaint("").find("no JSON") != std::string::npos);
  CHECK(complaint("null").find("the file is null, allowed: a table") != std::string::npos);
  for (std::size_t n = 0; n + 2 < good.size(); n += by_day ? 7 : 1)
    REQUIRE_FALSE(complaint(good.substr(0, n)).empty());

  SkinFile file = without_lines(parse_skin_file(good));
  SkinFile many = file;
  many.patches.resize(1);
  many.links.resize(1);
  many.regions.clear();
  many.patches[0].cells.resize(1);
  many.patches[0].cells[0].neighbours.clear();
  while (many.patches[0].cells.size() <= SkinFile::max_cells_of_a_patch) {
    many.patches[0].cells.push_back(many.patches[0].cells.back());
    ++many.patches[0].cells.back().id;
  }
  CHECK_THROWS_WITH_AS(static_cast<void>(skin_file_text(many)),
                       doctest::Contains("8193 cells, allowed: 1 to 8192"), ConfigurationError);
  many.patches[0].cells.pop_back();
  std::string text = skin_file_text(many);
  CHECK(complaint(text).empty());
  text.insert(text.find("      ]\n    }"), ", {\"id\": 9000}");
  CHECK(complaint(text).find("more than 8192 cells of a patch") != std::string::npos);
  file.patches.clear();
  CHECK_THROWS_AS(file.check(), ConfigurationError);
}

TEST_CASE("Skin file: any text is read whole or refused; what is read can be written and read again") {
  // Words that files hold, and those that break readers.
  static const std::vector<std::string> words = {"[",
                                                 "]",
                                                 "{",
                                                 "}",
                                                 ",",
                                                 ":",
                                                 "\"",
                                                 "null",
                                                 "true",
                                                 "-",
                                                 "1e308",
                                                 "1e-320",
                                                 "-0",
                                                 "4294967296",
                                                 "18446744073709551616",
                                                 "1048575",
                                                 "1048576",
                                                 "0.9999",
                                                 "\"id\": 1",
                                                 "\"id\": 2",
                                                 "\"cells\": []",
                                                 "\"neighbours\": [2, null, null, null]",
                                                 "\"q\": [0, 0, 0, 1]",
                                                 "\"name\"",
                                                 "\"forearm\"",
                                                 "\\u0000",
                                                 "\xff",
                                                 "\xf0\x9f\xa4\x96",
                                                 "\n",
                                                 std::string(1, '\0'),
                                                 "// x",
                                                 "NaN",
                                                 "Infinity",
                                                 "\"masked\": \"x\"",
                                                 "[[[[[[[[",
                                                 "{\"a\":",
                                                 "1",
                                                 "2",
                                                 "3",
                                                 "0"};
  using Edit = std::tuple<std::uint32_t, std::uint8_t, std::uint8_t, std::uint8_t>;
  int read = 0;
  const bool held = rc::check("mutations of a skin file", [&](const std::vector<Edit>& edits) {
    std::string text = good;
    for (const auto& [where, what, word, length] : edits) {
      const std::size_t at = text.empty() ? 0 : where % text.size();
      switch (what % 5) {
        case 0:
          text.erase(at, length % 12);
          break;
        case 1:
          text.insert(at, words[word % words.size()]);
          break;
        case 2:
          text.replace(at, std::min<std::size_t>(length % 4, text.size() - at), words[word % words.size()]);
          break;
        case 3:  // a part once more, elsewhere
          text.insert(at, text.substr(word * text.size() / 256, length));
          break;
        default:
          if (!text.empty()) text[at] = static_cast<char>(word);
      }
    }
    try {
      const SkinFile file = parse_skin_file(text);
      ++read;
      RC_ASSERT(same(without_lines(parse_skin_file(skin_file_text(file))), without_lines(file)));
      for (const auto& patch : file.patches)
        for (const auto& cell : patch.cells) RC_ASSERT(rotation_error(cell.X_RootCell.rotation()) <= 1e-14);
    } catch (const ConfigurationError& e) {
      RC_ASSERT(std::string_view(e.what()).size() < 700);
    }
  });
  CHECK(held);
  CHECK(read > 0);
}

TEST_CASE("Skin file: ten thousand cells are read in a fraction of a second") {
  SkinFile file;
  file.links = {{"link", 0.05, 1, {}, 0}};
  for (std::uint32_t k = 0; k < 2; ++k) {
    SkinFile::Patch patch;
    patch.name = std::to_string(k);
    patch.link = "link";
    for (std::uint32_t i = 0; i < 5000; ++i) {
      SkinFile::Cell cell;
      cell.id = 5000 * k + i;
      cell.X_RootCell.p = {1e-3 * i, 1.0 / 3, 0};
      patch.cells.push_back(cell);
    }
    file.patches.push_back(patch);
  }
  const std::string text = skin_file_text(file);
  const auto start = std::chrono::steady_clock::now();
  CHECK(same(without_lines(parse_skin_file(text)), file));
  const double t = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  MESSAGE(text.size(), " bytes in ", t, " s");
  CHECK(t < (sanitized ? 10.0 : 1.0));
}
