// Sends skin datagrams: what a bridge from another skin, or a simulation, needs.
#pragma once

#include <array>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/udp.hpp>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "examples/adapters/skin/authentication.hpp"
#include "examples/adapters/skin/datagram.hpp"
#include "examples/adapters/skin/lights.hpp"

namespace adapters::skin {

/// Packs samples into datagrams of version 3 to one receiver. Throws `ConnectionError` for an address that
/// is none; sending does not throw, wait or allocate.
class Sender {
 public:
  /// With a key the datagrams are sealed, and answer the receiver's questions.
  Sender(const std::string& host, std::uint16_t port, std::optional<Key> key = {});

  /// Sends `samples`, whose times are of the clock that shows `now`; without samples a heartbeat. Samples
  /// whose time is after `now` are refused by the receiver. Returns how many datagrams went out.
  template <skinctl::SensorKind Kind = skinctl::Hexagon>
  std::size_t send(std::span<const skinctl::SampleOf<Kind>> samples, skinctl::Nanoseconds now) noexcept {
    listen();
    std::size_t sent = 0;
    do {
      const auto some =
          samples.first(std::min(samples.size(), max_samples(skinctl::KindTable<Kind>::readings)));
      samples = samples.subspan(some.size());
      sent += pass_on(write<Kind>(buffer_, sequence_++, now, some, key_ ? &question_ : nullptr));
    } while (!samples.empty());
    return sent;
  }
  std::size_t send(std::span<const skinctl::CellSample> samples, skinctl::Nanoseconds now) noexcept {
    return send<skinctl::Hexagon>(samples, now);
  }
  /// As if the next datagram had gone out and were lost on its way.
  void skip() noexcept { ++sequence_; }
  /// Datagrams that the system did not take.
  [[nodiscard]] std::uint64_t failed() const noexcept { return failed_; }
  /// With a key: the receiver's questions so far. 0: nobody asks, and nothing will be taken.
  [[nodiscard]] std::uint64_t asked() const noexcept { return asked_; }
  /// The picture that the receiver wants the lights of the cells to show, until `lights_shown` has said that
  /// they do; null: there is none. An old one that somebody repeats is none.
  [[nodiscard]] const Picture* wanted() const noexcept { return wants_ ? &picture_ : nullptr; }
  /// Tells the receiver that the lights are as `wanted` says.
  void lights_shown() noexcept;
  /// What came in place of a question or a picture, of another key for example.
  [[nodiscard]] std::uint64_t foreign() const noexcept { return foreign_; }

 private:
  void listen() noexcept;
  std::size_t pass_on(std::size_t size) noexcept;
  bool push(std::span<const std::uint8_t> bytes) noexcept;

  boost::asio::io_context io_;
  boost::asio::ip::udp::socket socket_;
  std::optional<Key> key_;
  std::array<std::uint8_t, largest> buffer_{};
  Question question_{};  ///< the newest; zeros: none yet
  Picture picture_{};    ///< the newest
  bool wants_ = false;   ///< it is not shown yet, or its answer was lost
  std::uint64_t failed_ = 0, asked_ = 0, foreign_ = 0;
  std::uint32_t sequence_ = 0;
};

}  // namespace adapters::skin
