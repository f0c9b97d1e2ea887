// Sees touches in what skin and joints report, on a real robot as on a simulated one.
#pragma once

#include <span>
#include <vector>

#include "examples/compliant_ur5/run_log.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/frames/transform.hpp"
#include "skinctl/sensing/cell_sample.hpp"

namespace compliant_ur5 {

/// A cell as the observer needs it.
struct ObservedCell {
  std::uint32_t id = 0;
  int link = 0;
  skinctl::Xyz<double> position{}, normal{};  ///< link's frame
};

/// A touch begins when a link feels more than 1 N and ends when it has felt less than 0.5 N for 0.5 s.
/// Allocates for a new touch only, and outside of the real-time part.
class TouchObserver {
 public:
  TouchObserver(std::vector<ObservedCell> cells, double newtons_per_reading, double rest_reading);

  /// One cycle: the samples, where the joints are, and where the task wants them. `t` in seconds.
  void cycle(double t, std::span<const skinctl::CellSample> samples, const skinctl::JointPosition<6>& q,
             const skinctl::JointPosition<6>& task);

  /// The same without cells: a force [N] on link `felt.link`, at `felt.position`, against `felt.normal`.
  void cycle(double t, double force, const ObservedCell& felt, const skinctl::JointPosition<6>& q,
             const skinctl::JointPosition<6>& task);

  /// The force on the link that feels most [N].
  [[nodiscard]] double force() const noexcept { return force_; }
  [[nodiscard]] const std::vector<TouchSummary>& touches() const noexcept { return touches_; }
  [[nodiscard]] bool touching() const noexcept { return touching_; }

  /// Where a place of a link is in the base's frame [m], and a direction of the base along the axes of a
  /// link.
  [[nodiscard]] static skinctl::Xyz<double> point(const skinctl::JointPosition<6>& q,
                                                  const ObservedCell& at) noexcept;
  [[nodiscard]] static skinctl::Xyz<double> in_link(const skinctl::JointPosition<6>& q, int link,
                                                    const skinctl::Xyz<double>& direction) noexcept;

 private:
  using Poses = std::array<skinctl::Transform<skinctl::Base, skinctl::FrameTag>, 6>;
  static Poses poses(const skinctl::JointPosition<6>& q) noexcept;
  [[nodiscard]] skinctl::Xyz<double> place(const Poses& poses) const noexcept;
  void follow(double t, const ObservedCell& felt, const skinctl::JointPosition<6>& q,
              const skinctl::JointPosition<6>& task);
  static void felt_by(TouchSummary& touch, const ObservedCell& cell) noexcept;

  std::vector<ObservedCell> cells_;
  std::vector<std::size_t> index_;  ///< by id
  std::vector<float> reading_;
  double newtons_, rest_, force_ = 0;
  std::vector<TouchSummary> touches_;
  bool touching_ = false;
  double quiet_since_ = 0;
  ObservedCell touched_;  ///< where the present or last touch began
  skinctl::Xyz<double> from_{}, normal_{};
};

}  // namespace compliant_ur5
