// SPDX-License-Identifier: BSD-3-Clause
// A ring of bytes from the loop to a thread that writes and sends.
#pragma once

#include <atomic>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "skinctl/core/contract.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Records of any size from one thread to one other, in order, without lock, wait or allocation.
///
/// The producer claims room, fills it and publishes; a record never wraps around the end of the memory,
/// before which a mark is left that the consumer skips. Without room the record is dropped and counted: a
/// loop is never late because a disk or a reader is slow.
class CycleRing {
 public:
  /// `bytes` is a power of two from 4 KiB to 1 GiB, else `ConfigurationError`. All of it is touched here, so
  /// that the loop meets no page fault.
  explicit CycleRing(std::size_t bytes = std::size_t(16) << 20) {
    require(bytes >= 4096 && bytes <= (std::size_t(1) << 30) && (bytes & (bytes - 1)) == 0,
            "CycleRing: bytes", double(bytes), "a power of two from 2^12 to 2^30");
    memory_.resize(bytes / sizeof(Word));
  }
  CycleRing(const CycleRing&) = delete;
  CycleRing& operator=(const CycleRing&) = delete;

  /// Producer: room for `most` bytes, aligned to 8. Empty if there is none, or if it is more than half of the
  /// ring; then the record counts as dropped.
  [[nodiscard]] std::span<unsigned char> claim(std::size_t most) noexcept {
    const std::size_t size = bytes();
    if (most > size / 2 - header) {
      drop();
      return {};
    }
    const std::size_t need = header + padded(most), place = head_ & (size - 1);
    const std::size_t skipped = need > size - place ? size - place : 0;
    if (head_ + skipped + need - seen_tail_ > size) {
      seen_tail_ = tail_.load(std::memory_order_acquire);
      if (head_ + skipped + need - seen_tail_ > size) {
        drop();
        return {};
      }
    }
    if (skipped != 0) {
      put_header(place, skip);
      head_ += skipped;
    }
    return {at(head_ & (size - 1)) + header, most};
  }
  /// Producer: hands over the first `used` bytes of what was claimed last.
  void publish(std::size_t used) noexcept {
    put_header(head_ & (bytes() - 1), static_cast<std::uint64_t>(used));
    head_ += header + padded(used);
    published_.store(head_, std::memory_order_release);
  }
  /// Consumer: calls `f(bytes)` for each record that is there, oldest first, and gives its room back. Returns
  /// the number of records.
  template <class F>
  std::size_t consume(F&& f) {
    const std::uint64_t until = published_.load(std::memory_order_acquire);
    std::uint64_t from = tail_.load(std::memory_order_relaxed);
    std::size_t records = 0;
    while (from != until) {
      const std::size_t place = from & (bytes() - 1);
      std::uint64_t used = 0;
      std::memcpy(&used, at(place), sizeof used);
      if (used == skip) {
        from += bytes() - place;
      } else {
        f(std::span<const unsigned char>(at(place) + header, used));
        from += header + padded(used);
        ++records;
      }
      tail_.store(from, std::memory_order_release);
    }
    return records;
  }
  /// Number of records that found no room; for any thread.
  [[nodiscard]] std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }
  /// Producer: bytes that the consumer has not given back yet.
  [[nodiscard]] std::size_t used() const noexcept {
    return static_cast<std::size_t>(head_ - tail_.load(std::memory_order_acquire));
  }
  [[nodiscard]] std::size_t bytes() const noexcept { return memory_.size() * sizeof(Word); }

 private:
  using Word = std::uint64_t;
  static constexpr std::size_t header = sizeof(Word);
  static constexpr std::uint64_t skip = ~std::uint64_t(0);

  static std::size_t padded(std::size_t n) noexcept { return (n + header - 1) & ~(header - 1); }
  [[nodiscard]] unsigned char* at(std::size_t place) noexcept {
    return reinterpret_cast<unsigned char*>(memory_.data()) + place;
  }
  void put_header(std::size_t place, std::uint64_t value) noexcept {
    std::memcpy(at(place), &value, sizeof value);
  }
  void drop() noexcept {
    dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
  }

  std::vector<Word> memory_;
  // The producer's line, the consumer's, and what the producer tells: apart, so that neither waits for the
  // other's.
  alignas(64) std::uint64_t head_ = 0;  // bytes ever claimed and published
  std::uint64_t seen_tail_ = 0;
  alignas(64) std::atomic<std::uint64_t> published_{0};
  std::atomic<std::uint64_t> dropped_{0};
  alignas(64) std::atomic<std::uint64_t> tail_{0};  // bytes ever consumed
};

SKINCTL_END_NAMESPACE
