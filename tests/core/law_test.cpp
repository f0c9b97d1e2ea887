#include "skinctl/core/law.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <string>

using namespace skinctl;

namespace {
struct Knowledge {
  static constexpr std::size_t joints = 2;
  using scalar = double;
};
struct Good {
  struct Memory {};
  static constexpr Needs needs{};
  static constexpr Role role = Role::reactive;
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
  static constexpr Role role = Role::reactive;
  Memory start(const Knowledge&) const noexcept { return {}; }
  JointTorque<2> torque(const Memory&, const Knowledge&) const noexcept { return {}; }
};
static_assert(!Law<HeavyMemory, Knowledge>);  // a cycle copies memories, and replays them
static_assert(!Law<OtherSize, Knowledge> && !Law<GivesVelocity, Knowledge> &&
              !Law<DoesNotAdvance, Knowledge>);
static_assert(!Law<std::function<JointTorque<2>()>, Knowledge> && !Law<double, Knowledge>);
}  // namespace

TEST_CASE("Share: all of feedback and feed-forward unless said otherwise") {
  CHECK(Share<double>{}.feedback == 1);
  CHECK(Share<float>{}.feed_forward == 1);
}
