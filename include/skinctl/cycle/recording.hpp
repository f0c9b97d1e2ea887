// A run as a file: every input, every command, replayed bit for bit.
#pragma once

#include <bit>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "skinctl/core/contract.hpp"
#include "skinctl/cycle/cycle.hpp"
#include "skinctl/sensing/wrench_sample.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail {

/// Appends plain values to bytes reserved before: never allocates.
class ByteWriter {
 public:
  explicit ByteWriter(std::size_t capacity) { bytes_.reserve(capacity); }
  [[nodiscard]] bool fits(std::size_t n) const noexcept { return bytes_.capacity() - bytes_.size() >= n; }
  template <class V>
  void put(const V& value) noexcept {
    static_assert(std::is_arithmetic_v<V>);
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof value);  // within the capacity, else the record is dropped: see `fits`
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  [[nodiscard]] const std::vector<unsigned char>& bytes() const noexcept { return bytes_; }
  void clear() noexcept { bytes_.clear(); }

 private:
  std::vector<unsigned char> bytes_;
};

/// Reads plain values from bytes; past the end it gives zeros and sets a flag.
class ByteReader {
 public:
  explicit ByteReader(const std::vector<unsigned char>& bytes) noexcept : bytes_(bytes) {}
  template <class V>
  V get() noexcept {
    static_assert(std::is_arithmetic_v<V>);
    V value{};
    if (bytes_.size() - at_ < sizeof value) {
      short_ = true;
      at_ = bytes_.size();
      return value;
    }
    if constexpr (std::is_same_v<V, bool>) {
      value = bytes_[at_] != 0;
    } else {
      std::memcpy(&value, bytes_.data() + at_, sizeof value);
    }
    at_ += sizeof value;
    return value;
  }
  [[nodiscard]] std::size_t left() const noexcept { return bytes_.size() - at_; }
  [[nodiscard]] bool short_of_bytes() const noexcept { return short_; }

 private:
  const std::vector<unsigned char>& bytes_;
  std::size_t at_ = 0;
  bool short_ = false;
};

template <class C, class... Begin>
concept StartsWith = requires(const C& cycle, typename C::Memory& memory, const Begin&... begin) {
  cycle.start(memory, begin...);
};

}  // namespace detail

/// Calls `f(number)` for each plain number of a value. For goals of your own laws, overload
/// `each_number(goal, f)` in their namespace. A duration is a whole number of nanoseconds.
template <class F>
void each_number(Nanoseconds& t, F&& f) {
  std::int64_t count = t.count();
  f(count);
  t = Nanoseconds(count);
}
template <class K, std::size_t N, class T, class F>
void each_number(JointVector<K, N, T>& v, F&& f) {
  for (T& x : v) f(x);
}
template <std::size_t N, class T, class F>
void each_number(State<N, T>& s, F&& f) {
  each_number(s.time, f);
  each_number(s.q, f);
  each_number(s.dq, f);
}
template <std::size_t N, class T, class F>
void each_number(JointCommand<N, T>& c, F&& f) {
  each_number(c.time, f);
  each_number(c.position, f);
  each_number(c.velocity, f);
  each_number(c.acceleration, f);
  each_number(c.torque, f);
  f(c.valid);
}
template <class F>
void each_number(CellSample& s, F&& f) {
  each_number(s.time, f);
  f(s.cell);
  for (float& x : s.force) f(x);
  f(s.proximity);
  for (float& x : s.acceleration) f(x);
  f(s.temperature);
}
template <class F>
void each_number(WrenchSample& s, F&& f) {
  each_number(s.time, f);
  for (double& x : s.force) f(x);
  for (double& x : s.moment) f(x);
}
template <class F>
void each_number(GripperState& s, F&& f) {
  each_number(s.time, f);
  auto error = static_cast<std::uint8_t>(s.error);
  f(s.opening), f(s.force), f(s.heard), f(s.moving), f(s.holding), f(s.measured), f(error), f(s.code);
  s.error = static_cast<GripperError>(error);
}
template <class F>
void each_number(NoGoal&, F&&) {}
template <class G, class F>
  requires requires(G& g) {
    g.q_g;
    g.duration;
  }
void each_number(G& goal, F&& f) {
  each_number(goal.q_g, f);
  each_number(goal.duration, f);
}
template <class G, class F>
  requires requires(G& g) {
    g.q_d;
    g.dq_d;
  }
void each_number(G& goal, F&& f) {
  each_number(goal.q_d, f);
  each_number(goal.dq_d, f);
  if constexpr (requires { goal.ddq_d; }) each_number(goal.ddq_d, f);
}

template <class T, class F>
void each_number(Xyz<T>& v, F&& f) {
  f(v.x), f(v.y), f(v.z);
}
template <Frame A, Frame B, class T, class F>
void each_number(Transform<A, B, T>& X, F&& f) {
  auto R = X.axes();
  auto p = X.origin();
  for (Xyz<T>* v : {&R.x, &R.y, &R.z, &p}) each_number(*v, f);
  X = Transform<A, B, T>::trusted(R, p);
}
template <class G, class F>
  requires requires(G& g) { g.X_BP; }
void each_number(G& goal, F&& f) {
  each_number(goal.X_BP, f);
  if constexpr (requires { goal.duration; }) each_number(goal.duration, f);
  if constexpr (requires { goal.V; }) {
    for (auto* v : {&goal.V.linear, &goal.V.angular, &goal.A.linear, &goal.A.angular}) each_number(*v, f);
  }
}
template <class G, class F>
  requires requires(G& g) {
    g.direction;
    g.force;
  }
void each_number(G& goal, F&& f) {
  each_number(goal.direction, f);
  f(goal.force);
}

/// A recorded run of `C`: the state at its start, then every input with its command.
template <class C>
class Recording {
 public:
  using State = skinctl::State<C::joints, typename C::scalar>;
  using Input = typename C::Input;
  using Command = JointCommand<C::joints, typename C::scalar>;

  /// Room for `bytes` bytes; a cycle of a six-joint arm takes about 400 and a sample 48.
  explicit Recording(std::size_t bytes = std::size_t(64) << 20) : bytes_(bytes) {}

  using Position = JointPosition<C::joints, typename C::scalar>;

  /// The scene starts at `measured`. Discards the earlier recording.
  void start(const State& measured) noexcept { start(measured, nullptr); }
  /// The scene starts with a robot at `measured` that was told to be at `told`.
  void start(const State& measured, const Position& told) noexcept { start(measured, &told); }
  /// Adds a cycle; nothing is allocated. Without enough room the cycle and all following ones are dropped:
  /// see `full()`.
  void add(const Input& input, const Command& command) noexcept {
    std::size_t size = fixed_size + input.samples.size() * sample_size;
    if constexpr (has_wrenches) size += input.sensed.wrenches.size() * wrench_size;
    full_ = full_ || !bytes_.fits(size);
    if (full_) return;
    bytes_.put(input.now.count());
    write(input.measured);
    bytes_.put(static_cast<std::uint8_t>(input.request));
    bytes_.put(input.observed.bits());
    bytes_.put(input.has_goal);
    write(input.goal);
    if constexpr (configured) bytes_.put(input.configuration);
    bytes_.put(static_cast<std::uint32_t>(input.samples.size()));
    for (const CellSample& s : input.samples) write(s);
    if constexpr (has_wrenches) {
      bytes_.put(static_cast<std::uint32_t>(input.sensed.wrenches.size()));
      for (const WrenchSample& s : input.sensed.wrenches) write(s);
    }
    if constexpr (has_motors) write(input.sensed.motor_torque);
    if constexpr (has_gripper) write(input.gripper);
    if constexpr (has_weights) write(input.sensed.patch_weights);
    write(command);
    ++cycles_;
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
    for (std::size_t i = head.size(); i < all.size(); ++i) out.bytes_.put(all[i]);
    out.check(path);
    return out;
  }

  /// Calls `start(state)` or `start(state, told)`, then `each(input, command)` for every cycle.
  template <class Start, class Each>
  void visit(Start&& start, Each&& each) const {
    detail::ByteReader reader(bytes());
    const Beginning begin = read_start(reader);
    if (begin.has_told) {
      start(begin.measured, begin.told);
    } else {
      start(begin.measured);
    }
    Samples samples;
    for (std::uint64_t k = 0; k < cycles_ && !reader.short_of_bytes(); ++k) {
      Input input;
      Command command;
      read_cycle(reader, input, samples, command);
      each(static_cast<const Input&>(input), static_cast<const Command&>(command));
    }
  }

 private:
  static constexpr bool has_gripper = requires { requires C::has_gripper; };
  static constexpr bool has_weights = requires(const Input& input) { input.sensed.patch_weights; };
  static constexpr bool configured = requires(const Input& input) { input.configuration; };
  static constexpr bool has_wrenches = requires(const Input& input) { input.sensed.wrenches; };
  static constexpr bool has_motors = requires(const Input& input) { input.sensed.motor_torque; };
  static constexpr std::size_t sample_size = 8 + 4 + 8 * 4, wrench_size = 8 + 6 * 8;
  /// The samples of the input that was read last.
  struct Samples {
    std::vector<CellSample> cells;
    std::vector<WrenchSample> wrenches;
  };
  static constexpr std::size_t fixed_size = sizeof(Input) + sizeof(Command) + 64;

  struct Beginning {
    State measured;
    bool has_told = false;
    Position told;
  };
  void start(const State& measured, const Position* told) noexcept {
    bytes_.clear();
    cycles_ = 0;
    full_ = !bytes_.fits(fixed_size);
    if (full_) return;
    write(measured);
    bytes_.put(told != nullptr);
    if (told != nullptr) write(*told);
  }
  static Beginning read_start(detail::ByteReader& reader) {
    Beginning begin;
    read(reader, begin.measured);
    begin.has_told = reader.get<bool>();
    if (begin.has_told) read(reader, begin.told);
    return begin;
  }

  template <class V>
  void write(V value) noexcept {
    each_number(value, [this](const auto& x) { bytes_.put(x); });
  }
  template <class V>
  static void read(detail::ByteReader& reader, V& value) {
    each_number(value, [&](auto& x) { x = reader.get<std::remove_cvref_t<decltype(x)>>(); });
  }
  template <class Sample>
  static void read_samples(detail::ByteReader& reader, std::size_t size, std::vector<Sample>& samples) {
    const std::size_t count = reader.get<std::uint32_t>();
    samples.resize(count <= reader.left() / size ? count : 0);
    for (Sample& s : samples) read(reader, s);
  }
  static void read_cycle(detail::ByteReader& reader, Input& input, Samples& samples, Command& command) {
    read(reader, input.now);
    read(reader, input.measured);
    const auto request = reader.get<std::uint8_t>();
    input.request = request <= 2 ? static_cast<CycleRequest>(request) : CycleRequest::none;
    input.observed = Status::from_bits(reader.get<std::uint64_t>());
    input.has_goal = reader.get<bool>();
    read(reader, input.goal);
    if constexpr (configured) input.configuration = reader.get<std::uint32_t>();
    read_samples(reader, sample_size, samples.cells);
    input.samples = samples.cells;
    if constexpr (has_wrenches) {
      read_samples(reader, wrench_size, samples.wrenches);
      input.sensed.wrenches = samples.wrenches;
    }
    if constexpr (has_motors) read(reader, input.sensed.motor_torque);
    if constexpr (has_gripper) read(reader, input.gripper);
    if constexpr (has_weights) read(reader, input.sensed.patch_weights);
    read(reader, command);
  }
  void check(const std::string& path) const {
    detail::ByteReader reader(bytes());
    static_cast<void>(read_start(reader));
    Samples samples;
    std::uint64_t seen = 0;
    for (; seen < cycles_ && !reader.short_of_bytes(); ++seen) {
      Input input;
      Command command;
      read_cycle(reader, input, samples, command);
    }
    if (seen != cycles_ || reader.short_of_bytes() || reader.left() != 0)
      SKINCTL_THROW("skinctl: the recording " + path + " is damaged or cut short");
  }
  /// Magic (its last letter: with or without configurations, wrenches, motor torques, a gripper and weights of patches), byte order, sizes
  /// that must agree, number of cycles last.
  static std::vector<unsigned char> header(std::uint64_t cycles) {
    detail::ByteWriter w(64);
    constexpr char kind = "3XNDEyneGhijklmo4YOFAzpqHIJKLMPQ"[(has_weights ? 16 : 0) + (has_gripper ? 8 : 0) +
                                                             (configured ? 4 : 0) + (has_motors ? 2 : 0) +
                                                             (has_wrenches ? 1 : 0)];
    for (const char c : {'S', 'K', 'I', 'N', 'R', 'E', 'C', kind}) w.put(c);
    w.put(std::uint32_t(0x01020304));
    w.put(static_cast<std::uint32_t>(C::joints));
    w.put(static_cast<std::uint32_t>(sizeof(typename C::scalar)));
    w.put(static_cast<std::uint32_t>(sizeof(typename C::Goal)));
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
  std::uint64_t first_different = 0;  ///< the first of them
};

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
  // A file that says where the robot was told to be, of a scene that does not ask for it, is no recording of it.
  const auto start = [&]<class... Begin>(const Begin&... begin) {
    if constexpr (detail::StartsWith<C, Begin...>) cycle.start(*memory, begin...);
  };
  recording.visit(start, [&](const auto& input, const auto& command) {
    const auto out = cycle.step(*memory, input);
    if (!same_bits(out.command, command) && result.different++ == 0) result.first_different = result.cycles;
    ++result.cycles;
  });
  return result;
}

SKINCTL_END_NAMESPACE
