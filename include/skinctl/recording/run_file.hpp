// SPDX-License-Identifier: BSD-3-Clause
// A run on its way into an MCAP file, without its scene: what `McapRecorder` calls. The bodies are in
// `detail/run_file_body.hpp`, or compiled once by CMake's `skinctl::io`.
#pragma once

#include <map>
#include <memory>
#include <span>
#include <string>

#include "skinctl/recording/cycle_numbers.hpp"
#include "skinctl/recording/run_description.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The topics of a run that replays, and the encodings of their messages: the bytes of `CycleBytes`.
struct CycleTopic {
  static constexpr const char* start = "/skinctl/start";
  static constexpr const char* cycle = "/skinctl/cycle";
  static constexpr const char* start_encoding = "x-skinctl-start";
  static constexpr const char* cycle_encoding = "x-skinctl-cycle";
};

/// The MCAP file that `McapRecorder` writes of a run.
class RunFile {
 public:
  /// Opens `path`, in place of an existing file, and writes `facts` (see `RunIdentity`). `joints` and `laws`
  /// are the numbers of both in the scene. Throws `ConfigurationError` for a file that cannot be opened, and
  /// where `RunMessages` does.
  RunFile(const std::string& path, const std::map<std::string, std::string>& facts, RunDescription run,
          std::size_t joints, std::size_t laws);
  RunFile(const RunFile&) = delete;
  RunFile& operator=(const RunFile&) = delete;
  ~RunFile();

  /// Writes the beginning of a run, by which it replays; robot and skin for those who look at it.
  void start(Nanoseconds now, std::span<const unsigned char> bytes);
  /// Writes one cycle, and the pictures and the status that are due with it.
  void cycle(const CycleNumbers& numbers);
  /// Closes the chunk after a second; `dropped`: cycles that found no room so far.
  void pause(std::uint64_t dropped);
  /// Writes the summary. False if anything was lost on the way.
  bool finish();
  /// Number of cycles that were written.
  [[nodiscard]] std::uint64_t cycles() const noexcept;
  /// Number of messages that a full disk refused.
  [[nodiscard]] std::uint64_t lost() const noexcept;
  /// Size of the file [bytes].
  [[nodiscard]] std::uint64_t size() const noexcept;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

SKINCTL_END_NAMESPACE
