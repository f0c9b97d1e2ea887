// Switches a hand's servo off when the program that drives it dies without doing so.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "examples/adapters/allegro/datagrams.hpp"
#include "examples/adapters/allegro/frames.hpp"
#include "examples/adapters/can/link.hpp"

namespace adapters::allegro {

using can::Descriptor;
using can::FrameSocket;
using can::SlcanCodec;
using can::SlcanLink;

/// A hand keeps its last torque when its computer falls silent: no time-out of the maker's is known. Signals
/// and exceptions stop it through the driver; this covers SIGKILL and crashes. A second process shares the
/// link's descriptor, sleeps, and when the first one ends without a farewell writes the last words. It does
/// not cover a computer that hangs or loses its power.
class Guardian {
 public:
  /// One message per write.
  using Words = std::vector<std::vector<std::uint8_t>>;

  /// Forks. `link` is the descriptor of an open, connected link. Throws `ConnectionError`.
  Guardian(int link, Words last_words);
  /// The farewell: nothing is written any more.
  ~Guardian();
  Guardian(const Guardian&) = delete;
  Guardian& operator=(const Guardian&) = delete;

 private:
  Descriptor alive_;
  int child_ = -1;
};

/// No torque, servo off, no more positions, for hand number `hand` behind this kind of link.
[[nodiscard]] Guardian::Words last_words(const FrameSocket& link, unsigned hand);
[[nodiscard]] Guardian::Words last_words(const SlcanLink& link, unsigned hand);
/// For a V5 Sense by UDP: three times no torque.
[[nodiscard]] Guardian::Words last_words_of_udp();

}  // namespace adapters::allegro
