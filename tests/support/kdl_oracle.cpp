// KDL's library was built with an Eigen that leaves alignment to malloc. Eigen decides otherwise under the
// address sanitizer, and would then free what the library allocated at another address.
#define EIGEN_MALLOC_ALREADY_ALIGNED 1

#include "tests/support/kdl_oracle.hpp"

#include <algorithm>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfdsolver_recursive_newton_euler.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainiksolvervel_wdls.hpp>
#include <kdl/chainjnttojacdotsolver.hpp>
#include <kdl/chainjnttojacsolver.hpp>
#include <kdl/tree.hpp>
#include <kdl/treefksolverpos_recursive.hpp>
#include <kdl/treeidsolver_recursive_newton_euler.hpp>
#include <kdl/treejnttojacsolver.hpp>
#include <stdexcept>
#include <string>

namespace oracle {
namespace {

KDL::Frame placement(const Body& b) {
  return {KDL::Rotation(b.R[0], b.R[1], b.R[2], b.R[3], b.R[4], b.R[5], b.R[6], b.R[7], b.R[8]),
          KDL::Vector(b.p[0], b.p[1], b.p[2])};
}

/// Inertia of the body, seen from `frame` (given in the body's frame).
KDL::RigidBodyInertia inertia(const Body& b, const KDL::Frame& frame) {
  const auto to = table_detail::transposed(
      std::array<double, 9>{frame.M(0, 0), frame.M(0, 1), frame.M(0, 2), frame.M(1, 0), frame.M(1, 1),
                            frame.M(1, 2), frame.M(2, 0), frame.M(2, 1), frame.M(2, 2)});
  const auto I = table_detail::product(table_detail::product(to, b.inertia), table_detail::transposed(to));
  return KDL::RigidBodyInertia(b.mass, frame.Inverse(KDL::Vector(b.com[0], b.com[1], b.com[2])),
                               KDL::RotationalInertia(I[0], I[4], I[8], I[1], I[2], I[5]));
}

std::string name(int body) {
  return "body" + std::to_string(body);
}

KDL::Tree tree_of(const Robot& robot) {
  KDL::Tree tree("base");
  for (int i = 0; i < robot.body_count(); ++i) {
    const Body& b = robot.body(i);
    const KDL::Frame X = placement(b);
    const auto kind = b.motion == Motion::revolute ? KDL::Joint::RotAxis : KDL::Joint::TransAxis;
    const KDL::Joint joint = b.motion == Motion::fixed
                                 ? KDL::Joint("fixed" + name(i), KDL::Joint::None)
                                 : KDL::Joint("joint" + name(i), X.p, X.M.UnitZ(), kind);
    tree.addSegment(KDL::Segment(name(i), joint, X, inertia(b, KDL::Frame::Identity())),
                    b.parent < 0 ? "base" : name(b.parent));
  }
  return tree;
}

/// The segment of body i ends where the next joint begins, as in a table of Denavit and Hartenberg.
KDL::Chain chain_of(const Robot& robot) {
  KDL::Chain chain;
  if (!robot.is_chain()) return chain;
  if (const KDL::Frame X = placement(robot.body(0)); !KDL::Equal(X, KDL::Frame::Identity(), 0))
    chain.addSegment(KDL::Segment("mount", KDL::Joint("mount", KDL::Joint::None), X));
  for (int i = 0; i < robot.body_count(); ++i) {
    const Body& b = robot.body(i);
    const auto kind = b.motion == Motion::revolute    ? KDL::Joint::RotZ
                      : b.motion == Motion::prismatic ? KDL::Joint::TransZ
                                                      : KDL::Joint::None;
    const KDL::Frame tip = i + 1 < robot.body_count() ? placement(robot.body(i + 1)) : KDL::Frame::Identity();
    chain.addSegment(KDL::Segment(name(i), KDL::Joint("joint" + name(i), kind), tip, inertia(b, tip)));
  }
  return chain;
}

void store(const KDL::Frame& X, double* R, double* p) {
  std::copy_n(X.M.data, 9, R);
  std::copy_n(X.p.data, 3, p);
}

}  // namespace

struct KdlOracle::State {
  explicit State(const Robot& robot)
      : n(robot.joint_count()),
        bodies(robot.body_count()),
        is_chain(robot.is_chain()),
        g(robot.gravity[0], robot.gravity[1], robot.gravity[2]),
        tree(tree_of(robot)),
        chain(chain_of(robot)),
        tree_poses(tree),
        tree_jacobian(tree),
        tree_dynamics(tree, g),
        tree_dynamics_at_rest(tree, KDL::Vector::Zero()),
        chain_poses(chain),
        chain_jacobian(chain),
        chain_dynamics(chain, g),
        chain_parameters(chain, g),
        chain_forward(chain, g),
        chain_rate(chain),
        chain_inverse(chain),
        frames(chain.getNrOfSegments()),
        wrenches(chain.getNrOfSegments(), KDL::Wrench::Zero()),
        q(count()),
        dq(count()),
        ddq(count()),
        tau(count()),
        moving(count()),
        J(count()),
        M(n) {
    const KDL::Tree copy(tree);
    std::vector<bool> is_parent(static_cast<std::size_t>(bodies), false);
    for (int i = 0; i < bodies; ++i) {
      names.push_back(name(i));
      if (robot.body(i).motion != Motion::fixed)
        renumbered.push_back(GetTreeElementQNr(copy.getSegment(names.back())->second));
      if (robot.body(i).parent >= 0) is_parent[static_cast<std::size_t>(robot.body(i).parent)] = true;
    }
    for (int i = 0; i < bodies; ++i)
      if (!is_parent[static_cast<std::size_t>(i)]) leaves.push_back(name(i));
  }
  unsigned count() const { return static_cast<unsigned>(n); }

  void load(KDL::JntArray& to, const double* from) const { std::copy_n(from, n, to.data.data()); }
  void unload(const KDL::JntArray& from, double* to) const { std::copy_n(from.data.data(), n, to); }
  void unload_jacobian(double* to) const {
    for (unsigned r = 0; r < 6; ++r)
      for (unsigned c = 0; c < count(); ++c) to[r * count() + c] = J(r, c);
  }
  void load_renumbered(const double* from) {
    for (unsigned c = 0; c < count(); ++c) q(renumbered[c]) = from[c];
  }
  void unload_renumbered_jacobian(double* to) const {
    for (unsigned r = 0; r < 6; ++r)
      for (unsigned c = 0; c < count(); ++c) to[r * count() + c] = J(r, renumbered[c]);
  }
  static void check(int error) {
    if (error < 0) throw std::runtime_error("KDL error " + std::to_string(error));
  }

  int n, bodies;
  bool is_chain;
  KDL::Vector g;
  KDL::Tree tree;
  KDL::Chain chain;
  KDL::TreeFkSolverPos_recursive tree_poses;
  KDL::TreeJntToJacSolver tree_jacobian;
  KDL::TreeIdSolver_RNE tree_dynamics, tree_dynamics_at_rest;
  KDL::ChainFkSolverPos_recursive chain_poses;
  KDL::ChainJntToJacSolver chain_jacobian;
  KDL::ChainIdSolver_RNE chain_dynamics;
  KDL::ChainDynParam chain_parameters;
  KDL::ChainFdSolver_RNE chain_forward;
  KDL::ChainJntToJacDotSolver chain_rate;
  KDL::ChainIkSolverVel_wdls chain_inverse;
  std::vector<KDL::Frame> frames;
  KDL::Wrenches wrenches;
  KDL::WrenchMap no_wrenches;
  KDL::JntArray q, dq, ddq, tau;
  KDL::JntArrayVel moving;
  KDL::Jacobian J;
  KDL::JntSpaceInertiaMatrix M;
  std::vector<std::string> names, leaves;
  /// KDL's tree solvers for poses and Jacobians copy the tree, and its copy numbers the joints anew.
  std::vector<unsigned> renumbered;
};

KdlOracle::KdlOracle(const Robot& robot) : state_(std::make_unique<State>(robot)) {}
KdlOracle::~KdlOracle() = default;
KdlOracle::KdlOracle(KdlOracle&&) noexcept = default;
KdlOracle& KdlOracle::operator=(KdlOracle&&) noexcept = default;

int KdlOracle::joint_count() const {
  return state_->n;
}
int KdlOracle::body_count() const {
  return state_->bodies;
}

void KdlOracle::pose(int body, const double* q, double* R, double* p) {
  State& s = *state_;
  s.load_renumbered(q);
  KDL::Frame X;
  State::check(s.tree_poses.JntToCart(s.q, X, s.names[static_cast<std::size_t>(body)]));
  store(X, R, p);
}

void KdlOracle::jacobian(int body, const double* point, const double* q, double* J) {
  State& s = *state_;
  const std::string& segment = s.names[static_cast<std::size_t>(body)];
  s.load_renumbered(q);
  KDL::Frame X;
  State::check(s.tree_poses.JntToCart(s.q, X, segment));
  State::check(s.tree_jacobian.JntToJac(s.q, s.J, segment));
  s.J.changeRefPoint(X.M * KDL::Vector(point[0], point[1], point[2]));
  s.unload_renumbered_jacobian(J);
}

void KdlOracle::inverse_dynamics(const double* q, const double* dq, const double* ddq, double* tau) {
  State& s = *state_;
  s.load(s.q, q);
  s.load(s.dq, dq);
  s.load(s.ddq, ddq);
  State::check(s.is_chain ? s.chain_dynamics.CartToJnt(s.q, s.dq, s.ddq, s.wrenches, s.tau)
                          : s.tree_dynamics.CartToJnt(s.q, s.dq, s.ddq, s.no_wrenches, s.tau));
  s.unload(s.tau, tau);
}

void KdlOracle::gravity(const double* q, double* G) {
  State& s = *state_;
  s.load(s.q, q);
  if (s.is_chain) {
    State::check(s.chain_parameters.JntToGravity(s.q, s.tau));
  } else {
    KDL::SetToZero(s.dq);
    KDL::SetToZero(s.ddq);
    State::check(s.tree_dynamics.CartToJnt(s.q, s.dq, s.ddq, s.no_wrenches, s.tau));
  }
  s.unload(s.tau, G);
}

void KdlOracle::coriolis(const double* q, const double* dq, double* Cdq) {
  State& s = *state_;
  s.load(s.q, q);
  s.load(s.dq, dq);
  if (s.is_chain) {
    State::check(s.chain_parameters.JntToCoriolis(s.q, s.dq, s.tau));
  } else {
    KDL::SetToZero(s.ddq);
    State::check(s.tree_dynamics_at_rest.CartToJnt(s.q, s.dq, s.ddq, s.no_wrenches, s.tau));
  }
  s.unload(s.tau, Cdq);
}

void KdlOracle::mass_matrix(const double* q, double* M) {
  State& s = *state_;
  const unsigned n = s.count();
  s.load(s.q, q);
  if (s.is_chain) {
    State::check(s.chain_parameters.JntToMass(s.q, s.M));
    for (unsigned r = 0; r < n; ++r)
      for (unsigned c = 0; c < n; ++c) M[r * n + c] = s.M(r, c);
    return;
  }
  KDL::SetToZero(s.dq);
  for (unsigned c = 0; c < n; ++c) {
    KDL::SetToZero(s.ddq);
    s.ddq(c) = 1;
    State::check(s.tree_dynamics_at_rest.CartToJnt(s.q, s.dq, s.ddq, s.no_wrenches, s.tau));
    for (unsigned r = 0; r < n; ++r) M[r * n + c] = s.tau(r);
  }
}

void KdlOracle::forward_dynamics(const double* q, const double* dq, const double* tau, double* ddq) {
  State& s = *state_;
  if (!s.is_chain) throw std::logic_error("KDL has no forward dynamics of trees");
  s.load(s.q, q);
  s.load(s.dq, dq);
  s.load(s.tau, tau);
  State::check(s.chain_forward.CartToJnt(s.q, s.dq, s.tau, s.wrenches, s.ddq));
  s.unload(s.ddq, ddq);
}

void KdlOracle::jacobian_rate(const double* q, const double* dq, double* dJ) {
  State& s = *state_;
  if (!s.is_chain) throw std::logic_error("KDL has no rates of Jacobians of trees");
  s.load(s.moving.q, q);
  s.load(s.moving.qdot, dq);
  State::check(s.chain_rate.JntToJacDot(s.moving, s.J));
  s.unload_jacobian(dJ);
}

void KdlOracle::damped_inverse(const double* q, const double* twist, double damping, double* dq) {
  State& s = *state_;
  if (!s.is_chain) throw std::logic_error("KDL inverts Jacobians of chains only here");
  s.load(s.q, q);
  s.chain_inverse.setLambda(damping);
  State::check(s.chain_inverse.CartToJnt(
      s.q, {KDL::Vector(twist[0], twist[1], twist[2]), KDL::Vector(twist[3], twist[4], twist[5])}, s.dq));
  s.unload(s.dq, dq);
}

void KdlOracle::peer_poses(const double* q, double* X) {
  State& s = *state_;
  if (s.is_chain) {
    s.load(s.q, q);
    State::check(s.chain_poses.JntToCart(s.q, s.frames));
    const std::size_t mount = s.frames.size() - static_cast<std::size_t>(s.bodies);
    for (std::size_t i = mount; i < s.frames.size(); ++i, X += 12) store(s.frames[i], X, X + 9);
    return;
  }
  s.load_renumbered(q);
  KDL::Frame frame;
  for (const std::string& segment : s.names) {
    State::check(s.tree_poses.JntToCart(s.q, frame, segment));
    store(frame, X, X + 9);
    X += 12;
  }
}

void KdlOracle::peer_jacobian(const double* q, double* J) {
  State& s = *state_;
  if (s.is_chain) {
    s.load(s.q, q);
    State::check(s.chain_jacobian.JntToJac(s.q, s.J));
    s.unload_jacobian(J);
    return;
  }
  s.load_renumbered(q);
  for (const std::string& segment : s.leaves) {
    State::check(s.tree_jacobian.JntToJac(s.q, s.J, segment));
    s.unload_renumbered_jacobian(J);
    J += 6 * s.n;
  }
}

}  // namespace oracle
