#include "bench/tactile/kdl_skin.hpp"

#include <algorithm>
#include <kdl/chain.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <stdexcept>

namespace skinctl::bench {
namespace {

KDL::Frame placement(const oracle::Body& b) {
  return {KDL::Rotation(b.R[0], b.R[1], b.R[2], b.R[3], b.R[4], b.R[5], b.R[6], b.R[7], b.R[8]),
          KDL::Vector(b.p[0], b.p[1], b.p[2])};
}

/// Segment i is link i up to the next joint; a mount before it places the first joint.
KDL::Chain chain_of(const oracle::Robot& robot) {
  if (!robot.is_chain()) throw std::invalid_argument("KdlSkin: a chain is needed");
  KDL::Chain chain;
  chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::None), placement(robot.body(0))));
  for (int i = 0; i < robot.body_count(); ++i)
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), i + 1 < robot.body_count()
                                                                    ? placement(robot.body(i + 1))
                                                                    : KDL::Frame::Identity()));
  return chain;
}

}  // namespace

struct KdlSkin::State {
  State(const oracle::Robot& robot, std::vector<KdlCell> all)
      : cells(std::move(all)),
        chain(chain_of(robot)),
        poses(chain),
        jacobian(chain),
        frames(chain.getNrOfSegments()),
        n(chain.getNrOfJoints()),
        q(n),
        J(n) {
    for (unsigned i = 0; i < n; ++i) from_tip.push_back(chain.getSegment(i + 1).getFrameToTip().Inverse());
  }
  /// Poses of the links, not of the ends of their segments.
  void place_links(const double* position) {
    std::copy_n(position, n, q.data.data());
    if (poses.JntToCart(q, frames) < 0) throw std::runtime_error("KDL: poses");
    links.clear();
    for (unsigned i = 0; i < n; ++i) links.push_back(frames[i + 1] * from_tip[i]);
  }
  /// The Jacobian of the point `p` (base) of a link.
  void jacobian_at(int link, const KDL::Vector& p) {
    const int segments = link + 2;
    if (jacobian.JntToJac(q, J, segments) < 0) throw std::runtime_error("KDL: Jacobian");
    J.changeRefPoint(p - frames[static_cast<std::size_t>(link) + 1].p);
  }
  void add(const KDL::Wrench& w, double* tau) const {
    for (unsigned j = 0; j < n; ++j)
      for (int r = 0; r < 6; ++r) tau[j] += J.data(r, j) * w(r);
  }

  std::vector<KdlCell> cells;
  KDL::Chain chain;
  KDL::ChainFkSolverPos_recursive poses;
  KDL::ChainJntToJacSolver jacobian;
  std::vector<KDL::Frame> frames, from_tip, links;
  unsigned n;
  KDL::JntArray q;
  KDL::Jacobian J;
};

KdlSkin::KdlSkin(const oracle::Robot& robot, std::vector<KdlCell> cells)
    : state_(std::make_unique<State>(robot, std::move(cells))) {}
KdlSkin::~KdlSkin() = default;
KdlSkin::KdlSkin(KdlSkin&&) noexcept = default;

void KdlSkin::per_cell(const double* q, const double* newton, double* tau) {
  State& s = *state_;
  s.place_links(q);
  std::fill_n(tau, s.n, 0.0);
  for (const KdlCell& cell : s.cells) {
    const KDL::Frame& X = s.links[static_cast<std::size_t>(cell.link)];
    s.jacobian_at(cell.link, X * KDL::Vector(cell.p[0], cell.p[1], cell.p[2]));
    const KDL::Vector F = *newton++ * (X.M * KDL::Vector(cell.u[0], cell.u[1], cell.u[2]));
    s.add(KDL::Wrench(F, KDL::Vector::Zero()), tau);
  }
}

void KdlSkin::per_link(const double* q, const double* newton, double* tau) {
  State& s = *state_;
  s.place_links(q);
  std::fill_n(tau, s.n, 0.0);
  for (auto cell = s.cells.begin(); cell != s.cells.end();) {
    const int link = cell->link;
    double w[6] = {};
    for (; cell != s.cells.end() && cell->link == link; ++cell, ++newton)
      for (int r = 0; r < 6; ++r) w[r] += cell->u[r] * *newton;
    const KDL::Frame& X = s.links[static_cast<std::size_t>(link)];
    s.jacobian_at(link, X.p);
    s.add(X.M * KDL::Wrench(KDL::Vector(w[0], w[1], w[2]), KDL::Vector(w[3], w[4], w[5])), tau);
  }
}

}  // namespace skinctl::bench
