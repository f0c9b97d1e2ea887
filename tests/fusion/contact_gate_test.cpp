#include "skinctl/fusion/contact_gate.hpp"

#include <doctest/doctest.h>

#include <limits>

using namespace skinctl;

namespace {
constexpr Nanoseconds dt = 10ms;
const JointTorque<3> hard{0.9, 0.0, -0.9}, between{0.7, 0.0, 0.0}, weak{0.3, 0.3, 0.0};

ContactDetector::Memory repeated(const ContactDetector& detector, ContactDetector::Memory memory,
                                 const JointTorque<3>& skin, int cycles) {
  for (int k = 0; k < cycles; ++k) memory = detector.advanced(memory, skin, dt);
  return memory;
}
}  // namespace

TEST_CASE(
    "ContactDetector: begins above `on`, lasts between the thresholds, ends when it was quiet for long") {
  const ContactDetector detector({.on = 1, .off = 0.5, .release_after = 100ms});
  CHECK_FALSE(repeated(detector, {}, between, 1000).touched);  // the norm counts, and it must reach `on`
  const auto touched = repeated(detector, {}, hard, 1);
  CHECK(touched.touched);
  CHECK(repeated(detector, touched, between, 1000).touched);
  CHECK(repeated(detector, touched, weak, 10).touched);  // 100 ms are not yet over
  CHECK_FALSE(repeated(detector, touched, weak, 11).touched);
  // A moment of pressure, and the time starts again.
  const auto again = repeated(detector, repeated(detector, touched, weak, 10), between, 1);
  CHECK(repeated(detector, again, weak, 10).touched);
  CHECK_FALSE(repeated(detector, again, weak, 11).touched);
}

TEST_CASE("ContactDetector: a torque that is not finite neither begins nor ends a contact") {
  const ContactDetector detector;
  const JointTorque<3> bad{std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0};
  CHECK_FALSE(repeated(detector, {}, bad, 100).touched);
  CHECK(repeated(detector, repeated(detector, {}, hard, 1), bad, 100).touched);
}

TEST_CASE("ContactDetector: thresholds that cannot work are refused") {
  CHECK_THROWS_AS(ContactDetector({.on = 1, .off = 2}), ConfigurationError);
  CHECK_THROWS_AS(ContactDetector({.on = 1, .off = 0}), ConfigurationError);
  CHECK_THROWS_AS(ContactDetector({.release_after = -1ns}), ConfigurationError);
}
