#include "skinctl/law/law.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <string>

#include "skinctl/law/detail/check_law.hpp"

using namespace skinctl;

namespace {
struct Knowledge {
  static constexpr std::size_t joints = 2;
  using scalar = double;
};
struct Good {
  struct Memory {};
  static constexpr Needs needs{};
  static constexpr LawRole role = LawRole::reactive;
  Memory start(const Knowledge&) const noexcept { return {}; }
  JointTorque<2> torque(const Memory&, const Knowledge&) const noexcept { return {}; }
  Memory advance(const Memory&, const Knowledge&, double, Opposition) const noexcept { return {}; }
};
static_assert(Law<Good, Knowledge>);

struct HeavyMemory : Good {
  struct Memory {
    std::string text;
  };
  Memory start(const Knowledge&) const { return {}; }
  JointTorque<2> torque(const Memory&, const Knowledge&) const { return {}; }
  Memory advance(const Memory&, const Knowledge&, double, Opposition) const { return {}; }
};
struct OtherSize : Good {
  JointTorque<3> torque(const Memory&, const Knowledge&) const noexcept { return {}; }
};
struct GivesVelocity : Good {
  JointVelocity<2> torque(const Memory&, const Knowledge&) const noexcept { return {}; }
};
struct DoesNotAdvance {
  using Memory = Good::Memory;
  static constexpr Needs needs{};
  static constexpr LawRole role = LawRole::reactive;
  Memory start(const Knowledge&) const noexcept { return {}; }
  JointTorque<2> torque(const Memory&, const Knowledge&) const noexcept { return {}; }
};
static_assert(!Law<HeavyMemory, Knowledge>);  // a cycle copies memories, and replays them
static_assert(!Law<OtherSize, Knowledge> && !Law<GivesVelocity, Knowledge> &&
              !Law<DoesNotAdvance, Knowledge>);
static_assert(!Law<std::function<JointTorque<2>()>, Knowledge> && !Law<double, Knowledge>);
struct Throws : Good {
  JointTorque<2> torque(const Memory&, const Knowledge&) const { return {}; }
};
static_assert(!Law<Throws, Knowledge>);  // nothing throws in the loop

/// All that a law without memory states.
struct Short : StatelessLaw<Short> {
  JointTorque<2> torque(const auto&) const noexcept { return {}; }
};
struct AlsoShort : StatelessLaw<AlsoShort> {
  JointTorque<2> torque(const auto&) const noexcept { return {}; }
};
static_assert(Law<Short, Knowledge> && !TrackingLaw<Short, Knowledge> && !GoalLaw<Short, Knowledge>);
static_assert(std::is_empty_v<Short> && std::is_empty_v<Short::Memory>);
static_assert(!std::is_same_v<Short::Memory, AlsoShort::Memory>);  // side by side they take no room
struct NoTorque : StatelessLaw<NoTorque> {};
static_assert(!Law<NoTorque, Knowledge>);

struct InParts : StatelessLaw<InParts> {
  static constexpr LawRole role = LawRole::tracking;
  TorqueParts<2> parts(const auto&) const noexcept { return {}; }
};
static_assert(TrackingLaw<InParts, Knowledge>);
struct TracksByTorqueAlone : Good {
  static constexpr LawRole role = LawRole::tracking;
};
static_assert(Law<TracksByTorqueAlone, Knowledge> && !TrackingLaw<TracksByTorqueAlone, Knowledge>);

struct TakesGoals : Good {
  using Goal = double;
  Received<Memory> receive(const Memory& m, const Knowledge&, double) const noexcept { return {m, {}}; }
};
static_assert(GoalLaw<TakesGoals, Knowledge> && !GoalLaw<Good, Knowledge>);

// What is said where a sum or a scene is built; tests/compile_fail has the texts.
using detail::LawFault;
struct NamesNoGoal : Good {
  Received<Memory> receive(const Memory& m, const Knowledge&, double) const noexcept { return {m, {}}; }
};
struct ReceivesNothing : Good {
  using Goal = double;
};
static_assert(detail::fault_in_members<Good>() == LawFault::none);
static_assert(detail::fault_in_members<Short>() == LawFault::none);
static_assert(detail::fault_in_members<InParts>() == LawFault::none);
static_assert(detail::fault_in_members<TakesGoals>() == LawFault::none);
static_assert(detail::fault_in_members<NoTorque>() == LawFault::no_torque);
static_assert(detail::fault_in_members<DoesNotAdvance>() == LawFault::no_advance);
static_assert(detail::fault_in_members<HeavyMemory>() == LawFault::heavy_memory);
static_assert(detail::fault_in_members<NamesNoGoal>() == LawFault::no_goal);
static_assert(detail::fault_in_members<ReceivesNothing>() == LawFault::no_receive);
static_assert(Law<detail::WrongLaw<NoTorque>, Knowledge>);  // it stands for a law after an error
}  // namespace

TEST_CASE("a law's faults are found at compile time") {
  CHECK(detail::fault_in_members<NamesNoGoal>() == LawFault::no_goal);
}
