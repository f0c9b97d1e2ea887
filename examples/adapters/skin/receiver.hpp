// Receives skin datagrams and puts their samples on the robot's clock.
#pragma once

#include <bit>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "examples/adapters/skin/authentication.hpp"
#include "examples/adapters/skin/datagram.hpp"
#include "examples/adapters/skin/lights.hpp"
#include "skinctl/sensing/clock_offset.hpp"
#include "skinctl/sensing/unrest.hpp"

namespace adapters::skin {

struct ReceiverConfig {
  std::string address = "127.0.0.1";  ///< of this computer; 0.0.0.0 or ::, all its addresses
  std::uint16_t port = 0;             ///< 0: any
  std::string sender{};               ///< the only address that is listened to; empty: any
  /// Only datagrams that this key made are taken, and only answers to this receiver's questions; none: only
  /// open ones.
  std::optional<Key> key{};
  /// With a key: sealed datagrams of version 2 are taken too, until the first of version 3. Their sender
  /// hears no questions: a recording of it is taken as well.
  bool version_2 = false;
  skinctl::Nanoseconds oldest =
      std::chrono::milliseconds(100);  ///< a sample so long before its sending is refused
  skinctl::Nanoseconds forget =
      std::chrono::milliseconds(200);  ///< after so long without datagrams another sender may begin
  std::size_t max_samples = 16384;     ///< of one poll; more stay in the socket until the next
  std::size_t max_datagrams = 1024;    ///< looked at in one poll, whoever sends them
  std::size_t buffer = 4 << 20;        ///< that the system is asked for [bytes]; see `Receiver::buffer`
  /// Standard deviation of a force reading at rest, as declared [steps]: above 0.3, cells that say that
  /// they have no unrest are reported as frozen. 0: not declared.
  double noise = 0;
  std::size_t max_cells = 4096;               ///< watched for that
  skinctl::ClockOffset::Settings clock = {};  ///< of the sender's clock
  /// The time of the polls passes as this computer's does: the sender's clock is compared with the
  /// computer's, when the system received a datagram. false: with the time of the poll that reads it, as for
  /// a simulated robot that is slower or faster.
  bool real_time = true;
};

/// What arrived and what was refused, since the start.
struct Statistics {
  std::uint64_t datagrams = 0, samples = 0;
  std::uint64_t lost = 0;         ///< gaps in the sequence numbers
  std::uint64_t nonsense = 0;     ///< datagrams that are none of ours
  std::uint64_t other_kind = 0;   ///< datagrams of another kind of cells
  std::uint64_t strangers = 0;    ///< datagrams from another sender
  std::uint64_t unsealed = 0;     ///< with a key: datagrams without a seal
  std::uint64_t sealed = 0;       ///< without a key: datagrams with a seal, which nobody here can check
  std::uint64_t version_2 = 0;    ///< with a key: datagrams of version 2, which answer no question
  std::uint64_t forged = 0;       ///< with a key: datagrams with a wrong tag
  std::uint64_t unasked = 0;      ///< with a key: datagrams that answer no question of the last 100 ms
  std::uint64_t deaf = 0;         ///< with a key: datagrams of a sender that has heard no question yet
  std::uint64_t late = 0;         ///< datagrams that are repeated or overtaken
  std::uint64_t bad_samples = 0;  ///< implausible samples
  std::uint64_t repeated = 0;     ///< samples for which nothing was measured: old readings
  std::uint64_t untimed = 0;      ///< samples before the sender's clock was known, see `ClockOffset`
  std::uint64_t leaps = 0;        ///< leaps of the sender's clock
  std::uint64_t frozen = 0;       ///< cells now without unrest, see `ReceiverConfig::noise`
  std::uint64_t restarts = 0;     ///< new beginnings of the sender; without a key: of any, after a silence

  /// Datagrams that are not of our sender. Those of `unasked` and `deaf` may be: its first ones are.
  [[nodiscard]] std::uint64_t stray() const noexcept {
    return nonsense + other_kind + strangers + unsealed + sealed + version_2 + forged;
  }
};
/// The refused datagrams with their causes, for a person; empty: none were refused.
[[nodiscard]] std::string refusals(const Statistics& statistics);

/// A bound UDP socket, for cells of any kind: see `ReceiverOf`.
class ReceiverCore {
 public:
  ReceiverCore(const ReceiverCore&) = delete;
  ReceiverCore& operator=(const ReceiverCore&) = delete;
  virtual ~ReceiverCore();

  /// How long nothing of the sender's has arrived, by the robot's clock.
  [[nodiscard]] skinctl::Nanoseconds silent_for(skinctl::Nanoseconds now) const noexcept {
    return now - heard_at_;
  }
  [[nodiscard]] bool heard() const noexcept { return statistics_.datagrams > 0; }
  [[nodiscard]] const Statistics& statistics() const noexcept { return statistics_; }
  /// The frozen cells in words; empty: there are none.
  [[nodiscard]] std::string frozen() const;
  /// Leaps of the sender's clock, new beginnings of the sender and their price, in words; empty: none.
  [[nodiscard]] std::string leaps() const;
  /// From the next poll on the lights of these cells, and of no others, are to be on: the sender is told in
  /// each poll, at most every 20 ms, until it has answered. Throws `ConfigurationError` for ids that are
  /// farther apart than a `Picture` has room for.
  void show(std::span<const std::uint32_t> lit);
  /// Whether the sender has answered that they are.
  [[nodiscard]] bool shown() const noexcept { return picture_.number == 0 || shown_ == picture_.number; }
  [[nodiscard]] std::uint16_t port() const { return socket_.local_endpoint().port(); }
  /// The buffer that the system gave [bytes]. Linux cuts it at /proc/sys/net/core/rmem_max.
  [[nodiscard]] std::size_t buffer() const noexcept { return buffer_; }

 protected:
  /// What is asked of a kind.
  struct Kind {
    std::uint32_t fingerprint = 0;
    std::size_t readings = 0, sensors = 0;  ///< numbers of a sample; of these pressures
    std::size_t most = 0;                   ///< samples of a datagram
  };
  ReceiverCore(const ReceiverConfig& config, const Kind& kind);

  /// Takes what has arrived.
  void receive(skinctl::Nanoseconds now) noexcept;
  /// Takes the samples of a datagram of this kind; the sender's clock is known.
  virtual void take(const Datagram& datagram) noexcept = 0;
  /// Whether a sample is a measurement to be passed on; counts it, and whether its cell stands still.
  /// `at_zero`: none of its pressures reads anything.
  bool counts(bool plausible, std::uint32_t cell, std::uint16_t measured, std::uint16_t unrest,
              bool at_zero) noexcept;
  [[nodiscard]] skinctl::Nanoseconds stamp(skinctl::Nanoseconds t) const noexcept {
    return skinctl::ClockOffset::stamp(clock_memory_, t) + robot_ahead_;
  }
  [[nodiscard]] const ReceiverConfig& config() const noexcept { return config_; }

 private:
  struct Batch;

  void receive(std::span<const std::uint8_t> bytes, const void* from, std::size_t from_size,
               skinctl::Nanoseconds now, skinctl::Nanoseconds arrived) noexcept;
  bool admit(const Datagram& datagram, std::span<const std::uint8_t> bytes, const void* from,
             std::size_t from_size, skinctl::Nanoseconds now) noexcept;
  bool open(const Datagram& datagram, const void* from, std::size_t from_size,
            skinctl::Nanoseconds now) noexcept;
  bool sealed(const Datagram& datagram, std::span<const std::uint8_t> bytes, const void* from,
              std::size_t from_size, skinctl::Nanoseconds now) noexcept;
  bool session(const Datagram& datagram) noexcept;
  bool follows(std::int64_t step) noexcept;
  void ask(const void* to, std::size_t to_size) noexcept;
  void tell_lights(skinctl::Nanoseconds now) noexcept;
  bool is_sender(const void* from, std::size_t from_size) const noexcept;
  void watch(std::uint32_t cell, std::uint16_t measured, std::uint16_t unrest, bool at_zero) noexcept;
  void hear(const Datagram& datagram, skinctl::Nanoseconds arrived) noexcept;

  ReceiverConfig config_;
  boost::asio::io_context io_;
  boost::asio::ip::udp::socket socket_;
  std::unique_ptr<Batch> batch_;
  std::array<std::uint8_t, 32> sender_{};  ///< as the system writes addresses
  std::size_t sender_size_ = 0;
  std::array<std::uint8_t, 16> only_{};  ///< `config.sender`
  std::size_t only_size_ = 0;
  struct Watched {
    std::uint32_t cell = 0;
    skinctl::Stillness still;
  };
  std::vector<Watched> watched_;  ///< in the order of their ids
  std::uint16_t frozen_after_ = 65535;
  Kind kind_;
  std::size_t taken_ = 0;  ///< samples of this poll
  Statistics statistics_;
  std::size_t buffer_ = 0;
  Questions questions_;
  Picture picture_{};        ///< wanted; number 0: none
  std::uint64_t shown_ = 0;  ///< number of the picture that the sender has answered last
  std::optional<skinctl::Nanoseconds> told_lights_{};  ///< when it was sent
  std::size_t replies_ = 0;                            ///< left in this poll
  std::uint64_t session_ = 0;                          ///< newest one of version 2
  bool answers_ = false;                               ///< a datagram of version 3 was sealed
  bool has_sender_ = false;
  std::uint32_t newest_ = 0;
  skinctl::Nanoseconds heard_at_{};
  std::optional<skinctl::Nanoseconds> polled_;  ///< time of the last poll, by the clock of the arrivals
  skinctl::Nanoseconds robot_ahead_{};          ///< the robot's clock less that of the arrivals
  skinctl::ClockOffset clock_;                  ///< the sender's clock against that of the arrivals
  skinctl::ClockOffset::Memory clock_memory_;
};

/// Receives the samples of cells of one kind. Throws `ConnectionError` where the socket cannot be bound,
/// `ConfigurationError` for a setting that cannot work; after that nothing throws or allocates.
template <skinctl::SensorKind K>
class ReceiverOf final : public ReceiverCore {
  using Table = skinctl::KindTable<K>;

 public:
  using Sample = skinctl::SampleOf<K>;

  explicit ReceiverOf(const ReceiverConfig& config)
      : ReceiverCore(config,
                     {Table::fingerprint(), Table::readings,
                      static_cast<std::size_t>(std::popcount(Table::pressed_readings)),
                      std::is_same_v<K, skinctl::Hexagon> ? most_hexagons : max_samples(Table::readings)}) {
    samples_.reserve(config.max_samples);
  }

  /// The samples that have arrived, on the robot's clock, which shows `now`; the sender's clock is followed
  /// by a `ClockOffset`, which first listens for a tenth of a second.
  ///
  /// What is no datagram of the sender's is counted and dropped; the sender's own go on. Time is bounded by
  /// `max_datagrams` and `max_samples`. With a key it asks: the sender every 20 ms, and whoever holds the
  /// key and has not heard the newest question, at once.
  std::span<const Sample> poll(skinctl::Nanoseconds now) noexcept {
    samples_.clear();
    receive(now);
    return samples_;
  }

 private:
  void take(const Datagram& datagram) noexcept override {
    for (std::size_t i = 0; i < datagram.count(); ++i) {
      Sample s = datagram.sample<K>(i);
      const auto& x = skinctl::detail::readings_of(s);
      bool at_zero = true;
      for (std::size_t r = 0; r < x.size(); ++r)
        at_zero = at_zero && (((Table::pressed_readings >> r) & 1u) == 0 || x[r] == 0);
      if (!counts(plausible(s, datagram, config().oldest), s.cell, s.measured, s.unrest, at_zero)) continue;
      s.time = stamp(s.time);
      samples_.push_back(s);
    }
  }

  std::vector<Sample> samples_;
};

using Receiver = ReceiverOf<skinctl::Hexagon>;

}  // namespace adapters::skin
