// Pads of other makers, passed on as datagrams of their own kinds: see `adapters::skin::ReceiverOf`.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "examples/adapters/skin/sender.hpp"
#include "examples/adapters/udp.hpp"
#include "examples/support/exit.hpp"

namespace skin_bridge {

struct Counters {
  std::uint64_t samples = 0, messages = 0, refused = 0;
};
/// What a pad's packets become, until `ended`.
struct Passing {
  adapters::skin::Sender& to;
  Counters& count;
  const std::function<bool()>& ended;
};

/// An AnySkin at a serial line, as cell `cell` of kind `AnySkin`. `lost` where the line ends.
examples::job::Exit from_any_skin(const std::string& device, std::uint32_t cell, const Passing& passing);
/// A TF-Luna at a serial line, as cell `cell` of kind `TfLuna`. `lost` where the line ends.
examples::job::Exit from_tf_luna(const std::string& device, std::uint32_t cell, const Passing& passing);
/// XELA's server, as cells of kind `XelaForces`, or `XelaCounts`. Stamps follow the server's clock, where it
/// tells one. `lost` where the server goes.
examples::job::Exit from_xela(const std::string& host, std::uint16_t port, bool forces,
                              const Passing& passing);

/// A PapillArray's controller, as cells of kind `PapillArray`, 500 packets a second. Stamps follow the
/// controller's clock. `lost` where the line ends.
examples::job::Exit from_papill_array(const std::string& device, bool bias, const Passing& passing);

/// A line with skin datagrams of any kind, each of which is sent to `to` as it is. `lost` where the line
/// ends.
examples::job::Exit from_datagram_line(const std::string& device, unsigned speed, adapters::UdpSocket& to,
                                       Counters& count, const std::function<bool()>& ended);

}  // namespace skin_bridge
