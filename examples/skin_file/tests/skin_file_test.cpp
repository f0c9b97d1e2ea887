// The shipped skin file and its picture are what the program writes; poses of a URDF are those of its model.
#include "skinctl/io/skin_file.hpp"

#include <doctest/doctest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>

#include "examples/skin_file/picture.hpp"
#include "examples/support/own_input.hpp"
#include "skinctl/io/urdf.hpp"
#include "skinctl/kinematics/poses.hpp"

using namespace skinctl;

namespace {

std::string output(const std::string& arguments, int expected = 0) {
  const std::string out = (std::filesystem::temp_directory_path() / "skinctl_skin_file_test.out").string();
  const int status =
      std::system((std::string(SKIN_FILE_PROGRAM) + " " + arguments + " >" + out + " 2>&1").c_str());
  CHECK(WEXITSTATUS(status) == expected);
  std::ifstream in(out);
  return {std::istreambuf_iterator<char>(in), {}};
}
std::string content(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

TEST_CASE("skin_file: the UR5's shipped file and picture are those that the program writes") {
  const std::string file = EXAMPLES_DATA "/ur5_skin.json";
  CHECK(output("ur5") == content(file));
  CHECK(output("draw " + file) == content(EXAMPLES_PICTURES "/ur5_skin.svg"));
  CHECK(output("check " + file).find("260 cells, 0 of them masked, 0 regions") != std::string::npos);
}

TEST_CASE("skin_file: a picture is not drawn over its skin, nor a skin over its patches") {
  examples::check_own_input_is_kept(SKIN_FILE_PROGRAM, "draw IN -o OUT",
                                    content(EXAMPLES_DATA "/ur5_skin.json"), 2);
  examples::check_own_input_is_kept(SKIN_FILE_PROGRAM,
                                    "draw " EXAMPLES_DATA "/arm7_skin.json --urdf IN -o OUT",
                                    content(EXAMPLES_DATA "/arm7.urdf"), 2);
  examples::check_own_input_is_kept(SKIN_FILE_PROGRAM, "convert arm=IN -o OUT", "<SkinConfig/>", 2);
}

TEST_CASE("skin_file: what is wrong is said, with exit code 2") {
  CHECK(output("check " EXAMPLES_DATA "/arm7.urdf", 2).find("arm7.urdf:1: no JSON") != std::string::npos);
  CHECK(output("check " EXAMPLES_DATA "/arm7_skin.json", 2).find("the robot has no such link") !=
        std::string::npos);
  CHECK(output("ur5 --cells 7", 2).find("--cells 7, allowed") != std::string::npos);
  CHECK(output("draw", 2).find("file is required") != std::string::npos);
}

TEST_CASE("skin_file: cells that cannot be where the file says are named, with exit code 2") {
  const std::string path = (std::filesystem::temp_directory_path() / "skinctl_wrong_skin.json").string();
  const SkinFile good = read_skin_file(EXAMPLES_DATA "/ur5_skin.json");
  const auto says = [&](const char* words, const auto& change) {
    SkinFile file = good;
    change(file);
    write_skin_file(file, path);
    const std::string said = output("check " + path, 2);
    CAPTURE(said);
    CHECK(said.find(words) != std::string::npos);
  };
  const auto every = [](auto change) {
    return [change](SkinFile& file) {
      for (auto& patch : file.patches)
        for (auto& cell : patch.cells) change(cell.X_RootCell);
    };
  };
  const auto turned = [](SkinPose& X) {
    X.q = {X.q[3], X.q[2], -X.q[1], -X.q[0]};
  };  // half around its own x axis
  says("link 'forearm_link': the normals of its cells point into the body", every(turned));
  says("patch 'forearm', cell 135: its normal points against",
       [&](SkinFile& f) { turned(f.patches[2].cells[1].X_RootCell); });
  const auto small = every([](SkinPose& X) { X.p = {X.p.x / 1000, X.p.y / 1000, X.p.z / 1000}; });
  says("patch 'forearm': its cells are 0.027 mm apart", small);
  says("are its numbers millimetres?",
       every([](SkinPose& X) { X.p = {X.p.x * 30, X.p.y * 30, X.p.z * 30}; }));
  says("are its numbers millimetres?", [](SkinFile& f) { f.patches[5].X_LinkRoot.p = {2.7, 2.5, -2.2}; });
  says("cells 134 and 135 coincide",
       [](SkinFile& f) { f.patches[2].cells[1].X_RootCell.p = f.patches[2].cells[0].X_RootCell.p; });
  for (const int axis : {0, 1, 2})
    says("mirrored", every([axis](SkinPose& X) { (axis == 0 ? X.p.x : axis == 1 ? X.p.y : X.p.z) *= -1; }));
  for (const char* cells : {"60", "260", "383", "1260"}) {
    CHECK(output(std::string("ur5 --cells ") + cells + " -o " + path).empty());
    CHECK(output("check " + path).find(" regions\n") != std::string::npos);
  }
  const std::string arm = " --urdf " EXAMPLES_DATA "/arm7.urdf --tip hand_link";
  CHECK(output("check " EXAMPLES_DATA "/arm7_skin.json" + arm).find("4 cells") != std::string::npos);
  std::filesystem::remove(path);
}

TEST_CASE("skin_file: poses of a URDF's links are those of its model") {
  const Urdf urdf = read_urdf(EXAMPLES_DATA "/arm7.urdf", {.tip = "hand_link"});
  const auto model = calibrated_from<Chain<7>>(urdf);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> angle(-3, 3);
  for (int k = 0; k < 20; ++k) {
    std::vector<double> q(7);
    JointPosition<7> at;
    for (std::size_t i = 0; i < 7; ++i) at[i] = q[i] = angle(random);
    const skin_file::Pose pose = skin_file::urdf_at(urdf, q);
    const auto poses = link_poses(model, at);
    const auto compare = [&](const auto& X, std::size_t i) {
      CHECK((as_eigen(X.axes()) - as_eigen(pose.R[i])).cwiseAbs().maxCoeff() <= 1e-12);
      CHECK((as_eigen(X.origin()) - as_eigen(pose.p[i])).cwiseAbs().maxCoeff() <= 1e-12);
    };
    [&]<std::size_t... I>(std::index_sequence<I...>) {
      (compare(poses.template get<I>(), I), ...);
    }(std::make_index_sequence<7>{});
  }
  CHECK_THROWS_AS(static_cast<void>(skin_file::urdf_at(urdf, {1, 2})), ConfigurationError);
}

TEST_CASE(
    "skin_file: a picture shows each cell once from either side, masked ones crossed out, names escaped") {
  SkinFile file = read_skin_file(EXAMPLES_DATA "/arm7_skin.json");
  file.patches[0].name = "<a & b>";
  file.patches[0].cells[0].masked = "dead";
  const Urdf urdf = read_urdf(EXAMPLES_DATA "/arm7.urdf", {.tip = "hand_link"});
  const std::string svg = skin_file::picture(file, place_skin(file, urdf),
                                             skin_file::urdf_at(urdf, {0.3, -0.4, 0, -2, 0, 1.7, 0}));
  const auto count = [&](const std::string& text) {
    std::size_t n = 0;
    for (auto at = svg.find(text); at != std::string::npos; at = svg.find(text, at + 1)) ++n;
    return n;
  };
  CHECK(count("<path class=\"cell") == file.cells());
  CHECK(count("<path class=\"far") == 2);  // one a view,
  CHECK(count("Z") == 2 * file.cells());   // and each cell is seen from one side or the other
  CHECK(count("class=\"cross\"") == 1);
  CHECK(count("&lt;a &amp; b&gt;") == 1);
  CHECK(count("nan") == 0);
}
