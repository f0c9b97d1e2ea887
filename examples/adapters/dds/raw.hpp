// DDS as ROS 2 speaks it, without ROS: topics whose samples are the bytes that skinctl encodes. Over Fast
// DDS.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "skinctl/io/message_type.hpp"

namespace adapters::dds {

/// How messages of a topic are delivered, as ROS 2 has it.
enum class Delivery {
  sensor,  ///< best effort, the last one: a frame that is late is not sent again
  state,   ///< reliable, the last one
  latched  ///< reliable, the last one, also for readers that come later
};

struct ParticipantOptions {
  std::uint32_t domain = 0;             ///< 0 to 232; ROS_DOMAIN_ID
  std::string interface = "127.0.0.1";  ///< the only address that is opened
  std::string name = "skinctl";
};

/// Takes part in a domain over UDPv4 on one address. Others are looked for at the ports of the first four
/// participants of each host: this one's on loopback; on another interface by multicast. Threads of Fast DDS
/// serve it.
class Participant {
 public:
  /// Throws `skinctl::ConfigurationError` where the domain or the address cannot be used.
  explicit Participant(const ParticipantOptions& options);
  ~Participant();
  Participant(Participant&&) noexcept;
  Participant& operator=(Participant&&) = delete;

 private:
  friend class RawWriter;
  friend class RawReader;
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Writes messages of one topic. Not for the loop: a write is a system call in the calling thread.
class RawWriter {
 public:
  /// `topic` as ROS 2 names it, "/skin/cells"; DDS calls it "rt/skin/cells". A message has at most `most`
  /// bytes. The participant must live longer. Throws `skinctl::ConfigurationError`.
  RawWriter(Participant& participant, const std::string& topic, const skinctl::MessageType& type,
            Delivery delivery, std::size_t most);
  ~RawWriter();
  RawWriter(RawWriter&&) noexcept;
  RawWriter& operator=(RawWriter&&) = delete;

  /// Sends a message of CDR bytes. False if it is too long or the middleware refused it.
  bool write(std::span<const unsigned char> message);
  /// Readers that have been found.
  [[nodiscard]] int readers() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Reads messages of one topic; only the last one is kept.
class RawReader {
 public:
  /// Longer messages than `most` bytes are not taken. Throws like `RawWriter`.
  RawReader(Participant& participant, const std::string& topic, const skinctl::MessageType& type,
            Delivery delivery, std::size_t most);
  ~RawReader();
  RawReader(RawReader&&) noexcept;
  RawReader& operator=(RawReader&&) = delete;

  /// The newest message since the last call, if there is one: CDR bytes of anybody, perhaps padded. They stay
  /// until the next call.
  [[nodiscard]] std::optional<std::span<const unsigned char>> take();
  /// Waits until there is a message, or the time is over; returns whether there is one.
  bool wait(std::chrono::milliseconds time);
  [[nodiscard]] int writers() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace adapters::dds
