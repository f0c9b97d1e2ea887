// SPDX-License-Identifier: BSD-3-Clause
// From the loop to a thread: every cycle's input, command, status, torque shares and times.
#pragma once

#include <array>
#include <vector>

#include "skinctl/cycle/stage.hpp"
#include "skinctl/recording/cycle_bytes.hpp"
#include "skinctl/recording/cycle_ring.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A cycle as a thread beside the loop sees it. Samples and bytes are valid during the call only.
template <class C>
struct CycleRecord {
  using Output = typename C::Output;
  std::uint32_t number = 0;  ///< number of the cycle, from 0; a gap: cycles that found no room
  typename C::Input input;
  typename CycleBytes<C>::Command command;
  Status status;
  decltype(Output::shares) shares{};             ///< torque of each law [N m]
  std::array<Nanoseconds, stage_count> times{};  ///< times of the stages
  std::span<const unsigned char> bytes;          ///< the cycle as `CycleBytes` has it
};

/// Puts cycles of `C` into a ring, and takes them out elsewhere. In the loop it is a recorder of
/// `run_loop`, or `start` once, then the object itself. In one thread beside it: `consume`.
///
/// The loop pays for copying: nothing is encoded, allocated or waited for. Without room a cycle is dropped
/// and counted.
template <class C>
class CycleHandOver {
 public:
  using Format = CycleBytes<C>;
  using Input = typename Format::Input;
  using Output = typename C::Output;

  /// A ring of `bytes`, a power of two from 4 KiB to 1 GiB, else `ConfigurationError`.
  explicit CycleHandOver(std::size_t bytes = std::size_t(16) << 20) : ring_(bytes) {}

  /// Hands over the start of the scene at `measured`.
  void start(const typename Format::State& measured) noexcept { put_start(measured, nullptr); }
  /// Hands over the start of the scene with a robot at `measured` that was told to be at `told`.
  void start(const typename Format::State& measured, const typename Format::Position& told) noexcept {
    put_start(measured, &told);
  }
  /// Hands over a cycle. `watch[stage]` gives the times; a `NoStopwatch` gives zeros.
  template <class Watch>
  void operator()(const Input& input, const Output& out, const Watch& watch) noexcept {
    const auto number = number_++;
    const auto room = ring_.claim(sizeof(Head) + Format::max_size(input));
    if (room.empty()) return;
    Head head;
    head.number = number;
    head.status = out.status.bits();
    for (std::size_t s = 0; s < stage_count; ++s) {
      head.times[s] = watch[static_cast<CycleStage>(s)].count();
    }
    for (std::size_t k = 0; k < laws; ++k)
      for (std::size_t i = 0; i < C::joints; ++i) head.shares[k * C::joints + i] = out.shares[k][i];
    detail::BytePlace place(room.data());
    place.put(&head, sizeof head);
    Format::write(place, input, out.planned);
    ring_.publish(place.size());
  }

  /// Calls `start(Beginning, bytes)` and `cycle(CycleRecord)` for all that came since the last call, oldest
  /// first. Returns their number.
  template <class Start, class Each>
  std::size_t consume(Start&& start, Each&& cycle) {
    return ring_.consume([&](std::span<const unsigned char> bytes) {
      Head head;
      std::memcpy(&head, bytes.data(), sizeof head);
      const auto content = bytes.subspan(sizeof head);
      detail::ByteReader reader(content);
      if (head.begins != 0) {
        const auto begin = Format::read_beginning(reader);
        start(begin, content);
        return;
      }
      CycleRecord<C> record;
      record.number = head.number;
      Format::read(reader, record.input, samples_, record.command);
      record.status = Status::from_bits(head.status);
      for (std::size_t s = 0; s < stage_count; ++s) record.times[s] = Nanoseconds(head.times[s]);
      for (std::size_t k = 0; k < laws; ++k)
        for (std::size_t i = 0; i < C::joints; ++i) record.shares[k][i] = head.shares[k * C::joints + i];
      record.bytes = content;
      cycle(static_cast<const CycleRecord<C>&>(record));
    });
  }
  /// Share of the ring that is not given back yet; for the loop's thread.
  [[nodiscard]] double used() const noexcept { return double(ring_.used()) / double(ring_.bytes()); }
  /// Number of cycles that found no room.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return ring_.dropped(); }

 private:
  static constexpr std::size_t laws = std::tuple_size_v<decltype(Output::shares)>;
  struct Head {
    std::uint32_t begins = 0, number = 0;
    std::uint64_t status = 0;
    std::array<std::int64_t, stage_count> times{};
    std::array<typename C::scalar, laws * C::joints> shares{};
  };
  void put_start(const typename Format::State& measured, const typename Format::Position* told) noexcept {
    const auto room = ring_.claim(sizeof(Head) + Format::fixed_size);
    if (room.empty()) return;
    number_ = 0;
    Head head;
    head.begins = 1;
    detail::BytePlace place(room.data());
    place.put(&head, sizeof head);
    Format::write(place, measured, told);
    ring_.publish(place.size());
  }

  CycleRing ring_;
  std::uint32_t number_ = 0;          // the producer's
  typename Format::Samples samples_;  // the consumer's
};

SKINCTL_END_NAMESPACE
