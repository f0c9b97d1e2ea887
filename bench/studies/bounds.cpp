// Proven rounding errors: `bounds [--robot NAME] [--seconds S] [--velocity V] [--acceleration A] [--only
// QUANTITY] [--csv FILE]`.
//
// For every state of a robot (all joint angles; rates within 3 rad/s, accelerations within 3 rad/s^2, or V
// and A) a bracket of the largest error of each quantity, in float and in double: the worst that a search has
// found, and what is proven by interval adjoints over boxes of the joint angles and velocities, which are
// split where the bound is worst. Poses in their unit and in metres, torques in N m; forward dynamics as the
// torque that would explain the error of the acceleration. The quantity that is farthest off its goal, which
// is a ratio of proven to found, has the processor. A cycle is bounded at single states (`Bound`), with the
// configuration as the program holds it.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <memory>

#include "bench/studies/bounds/box_search.hpp"
#include "bench/studies/bounds/brackets.hpp"
#include "bench/studies/bounds/one_cycle.hpp"
#include "bench/studies/bounds/program.hpp"
#include "bench/studies/bounds/quantities.hpp"
#include "bench/studies/bounds/sign_symmetries.hpp"
#include "bench/studies/bounds/worst_found.hpp"
#include "bench/studies/proofs/traced.hpp"
#include "skinctl/robots/allegro.hpp"
#include "skinctl/robots/universal_robots.hpp"
#include "skinctl/robots/ur5.hpp"

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

struct Goal {
  double ratio;   ///< proven over found
  double share;   ///< of the time for the proof
  double search;  ///< of that for the search
};
Goal goal_of(Quantity q) {
  switch (q) {
    case Quantity::pose:
      return {6, 0.13, 0.12};
    case Quantity::jacobian:
      return {6, 0.05, 0.10};
    case Quantity::gravity:
      return {6, 0.02, 0.08};
    case Quantity::inverse_dynamics:
      return {8, 0.30, 0.22};
    case Quantity::yr_theta:
      return {8, 0.28, 0.20};
    case Quantity::mass:
      return {8, 0.02, 0.08};
    case Quantity::forward_dynamics:
      return {10, 0.20, 0.20};
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

/// A quantity of a robot: what is found, and the boxes that prove.
///
/// The same rounding on each joint: a joint whose angle enters by its sine and cosine alone is bounded over
/// one turn for all turns.
class Quest {
 public:
  /// Nothing is bounded where float and double run different operations.
  template <class Robot, Quantity Q>
  static std::unique_ptr<Quest> of(double search, const Rates& rates) {
    constexpr std::size_t N = decltype(Robot::template in<double>())::joints;
    auto quest = std::make_unique<Quest>();
    quest->about_ = named(Q), quest->goal_ = goal_of(Q);
    quest->ranges_ = ranges_of(Q, N, rates);
    const Program<Robot, Q, float> in_float(quest->ranges_, rates);
    const Program<Robot, Q, double> in_double(quest->ranges_, rates);
    math::Tape tape, other;
    math::undecided() = 0;
    in_double.record(other);
    std::vector<std::vector<Range>> parts;
    for (const auto node : in_float.record(tape)) {
      quest->outputs_.emplace_back(tape, node);
      const SignSymmetries symmetries(tape, node, quest->ranges_);
      parts.push_back(symmetries.reduced(quest->ranges_));
      if (quest->outputs_.back().inputs().empty()) continue;
      quest->fewest_ = std::min(quest->fewest_, symmetries.count());
      quest->most_ = std::max(quest->most_, symmetries.count());
    }
    if (!same_program(tape, other) || math::undecided() != 0) {
      std::printf("%-18s float and double run different operations: not bounded\n", named(Q).name);
      return nullptr;
    }
    const auto states = SteepStates(quest->ranges_, quest->outputs_).run(0.3 * search);
    quest->of_float_.found = worst_found<float>(in_float, quest->ranges_, states, 0.35 * search);
    quest->of_double_.found = worst_found<double>(in_double, quest->ranges_, states, 0.35 * search);
    if constexpr (Q == Quantity::forward_dynamics) {
      const auto diagonal = largest_inertias<Robot, N>();
      quest->of_float_.more = factorisation_error(diagonal, N, 0x1p-24, rates.acceleration);
      quest->of_double_.more = factorisation_error(diagonal, N, 0x1p-53, rates.acceleration);
    }
    quest->boxes_ = std::make_unique<BoxSearch>(quest->outputs_, std::move(parts));
    return quest;
  }

  /// Splits boxes for `seconds` of processor time.
  void prove(double seconds) {
    const auto proven = boxes_->run(0, seconds);
    of_float_.proven = proven.in_float + of_float_.more,
    of_double_.proven = proven.in_double + of_double_.more;
    count_ = proven.boxes, seconds_ += proven.seconds;
  }
  [[nodiscard]] const Goal& goal() const noexcept { return goal_; }
  /// The worse of the two ratios, in goals.
  [[nodiscard]] double off() const noexcept {
    return std::max(of_float_.ratio(), of_double_.ratio()) / goal_.ratio;
  }
  void print() const {
    std::printf("%-17s %-6s", about_.name, about_.unit);
    for (const Ends& e : {of_float_, of_double_})
      std::printf(" [%.2e, %.2e] %5.1fx ", e.found, rounded_up(e.proven), e.ratio());
    std::printf(" %3.0fx %s %8zu %5.1f  %zu to %zu\n", goal_.ratio, off() <= 1 ? "met   " : "missed", count_,
                seconds_, fewest_, most_);
    std::fflush(stdout);
  }
  [[nodiscard]] Bracket bracket(const char* robot, const Rates& rates) const {
    return {robot,           about_.name,      about_.unit,      rates.velocity,    rates.acceleration,
            of_float_.found, of_float_.proven, of_double_.found, of_double_.proven, seconds_};
  }

 private:
  struct Ends {
    double found = 0, proven = HUGE_VAL;
    double more = 0;  ///< proven beside the boxes
    [[nodiscard]] double ratio() const noexcept { return proven / found; }
  };
  /// Upper limits of the diagonal of M.
  template <class Robot, std::size_t N>
  static std::vector<double> largest_inertias() {
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
    return diagonal;
  }

  Named about_{};
  Goal goal_{};
  std::vector<Range> ranges_;
  std::vector<math::TracedOutput> outputs_;
  std::unique_ptr<BoxSearch> boxes_;
  Ends of_float_, of_double_;
  std::size_t count_ = 0;
  std::size_t fewest_ = SIZE_MAX, most_ = 0;  ///< symmetries of a result
  double seconds_ = 0;
};

/// A quarter of the time searches. Half of the rest is shared as goals say, until one is met; then the
/// quantity that is farthest off its goal has the next quarter of a second.
template <class Robot>
void bound_all(const char* name, double seconds, const Rates& rates, const char* only, const char* csv) {
  std::printf(
      "\n%s: [worst found, worst proven] and their ratio; goal; boxes; processor time [s]; symmetries of a "
      "result\n",
      name);
  std::printf("%-24s %-30s %-30s\n", "", "float", "double");
  const double start = processor_seconds(), search = 0.25 * seconds;
  std::vector<std::unique_ptr<Quest>> quests;
  const auto one = [&]<Quantity Q>(std::integral_constant<Quantity, Q>) {
    if (only != nullptr && std::strstr(named(Q).name, only) == nullptr) return;
    if (auto quest = Quest::of<Robot, Q>(only == nullptr ? search * goal_of(Q).search : search, rates))
      quests.push_back(std::move(quest));
  };
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (one(std::integral_constant<Quantity, quantities[I]>{}), ...);
  }(std::make_index_sequence<std::size(quantities)>{});
  const double slice = std::min(0.25, 0.02 * seconds), shared = 0.375 * seconds;
  for (const auto& quest : quests) {
    const double begin = processor_seconds();
    do {
      quest->prove(slice);
    } while (quest->off() > 1 && processor_seconds() - begin < shared * quest->goal().share);
  }
  const auto farther = [](const auto& a, const auto& b) { return a->off() < b->off(); };
  while (!quests.empty() && processor_seconds() - start < seconds)
    (*std::max_element(quests.begin(), quests.end(), farther))->prove(slice);
  std::vector<Bracket> found;
  for (const auto& quest : quests) quest->print(), found.push_back(quest->bracket(name, rates));
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
