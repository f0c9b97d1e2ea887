// A UR5 as it comes: robots that are not as declared, in scenes with hands, walls and goals. Nobody touches
// it and it moves by no more than its gap; a touch is pressed no harder than by the same robot declared
// truly; whatever else happens has its reason. `as_it_comes [cases [first seed [folder [dead band in
// rad]]]]`, or `as_it_comes case SEED` for one of them, cycle by cycle.
//
// A case: encoders off by up to 0.1 rad, a lag of 0 to 50 ms where 8 are declared (one or two in a row),
// servos of 500 N m/rad to rigid with and without integral, friction of up to 20 % of the largest torques,
// encoder steps up to 1e-3 rad, delay and stamps that jitter, up to a tenth of the outputs skipped, a payload
// of up to 5 kg of which the robot does not know; by position or velocity, 125 or 500 Hz. Twins have the same
// servos, friction, payload, noise and jitter, but their lag is declared and their encoders are calibrated.
// They are touched at the same cells; where a case is not as promised beside one twin, four further twins
// start where the robot may stand in its gap, and those that are held fast are let go at other moments. Such
// a case is run again without each of its causes: the list tells which of them it takes.
#include "bench/studies/worlds/as_it_comes.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "examples/support/svg_plot.hpp"
#include "skinctl/guard/faults.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

constexpr int scenes = static_cast<int>(AsItComesScene::count);
constexpr std::uint64_t further_twins = 4;  // of a case that is not as promised beside one

struct Row {
  int cases = 0, moved = 0, early = 0, late = 0, goal = 0, away = 0, silent = 0, consents = 0;
  double most_beyond = -1, worst_early = 0, worst_late = 0, worst_goal = 0;

  void add(const AsItComesVerdict& v, const AsItComesResult& r) {
    ++cases;
    moved += v.moved, early += v.early, late += v.late, goal += v.goal, away += v.away, silent += v.silent;
    consents += r.consents > 0;
    most_beyond = std::max(most_beyond, r.beyond);
    worst_early = std::max(worst_early, v.early_ratio);
    worst_late = std::max(worst_late, v.late_ratio);
    worst_goal = std::max(worst_goal, r.goal_error);
  }
  void print(const char* name) const {
    std::printf("| %s | %d | %d | %.4f | %d | %.2f | %d | %.2f | %d | %.3f | %d | %d | %d |\n", name, cases,
                moved, std::max(0.0, most_beyond), early, worst_early, late, worst_late, goal,
                std::max(0.0, worst_goal), away, silent, consents);
  }
};

void head(const char* by) {
  std::printf(
      "\n| %s | cases | moved untouched | most [rad] | harder, first 10 s | most | harder, after | most | "
      "beside goal | most [rad] | ran away | no reason | consents |\n|---|---|---|---|---|---|---|---|---|---"
      "|---|---|---|\n",
      by);
}

struct Cause {
  const char* name;
  bool (*in)(const AsItComes&);
};
double largest_gap(const AsItComes& c) {
  double most = 0;
  for (const double g : c.truth.gap) most = std::max(most, std::abs(g));
  return most;
}
const Cause causes[] = {
    {"encoders off by more than 20 mrad", [](const AsItComes& c) { return largest_gap(c) > 0.02; }},
    {"lag 15 to 30 ms",
     [](const AsItComes& c) {
       const double lag = c.truth.lag + c.truth.lookahead;
       return lag > 0.015 && lag <= 0.03;
     }},
    {"lag above 30 ms", [](const AsItComes& c) { return c.truth.lag + c.truth.lookahead > 0.03; }},
    {"servo below 3000 N m/rad", [](const AsItComes& c) { return c.truth.stiffness[0] < 3000; }},
    {"the same with integral",
     [](const AsItComes& c) { return c.truth.stiffness[0] < 3000 && c.truth.integral_time < 10; }},
    {"friction above 5 %", [](const AsItComes& c) { return c.friction > 0.05; }},
    {"encoder steps above 1e-4 rad", [](const AsItComes& c) { return c.truth.resolution > 1e-4; }},
    {"jitter", [](const AsItComes& c) { return c.truth.delay_jitter > 0; }},
    {"skipped outputs", [](const AsItComes& c) { return c.truth.skipped > 0; }},
    {"payload wrong by more than 2 kg", [](const AsItComes& c) { return c.payload > 2; }},
    {"by position", [](const AsItComes& c) { return c.interface == Interface::position; }},
    {"by velocity", [](const AsItComes& c) { return c.interface == Interface::velocity; }},
    {"125 Hz", [](const AsItComes& c) { return c.period == 8ms; }},
    {"500 Hz", [](const AsItComes& c) { return c.period == 2ms; }}};

/// What is not as declared, one at a time, and the case without it.
struct Cure {
  const char* cause;
  void (*cure)(AsItComes&);
};
const Cure cures[] = {
    {"lag not declared", [](AsItComes& c) { c.declared_lag = c.truth.lookahead + c.truth.lag; }},
    {"encoders off", [](AsItComes& c) { c.truth.gap = {}; }},
    {"friction", [](AsItComes& c) { c.friction = 0, c.truth.coulomb = c.truth.stiction = {}; }},
    {"servo that gives way",
     [](AsItComes& c) {
       for (double& k : c.truth.stiffness) k = std::max(k, 1e5);
     }},
    {"payload", [](AsItComes& c) { c.payload = 0; }},
    {"jitter, skipped outputs",
     [](AsItComes& c) { c.truth.delay_jitter = c.truth.stamp_jitter = c.truth.skipped = 0; }}};

/// Which of its causes a case must be without to be as promised, each alone.
struct Cured {
  bool by[std::size(cures)] = {};
  bool any = false;

  explicit Cured(const AsItComes& c) {
    for (std::size_t k = 0; k < std::size(cures); ++k) {
      AsItComes without = c;
      cures[k].cure(without);
      const auto twin = worst_twin(without, run_as_it_comes(without, true), further_twins);
      by[k] = AsItComesVerdict(without, run_as_it_comes(without, false), twin).good();
      any = any || by[k];
    }
  }
  [[nodiscard]] std::string list() const {
    std::string out;
    for (std::size_t k = 0; k < std::size(cures); ++k)
      if (by[k]) out += (out.empty() ? " (" : ", ") + std::string(cures[k].cause);
    return out.empty() ? " (several)" : out + ")";
  }
};

void tell(const AsItComes& c) {
  std::printf("seed %llu: %s, by %s, %.0f ms; link %zu, hand %.0f N/m, wall %.0f N/m, way %.3f m\n",
              static_cast<unsigned long long>(c.seed), as_it_comes_scenes[static_cast<int>(c.scene)],
              c.interface == Interface::position ? "position" : "velocity", milliseconds(c.period), c.link,
              c.hand, c.wall, c.way);
  std::printf(
      "  lookahead %.1f ms, lag %.1f ms; servo %.0f N m/rad, integral %.2f s; friction %.1f %%; payload "
      "%.1f kg\n",
      1e3 * c.truth.lookahead, 1e3 * c.truth.lag, c.truth.stiffness[0], c.truth.integral_time,
      100 * c.friction, c.payload);
  std::printf("  encoder step %.1e, noise %.1e, jitter %.1f ms, skipped %.0f %%; gaps", c.truth.resolution,
              c.truth.noise, 1e3 * c.truth.delay_jitter, 100 * c.truth.skipped);
  for (const double g : c.truth.gap) std::printf(" %.3f", g);
  std::printf("\n");
}

void print(const char* name, const AsItComesResult& r) {
  std::printf(
      "  %s: untouched %.4f rad (%.4f beyond), force %.1f N then %.1f N, goal %.4f, last speed %.4f, "
      "furthest %.3f, alone %.3f, consents %d:",
      name, r.moved, r.beyond, r.early, r.late, r.goal_error, r.last_speed, r.outside, r.alone, r.consents);
  r.reasons.for_each([](Reason reason) { std::printf(" [%s]", skinctl::name(reason)); });
  std::printf("\n");
}

int one(std::uint64_t seed) {
  const AsItComes c(seed);
  tell(c);
  double next = 0;
  const auto trace = [&](double t, const auto& joints, const auto& out, const auto& forces) {
    if (t < next) return;
    next += 0.1;
    std::printf("%7.3f  q", t);
    for (std::size_t i = 0; i < 6; ++i) std::printf(" %8.4f", joints.q()[i] - c.pose[i]);
    std::printf("  command");
    for (std::size_t i = 0; i < 6; ++i) std::printf(" %8.4f", out.planned.position[i] - c.pose[i]);
    std::printf("  N %6.1f %6.1f ", forces[0], forces[1]);
    out.status.for_each([](Reason reason) { std::printf(" %d", static_cast<int>(reason)); });
    std::printf("\n");
  };
  const auto r = run_as_it_comes(c, false, trace);
  const auto twin = run_as_it_comes(c, true);
  print("as it comes", r);
  print("truly declared", twin);
  const AsItComesVerdict v(c, r, twin);
  return v.good() ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::strcmp(argv[1], "case") == 0) return one(std::strtoull(argv[2], nullptr, 10));
  const std::uint64_t cases = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 10000;
  const std::uint64_t first = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  const std::string folder = argc > 3 ? argv[3] : ".";
  const double dead_band = argc > 4 ? std::strtod(argv[4], nullptr) : 0.02;
  Row by_scene[scenes], by_cause[std::size(causes)], all, twins;
  int by_reason[static_cast<int>(Reason::count)] = {};
  std::vector<double> ratios[scenes], forces[scenes], twin_forces[scenes];
  std::vector<std::string> bad;
  int led_further = 0, first_harder = 0, twin_too = 0, beside_too = 0;
  int asked = 0, asked_at_start = 0, asked_again = 0, asked_if_held = 0;
  double most_alone = 0;
  int without[std::size(cures)] = {}, by_several = 0;
  for (std::uint64_t seed = first; seed < first + cases; ++seed) {
    AsItComes c(seed);
    c.dead_band = dead_band;
    const auto r = run_as_it_comes(c, false);
    auto twin = run_as_it_comes(c, true);
    const auto again = run_as_it_comes(started_aside(c, {}, 0.001, further_twins + 1), true);
    const AsItComesVerdict of_twin(c, again, twin);
    twins.add(of_twin, again);
    if (of_twin.late) twin_too += AsItComesVerdict(c, again, worst_twin(c, twin, further_twins)).late;
    const AsItComesVerdict first_verdict(c, r, twin);
    first_harder += first_verdict.late;
    if (!first_verdict.good()) twin = worst_twin(c, twin, further_twins);
    const AsItComesVerdict v(c, r, twin);
    beside_too += v.goal && twin.goal_error > 0.01;
    all.add(v, r);
    led_further += v.led_further;
    if (r.consents > 0) {
      ++asked;
      // Before any hand, of a gap that the dead band does not hold.
      asked_at_start += r.consents == 1 && r.asked_at < AsItComesWorld::begins && largest_gap(c) > 0.03;
      asked_again += r.consents > 1;
      AsItComes held = c;
      held.reports_held = true;
      asked_if_held += run_as_it_comes(held, false).consents > 0;
    }
    most_alone = std::max(most_alone, r.alone);
    by_scene[static_cast<int>(c.scene)].add(v, r);
    for (std::size_t k = 0; k < std::size(causes); ++k)
      if (causes[k].in(c)) by_cause[k].add(v, r);
    r.reasons.for_each([&](Reason reason) { ++by_reason[static_cast<int>(reason)]; });
    forces[static_cast<int>(c.scene)].push_back(std::max(r.early, r.late));
    twin_forces[static_cast<int>(c.scene)].push_back(std::max(twin.early, twin.late));
    if (v.late_ratio > 0) ratios[static_cast<int>(c.scene)].push_back(v.late_ratio);
    if (!v.good()) {
      std::string what = std::to_string(seed);
      for (const auto& [is, name] : {std::pair{v.away, " ran away"},
                                     {v.moved, " moved"},
                                     {v.early, " early"},
                                     {v.late, " harder"},
                                     {v.goal, " goal"},
                                     {v.silent, " no reason"}})
        if (is) what += name;
      const Cured cured(c);
      for (std::size_t k = 0; k < std::size(cures); ++k) without[k] += cured.by[k];
      by_several += !cured.any;
      bad.push_back(what + cured.list());
    }
  }
  std::printf(
      "%llu cases from seed %llu. Harder: a force above %.1f times the largest of the twin; in the first "
      "10 s of guided motion, in which gaps are met and agreed to, above that of a rigid arm.\n",
      static_cast<unsigned long long>(cases), static_cast<unsigned long long>(first),
      AsItComesVerdict::late_bound);
  head("scene");
  for (int k = 0; k < scenes; ++k) by_scene[k].print(as_it_comes_scenes[k]);
  all.print("all");
  twins.print("their twins, 1 mrad aside");
  head("cause, alone or with others");
  for (std::size_t k = 0; k < std::size(causes); ++k) by_cause[k].print(causes[k].name);
  std::printf(
      "\n| largest force [N] | median | 99 %% | most | of the twins: median | 99 %% | most |\n"
      "|---|---|---|---|---|---|---|\n");
  for (int k = 1; k < scenes; ++k) {
    std::printf("| %s |", as_it_comes_scenes[k]);
    for (auto* list : {&forces[k], &twin_forces[k]}) {
      std::sort(list->begin(), list->end());
      for (const double share : {0.5, 0.99, 1.0})
        std::printf(" %.1f |",
                    list->empty()
                        ? 0.0
                        : (*list)[static_cast<std::size_t>(share * static_cast<double>(list->size() - 1))]);
    }
    std::printf("\n");
  }
  std::printf("\n| reason that was reported | cases |\n|---|---|\n");
  for (int k = 0; k < static_cast<int>(Reason::count); ++k)
    if (by_reason[k] > 0)
      std::printf("| %s | %d |\n", skinctl::describe(static_cast<Reason>(k)), by_reason[k]);
  std::printf(
      "\nharder than one twin: %d, than the hardest of five that start within the gap: %d; a twin declared "
      "truly, "
      "1 mrad aside: %d and %d; beside the goal: %d, a twin too in %d of them\n",
      first_harder, all.late, twins.late, twin_too, all.goal, beside_too);
  std::printf(
      "\nasked for consent: %d, of them %d once, at the start, of encoders off by more than the dead band; "
      "more "
      "than once: %d; where the controller reports the position that it holds: %d\n",
      asked, asked_at_start, asked_again, asked_if_held);
  std::printf(
      "\nmost way of a joint on which no hand led it: %.3f rad; led by more than 0.5 rad further than the "
      "twin: %d\n",
      most_alone, led_further);
  if (!bad.empty()) {
    std::printf("\n| not as promised, but as promised without | cases of %zu |\n|---|---|\n", bad.size());
    for (std::size_t k = 0; k < std::size(cures); ++k)
      std::printf("| %s | %d |\n", cures[k].cause, without[k]);
    std::printf("| none of these alone | %d |\n", by_several);
    std::printf("\nnot as promised (%zu), in brackets each cause without which it is:", bad.size());
    for (std::size_t k = 0; k < bad.size() && k < 1000; ++k)
      std::printf("%s %s", k > 0 ? ";" : "", bad[k].c_str());
    std::printf("\n");
  }
  plotting::Plot plot;
  plot.title = "Largest force after 10 s of guided motion, as a multiple of that of the robot declared truly";
  plot.x_name = "share of the cases [%]";
  plot.y_name = "times";
  for (int k = 0; k < scenes; ++k) {
    if (ratios[k].size() < 2) continue;
    std::sort(ratios[k].begin(), ratios[k].end());
    plotting::Series s{.name = as_it_comes_scenes[k], .x = {}, .y = {}};
    const std::size_t n = ratios[k].size(), stride = std::max<std::size_t>(1, n / 400);
    for (std::size_t i = 0; i < n; i += stride) {
      s.x.push_back(100.0 * static_cast<double>(i) / static_cast<double>(n - 1));
      s.y.push_back(std::min(5.0, ratios[k][i]));
    }
    plot.series.push_back(s);
  }
  const bool drawn =
      plot.series.empty() ||
      plotting::write_svg(folder + "/as_it_comes.svg", plotting::svg_figure("A UR5 as it comes", {plot}));
  return drawn && bad.empty() ? 0 : 1;
}
