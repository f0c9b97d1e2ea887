// Study: joints' axes and cells' places from motion, from nothing, over seeds. Baseline: Mittendorfer's
// method.
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>

#include "bench/studies/worlds/ur5_excitation.hpp"
#include "examples/worlds/moved_skin.hpp"
#include "skinctl/calibration/joint_lines.hpp"
#include "skinctl/dynamics/gravity.hpp"
#include "skinctl/robots/ur5.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

// Cells of TUM's size on the tubes of a UR5.
struct TubeSkin {
  std::vector<TrueCell> cells;
  std::vector<int> patch;
};
TubeSkin make_skin(std::size_t count, const MovedSkinSettings& s, Random& rng) {
  struct Tube {
    double radius;
    Eigen::Vector3d from, to;
    double share;
  };
  // Radii and offsets: UR ROS 2 description, config/ur5/physical_parameters.yaml.
  const Tube tubes[6] = {{0.060, {0, 0, 0.03}, {0, 0, 0.15}, 0.14},
                         {0.054, {-0.06, 0, 0.13585}, {-0.365, 0, 0.13585}, 0.37},
                         {0.040, {-0.06, 0, 0.0165}, {-0.347, 0, 0.0165}, 0.26},
                         {0.045, {0, 0, 0.039}, {0, 0, 0.139}, 0.10},
                         {0.045, {0, 0, 0.025}, {0, 0, 0.125}, 0.10},
                         {0.0375, {0, 0, 0.0373}, {0, 0, 0.0823}, 0.03}};
  TubeSkin out;
  for (int link = 0; link < 6; ++link) {
    const Tube& tube = tubes[link];
    const auto cells = std::max<std::size_t>(2, std::size_t(tube.share * double(count)));
    const Eigen::Vector3d z = (tube.to - tube.from).normalized(), x = z.unitOrthogonal(), y = z.cross(x);
    const auto ring = std::size_t(6.2832 * tube.radius / 0.0278);
    const double rows = std::ceil(double(cells) / double(ring));
    for (std::size_t k = 0; k < cells; ++k) {
      const double angle = 6.2832 * (double(k % ring) + 0.5 * double((k / ring) % 2)) / double(ring);
      const Eigen::Vector3d normal = std::cos(angle) * x + std::sin(angle) * y;
      TrueCell c;
      c.link = link;
      c.R << z.cross(normal), -z, normal;
      c.R.col(1) = c.R.col(2).cross(c.R.col(0));
      c.p = tube.from + (double(k / ring) + 0.5) / rows * (tube.to - tube.from) + tube.radius * normal;
      add_errors(c, s, rng);
      out.cells.push_back(c), out.patch.push_back(link);
    }
  }
  return out;
}

// Links at home, along the robot's base.
struct Truth {
  std::array<Eigen::Matrix3d, 6> R;
  std::array<Eigen::Vector3d, 6> p;
};
Truth truth_at(const Eigen::VectorXd& q, double compliance) {
  Truth out;
  JointPosition<6> x;
  for (std::size_t i = 0; i < 6; ++i) x[i] = q(Eigen::Index(i));
  const auto sag = gravity_torque(ur5::Model{}, x);  // at rest, at home
  for (std::size_t i = 0; i < 6; ++i) x[i] -= compliance * sag[i];
  const auto at = link_poses(ur5::Model{}, x);
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    ((out.R[I] = at.get<I>().rotation(), out.p[I] = at.get<I>().translation()), ...);
  }(std::make_index_sequence<6>{});
  return out;
}

struct Score {
  double rms = 0, most = 0, turn = 0, axis = 0, line = 0, late = 0, nees = 0, seconds = 0, residual = 0;
  std::size_t unknown = 0, cells = 0;
  std::size_t unobserved = 0;
};

// Of cells on links `from` and above, after the best shift, and turn about the vertical, of all of them.
template <class Position, class Turn>
void judge(const std::vector<TrueCell>& cells, const Truth& truth, const Eigen::Matrix3d& base, int from,
           const Position& p, const Turn& R, Score& out, Eigen::Matrix3d& align, Eigen::Vector3d& shift) {
  Eigen::Vector3d a = Eigen::Vector3d::Zero(), b = a;
  double n = 0;
  std::vector<Eigen::Vector3d> true_p(cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto l = std::size_t(cells[c].link);
    true_p[c] = base * (truth.p[l] + truth.R[l] * cells[c].p);
    if (cells[c].link < from) continue;
    a += p(c), b += true_p[c], n += 1;
  }
  a /= n, b /= n;
  Eigen::Matrix3d W = Eigen::Matrix3d::Zero();
  for (std::size_t c = 0; c < cells.size(); ++c)
    if (cells[c].link >= from) W += (true_p[c] - b) * (p(c) - a).transpose();
  align = Eigen::AngleAxisd(std::atan2(W(1, 0) - W(0, 1), W(0, 0) + W(1, 1)), Eigen::Vector3d::UnitZ());
  shift = b - align * a;
  double squares = 0, turns = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (cells[c].link < from) continue;
    const double e = (align * p(c) + shift - true_p[c]).norm();
    squares += e * e, out.most = std::max(out.most, e);
    const auto l = std::size_t(cells[c].link);
    turns += turn_vector((base * truth.R[l] * cells[c].R).transpose() * align * R(c)).squaredNorm();
  }
  out.rms = std::sqrt(squares / n), out.turn = std::sqrt(turns / n);
}

Score run(const std::vector<TrueCell>& cells, const MotionRecording& recording, const MovedSkinSettings& s,
          bool cross_axis, bool print) {
  const std::clock_t started = std::clock();
  JointLinesSettings settings;
  if (!cross_axis) settings.cross_axis = 1e-7;
  const JointLines found = find_joint_lines(recording, settings);
  Score out;
  out.seconds = double(std::clock() - started) / CLOCKS_PER_SEC;
  const Truth truth = truth_at(found.home, s.compliance);
  Eigen::Matrix3d align;
  Eigen::Vector3d shift;
  judge(
      cells, truth, s.base, 1, [&](std::size_t c) { return found.cells[c].p; },
      [&](std::size_t c) { return found.cells[c].R; }, out, align, shift);
  double squares = 0, dof = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    out.unknown += !found.cells[c].known;
    if (cells[c].link < 1 || !found.cells[c].known) continue;
    const auto l = std::size_t(cells[c].link);
    Eigen::Matrix<double, 6, 1> e;
    e.head<3>() =
        align.transpose() * (s.base * (truth.p[l] + truth.R[l] * cells[c].p) - shift) - found.cells[c].p;
    e.tail<3>() =
        turn_vector(found.cells[c].R.transpose() * align.transpose() * s.base * truth.R[l] * cells[c].sensor);
    squares += e.head<3>().dot(found.cells[c].covariance.topLeftCorner<3, 3>().ldlt().solve(e.head<3>()));
    dof += 3;
  }
  out.nees = squares / dof;
  out.cells = cells.size();
  for (std::size_t j = 0; j < found.lines.size(); ++j) {
    const Eigen::Vector3d w = s.base * truth.R[j].col(2), v = align * found.lines[j].line.direction;
    const Eigen::Vector3d c = s.base * truth.p[j], d = align * found.lines[j].line.point + shift - c;
    const double angle = std::atan2(w.cross(v).norm(), w.dot(v));
    // Where the axis is nearest to the home's next one: across the line, at the link's origin.
    const double off = (d - v * v.dot(d)).norm();
    if (print)
      std::printf("  joint %zu: axis %.3f deg (%.3f), %.2f mm (%.2f)\n", j, angle * 57.3,
                  found.lines[j].direction_deviation * 57.3, off * 1e3,
                  found.lines[j].position_deviation * 1e3),
          std::printf("    compliance %.2e (%.1e)\n", found.lines[j].compliance.value,
                      found.lines[j].compliance.deviation);
    out.axis = std::max(out.axis, angle), out.line = std::max(out.line, off);
  }
  out.late = std::abs(found.lateness.value - s.late);
  out.residual = found.residual;
  out.unobserved = found.unobservable.size();
  if (print) {
    std::printf("  %d steps%s, residual %.2f mg, late %.3f ms +- %.3f, %.2f s\n", found.steps,
                found.converged ? "" : " (not converged)", found.residual * 1e3, found.lateness.value * 1e3,
                found.lateness.deviation * 1e3, out.seconds);
    for (const auto& u : found.unobservable)
      std::printf("  not observed: %s (%.3g %s); %s\n", u.name.c_str(), u.deviation, u.unit.c_str(),
                  u.remedy.c_str());
    std::vector<double> per(6, 0), n(6, 0), turn(6, 0);
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const auto l = std::size_t(cells[c].link);
      per[l] +=
          (align * found.cells[c].p + shift - s.base * (truth.p[l] + truth.R[l] * cells[c].p)).squaredNorm();
      turn[l] += turn_vector((s.base * truth.R[l] * cells[c].R).transpose() * align * found.cells[c].R)
                     .squaredNorm(),
          n[l] += 1;
    }
    for (std::size_t l = 0; l < 6; ++l)
      std::printf("  link %zu: %.2f mm %.2f deg\n", l, 1e3 * std::sqrt(per[l] / n[l]),
                  57.3 * std::sqrt(turn[l] / n[l]));
  }
  return out;
}

// Poses, and in each of them every joint alone for a moment: the motion of Mittendorfer's method.
class PosesAndJoints {
 public:
  static constexpr int poses = 5;
  static constexpr double go = 1.5, rest = 0.9, single = 1.6, all = go + rest + 6 * single;

  explicit PosesAndJoints(Random& rng) {
    for (int k = 0; k < poses; ++k) {
      pose_.push_back(ur5_home);
      for (Eigen::Index j = 0; j < 6; ++j) pose_.back()(j) += k == 0 ? 0 : uniform(rng, -1.0, 1.0);
    }
  }
  [[nodiscard]] double duration() const { return poses * all; }
  [[nodiscard]] double rests(int k) const { return all * k + go; }
  [[nodiscard]] JointPoint at(double t) const {
    const int k = std::clamp(int(std::floor(t / all)), 0, poses - 1);
    const double s = t - all * k;
    JointPoint p{pose_[std::size_t(k)], Eigen::VectorXd::Zero(6), Eigen::VectorXd::Zero(6)};
    if (s < go && k > 0) {
      const double r = s / go;
      const Eigen::VectorXd way = pose_[std::size_t(k)] - pose_[std::size_t(k - 1)];
      p.q = pose_[std::size_t(k - 1)] + r * r * r * (10 + r * (6 * r - 15)) * way;
      p.dq = 30 * r * r * (1 - r) * (1 - r) / go * way,
      p.ddq = 60 * r * (1 - r) * (1 - 2 * r) / (go * go) * way;
    } else if (s > go + rest) {
      const int j = std::min(5, int((s - go - rest) / single));
      const detail::fit::RisingSines f{0, single, 0.4, {6.2831853 * 1.25}, {0.16}, {0}};
      const auto v = f.at(s - go - rest - single * j);
      p.q(j) += v.x, p.dq(j) = v.v, p.ddq(j) = v.a;
    }
    return p;
  }

 private:
  std::vector<Eigen::VectorXd> pose_;
};

// Specific force on link `l` at a time, by differences of the nominal poses.
void signals_at(const PosesAndJoints& motion, const MovedSkinSettings& s, double t, std::size_t l,
                Eigen::Vector3d& A, Eigen::Matrix3d& S) {
  std::array<Truth, 5> at;
  for (int k = -2; k <= 2; ++k) at[std::size_t(k + 2)] = truth_at(motion.at(t + 0.002 * k).q, 0);
  const double per = 1 / (12 * 0.002 * 0.002 * s.gravity);
  const auto second = [&](const auto& x) {
    return (per * (16 * (x(3) + x(1)) - 30 * x(2) - x(0) - x(4))).eval();
  };
  const Eigen::Matrix3d R = at[2].R[l].transpose();
  S = R * second([&](std::size_t k) { return at[k].R[l]; });
  A = R * (second([&](std::size_t k) { return at[k].p[l]; }) +
           Eigen::Vector3d(s.base.transpose() * Eigen::Vector3d::UnitZ()));
}

// Mittendorfer's method: the robot's kinematics are given; a cell's turn from means at rest, its place from
// the single sample of largest acceleration of each pose and joint.
double baseline(const std::vector<TrueCell>& cells, const MotionRecording& recording,
                const PosesAndJoints& motion, const MovedSkinSettings& s) {
  std::vector<Eigen::Vector3d> found(cells.size());
  Score score;
  std::vector<Eigen::Matrix3d> turned(cells.size());
  const Truth at_home = truth_at(ur5_home, 0);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto l = std::size_t(cells[c].link);
    const CellReadings& r = recording.cells[c];
    Eigen::Matrix3d B = Eigen::Matrix3d::Zero();
    std::vector<Eigen::Vector3d> rest;
    for (int k = 0; k < PosesAndJoints::poses; ++k) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      double n = 0;
      for (std::size_t i = 0; i < r.time.size(); ++i)
        if (r.time[i] > motion.rests(k) + 0.2 && r.time[i] < motion.rests(k) + 0.8)
          sum += r.y.col(Eigen::Index(i)), n += 1;
      rest.push_back(sum / n);
      Eigen::Vector3d A;
      Eigen::Matrix3d S;
      signals_at(motion, s, motion.rests(k) + 0.5, l, A, S);
      B += A * rest.back().transpose();
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(B, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const Eigen::Matrix3d Q =
        svd.matrixU() *
        Eigen::Vector3d(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant()).asDiagonal() *
        svd.matrixV().transpose();
    Eigen::Matrix3d H = 1e-12 * Eigen::Matrix3d::Identity();
    Eigen::Vector3d g = Eigen::Vector3d::Zero();
    for (int k = 0; k < PosesAndJoints::poses; ++k)
      for (int j = 0; j <= int(l); ++j) {
        const double from = motion.rests(k) + PosesAndJoints::rest + PosesAndJoints::single * j;
        double most = -1;
        std::size_t at = 0;
        for (std::size_t i = 0; i < r.time.size(); ++i) {
          if (r.time[i] < from + 0.1 || r.time[i] > from + PosesAndJoints::single - 0.1) continue;
          const double a = (r.y.col(Eigen::Index(i)) - rest[std::size_t(k)]).norm();
          if (a > most) most = a, at = i;
        }
        Eigen::Vector3d A;
        Eigen::Matrix3d S;
        signals_at(motion, s, r.time[at], l, A, S);
        const Eigen::Vector3d e = Q * r.y.col(Eigen::Index(at)) - A;
        H += S.transpose() * S, g += S.transpose() * e;
      }
    const Eigen::Vector3d in_link = H.ldlt().solve(g);
    found[c] = s.base * (at_home.p[l] + at_home.R[l] * in_link);
    turned[c] = s.base * at_home.R[l] * Q;
  }
  Eigen::Matrix3d align;
  Eigen::Vector3d shift;
  judge(
      cells, at_home, s.base, 1, [&](std::size_t c) { return found[c]; },
      [&](std::size_t c) { return turned[c]; }, score, align, shift);
  return score.rms;
}

void line(const char* name, std::vector<double> v, double scale) {
  std::sort(v.begin(), v.end());
  std::printf("  %-36s median %.3g, worst %.3g\n", name, scale * v[v.size() / 2], scale * v.back());
}

}  // namespace

// skin_kinematics [seeds] [cells] [only this part]
int main(int argc, char** argv) {
  const int seeds = argc > 1 ? std::atoi(argv[1]) : 8;
  const std::size_t count = argc > 2 ? std::size_t(std::atoi(argv[2])) : 60;
  const std::string only = argc > 3 ? argv[3] : "";
  const bool print = seeds <= 2;
  const SkinExcitation excitation(ur5_home, ur5_limits(), {}, ur5::Model{});
  for (const auto& a : excitation.announcements()) std::printf("%s\n", a.text.c_str());
  std::printf("largest share of a limit: %.2f, of a torque: %.2f\n", excitation.largest_share(ur5_limits()),
              excitation.torque_share(ur5::Model{}, ur5_limits().torque));
  struct Part {
    const char* name;
    MovedSkinSettings settings;
    bool poses = false, patches = true, cross_axis = true;
  };
  std::vector<Part> parts = {{"60 s, from nothing", {}, false, true},
                             {"poses and single joints", {}, true, true},
                             {"poses, ideal sensor", MovedSkinSettings::ideal(), true, true},
                             {"60 s, ideal sensor", MovedSkinSettings::ideal(), false, true},
                             {"60 s, stiff joints", {}, false, true},
                             {"60 s, base tilted 5 degrees", {}, false, true},
                             {"60 s, cells on their own", {}, false, false},
                             {"60 s, no torques recorded", {}, false, true},
                             {"60 s, cross-axis sensitivity not fitted", {}, false, true, false}};
  parts[4].settings.compliance = 0, parts[7].settings.torques = false;
  parts[5].settings.base = Eigen::AngleAxisd(5 / 57.29578, Eigen::Vector3d(0.6, 0.8, 0)).toRotationMatrix();
  for (const Part& part : parts) {
    if (!only.empty() && std::string(part.name).find(only) == std::string::npos) continue;
    std::printf("%s, %zu cells, %d seeds\n", part.name, count, seeds);
    std::vector<Score> scores;
    std::vector<double> mm;
    for (int seed = 1; seed <= seeds; ++seed) {
      Random rng = seeded(std::uint64_t(seed));
      const TubeSkin skin = make_skin(count, part.settings, rng);
      const PosesAndJoints poses(rng);
      MotionRecording recording = record_motion(
          ur5::Model{}, [&](double t) { return part.poses ? poses.at(t) : excitation.at(t); },
          part.poses ? poses.duration() : excitation.duration(), skin.cells, part.settings,
          std::uint64_t(seed) + 100);
      if (part.patches)
        recording.places = reconstructed_places(skin.cells, skin.patch, 0.0003 / 1.7, 0.3 / 57.3, rng);
      if (part.poses) mm.push_back(baseline(skin.cells, recording, poses, part.settings));
      scores.push_back(run(skin.cells, recording, part.settings, part.cross_axis, print));
      const Score& score = scores.back();
      std::printf(
          "  seed %d: rms %.2f mm, max %.2f, %.3f deg; axes %.3f deg %.2f mm; late %.3f ms; nees %.2f; %zu "
          "of %zu not known; residual %.2f mg; %.2f s\n",
          seed, score.rms * 1e3, score.most * 1e3, score.turn * 57.3, score.axis * 57.3, score.line * 1e3,
          score.late * 1e3, score.nees, score.unknown, score.cells, score.residual * 1e3, score.seconds);
      std::fflush(stdout);
    }
    const auto all = [&](double Score::* m) {
      std::vector<double> v;
      for (const Score& s : scores) v.push_back(s.*m);
      return v;
    };
    line("cells of links 2 to 6, rms [mm]", all(&Score::rms), 1e3),
        line("largest [mm]", all(&Score::most), 1e3);
    line("turn, rms [deg]", all(&Score::turn), 57.29578),
        line("axes, worst of six [deg]", all(&Score::axis), 57.29578);
    line("axes, worst of six [mm]", all(&Score::line), 1e3), line("lateness [ms]", all(&Score::late), 1e3);
    line("NEES per number", all(&Score::nees), 1), line("processor time [s]", all(&Score::seconds), 1);
    if (!mm.empty()) line("Mittendorfer's method, rms [mm]", mm, 1e3);
  }
}
