// Teaches a task by demonstrations: records them, learns a task that people read back, and runs it among
// other things.
#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdio>
#include <exception>
#include <fstream>
#include <thread>

#include "examples/support/job.hpp"
#include "examples/support/output_file.hpp"
#include "examples/support/program.hpp"
#include "examples/teach/kinematic_world.hpp"
#include "examples/teach/player.hpp"
#include "examples/teach/written.hpp"
#include "examples/worlds/demonstrations.hpp"

namespace {
using namespace teach;
using namespace skinctl;
using namespace skinctl::testing;

const std::map<std::string, LedTask> tasks = {{"packing", LedTask::packing},
                                              {"pancake", LedTask::pancake},
                                              {"sandwich", LedTask::sandwich},
                                              {"table", LedTask::table}};
const char* const names[] = {"",        "orange", "box",   "bin",   "bottle", "pan",
                             "spatula", "knife",  "bread", "plate", "cup",    "fork"};

/// What a simulated person of a kind shows.
Recording simulated(LedTask task, const std::string& people, std::uint64_t seed, double nearer = 0) {
  const auto kinds = kinds_of_people();
  const auto kind = std::find_if(kinds.begin(), kinds.end(), [&](const Kind& k) { return k.name == people; });
  if (kind == kinds.end()) throw std::runtime_error("there are no such people: " + people);
  Recording out{{{}, kitchen().deeds.containers}, {}};
  auto random = seeded(seed);
  Person person = Person::any(random);
  ShownBy by;
  kind->change(person, by);
  out.shown =
      shown(led_run(task, person, seed * 10 + 1), by, seed * 10 + 2, {hard_orange, soft_orange, hard_orange});
  for (const auto k : out.shown.kinds) out.classes.names[k] = names[k];
  const Xyz<double> moved{-nearer, 0, 0};
  for (auto& x : out.shown.hand) x.X_WH = {x.X_WH.axes(), x.X_WH.origin() + moved};
  for (auto& x : out.shown.seen) x.X_WO = {x.X_WO.axes(), x.X_WO.origin() + moved};
  return out;
}
void save(const std::string& file, const std::string& text) {
  if (file.empty()) return;
  std::ofstream out(file, std::ios::binary);
  out << text;
  if (!out.flush()) throw std::runtime_error("cannot write " + file);
}
int learn_from(const std::vector<std::string>& files, const std::string& json, const std::string& svg,
               const std::string& xml, bool round) {
  NamedTask out;
  std::vector<Demonstration<>> shown;
  LearnSettings settings;
  for (const auto& file : files) {
    const Recording r = read(file);
    for (const auto& [kind, name] : r.classes.names)
      if (const auto [at, is_new] = out.classes.names.try_emplace(kind, name); !is_new && at->second != name)
        throw std::runtime_error(file + ": class " + std::to_string(int(kind)) + " has another name there");
    out.classes.containers |= r.classes.containers;
    shown.push_back(r.shown);
  }
  settings.deeds.containers = out.classes.containers;
  const auto learnt = learn<max_steps>(shown, settings);
  if (learnt.why != Refusal::none) {
    std::printf("refused: %s\n", describe(learnt.why));
    if (learnt.at > 0ns)
      std::printf("(%s, at %.2f s)\n", files[learnt.demonstration].c_str(), seconds<double>(learnt.at));
    return examples::job::code(examples::job::Exit::refused);
  }
  out.task = learnt.task;
  out.ways = learnt.ways;
  std::printf("%s%d steps, %d places, %d borders; proved\n", to_text(out).c_str(), int(out.task.size),
              int(out.task.place_count), int(out.task.border_count));
  save(json, to_json(round ? NamedTask{one_round(out.task), out.classes, out.ways} : out));
  save(svg, to_svg(out));
  save(xml, to_xml(out));
  return 0;
}
int run_task(const std::string& file, int count, std::uint64_t seed, double pace, bool quiet,
             const std::atomic<bool>& stopped) {
  const NamedTask task = load(file);
  if (task.task.begins.any())
    throw std::runtime_error("it begins with " + to_text(task.task.begins) + ": it is a part of a process");
  const RunResult r = run(task, count, seed, pace, !quiet, stopped);
  if (stopped) return examples::job::code(examples::job::Exit::interrupted);
  std::map<std::string, int> ends;
  for (const auto& thing : r.things)
    if (thing.placed)
      ++ends[task.classes.name(thing.kind) + (thing.stiffness > 2000 ? ", hard" : ", soft") + ": " +
             task.classes.name(thing.ends_at)];
  for (const auto& [words, number] : ends) std::printf("%3d %s\n", number, words.c_str());
  std::printf("%s after %.0f s, %d requests, %d failures, %d questions\n",
              r.finished ? "finished" : "not finished", r.lasted, r.requests, r.failures, r.questions);
  return r.finished ? 0 : 1;
}
int live(const Recording& recording, double speed, const std::atomic<bool>& stopped) {
  const auto begun = std::chrono::steady_clock::now();
  play(recording, [&](Nanoseconds time, const char* word, Nanoseconds since) {
    const auto due = begun + std::chrono::duration<double>(speed > 0 ? seconds<double>(time) / speed : 0);
    while (!stopped && std::chrono::steady_clock::now() < due)
      std::this_thread::sleep_for(std::min<std::chrono::duration<double>>(
          due - std::chrono::steady_clock::now(), std::chrono::milliseconds(50)));
    if (stopped || word == nullptr) return;
    std::printf("%8.3f %8.3f  %s\n", seconds<double>(time), seconds<double>(since), word);
    std::fflush(stdout);
  });
  return stopped ? examples::job::code(examples::job::Exit::interrupted) : 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Teaches a task by demonstrations.");
  app.footer(examples::job::exit_help());
  app.require_subcommand(1);
  std::string task = "packing", people = "ordinary", file, json, svg, xml;
  std::vector<std::string> files;
  std::uint64_t seed = 1;
  double speed = 1, pace = 0, nearer = 0;
  int count = 24;
  bool quiet = false;
  const auto by_whom = [&](CLI::App* command) {
    command->add_option("--task", task, "packing, pancake, sandwich or table")
        ->check(CLI::IsMember(tasks))
        ->capture_default_str();
    command->add_option("--people", people, "the kind of person, as the study `teaching` names it")
        ->capture_default_str();
    command->add_option("--seed", seed, "another person, another run")->capture_default_str();
  };
  auto* record = app.add_subcommand("record", "writes what a simulated person shows to a file");
  by_whom(record);
  record->add_option("--nearer", nearer, "everything stands so much nearer to the arm that is led [m]")
      ->check(CLI::Range(0.0, 0.3));
  record->add_option("file", file)->required();
  auto* learns = app.add_subcommand("learn", "the task that recordings show, or why there is none");
  learns->add_option("files", files)->required();
  learns->add_option("--task", json, "writes the task as JSON");
  bool round = false;
  learns->add_flag("--round", round,
                   "one round of what is done until nothing is left, for a process of several tasks");
  learns->add_option("--svg", svg, "draws it");
  learns->add_option("--xml", xml, "writes it as a tree of BehaviorTree.CPP");
  auto* runs = app.add_subcommand("run", "runs a learnt task in a kinematic world, at other places");
  runs->add_option("task", file)->required();
  runs->add_option("--count", count, "things of each kind that is done until none is left")
      ->check(CLI::Range(0, 1000));
  runs->add_option("--seed", seed, "another world")->capture_default_str();
  runs->add_option("--speed", pace, "times real time; 0: as fast as possible")
      ->check(CLI::Range(0.0, 1000.0));
  runs->add_flag("--quiet", quiet, "only the result");
  auto* lives =
      app.add_subcommand("live", "words as they are recognised, of a recording or a simulated person");
  by_whom(lives);
  lives->add_option("file", file, "a recording");
  lives->add_option("--speed", speed, "times real time; 0: as fast as possible")
      ->check(CLI::Range(0.0, 1000.0));
  if (const auto end = examples::job::parse(app, argc, argv)) return *end;
  try {
    const examples::job::StopSignals signals;
    for (const auto& in : files)
      for (const auto& out : {json, svg, xml}) examples::refuse_own_input(out, {in});
    if (record->parsed()) write(simulated(tasks.at(task), people, seed, nearer), file);
    if (learns->parsed()) return learn_from(files, json, svg, xml, round);
    if (runs->parsed()) return run_task(file, count, seed, pace, quiet, signals.asked());
    if (lives->parsed())
      return live(file.empty() ? simulated(tasks.at(task), people, seed) : read(file), speed,
                  signals.asked());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "teach: %s\n", error.what());
    return 1;
  }
  return 0;
}
