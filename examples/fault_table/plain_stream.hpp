// A TCP stream of small messages over a network of its own, with nothing of skinctl at its ends: what the
// network and the kernels alone do to it.
#pragma once

#include <string>
#include <vector>

#include "examples/fault_table/network_link.hpp"

namespace fault_table {

/// A sender that puts out one message each period and asks for nothing back.
struct PlainStream {
  std::size_t bytes = 32;  ///< of a message: a command of the main job
  double rate = 125;       ///< of messages [1/s]
  std::string congestion;  ///< algorithm of congestion control; empty: the system's
  int retransmission = 0;  ///< `Stream::set_retransmission_wait` [ms]; 0: the system's
};

/// When the wire is faulty: since the first message [s].
struct FaultyTime {
  double from = 0, until = 1e9;
};

/// Times between two pieces of the stream at its reader, of those that last longer than 3 periods [s]. Throws
/// `adapters::ConnectionError` where the kernel has no such algorithm or refuses the wait, and where the
/// stream breaks before its end.
std::vector<double> stalls(NetworkLink& link, const LinkFault& fault, const PlainStream& stream,
                           double seconds, const FaultyTime& when = {});

}  // namespace fault_table
