// not sanitized: the fits of Eigen take this compiler minutes; least_squares_test holds a sample
//
// Promise: a skin's cells find their places, and the robot its axes, from a motion that accelerometers
// feel, from nothing
// Tried: UR5, 60 s within its limits and announced, sensors as bought (9 mg, 40 mg, 1.5 %, cross-axis,
// vibration, labels 7 ms late), joints that give way by 5e-5 rad/(N m): cells of links 2 to 6 within 0.18
// mm rms in the median of 8 seeds (worst 0.20; single cells 0.37, worst 0.40), 0.72 where cross-axis
// sensitivity is not fitted; axes 0.013 degrees and 0.13 mm (0.017, 0.17), lateness 0.005 ms; the single
// largest sample of each pose 21.9 mm where the same motion gives 0.55; 260 cells in 2.0 s of one
// processor. Also: study `skin_kinematics`
//
// Promise: what such a motion cannot show is named, and no cell is placed by a guess
// Tried: links that turn about the vertical only, a joint that never moves, cells that are silent, stuck
// or not numbers; a joint that moves, but never alone, is refused

#include "skinctl/calibration/joint_lines.hpp"

#include <doctest/doctest.h>

#include "bench/studies/worlds/ur5_excitation.hpp"
#include "examples/worlds/moved_skin.hpp"
#include "skinctl/calibration/nees.hpp"
#include "skinctl/robots/ur5.hpp"
#include "tests/support/kdl_oracle.hpp"
#include "tests/support/robot_table.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

SkinExcitation motion_of(double seconds) {
  SkinExcitation::Settings s;
  s.duration = seconds;
  return SkinExcitation(ur5_home, ur5_limits(), s);
}
// Two or three cells on each link, those of a link in a patch.
struct SmallSkin {
  std::vector<TrueCell> cells;
  std::vector<int> patch;
};
SmallSkin small_skin(const MovedSkinSettings& s, std::uint64_t seed) {
  auto rng = seeded(seed);
  SmallSkin out;
  for (int link = 0; link < 6; ++link)
    for (int k = 0; k < 2; ++k) {
      TrueCell c;
      c.link = link;
      const double angle = 1.1 * link + 1.9 * k;
      const Eigen::Vector3d z(std::cos(angle), std::sin(angle), 0), x(0, 0, 1);
      c.R << x, z.cross(x), z;
      c.p = 0.05 * z + Eigen::Vector3d(link == 1 || link == 2 ? -0.15 - 0.03 * k : 0, 0, 0.03 + 0.03 * k);
      add_errors(c, s, rng);
      out.cells.push_back(c), out.patch.push_back(link);
    }
  return out;
}

struct Found {
  double cells = 0, turns = 0, axes = 0, nees = 0;  // worst [m], [rad], [rad], mean
};
// Against KDL's poses and axes, up to where the base stands and faces; cells of `from` and further links.
Found judge(const JointLines& found, const SmallSkin& skin, const MovedSkinSettings& s, int from) {
  using Pose = Eigen::Isometry3d;
  oracle::KdlOracle kdl(oracle::ur5());
  double q[6], tau[6], R[9], p[3], J[36];
  for (int i = 0; i < 6; ++i) q[i] = found.home(i);
  kdl.gravity(q, tau);
  for (int i = 0; i < 6; ++i) q[i] -= s.compliance * tau[i];
  std::vector<Pose> at;
  for (int i = 0; i < 6; ++i) {
    kdl.pose(i, q, R, p);
    Pose X = Pose::Identity();
    X.linear() = s.base * Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(R);
    X.translation() = s.base * Eigen::Map<const Eigen::Vector3d>(p);
    at.push_back(X);
  }
  const double origin[3] = {0, 0, 0};
  kdl.jacobian(5, origin, q, J);
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = a;
  double n = 0;
  std::vector<Eigen::Vector3d> is;
  for (std::size_t c = 0; c < skin.cells.size(); ++c) {
    is.push_back(at[std::size_t(skin.cells[c].link)] * skin.cells[c].p);
    if (skin.cells[c].link >= from) a += found.cells[c].p, b += is[c], n += 1;
  }
  a /= n, b /= n;
  double sine = 0, cosine = 0;
  for (std::size_t c = 0; c < skin.cells.size(); ++c) {
    if (skin.cells[c].link < from) continue;
    const Eigen::Vector3d u = found.cells[c].p - a, v = is[c] - b;
    sine += u.x() * v.y() - u.y() * v.x(), cosine += u.x() * v.x() + u.y() * v.y();
  }
  const Eigen::Matrix3d yaw =
      Eigen::AngleAxisd(std::atan2(sine, cosine), Eigen::Vector3d::UnitZ()).toRotationMatrix();
  Found out;
  double count = 0;
  for (std::size_t c = 0; c < skin.cells.size(); ++c) {
    if (skin.cells[c].link < from) continue;
    const Eigen::Vector3d e = yaw * (found.cells[c].p - a) - (is[c] - b);
    out.cells = std::max(out.cells, e.norm());
    const Eigen::Matrix3d R_is = at[std::size_t(skin.cells[c].link)].linear() * skin.cells[c].R;
    out.turns = std::max(out.turns, turn_vector(R_is.transpose() * yaw * found.cells[c].R).norm());
    const Eigen::Vector3d own = yaw.transpose() * e;
    out.nees += nees(own, Eigen::Matrix3d(found.cells[c].covariance.topLeftCorner<3, 3>())), count += 3;
  }
  out.nees /= count;
  for (int j = 0; j < 6; ++j) {
    if (!found.lines[std::size_t(j)].known) continue;
    const Eigen::Vector3d w = s.base * Eigen::Vector3d(J[18 + j], J[24 + j], J[30 + j]);
    const Eigen::Vector3d v = yaw * found.lines[std::size_t(j)].line.direction;
    out.axes = std::max(out.axes, std::atan2(w.cross(v).norm(), w.dot(v)));
  }
  return out;
}
bool names(const JointLines& found, const std::string& what) {
  for (const auto& u : found.unobservable)
    if (u.name.find(what) != std::string::npos) return true;
  return false;
}
MotionRecording recorded(const SmallSkin& skin, const MovedSkinSettings& s, double seconds, int held = -1) {
  const SkinExcitation excitation = motion_of(seconds);
  return record_motion(
      ur5::Model{},
      [&](double t) {
        JointPoint p = excitation.at(t);
        if (held >= 0) p.q(held) = ur5_home(held), p.dq(held) = 0, p.ddq(held) = 0;
        return p;
      },
      seconds, skin.cells, s, 7);
}

}  // namespace

TEST_CASE(
    "Lines from motion: sensors as bought, 60 s, from nothing; what an upright first joint hides is named") {
  const MovedSkinSettings s;
  const SmallSkin skin = small_skin(s, 1);
  MotionRecording r = recorded(skin, s, 60);
  auto rng = seeded(2);
  r.places = reconstructed_places(skin.cells, skin.patch, 2e-4, 0.005, rng);
  const JointLines found = find_joint_lines(r);
  for (std::size_t c = 0; c < skin.cells.size(); ++c) CHECK(found.cells[c].joint == skin.cells[c].link);
  const Found is = judge(found, skin, s, 1);
  MESSAGE("cells within " << 1e3 * is.cells << " mm, " << 57.3 * is.turns << " deg; axes " << 57.3 * is.axes
                          << " deg; NEES " << is.nees << "; late " << 1e3 * found.lateness.value << " ms");
  CHECK(found.converged);
  CHECK(is.cells < 0.6e-3);
  CHECK(is.axes < 0.03 / 57.3);
  CHECK(std::abs(found.lateness.value - s.late) < 0.5e-3);
  // Taken for accelerometers whose axes do not feel each other.
  const Found blind = judge(find_joint_lines(r, {.cross_axis = 1e-7}), skin, s, 1);
  MESSAGE("without cross-axis sensitivity: " << 1e3 * blind.cells << " mm");
  CHECK(blind.cells > 2 * is.cells);
  // Link 0 turns about the vertical only.
  CHECK(names(found, "link 0: height"));
  CHECK(names(found, "link 0: turn of its cells about the joint's axis"));
  CHECK(found.unobservable.size() == 2);
  for (std::size_t c = 0; c < 2; ++c) {
    CHECK(!found.cells[c].known);
    CHECK(!found.cells[c].reason.empty());
  }
  for (std::size_t c = 2; c < skin.cells.size(); ++c) CHECK(found.cells[c].known);
}

TEST_CASE(
    "Lines from motion: a base tilted by 5 degrees shows all but the height of the first link's cells") {
  MovedSkinSettings s = MovedSkinSettings::ideal();
  s.base = Eigen::AngleAxisd(5 / 57.3, Eigen::Vector3d(0.6, 0.8, 0)).toRotationMatrix();
  const SmallSkin skin = small_skin(s, 3);
  const JointLines found = find_joint_lines(recorded(skin, s, 30));
  CHECK(names(found, "link 0: "));
  CHECK(!names(found, "azimuth"));
  CHECK(judge(found, skin, s, 1).cells < 0.5e-3);
}

TEST_CASE("Lines from motion: a joint that never moves is named, and the rest is found") {
  const MovedSkinSettings s = MovedSkinSettings::ideal();
  const SmallSkin skin = small_skin(s, 4);
  const JointLines found = find_joint_lines(recorded(skin, s, 30, 3));
  CHECK(names(found, "joint 3: its axis"));
  CHECK(!found.lines[3].known);
  CHECK(found.joints == std::vector<int>{0, 1, 2, 4, 5});
  for (std::size_t c = 6; c < 8; ++c) CHECK(found.cells[c].joint == 2);  // link 3 is fixed to link 2
  CHECK(judge(found, skin, s, 1).cells < 0.5e-3);
}

TEST_CASE("Lines from motion: what lies, is silent or is cut short gives words") {
  const MovedSkinSettings s = MovedSkinSettings::ideal();
  const SmallSkin skin = small_skin(s, 5);
  MotionRecording r = recorded(skin, s, 30);
  for (std::size_t k = 0; k < r.cells[5].time.size(); ++k)
    r.cells[5].y(int(k % 3), Eigen::Index(k)) = std::nan("");
  r.cells[6].time.clear(), r.cells[6].y.resize(3, 0);
  r.cells[7].y.setConstant(0.3);  // stuck
  const JointLines found = find_joint_lines(r);
  for (const std::size_t c : {std::size_t(5), std::size_t(6), std::size_t(7)}) {
    CHECK(!found.cells[c].known);
    CHECK(!found.cells[c].reason.empty());
  }
  CHECK(found.cells[4].known);
  CHECK(found.cells[8].known);
  MotionRecording brief = r;
  brief.joints.time.resize(20), brief.joints.q.conservativeResize(20, 6);
  CHECK_THROWS_AS(static_cast<void>(find_joint_lines(brief)), ConfigurationError);
  MotionRecording odd = r;
  odd.places.resize(3);
  CHECK_THROWS_AS(static_cast<void>(find_joint_lines(odd)), ConfigurationError);
  MotionRecording none = r;
  none.cells.clear();
  CHECK_THROWS_AS(static_cast<void>(find_joint_lines(none)), ConfigurationError);
  // A joint that moves with the others only: which cells it carries cannot be told.
  MotionRecording hidden = r;
  for (std::size_t k = 0; k < hidden.joints.time.size(); ++k)
    if (hidden.joints.time[k] < 12) hidden.joints.q(Eigen::Index(k), 2) = ur5_home(2);
  CHECK_THROWS_AS(static_cast<void>(find_joint_lines(hidden)), ConfigurationError);
}
