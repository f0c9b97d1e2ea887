// SPDX-License-Identifier: BSD-3-Clause
// A skin whose proximity does not count what it sees of its own robot.
#pragma once

#include <array>

#include "skinctl/clearance/own_view.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/sensing/joint_history.hpp"
#include "skinctl/tactile/touch.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The skin `S` whose proximity does not count the robot itself and known objects: see `OwnView`. For a
/// `Cycle` in place of `S`; of a skin with contacts it is made as `OwnViewSkin(ContactSkin(skin), view)`.
///
/// The prediction follows the measured joints, also for a cell that is silent because its reading is
/// constant.
template <class S, RobotModel M>
class OwnViewSkin : public WrappedTouch<OwnViewSkin<S, M>, S, NoSensors> {  // the state is what it adds
  using Base = WrappedTouch<OwnViewSkin, S, NoSensors>;

 public:
  using scalar = typename Base::scalar;

  using Joints = JointHistory<M::joints, scalar>;
  /// The skin's memory, the raw reading of each cell and its prediction: six bytes a cell. Trivially
  /// copyable.
  struct Memory : S::Memory {
    typename Joints::Memory joints;
    Nanoseconds late{0};  ///< time from the newest sample's stamp to that of the measured state
    std::array<CellCounts, S::cells> raw{};
    std::array<std::uint16_t, S::cells> own{};
  };

  /// Throws `ConfigurationError` if the view is of another number of cells.
  SKINCTL_COLD OwnViewSkin(const S& skin, const OwnView<M, scalar>& view) : Base(skin), view_(view) {
    require(view.size() == S::cells, "OwnViewSkin: cells of the view", double(view.size()),
            "those of the skin");
  }
  [[nodiscard]] const OwnView<M, scalar>& view() const noexcept { return view_; }

  /// Takes samples: see `S::receive`. The prediction is made for where the robot was at the stamp of the
  /// newest sample, up to 16 states before `measured`; without a sample, for as long ago as last time.
  template <class Given, class Means>
  Status take(Memory& memory, const Given& in, Means* means) const noexcept {
    const State<M::joints, scalar>& measured = in.measured;
    const auto before = memory.own;
    Nanoseconds newest = Nanoseconds::min();
    for (const CellSample& s : in.samples)
      if (s.time > newest && s.time <= in.to) newest = s.time;
    if (newest > Nanoseconds::min()) memory.late = newest < measured.time ? measured.time - newest : 0ns;
    // A state that is no later than the last one stands for itself.
    const bool known = joints_.add(memory.joints, measured) == Status{} && memory.late > 0ns;
    view_.look(known ? joints_.at(memory.joints, measured.time - memory.late).state.q : measured.q,
               memory.own);
    return this->take_on(memory, in, means, Front{view_, memory, before});
  }

 private:
  struct Front {
    const OwnView<M, scalar>& view;
    Memory& memory;
    const std::array<std::uint16_t, S::cells>& before;

    [[nodiscard]] SKINCTL_INLINE CellCounts reading(std::size_t i, const CellSample& sample) const noexcept {
      memory.raw[i] = counts(sample);
      return {memory.raw[i].force, view.foreign(memory.raw[i].proximity, memory.own[i])};
    }
    template <class Revise>
    void settle(const Revise& revise) const noexcept {
      for (std::size_t i = 0; i < S::cells; ++i) {
        if (memory.own[i] == before[i]) continue;
        const CellCounts raw = memory.raw[i];
        if (raw.proximity != 0) revise(i, {raw.force, view.foreign(raw.proximity, memory.own[i])});
      }
    }
  };
  OwnView<M, scalar> view_;
  Joints joints_{8ms};
};

SKINCTL_END_NAMESPACE
