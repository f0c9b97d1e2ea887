// needs: kdl
// The peer's file with the same content.
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainidsolver_recursive_newton_euler.hpp>
#include <kdl/chainjnttojacsolver.hpp>

int main() {
  KDL::Chain chain;
  for (int i = 0; i < 6; ++i) {
    chain.addSegment(KDL::Segment(KDL::Joint(KDL::Joint::RotZ), KDL::Frame::DH(0.1, 1.57, 0.1, 0),
                                  KDL::RigidBodyInertia(1, KDL::Vector(0, 0, 0.1))));
  }
  const KDL::Vector gravity(0, 0, -9.81);
  KDL::ChainFkSolverPos_recursive poses(chain);
  KDL::ChainJntToJacSolver jacobian(chain);
  KDL::ChainIdSolver_RNE inverse_dynamics(chain, gravity);
  KDL::ChainDynParam parameters(chain, gravity);

  const KDL::JntArray q(6);
  const KDL::JntArray dq(6);
  const KDL::JntArray ddq(6);
  KDL::Frame pose;
  KDL::Jacobian J(6);
  KDL::JntArray tau(6);
  KDL::JntArray G(6);
  KDL::JntSpaceInertiaMatrix M(6);
  poses.JntToCart(q, pose);
  jacobian.JntToJac(q, J);
  inverse_dynamics.CartToJnt(q, dq, ddq, KDL::Wrenches(6), tau);
  parameters.JntToGravity(q, G);
  parameters.JntToMass(q, M);
  return static_cast<int>(pose.p.x() + J(0, 0) + tau(0) + G(0) + M(0, 0));
}
