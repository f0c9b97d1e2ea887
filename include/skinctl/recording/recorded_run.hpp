// SPDX-License-Identifier: BSD-3-Clause
// A recorded run, read from its MCAP file.
#pragma once

#include "skinctl/recording/mcap_file.hpp"
#include "skinctl/recording/recording.hpp"
#include "skinctl/recording/run_file.hpp"
#include "skinctl/recording/run_identity.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The result of `load_run`.
template <class C>
struct LoadedRun {
  Recording<C> recording;
  bool whole = true;                 ///< whether the file is whole; a cut one replays up to the cut
  std::uint64_t missing_cycles = 0;  ///< cycles that the file skips: a recorder that had no room
};

/// Reads the run of a file. Cycles after one that is missing cannot be replayed, so they are left out and
/// counted. Throws `ConfigurationError` for a file that cannot be read, is no MCAP, has no run or a damaged
/// one, or is of another scene, build or kind than `identity`.
template <class C>
[[nodiscard]] LoadedRun<C> load_run(const std::string& path, const RunIdentity& identity) {
  const MappedFile file(path);
  std::size_t size = 0;
  const auto contents = read_mcap(file.bytes(), [&](const McapMessage& m) {
    if (m.channel.topic == CycleTopic::start || m.channel.topic == CycleTopic::cycle) size += m.bytes.size();
  });
  if (!contents.is_mcap) refuse("skinctl: " + path + ": no MCAP file");
  const auto facts = contents.metadata.find(RunIdentity::name);
  if (facts == contents.metadata.end()) refuse("skinctl: " + path + ": no run that replays");
  identity.check<C>(path, facts->second);
  if (const std::string missing = contents.left_out(); !missing.empty())
    refuse("skinctl: " + path + ": " + missing);
  LoadedRun<C> out{Recording<C>(size + 4096)};
  out.whole = contents.whole;
  bool began = false, fits = true;
  std::uint32_t expected = 0;
  static_cast<void>(read_mcap(file.bytes(), [&](const McapMessage& m) {
    if (m.channel.encoding == CycleTopic::start_encoding && !began) {
      began = true;
      fits = fits && out.recording.start(m.bytes);
    } else if (m.channel.encoding == CycleTopic::cycle_encoding && fits) {
      // Sequence numbers count what the loop handed over; a gap is what found no room.
      out.missing_cycles += m.sequence - expected;
      expected = m.sequence + 1;
      fits = out.missing_cycles > 0 || (began && out.recording.add(m.bytes));
    }
  }));
  if (!began || !fits) refuse("skinctl: " + path + ": the run is damaged, or has no start");
  return out;
}

/// The result of a file's replay.
struct ReplayedRun : Replayed {
  bool whole = true;                 ///< whether the file is whole; a cut one was replayed up to the cut
  std::uint64_t missing_cycles = 0;  ///< cycles that the file skips: replayed up to the first of them
};

/// Runs `cycle` once more on the inputs of a file, and compares every command. Throws where `load_run` does.
template <class C>
[[nodiscard]] ReplayedRun replay(const std::string& path, const C& cycle, const RunIdentity& identity) {
  const auto run = load_run<C>(path, identity);
  return {replay(cycle, run.recording), run.whole, run.missing_cycles};
}

SKINCTL_END_NAMESPACE
