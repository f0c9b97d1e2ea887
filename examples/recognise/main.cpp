// Says what a led robot is doing: live, from a recording, or for many people with the tables of what is mistaken for what.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <exception>
#include <map>
#include <thread>

#include "examples/recognise/player.hpp"
#include "examples/support/job.hpp"

namespace {

using namespace recognise;
using namespace skinctl;
using namespace skinctl::testing;

const std::map<std::string, LedTask> tasks = {{"packing", LedTask::packing},
                                              {"pancake", LedTask::pancake},
                                              {"sandwich", LedTask::sandwich},
                                              {"table", LedTask::table}};
constexpr ToolUse uses[] = {{thing::knife, thing::bread, "cut"},
                            {thing::bottle, thing::pan, "pour"},
                            {thing::spatula, thing::pan, "turn over"}};

LedRun simulated(LedTask task, std::uint64_t seed) {
  auto random = seeded(seed);
  const Person person = Person::any(random);
  return led_run(task, person, random());
}
void confusion(const char* name, const Score& s) {
  std::printf(
      "\n%s: right for %.1f %% of the time on-line, %.1f %% as known 60 ms later; %.0f of %.0f segments\n",
      name, 100 * s.online(), 100 * s.later(), s.right_segments, s.segments);
  std::printf("%12s", "s, said:");
  for (std::size_t j = 0; j < activities; ++j) std::printf(" %10s", describe(static_cast<Activity>(j)));
  for (std::size_t i = 1; i < activities; ++i) {
    std::printf("\n%12s", describe(static_cast<Activity>(i)));
    for (std::size_t j = 0; j < activities; ++j) std::printf(" %10.1f", s.said[i][j]);
  }
  std::printf("\n");
}
/// Prints each new word, of `IntentRules` if `intent`; with `speed` > 0 in that multiple of real time, until it is asked to stop.
Outcome tell(const Recording& recording, double speed, bool intent, const std::atomic<bool>& stopped) {
  Activity last = Activity::unknown;
  const auto begun = std::chrono::steady_clock::now();
  std::printf("%8s %8s  %-16s %s\n", "said [s]", "since", "", "meant");
  return play(recording,
              [&](const Line& l, const Recognised& defined, const Recognised& meant, const Features& f) {
                const Recognised& r = intent ? meant : defined;
                const auto due = begun + std::chrono::duration<double>(speed > 0 ? l.time / speed : 0);
                while (!stopped && std::chrono::steady_clock::now() < due)
                  std::this_thread::sleep_for(std::min<std::chrono::duration<double>>(
                      due - std::chrono::steady_clock::now(), std::chrono::milliseconds(50)));
                if (stopped) return;
                if (r.activity == last) return;
                last = r.activity;
                std::printf("%8.3f %8.3f  %-16s %s\n", l.time, seconds<double>(r.since),
                            r.activity == Activity::use ? describe_use(f, uses) : describe(r.activity),
                            describe(l.meant));
                std::fflush(stdout);
              });
}
int finish(const Outcome& outcome, bool stopped) {
  if (stopped) return examples::job::code(examples::job::Exit::interrupted);
  if (outcome.labelled) {
    confusion("by definition", outcome.by_definition);
    confusion("by intent", outcome.by_intent);
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("What is a led robot doing?");
  app.footer(examples::job::exit_help());
  app.require_subcommand(1);
  std::string task = "packing", file;
  std::uint64_t seed = 1;
  double speed = 1;
  int people = 5;
  bool intent = false;
  const auto with_task = [&](CLI::App* command) {
    command->add_option("--task", task, "packing, pancake, sandwich or table")
        ->check(CLI::IsMember(tasks))
        ->capture_default_str();
    command->add_option("--seed", seed, "another person, another run")->capture_default_str();
    return command;
  };
  auto* live =
      with_task(app.add_subcommand("live", "a simulated person leads a robot; words as they are recognised"));
  live->add_option("--speed", speed, "times real time; 0: as fast as possible")
      ->check(CLI::Range(0.0, 1000.0))
      ->capture_default_str();
  const auto with_words = [&](CLI::App* command) {
    command->add_flag("--intent", intent, "say what the person means, not what holds by definition");
  };
  with_words(live);
  auto* record_to = with_task(app.add_subcommand("record", "writes what a simulated person does to a file"));
  record_to->add_option("file", file)->required();
  auto* from = app.add_subcommand("play", "words and tables of a recording");
  from->add_option("file", file)->required();
  with_words(from);
  auto* tables =
      app.add_subcommand("tables", "the four tasks by several people, and what is mistaken for what");
  tables->add_option("--people", people)->check(CLI::Range(1, 1000))->capture_default_str();
  tables->add_option("--seed", seed)->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    const examples::job::StopSignals signals;
    const auto say = [&](const Recording& recording, double pace) {
      const Outcome outcome = tell(recording, pace, intent, signals.asked());
      return finish(outcome, signals.asked());
    };
    if (live->parsed()) return say(record(simulated(tasks.at(task), seed), seed + 1), speed);
    if (record_to->parsed()) {
      write(record(simulated(tasks.at(task), seed), seed + 1), file);
      return 0;
    }
    if (from->parsed()) return say(read(file), 0);
    Score defined, meant;
    for (int i = 0; i < people && !signals.asked(); ++i)
      for (const auto& [name, which] : tasks) {
        const auto out = play(record(simulated(which, seed + static_cast<std::uint64_t>(i)), seed + 1),
                              [](const auto&...) {});
        defined.add(out.by_definition);
        meant.add(out.by_intent);
      }
    if (signals.asked()) return examples::job::code(examples::job::Exit::interrupted);
    confusion("by definition", defined);
    confusion("by intent", meant);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "recognise: %s\n", error.what());
    return 1;
  }
  return 0;
}
