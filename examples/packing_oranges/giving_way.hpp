// How an arm gives way to what it sees: away with all joints, but not through the oranges that lie around its hand.
#pragma once

#include <Eigen/Cholesky>
#include <span>

#include "examples/packing_oranges/tomm.hpp"
#include "skinctl/clearance/retreat.hpp"

namespace packing {

/// Joint velocities of an arm that gives way: `Retreat`, which also keeps the hand clear of oranges that lie, so that it does
/// not push them off their places, and a hand that is low would rather go up.
template <class R>
class GivingWay {
 public:
  using A = Arm<R>;
  /// What an arm sees, and all oranges.
  static constexpr std::size_t most = near_most + arms * slots;
  using Plan = skinctl::Retreat<typename A::Model, most>;
  using Others = typename Plan::Others;

  /// @param carry  height from which a hand is over everything [m].
  explicit GivingWay(std::size_t arm, double carry, const Trays& trays = first_trays)
      : X_BW_(A::base(arm).inverse()),
        carry_(carry),
        retreat_(typename A::Model{},
                 {.own = A::clearance_at_work(arm, trays).own,
                  .exposed = A::clearance_at_work(arm, trays).exposed},
                 A::home()) {}

  /// At `q` beside what is seen; `lying`: middles of the oranges that are neither in the hand nor between its fingers.
  [[nodiscard]] skinctl::JointVelocity<6> operator()(const skinctl::JointPosition<6>& q,
                                                     const skinctl::Surroundings<near_most>& seen,
                                                     std::span<const skinctl::Xyz<double>> lying,
                                                     Others others = Others::stay) const {
    using namespace skinctl;
    Surroundings<most> near;
    near.time = seen.time;
    for (std::size_t i = 0; i < seen.count && i < near_most; ++i) near.add(seen.obstacles[i]);
    for (const auto& p : lying) near.add(X_BW_ * Obstacle<skinctl::World>{{p, p, kept_from}, 0});
    return retreat_(q, near, others, up(q));
  }

 private:
  /// The hand's capsule is wider than fingers that hold: with its margin, their middle stays 0.12 m from an orange's.
  static constexpr double kept_from = 0.02;

  [[nodiscard]] skinctl::JointVelocity<6> up(const skinctl::JointPosition<6>& q) const {
    skinctl::JointVelocity<6> out;
    if (A::hand(q).origin().z >= carry_) return out;
    Eigen::Matrix<double, 3, 6> J;
    skinctl::jacobian<5>(skinctl::link_poses(typename A::Model{}, q), A::tool())
        .for_each([&](auto j, const auto& c) {
          J.col(static_cast<Eigen::Index>(j.value)) << c.linear.x, c.linear.y, c.linear.z;
        });
    const Eigen::Vector3d v(0, 0, 0.6);
    const Eigen::Matrix3d square = J * J.transpose() + 0.01 * Eigen::Matrix3d::Identity();
    const Eigen::Matrix<double, 6, 1> dq = J.transpose() * square.ldlt().solve(v);
    for (std::size_t i = 0; i < 6; ++i) out[i] = dq[static_cast<Eigen::Index>(i)];
    return out;
  }

  skinctl::Transform<skinctl::Base, skinctl::World> X_BW_;
  double carry_;
  Plan retreat_;
};

}  // namespace packing
