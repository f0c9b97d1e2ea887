// Proven rounding errors: `bounds [--robot NAME] [--seconds S] [--velocity V] [--acceleration A] [--only QUANTITY] [--csv FILE]`.
//
// For every state of a robot (all joint angles; rates within 3 rad/s, accelerations within 3 rad/s^2, or V and A) a bracket of
// the largest error of each quantity, in float and in double: the worst that a search has found, and what is
// proven by interval adjoints over boxes of the joint angles, which are split where the bound is worst. Poses in
// their unit and in metres, torques in N m; forward dynamics as the torque that would explain the error of the
// acceleration. A quantity ends when its proven error is `goal` times the found one, or when its time is over.
// A cycle is bounded at single states (`Bound`), with the configuration as the program holds it.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <memory>

#include "bench/studies/bounds/box_search.hpp"
#include "bench/studies/bounds/brackets.hpp"
#include "bench/studies/bounds/one_cycle.hpp"
#include "bench/studies/bounds/quantities.hpp"
#include "bench/studies/bounds/worst_found.hpp"
#include "skinctl/math/traced.hpp"
#include "skinctl/model/allegro.hpp"
#include "skinctl/model/universal_robots.hpp"
#include "skinctl/model/ur5.hpp"

using namespace skinctl;
using namespace skinctl::bounds;

namespace {

/// A static model: the same type in every scalar.
template <class D>
struct Static {
  template <class T>
  static StaticModel<D> in() {
    return {};
  }
};
/// A hand, whose numbers are known at run time.
struct Hand {
  template <class T>
  static auto in() {
    return allegro::hand<T>(allegro::Side::right);
  }
};

template <class Robot, Quantity Q>
struct Program {
  template <class T>
  auto operator()(const T* x) const {
    return computed<Q>(Robot::template in<T>(), x);
  }
  template <class R, class Wide>
  std::vector<double> errors(const R* x) const {
    static const auto model = Robot::template in<R>();
    static const auto wide = Robot::template in<Wide>();
    if constexpr (Q == Quantity::forward_dynamics) {
      return unexplained_torque<R, Wide>(model, wide, x);
    } else {
      std::vector<Wide> more(x, x + std::remove_cvref_t<decltype(model)>::joints * (1 + named(Q).rates));
      const auto y = computed<Q>(model, x);
      const auto z = computed<Q>(wide, more.data());
      std::vector<double> out;
      for (std::size_t i = 0; i < y.size(); ++i)
        out.push_back(static_cast<double>(static_cast<Wide>(y[i]) - z[i]));
      return out;
    }
  }
};

struct Goal {
  double ratio, share, search;  ///< proven over found; of the time for the proof, and of that for the search
};
Goal goal_of(Quantity q) {
  switch (q) {
    case Quantity::pose:
      return {6, 0.13, 0.25};
    case Quantity::jacobian:
      return {6, 0.05, 0.15};
    case Quantity::gravity:
      return {6, 0.02, 0.07};
    case Quantity::inverse_dynamics:
      return {8, 0.42, 0.20};
    case Quantity::yr_theta:
      return {8, 0.16, 0.12};
    case Quantity::mass:
      return {8, 0.02, 0.07};
    case Quantity::forward_dynamics:
      return {10, 0.20, 0.14};
  }
  return {};
}

/// The proven largest of `output` itself over all inputs, by a grid of boxes.
double largest_value(math::TracedOutput& output, const std::vector<Range>& ranges, std::size_t cells) {
  using L = math::TracedOutput::L;
  const auto& inputs = output.inputs();
  std::size_t count = 1;
  for (std::size_t i = 0; i < inputs.size(); ++i) count *= cells;
  double most = 0;
  std::vector<L> low(inputs.size()), high(inputs.size());
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t at = k;
    for (std::size_t i = 0; i < inputs.size(); ++i, at /= cells) {
      const math::Enclosure& whole = ranges[inputs[i]].whole;
      const double step = whole.width() / static_cast<double>(cells), cell = static_cast<double>(at % cells);
      low[i] = whole.low + step * cell - 1e-9, high[i] = whole.low + step * (cell + 1) + 1e-9;
    }
    static_cast<void>(output(low.data(), high.data()));
    most = std::max(most, output.highest()[0]);
  }
  return most;
}

/// A little more than pi.
constexpr double half_turn = 3.1416;

/// The same rounding on each joint: a joint whose angle enters by its sine and cosine alone is bounded over one
/// turn for all turns.
///
/// The signs of all rates at once change no torque, and no error of one (products of two of them are what occurs): the first
/// joint's velocity is not negative.
template <class Robot, Quantity Q>
Bracket bound(double seconds, double search, const Rates& rates) {
  using Model = decltype(Robot::template in<double>());
  constexpr std::size_t N = Model::joints;
  const auto about = named(Q);
  const Goal goal = goal_of(Q);
  std::vector<Range> ranges;
  for (std::size_t i = 0; i < N; ++i) {
    ranges.push_back({{-half_turn, half_turn}, true});
    for (std::size_t k = 0; k < about.rates; ++k) {
      const double most = k == 1 ? rates.acceleration : rates.velocity;
      ranges.push_back({{k == 0 && i == 0 ? 0 : -most, most}, k == 0, 0.06f});
    }
  }
  const Program<Robot, Q> program;
  math::Tape tape, other;
  const auto record = [&]<class R>(math::Tape& on, R) {
    const math::Tape::Recording recording(on);
    std::vector<math::Traced<R>> x;
    for (const auto& r : ranges) x.push_back(math::Traced<R>::input(r.whole));
    std::vector<std::int32_t> nodes;
    for (const auto& y : program(x.data())) nodes.push_back(y.node());
    return nodes;
  };
  math::undecided() = 0;
  record(other, 0.0);
  std::vector<math::TracedOutput> outputs;
  for (const auto node : record(tape, 0.0f)) outputs.emplace_back(tape, node);
  if (!same_program(tape, other) || math::undecided() != 0) {
    std::printf("%-18s float and double run different operations: not bounded\n", about.name);
    return {};
  }
  WorstFound<float, Program<Robot, Q>> in_float(program, ranges, outputs, 1);
  WorstFound<double, Program<Robot, Q>> in_double(program, ranges, outputs, 2);
  const auto f = in_float.run(0.3 * search);
  const auto d = in_double.run(0.7 * search);  // more digits take longer

  double factors_float = 0, factors_double = 0;
  if constexpr (Q == Quantity::forward_dynamics) {
    math::Tape mass;
    std::vector<double> diagonal;
    const math::Tape::Recording recording(mass);
    JointPosition<N, math::Traced<float>> q;
    for (auto& x : q) x = math::Traced<float>::input({-half_turn, half_turn});
    const auto m = mass_matrix(Robot::template in<math::Traced<float>>(), q);
    const std::vector<Range> angles(N, Range{{-half_turn, half_turn}, true});
    for (std::size_t i = 0; i < N; ++i) {
      math::TracedOutput output(mass, m(i, i).node());
      diagonal.push_back(largest_value(output, angles, output.inputs().size() > 4 ? 8 : 12));
    }
    factors_float = factorisation_error(diagonal, N, 0x1p-24, rates.acceleration);
    factors_double = factorisation_error(diagonal, N, 0x1p-53, rates.acceleration);
  }
  BoxSearch boxes(outputs, ranges);
  const double finest = 2.5 * std::min(f.error, d.error * 0x1p29) - factors_float;
  auto result = boxes.run(finest, goal.share * seconds);
  result.in_float += factors_float, result.in_double += factors_double;
  const double of_float = result.in_float / f.error, of_double = result.in_double / d.error;
  const bool met = of_float <= goal.ratio && of_double <= goal.ratio;
  std::printf("%-17s %-6s [%.2e, %.2e] %5.1fx  [%.2e, %.2e] %5.1fx  %3.0fx %s %8zu %5.1f\n", about.name,
              about.unit, f.error, result.in_float, of_float, d.error, result.in_double, of_double,
              goal.ratio, met ? "met   " : "missed", result.boxes, result.seconds);
  std::fflush(stdout);
  return {"",      about.name,      about.unit, rates.velocity,   rates.acceleration,
          f.error, result.in_float, d.error,    result.in_double, result.seconds};
}

template <class Robot>
void bound_all(const char* name, double seconds, const Rates& rates, const char* only, const char* csv) {
  std::printf("\n%s: [worst found, worst proven] and their ratio; goal; boxes; processor time [s]\n", name);
  std::printf("%-24s %-30s %-30s\n", "", "float", "double");
  const double start = processor_seconds();
  const bool all = only == nullptr;
  std::vector<Bracket> found;
  const double rest = 0.75 * seconds, search = 0.25 * seconds;
  const auto one = [&]<Quantity Q>(std::integral_constant<Quantity, Q>) {
    if (all || std::strstr(named(Q).name, only) != nullptr)
      found.push_back(bound<Robot, Q>(all ? rest : rest / goal_of(Q).share,
                                      all ? search * goal_of(Q).search : search, rates));
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (one(std::integral_constant<Quantity, quantities[I]>{}), ...);
  }(std::make_index_sequence<std::size(quantities)>{});
  for (Bracket& b : found) b.robot = name;
  if (csv != nullptr) write_brackets(csv, found);
  std::printf("%.1f s of processor time in all\n", processor_seconds() - start);
}

}  // namespace

int main(int argc, char** argv) {
  const char *robot = "ur5", *only = nullptr, *csv = nullptr;
  double seconds = 60;
  Rates rates;
  for (int i = 1; i + 1 < argc; i += 2) {
    const auto is = [&](const char* name) { return std::strcmp(argv[i], name) == 0; };
    if (is("--robot")) robot = argv[i + 1];
    if (is("--only")) only = argv[i + 1];
    if (is("--csv")) csv = argv[i + 1];
    if (is("--seconds")) seconds = std::atof(argv[i + 1]);
    if (is("--velocity")) rates.velocity = std::atof(argv[i + 1]);
    if (is("--acceleration")) rates.acceleration = std::atof(argv[i + 1]);
  }
  const auto run = [&]<class Robot>(const char* name, Robot) {
    if (std::strcmp(robot, name) != 0 && std::strcmp(robot, "all") != 0) return false;
    bound_all<Robot>(name, seconds, rates, only, csv);
    return true;
  };
  bool any = run("ur5", Static<ur5::Description>{});
#if !defined(SKINCTL_BOUNDS_UR5)  // the others take minutes to compile
  any |= run("ur3", Static<ur3::Description>{});
  any |= run("ur10", Static<ur10::Description>{});
  any |= run("ur3e", Static<ur3e::Description>{});
  any |= run("ur5e", Static<ur5e::Description>{});
  any |= run("ur10e", Static<ur10e::Description>{});
  any |= run("allegro", Hand{});
#endif
  if (std::strcmp(robot, "ur5") == 0 && seconds >= 60 && only == nullptr) print_one_cycle();
  if (!any) std::printf("no such robot: %s\n", robot);
  return any ? 0 : 1;
}
