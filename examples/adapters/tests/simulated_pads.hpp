// Pads that are pressed in a test: what their sensors read of a known force, and lines on which they write
// it.
#pragma once

#include <doctest/doctest.h>
#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <span>
#include <string>

#include "examples/adapters/skin/any_skin.hpp"
#include "skinctl/testing/random.hpp"

namespace simulated_pads {

/// The near end of a new pseudo terminal; a device opens `name`.
struct Terminal {
  Terminal() : fd(::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    REQUIRE(fd.get() >= 0);
    REQUIRE(::grantpt(fd.get()) == 0);
    REQUIRE(::unlockpt(fd.get()) == 0);
    name = ::ptsname(fd.get());
  }
  void write(std::span<const std::uint8_t> bytes) const {
    REQUIRE(::write(fd.get(), bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  }
  adapters::can::Descriptor fd;
  std::string name;
};

/// Five magnetometers under a skin: a field at rest, what a newton adds to it, noise of 1 uT. A press is
/// nearest to the middle; it bends the skin a little more than in proportion.
class MagneticPad {
 public:
  explicit MagneticPad(unsigned seed) : random_(seed) {
    for (double& b : rest_) b = random_.between(-800, 800);
    for (auto& row : per_newton_)
      for (double& b : row) b = random_.between(-60, 60);
  }
  /// @param force  normal, shear x, shear y [N].  @param warmth  above the temperature at which it rested
  /// [K].
  adapters::skin::AnySkinPacket read(const std::array<double, 3>& force, double warmth = 0) {
    adapters::skin::AnySkinPacket packet{};
    for (std::size_t chip = 0; chip < adapters::skin::AnySkin::chips; ++chip) {
      packet[4 * chip] = static_cast<float>(24 + warmth + 0.1 * double(chip));
      for (std::size_t axis = 0; axis < 3; ++axis) {
        double field = rest_[3 * chip + axis] * (1 - 0.001 * warmth) + random_();
        for (std::size_t c = 0; c < 3; ++c)
          field += per_newton_[3 * chip + axis][c] * force[c] * (1 + 0.005 * std::abs(force[c]));
        packet[4 * chip + 1 + axis] = static_cast<float>(0.15 * std::round(field / 0.15));
      }
    }
    return packet;
  }

 private:
  skinctl::testing::Seeded random_;
  std::array<double, 15> rest_{};
  std::array<std::array<double, 3>, 15> per_newton_{};
};

}  // namespace simulated_pads
