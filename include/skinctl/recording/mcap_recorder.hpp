// SPDX-License-Identifier: BSD-3-Clause
// Records a run into an MCAP file while it runs: what replays, and what people look at. The file is written
// by the bodies in `detail/run_file_body.hpp`, in each file that includes this, or in one source of the
// program by CMake's `skinctl::io`.
#pragma once

#include "skinctl/recording/cycle_thread.hpp"
#include "skinctl/recording/numbers_of.hpp"
#include "skinctl/recording/run_file.hpp"
#include "skinctl/recording/run_identity.hpp"
#ifndef SKINCTL_COMPILED_IO
#include "skinctl/recording/detail/run_file_body.hpp"
#endif

SKINCTL_BEGIN_NAMESPACE

/// The consumer that writes an MCAP file: every cycle as it is replayed, joint states and torque shares of
/// every cycle, cells, contacts and frames at 30 Hz, the status at 10 Hz, robot and skin once. A full disk
/// costs messages, which are counted.
template <class C>
class McapRecorder : public CycleConsumer<C> {
 public:
  using typename CycleConsumer<C>::Beginning;

  /// Replaces an existing file. Throws `ConfigurationError` where it cannot be made, and where `RunMessages`
  /// does.
  McapRecorder(const std::string& path, const RunIdentity& identity, RunDescription run)
      : file_(path, identity.facts<C>(), std::move(run), NumbersOf<C>::joints, NumbersOf<C>::laws) {}

  void start(const Beginning& begin, std::span<const unsigned char> bytes) override {
    file_.start(begin.measured.time, bytes);
  }
  void cycle(const CycleRecord<C>& r) override { file_.cycle(numbers_(r)); }
  /// Called while no cycle comes: closes the chunk after a second, also where the loop stands.
  void pause(std::uint64_t dropped) override { file_.pause(dropped); }
  /// Writes the summary, after the thread's end. False if a message or a cycle was lost on the way; see
  /// `lost`.
  bool finish() { return file_.finish(); }
  [[nodiscard]] std::uint64_t cycles() const noexcept { return file_.cycles(); }
  /// Number of messages that a full disk refused.
  [[nodiscard]] std::uint64_t lost() const noexcept { return file_.lost(); }
  /// Size of the file [bytes].
  [[nodiscard]] std::uint64_t size() const noexcept { return file_.size(); }

 private:
  RunFile file_;
  NumbersOf<C> numbers_;
};

SKINCTL_END_NAMESPACE
