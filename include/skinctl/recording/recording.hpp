// SPDX-License-Identifier: BSD-3-Clause
// A run as a file: every input, every command, replayed bit for bit.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <string>

#include "skinctl/core/contract.hpp"
#include "skinctl/cycle/detail/starts_with.hpp"
#include "skinctl/recording/cycle_bytes.hpp"

SKINCTL_BEGIN_NAMESPACE
/// A recorded run of `C`: the state at its start, then every input with its command. `run_loop` begins and
/// fills the recordings that it is given; a loop of your own calls `start` with what it starts the scene
/// with, then `add`.
template <class C>
class Recording {
 public:
  using Format = CycleBytes<C>;
  using State = typename Format::State;
  using Input = typename Format::Input;
  using Command = typename Format::Command;
  using Position = typename Format::Position;

  /// Room for `bytes` bytes; a cycle of a six-joint arm takes about 400 and a sample 44.
  explicit Recording(std::size_t bytes = std::size_t(64) << 20) : bytes_(bytes) {}

  /// Begins with a scene that starts at `measured`. Discards the earlier recording.
  void start(const State& measured) noexcept { start(measured, nullptr); }
  /// Begins with a scene whose robot is at `measured` and was told to be at `told`.
  void start(const State& measured, const Position& told) noexcept { start(measured, &told); }
  /// Adds a cycle; nothing is allocated. Without enough room the cycle and all following ones are dropped:
  /// see `full()`.
  void add(const Input& input, const Command& command) noexcept {
    full_ = full_ || !bytes_.fits(Format::max_size(input));
    if (full_) return;
    Format::write(bytes_, input, command);
    ++cycles_;
  }
  /// Records a cycle as `run_loop` hands it over.
  template <class Output, class Watch>
  void operator()(const Input& input, const Output& output, const Watch&) noexcept {
    add(input, output.planned);
  }
  /// Begins with a start from bytes that `CycleBytes` wrote. Discards the earlier recording; false, and
  /// nothing is left of it, for bytes that are no start.
  bool start(std::span<const unsigned char> bytes) {
    detail::ByteReader reader(bytes);
    static_cast<void>(Format::read_beginning(reader));
    bytes_.clear();
    cycles_ = 0;
    full_ = !bytes_.fits(bytes.size());
    if (full_ || reader.short_of_bytes() || reader.left() != 0) return false;
    bytes_.put(bytes.data(), bytes.size());
    return true;
  }
  /// Adds a cycle from bytes that `CycleBytes` wrote; false for bytes that are no cycle, which are left out.
  bool add(std::span<const unsigned char> bytes) {
    detail::ByteReader reader(bytes);
    Input input;
    Command command;
    typename Format::Samples samples;
    Format::read(reader, input, samples, command);
    full_ = full_ || !bytes_.fits(bytes.size());
    if (full_ || reader.short_of_bytes() || reader.left() != 0) return false;
    bytes_.put(bytes.data(), bytes.size());
    ++cycles_;
    return true;
  }
  [[nodiscard]] std::uint64_t cycles() const noexcept { return cycles_; }
  [[nodiscard]] bool full() const noexcept { return full_; }
  [[nodiscard]] const std::vector<unsigned char>& bytes() const noexcept { return bytes_.bytes(); }

  /// Writes a file. Throws `ConfigurationError` on failure.
  void save(const std::string& path) const {
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "wb"), &std::fclose);
    const auto put = [&](const void* data, std::size_t n) {
      return file != nullptr && (n == 0 || std::fwrite(data, 1, n, file.get()) == n);
    };
    const auto head = header(cycles_);
    if (!put(head.data(), head.size()) || !put(bytes().data(), bytes().size()) ||
        std::fflush(file.get()) != 0)
      SKINCTL_THROW("skinctl: cannot write the recording " + path);
  }
  /// Reads a file of the same kind of scene. Throws `ConfigurationError` for a file that cannot be read, is
  /// damaged, or was recorded by another kind of scene or scalar.
  [[nodiscard]] static Recording load(const std::string& path) {
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
    if (file == nullptr) SKINCTL_THROW("skinctl: cannot read the recording " + path);
    std::vector<unsigned char> all;
    unsigned char block[65536];
    for (std::size_t n; (n = std::fread(block, 1, sizeof block, file.get())) > 0;)
      all.insert(all.end(), block, block + n);
    const auto head = header(0);
    constexpr std::size_t counted = sizeof(std::uint64_t);
    if (all.size() < head.size() || std::memcmp(all.data(), head.data(), head.size() - counted) != 0)
      SKINCTL_THROW("skinctl: " + path +
                    " is no recording of this scene (other robot, goals, scalar or version)");
    Recording out(all.size());
    std::memcpy(&out.cycles_, all.data() + head.size() - counted, counted);
    out.bytes_.put(all.data() + head.size(), all.size() - head.size());
    out.check(path);
    return out;
  }

  /// Calls `start(state)` or `start(state, told)`, then `each(input, command)` for every cycle.
  template <class Start, class Each>
  void visit(Start&& start, Each&& each) const {
    detail::ByteReader reader(bytes());
    const typename Format::Beginning begin = Format::read_beginning(reader);
    if (begin.has_told) {
      start(begin.measured, begin.told);
    } else {
      start(begin.measured);
    }
    typename Format::Samples samples;
    for (std::uint64_t k = 0; k < cycles_ && !reader.short_of_bytes(); ++k) {
      Input input;
      Command command;
      Format::read(reader, input, samples, command);
      each(static_cast<const Input&>(input), static_cast<const Command&>(command));
    }
  }

 private:
  void start(const State& measured, const Position* told) noexcept {
    bytes_.clear();
    cycles_ = 0;
    full_ = !bytes_.fits(Format::fixed_size);
    if (full_) return;
    Format::write(bytes_, measured, told);
  }
  void check(const std::string& path) const {
    detail::ByteReader reader(bytes());
    static_cast<void>(Format::read_beginning(reader));
    typename Format::Samples samples;
    std::uint64_t seen = 0;
    for (; seen < cycles_ && !reader.short_of_bytes(); ++seen) {
      Input input;
      Command command;
      Format::read(reader, input, samples, command);
    }
    if (seen != cycles_ || reader.short_of_bytes() || reader.left() != 0)
      SKINCTL_THROW("skinctl: the recording " + path + " is damaged or cut short");
  }
  /// The head of a file: eight letters, the last of which is the version; `CycleBytes::kind`, which must
  /// agree; the number of cycles.
  static std::vector<unsigned char> header(std::uint64_t cycles) {
    detail::ByteWriter w(64);
    for (const char c : {'S', 'K', 'I', 'N', 'R', 'E', 'C', '6'}) w.put(c);
    for (const std::uint32_t number : Format::kind()) w.put(number);
    w.put(cycles);
    return w.bytes();
  }

  detail::ByteWriter bytes_;
  std::uint64_t cycles_ = 0;
  bool full_ = false;
};

/// The comparison of a replay with its recording.
struct Replayed {
  std::uint64_t cycles = 0;
  std::uint64_t different = 0;        ///< number of cycles whose command is not the same to the bit
  std::uint64_t first_different = 0;  ///< number of the first cycle whose command differs
  Nanoseconds started_at{};           ///< stamp of the recorded start
  Nanoseconds first_state_at{};       ///< stamp of the first cycle's measured state
  /// Largest distance of a joint between the recorded start and the first state [rad] or [m].
  double first_step = 0;
  std::size_t first_step_joint = 0;  ///< joint with the distance `first_step`, counted from 1; 0: none
};

/// A sentence about a replay: the number of commands that differ, and then how the recorded start and the
/// first state differ. A recording that was not begun where its scene was started shows there.
[[nodiscard]] inline std::string in_words(const Replayed& r) {
  if (r.different == 0) return "every command is the same to the bit";
  char states[160];
  std::snprintf(states, sizeof states,
                "; recorded start at %.6f s, first state at %.6f s, apart by at most %.6f (joint %zu)",
                seconds<double>(r.started_at), seconds<double>(r.first_state_at), r.first_step,
                r.first_step_joint);
  const std::string words = std::to_string(r.different) + " commands differ, the first in cycle " +
                            std::to_string(r.first_different) + states;
  const bool later = r.started_at > r.first_state_at, at_once = r.first_different == 0;
  if (!later && !(at_once && r.started_at == r.first_state_at)) return words;
  return words + ": that is no start of the scene, which came before; let run_loop begin the recording";
}

/// Runs a recording through `cycle` and compares every command to the bit. The same program gives the same
/// bits; another compiler or instruction set rounds differently.
template <class C>
[[nodiscard]] Replayed replay(const C& cycle, const Recording<C>& recording) {
  Replayed result;
  const auto memory = std::make_unique<typename C::Memory>();
  const auto same_bits = [](auto a, auto b) {
    detail::ByteWriter x(1024), y(1024);
    each_number(a, [&](const auto& v) { x.put(v); });
    each_number(b, [&](const auto& v) { y.put(v); });
    return x.bytes() == y.bytes();
  };
  typename Recording<C>::State started;
  // A file that says where the robot was told to be, of a scene that does not ask for it, is no recording of
  // it.
  const auto start = [&]<class... Told>(const auto& measured, const Told&... told) {
    started = measured;
    if constexpr (detail::StartsWith<C, decltype(measured), Told...>) cycle.start(*memory, measured, told...);
  };
  recording.visit(start, [&](const auto& input, const auto& command) {
    if (result.cycles == 0) {
      result.started_at = started.time;
      result.first_state_at = input.measured.time;
      for (std::size_t i = 0; i < C::joints; ++i) {
        const auto step = static_cast<double>(std::abs(input.measured.q[i] - started.q[i]));
        if (step > result.first_step) result.first_step = step, result.first_step_joint = i + 1;
      }
    }
    const auto out = cycle.step(*memory, input);
    if (!same_bits(out.planned, command) && result.different++ == 0) result.first_different = result.cycles;
    ++result.cycles;
  });
  return result;
}

SKINCTL_END_NAMESPACE
