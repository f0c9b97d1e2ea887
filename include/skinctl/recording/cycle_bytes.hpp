// SPDX-License-Identifier: BSD-3-Clause
// A cycle's input and command as bytes: what recordings hold, and what the loop hands to other threads.
#pragma once

#include <cstddef>
#include <vector>

#include "skinctl/cycle/cycle.hpp"
#include "skinctl/recording/detail/byte_stream.hpp"
#include "skinctl/recording/each_number.hpp"
#include "skinctl/tactile/kind_input.hpp"

SKINCTL_BEGIN_NAMESPACE

/// The bytes of the cycles of `C`; in this order, without padding, as they lie in memory: now, measured
/// state, request, observed status, goal, configuration (if `C` has several), cell samples, wrenches and
/// motor torques (if its skin takes them), taxels of other kinds, what its law adds (the gripper's state),
/// what its limits add (what is around), weights of patches (of a `WeightedSkin`), command.
template <class C>
class CycleBytes {
 public:
  using State = skinctl::State<C::joints, typename C::scalar>;
  using Input = typename C::Input;
  using Command = JointCommand<C::joints, typename C::scalar>;
  using Position = JointPosition<C::joints, typename C::scalar>;

  static constexpr bool configured = InputWithConfiguration<Input>;
  static constexpr bool has_wrenches = SensesWrenches<typename C::Sensed>;
  static constexpr bool has_motors = SensesMotors<typename C::Sensed>;
  static constexpr bool has_gripper = InputWithGripper<Input>;
  static constexpr bool has_weights = SensesWeights<typename C::Sensed>;
  static constexpr bool has_surroundings = InputWithSurroundings<Input>;
  /// Number of inputs that laws and limits of the user's own add.
  static constexpr std::uint32_t own_inputs =
      std::uint32_t(std::tuple_size_v<typename C::Added>) - has_gripper - has_surroundings;
  static constexpr std::size_t sample_size = 8 + 4 + 8 * 4 + 2 * 2, wrench_size = 8 + 6 * 8;

  /// The samples of an input that was read.
  struct Samples {
    std::vector<CellSample> cells;
    std::vector<WrenchSample> wrenches;
    TaxelStore<typename C::Sensed> taxels;
  };
  /// The start of a scene: at a measured state, perhaps told to be elsewhere.
  struct Beginning {
    State measured;
    bool has_told = false;
    Position told;
  };

  /// A bound on the bytes of a cycle with this input.
  [[nodiscard]] static std::size_t max_size(const Input& input) noexcept {
    std::size_t size = fixed_size + input.samples.size() * sample_size;
    if constexpr (has_wrenches) size += input.sensed.wrenches.size() * wrench_size;
    TaxelStore<typename C::Sensed>::look(
        input.sensed, [&](const auto& samples) { size += 4 + samples.size() * taxel_size(samples); });
    return size;
  }
  /// A bound on the bytes of a beginning.
  static constexpr std::size_t fixed_size = sizeof(Input) + sizeof(Command) + 64;

  /// Writes a cycle into `out`, which has room for `max_size(input)` bytes.
  template <class Out>
  static void write(Out& out, const Input& input, const Command& command) noexcept {
    out.put(input.now.count());
    numbers(out, input.measured);
    out.put(static_cast<std::uint8_t>(input.request));
    out.put(input.observed.bits());
    if constexpr (InputWithGoal<Input>) {
      out.put(input.goal.has_value());
      numbers(out, input.goal ? *input.goal : typename C::Goal{});
    } else {
      out.put(false);
    }
    if constexpr (configured) out.put(input.configuration);
    out.put(static_cast<std::uint32_t>(input.samples.size()));
    for (const CellSample& s : input.samples) out.put(&s, sample_size);
    if constexpr (has_wrenches) {
      out.put(static_cast<std::uint32_t>(input.sensed.wrenches.size()));
      for (const WrenchSample& s : input.sensed.wrenches) numbers(out, s);
    }
    if constexpr (has_motors) numbers(out, input.sensed.motor_torque);
    TaxelStore<typename C::Sensed>::look(input.sensed, [&](const auto& samples) {
      out.put(static_cast<std::uint32_t>(samples.size()));
      for (const auto& s : samples) numbers(out, s);
    });
    each_part(Added(),
              [&]<class Part>(std::type_identity<Part>) { numbers(out, static_cast<const Part&>(input)); });
    if constexpr (has_weights) numbers(out, input.sensed.patch_weights);
    numbers(out, command);
  }
  template <class Out>
  static void write(Out& out, const State& measured, const Position* told) noexcept {
    numbers(out, measured);
    out.put(told != nullptr);
    if (told != nullptr) numbers(out, *told);
  }
  static void read(detail::ByteReader& in, Input& input, Samples& samples, Command& command) {
    read_numbers(in, input.now);
    read_numbers(in, input.measured);
    const auto request = in.get<std::uint8_t>();
    input.request = request <= 2 ? static_cast<CycleRequest>(request) : CycleRequest::none;
    input.observed = Status::from_bits(in.get<std::uint64_t>());
    [[maybe_unused]] const bool has_goal = in.get<bool>();
    if constexpr (InputWithGoal<Input>) {
      typename C::Goal goal{};
      read_numbers(in, goal);
      input.goal.reset();
      if (has_goal) input.goal = goal;
    }
    if constexpr (configured) input.configuration = in.get<std::uint32_t>();
    read_samples(in, sample_size, samples.cells);
    input.samples = samples.cells;
    if constexpr (has_wrenches) {
      read_samples(in, wrench_size, samples.wrenches);
      input.sensed.wrenches = samples.wrenches;
    }
    if constexpr (has_motors) read_numbers(in, input.sensed.motor_torque);
    samples.taxels.each(input.sensed, [&](auto& span, auto& kept) {
      read_samples(in, taxel_size(span), kept);
      span = kept;
    });
    each_part(Added(),
              [&]<class Part>(std::type_identity<Part>) { read_numbers(in, static_cast<Part&>(input)); });
    if constexpr (has_weights) read_numbers(in, input.sensed.patch_weights);
    read_numbers(in, command);
  }
  [[nodiscard]] static Beginning read_beginning(detail::ByteReader& in) {
    Beginning begin;
    read_numbers(in, begin.measured);
    begin.has_told = in.get<bool>();
    if (begin.has_told) read_numbers(in, begin.told);
    return begin;
  }
  /// The kind of scene that writes such bytes: the first number tells byte orders apart, the others kinds of
  /// input and of cells, joints, scalars and goals.
  [[nodiscard]] static std::array<std::uint32_t, 5> kind() noexcept {
    return {0x01020304,
            ((TaxelStore<typename C::Sensed>::fingerprint >> 6) << 6) + 64u * own_inputs +
                (has_surroundings ? 32u : 0u) + (has_weights ? 16u : 0u) + (has_gripper ? 8u : 0u) +
                (configured ? 4u : 0u) + (has_motors ? 2u : 0u) + (has_wrenches ? 1u : 0u),
            static_cast<std::uint32_t>(C::joints), static_cast<std::uint32_t>(sizeof(typename C::scalar)),
            static_cast<std::uint32_t>(sizeof(typename C::Goal))};
  }

 private:
  // A sample lies in memory as it is written.
  static_assert(std::is_standard_layout_v<CellSample> && offsetof(CellSample, cell) == 8 &&
                offsetof(CellSample, force) == 12 && offsetof(CellSample, unrest) == sample_size - 2);

  using Added = std::type_identity<typename C::Added>;
  template <class... Parts, class F>
  static void each_part(std::type_identity<std::tuple<Parts...>>, F&& f) {
    (f(std::type_identity<Parts>()), ...);
  }
  template <class Samples>
  static constexpr std::size_t taxel_size(const Samples&) noexcept {
    return 8 + 4 + sizeof(Samples::value_type::readings) + 2 * 2;
  }
  template <class Out, class V>
  static void numbers(Out& out, V value) noexcept {
    each_number(value, [&](const auto& x) { out.put(x); });
  }
  template <class V>
  static void read_numbers(detail::ByteReader& in, V& value) {
    each_number(value, [&](auto& x) { x = in.get<std::remove_cvref_t<decltype(x)>>(); });
  }
  template <class Sample>
  static void read_samples(detail::ByteReader& in, std::size_t size, std::vector<Sample>& samples) {
    const std::size_t count = in.get<std::uint32_t>();
    samples.resize(count <= in.left() / size ? count : 0);
    for (Sample& s : samples) read_numbers(in, s);
  }
};

SKINCTL_END_NAMESPACE
