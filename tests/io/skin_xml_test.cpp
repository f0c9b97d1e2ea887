#include "skinctl/io/skin_xml.hpp"

#include <doctest/doctest.h>
#include <rapidcheck.h>

#include "skinctl/io/skin_file.hpp"
#include "support/wrong_text.hpp"

using namespace skinctl;
using testing::replaced;

namespace {

template <std::size_t N>
std::string matrix(const char* name, int rows, int columns, const char* const (&x)[N]) {
  std::string out = std::string("<") + name + "><matrix rows=\"" + std::to_string(rows) + "\" cols=\"" +
                    std::to_string(columns) + "\">";
  for (int i = 0; i < rows * columns; ++i)
    out += "<element row=\"" + std::to_string(i / columns) + "\" col=\"" + std::to_string(i % columns) +
           "\">" + x[i] + "</element>";
  return out + "</matrix></" + name + ">\n";
}
// A quarter turn about z: x comes to lie on y. With the four digits that files have.
const std::string turned = matrix("rot", 3, 3, {"0.0000", "-1.0000", "0", "1", "0.0000", "0", "0", "0", "1"});
const std::string straight = matrix("rot", 3, 3, {"1", "0", "0", "0", "1", "0", "0", "0", "1"});
const std::string good =
    "<?xml version=\"1.0\"?>\n<SkinConfig numberOfCells=\"2\">\n<patchDriverSettings patchId=\"7\" "
    "prefix=\"/p\"/>\n"
    "<patchExtrinsics baseFrame=\"forearm_link\" dhFrame=\"DH3\" jointId=\"3\"><tf_rootCell_base>\n" +
    matrix("pos", 3, 1, {"0.01", "-2e-2", " 0.3 "}) + turned + "</tf_rootCell_base></patchExtrinsics>\n" +
    "<cell id=\"5\" rootCellId=\"5\">\n" + matrix("pos", 3, 1, {"0", "0", "0"}) + straight +
    "<neighbors size=\"4\"><neighbor id=\"6\"/><neighbor id=\"0\"/><neighbor id=\"0\"/><neighbor "
    "id=\"0\"/></neighbors>"
    "</cell>\n<cell id=\"6\" rootCellId=\"5\">\n" +
    matrix("pos", 3, 1, {"0.024", "0.014", "0"}) + turned +
    "<neighbors size=\"4\"><neighbor id=\"0\"/><neighbor id=\"0\"/><neighbor id=\"0\"/><neighbor "
    "id=\"5\"/></neighbors>"
    "</cell>\n</SkinConfig>\n";

std::string complaint(const std::string& text) {
  return testing::complaint_of([&] { return parse_skin_xml(text, "p.xml"); });
}

}  // namespace

TEST_CASE("Skin XML: what it says is what comes out, and can be written as JSON") {
  const SkinFile file =
      parse_skin_xml(good, "p.xml", {.name = "outside", .gains = {.force = 20, .proximity = 1}});
  REQUIRE(file.patches.size() == 1);
  const auto& patch = file.patches[0];
  CHECK(patch.name == "outside");
  CHECK(patch.link == "forearm_link");
  CHECK(patch.gains.force == 20);
  CHECK(patch.X_LinkRoot.p == Xyz<double>{0.01, -0.02, 0.3});
  const Rotation<double> R = patch.X_LinkRoot.rotation();
  CHECK(R.x.y == doctest::Approx(1));
  CHECK(R.y.x == doctest::Approx(-1));
  REQUIRE(patch.cells.size() == 2);
  CHECK(patch.cells[1].id == 6);
  CHECK(patch.cells[1].X_RootCell.p == Xyz<double>{0.024, 0.014, 0});
  constexpr auto nobody = SkinFile::nobody;
  CHECK(patch.cells[0].neighbours == std::vector<std::uint32_t>{6, nobody, nobody, nobody});
  CHECK(patch.cells[1].neighbours == std::vector<std::uint32_t>{nobody, nobody, nobody, 5});
  const SkinFile again = parse_skin_file(skin_file_text(file));
  CHECK(again.patches[0].cells[1].X_RootCell == patch.cells[1].X_RootCell);

  SkinFile both = file;
  SkinXmlOptions options;
  options.name = "inside";
  CHECK_THROWS_WITH_AS(append(both, parse_skin_xml(good, "q.xml", options)),
                       doctest::Contains("patch \"inside\", cell 5, the id occurs twice"),
                       ConfigurationError);
  options.link = "wrist_link";
  options.X_LinkRoot = SkinPose{{0, 0, 1}, {0, 0, 0, 1}};
  const SkinFile other = parse_skin_xml(
      replaced(good, "patchExtrinsics baseFrame=\"forearm_link\"", "patchExtrinsics"), "q.xml", options);
  CHECK(other.patches[0].link == "wrist_link");
  CHECK(other.patches[0].X_LinkRoot.p.z == 1);
}

TEST_CASE("Skin XML: each error names line, patch, cell, field, value and range") {
  struct Wrong {
    const char *from, *to, *says;
  };
  const Wrong wrong[] = {
      {"<SkinConfig", "<SkinKonfig", "p.xml:2: no XML"},
      {" numberOfCells=\"2\"", " numberOfCells=\"3\"",
       "p.xml:2: patch \"patch\", numberOfCells = 3, but there are 2"},
      {"baseFrame=\"forearm_link\"", "", "p.xml:4: patch \"patch\", <patchExtrinsics> has no baseFrame"},
      {">-2e-2<", ">nan<", "p.xml:5: patch \"patch\", pos = \"nan\", allowed: a finite number"},
      {">-2e-2<", "><", "p.xml:5: patch \"patch\", pos = \"\", allowed: a finite number"},
      {">-2e-2<", ">-20<", "p.xml:2: patch \"patch\", X_LinkRoot.p = -20, allowed: -10 to 10 m"},
      {">-1.0000<", ">-0.9<", "p.xml:6: patch \"patch\", rot: |R'R - 1| = 0.19, allowed: <= 0.01"},
      {">-1.0000<", ">1<", "rot: |R'R - 1| = "},
      {"rows=\"3\" cols=\"1\"", "rows=\"4\" cols=\"1\"",
       "p.xml:5: patch \"patch\", pos: rows = 4, allowed: 3"},
      {"rows=\"3\" cols=\"1\"", "cols=\"1\"", "pos rows = \"\", allowed: a whole number"},
      {"row=\"2\" col=\"0\"", "row=\"3\" col=\"0\"",
       "pos: element 3, 0, allowed: rows 0 to 2, columns 0 to 0"},
      {"row=\"2\" col=\"0\"", "row=\"1\" col=\"0\"", "pos: an element occurs twice"},
      {"<element row=\"2\" col=\"0\"> 0.3 </element>", "", "pos: an element is missing"},
      {"cell id=\"6\"", "cell id=\"5\"", "patch \"patch\", cell 5, the id occurs twice"},
      {"cell id=\"6\"", "cell id=\"-6\"", "<cell> id = -6, allowed: 0 to 1048575"},
      {"cell id=\"6\"", "cell id=\"99999999999999999999\"", "<cell> id = \"99999999999999999999\""},
      {"cell id=\"6\" rootCellId=\"5\"", "cell id=\"6\" rootCellId=\"6\"",
       "cell 6, rootCellId = 6, allowed: 5 as before"},
      {"<neighbor id=\"5\"/>", "<neighbor id=\"0\"/>",
       "patch \"patch\", cell 5, neighbour at port 1 = 6, but cell 6 does not name cell 5"},
      {"<neighbor id=\"5\"/>", "<neighbor id=\"5\"/><neighbor id=\"0\"/>",
       "cell 6, more than four neighbours"},
  };
  CHECK(complaint(good).empty());
  for (const Wrong& w : wrong) {
    const std::string says = complaint(replaced(good, w.from, w.to));
    CHECK_MESSAGE(says.find(w.says) != std::string::npos, "expected: ", std::string(w.says),
                  "\nsaid: ", says);
  }
  CHECK_FALSE(complaint("").empty());
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += "<a>";
  CHECK_FALSE(complaint(deep).empty());
}

TEST_CASE("Skin XML: any text is read whole or refused") {
  static const std::vector<std::string> words = {"<",
                                                 ">",
                                                 "/>",
                                                 "\"",
                                                 "<cell id=\"6\">",
                                                 "</cell>",
                                                 "&#0;",
                                                 "&lt;",
                                                 "<!--",
                                                 "]]>",
                                                 "<matrix rows=\"3\" cols=\"3\">",
                                                 "1e999",
                                                 "-1",
                                                 "5",
                                                 "6",
                                                 "id",
                                                 "<!DOCTYPE a [",
                                                 std::string(1, '\0'),
                                                 "\xff"};
  using Edit = std::tuple<std::uint32_t, std::uint8_t, std::uint8_t, std::uint8_t>;
  CHECK(rc::check("mutations of a patch file", [&](const std::vector<Edit>& edits) {
    std::string text = good;
    for (const auto& [where, what, word, length] : edits) {
      const std::size_t at = text.empty() ? 0 : where % text.size();
      if (what % 3 == 0) {
        text.erase(at, length % 12);
      } else if (what % 3 == 1) {
        text.insert(at, words[word % words.size()]);
      } else {
        text.insert(at, text.substr(word * text.size() / 256, length));
      }
    }
    try {
      const SkinFile file = parse_skin_xml(text);
      RC_ASSERT(parse_skin_file(skin_file_text(file)).cells() == file.cells());
    } catch (const ConfigurationError& e) {
      RC_ASSERT(std::string_view(e.what()).size() < 700);
    }
  }));
}
