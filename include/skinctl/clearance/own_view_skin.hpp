// A skin whose proximity does not count what it sees of its own robot.
#pragma once

#include <array>

#include "skinctl/clearance/own_view.hpp"
#include "skinctl/core/state.hpp"
#include "skinctl/sensing/joint_history.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A touch source that needs the robot's state, and nothing that is sensed besides cells.
struct NothingSensed {};

/// The skin `S` whose proximity readings are those of what is foreign: see `OwnView`. For a `Cycle` in place of
/// `S`; of a skin with contacts it is made as `OwnViewSkin(ContactSkin(skin), view)`.
///
/// The prediction follows the measured joints, also for a cell that is silent because its reading is constant.
template <class S, RobotModel M>
class OwnViewSkin : public S {
 public:
  using scalar = typename S::scalar;
  using Sensed = NothingSensed;

  using Joints = JointHistory<M::joints, scalar>;
  /// That of the skin, the raw reading of each cell and its prediction: six bytes a cell. Trivially copyable.
  struct Memory : S::Memory {
    typename Joints::Memory joints;
    Nanoseconds late{0};  ///< of the newest sample's stamp, behind the measured state
    std::array<CellCounts, S::cells> raw{};
    std::array<std::uint16_t, S::cells> own{};
  };

  /// Throws `ConfigurationError` if the view is of another number of cells.
  SKINCTL_COLD OwnViewSkin(const S& skin, const OwnView<M, scalar>& view) : S(skin), view_(view) {
    require(view.size() == S::cells, "OwnViewSkin: cells of the view", double(view.size()),
            "those of the skin");
  }
  [[nodiscard]] const OwnView<M, scalar>& view() const noexcept { return view_; }
  [[nodiscard]] Memory start(Nanoseconds now) const noexcept { return {S::start(now), {}, 0ns, {}, {}}; }

  /// See `S::receive`; the prediction is made for where the robot was at the stamp of the newest sample, up to 16 states
  /// before `measured`; without a sample, for as long ago as last time.
  template <class Means>
  Status receive(Memory& memory, std::span<const CellSample> samples, const Sensed&,
                 const State<M::joints, scalar>& measured, Nanoseconds from, Nanoseconds to,
                 std::size_t parts, Means* means) const noexcept {
    const auto before = memory.own;
    Nanoseconds newest = Nanoseconds::min();
    for (const CellSample& s : samples)
      if (s.time > newest && s.time <= to) newest = s.time;
    if (newest > Nanoseconds::min()) memory.late = newest < measured.time ? measured.time - newest : 0ns;
    // A state that is no later than the last one stands for itself.
    const bool known = joints_.add(memory.joints, measured) == Status{} && memory.late > 0ns;
    view_.look(known ? joints_.at(memory.joints, measured.time - memory.late).state.q : measured.q,
               memory.own);
    return S::receive(memory, samples, from, to, parts, means, Front{view_, memory, before});
  }
  /// See `S::recomputed`.
  [[nodiscard]] Memory recomputed(Memory memory) const noexcept {
    static_cast<typename S::Memory&>(memory) = S::recomputed(memory);
    return memory;
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
