// Skin torque with KDL behind plain arrays: cell by cell as the paper writes it, and link by link.
#pragma once

#include <memory>
#include <vector>

#include "tests/support/robot_table.hpp"

namespace skinctl::bench {

/// A cell: its link, its place on it, and its unit wrench about the link's origin.
struct KdlCell {
  int link;
  double p[3];
  double u[6];
};

/// The strongest use of KDL that we know: its chain solver, which allocates nothing, told where to stop. The
/// header shows neither KDL nor Eigen; kdl_skin.cpp is built for the distribution's baseline.
class KdlSkin {
 public:
  /// `robot` is a chain of revolute joints; the cells come link by link.
  KdlSkin(const oracle::Robot& robot, std::vector<KdlCell> cells);
  ~KdlSkin();
  KdlSkin(KdlSkin&&) noexcept;

  /// `sum J_cell' F_cell` with a Jacobian for every cell.
  void per_cell(const double* q, const double* newton, double* tau);
  /// The cells' wrenches added up on each link, then one Jacobian for every link.
  void per_link(const double* q, const double* newton, double* tau);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace skinctl::bench
