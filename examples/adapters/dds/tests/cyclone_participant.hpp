// Cyclone DDS as the other side of tests.
#pragma once

#include <dds/dds.h>

#include <cstdint>

namespace adapters::dds::testing {

/// Cyclone's participant in a domain, on loopback, which looks for others at the ports of the first ten. Once
/// a domain.
[[nodiscard]] inline dds_entity_t cyclone_participant(std::uint32_t domain) {
  dds_create_domain(domain,
                    "<General><Interfaces><NetworkInterface address='127.0.0.1'/></Interfaces>"
                    "<AllowMulticast>false</AllowMulticast></General>"
                    "<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>10"
                    "</MaxAutoParticipantIndex><Peers><Peer address='127.0.0.1'/></Peers></Discovery>");
  return dds_create_participant(domain, nullptr, nullptr);
}

}  // namespace adapters::dds::testing
