// How long a cycle takes at worst: `worst_case [cycles [repeated cycles]]`.
//
// Ten million cycles of a UR5 with 260 cells that reaches and is touched, without and with a governor, as
// isolated as the machine allows: on one core, with real-time priority and locked memory where they are
// granted. After each cycle runs an empty loop of the same median length: what is seen of it beyond that is
// the machine's doing, and so is as much of the cycle's. CycleStage by stage, and the slowest one again.
//
// Then a million cycles, each five times or more from its memory and input: the fastest is what the cycle
// takes where nobody disturbs it, and the worst of those is the cycle's own. Where the processor lets its
// instructions be counted, how many a cycle takes, which no neighbour changes.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <thread>

#if defined(__linux__)
#include <linux/perf_event.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>
#endif

#include "skinctl/cycle/stopwatch.hpp"
#include "skinctl/hardware/histogram.hpp"
#include "skinctl/hardware/scheduling.hpp"
#include "skinctl/limits/contact_limits.hpp"
#include "skinctl/limits/jerk_limits.hpp"
#include "skinctl/limits/tool_speed.hpp"
#include "tests/support/robot_table.hpp"
#include "tests/support/scene.hpp"

using namespace skinctl;
using namespace skinctl::testing;

namespace {

/// What happens to the arm, from a seed: new samples each cycle, a goal now and then.
template <class Scene>
class Day {
 public:
  explicit Day(const Scene& scene) : scene_(scene) {
    state_.q = home_position();
    scene.start(*memory_, state_);
  }
  typename Scene::Memory& memory() { return *memory_; }
  const typename Scene::Input& input() const { return input_; }
  const std::array<CellSample, 16>& samples() const { return samples_; }

  void next() {
    const bool goal = random_.index(2000) == 0;
    input_.now += 8ms;
    input_.measured = state_;
    input_.measured.time = input_.now;
    for (auto& s : samples_)
      s = {.time = input_.now - 1us * random_.index(8000),
           .cell = static_cast<std::uint32_t>(1 + random_.index(260)),
           .force = {static_cast<float>(random_.index(3) == 0 ? random_.uniform(0, 0.3) : 0), 0, 0}};
    input_.samples = samples_;
    input_.goal.reset();
    if (!goal) return;
    input_.goal.emplace();
    for (auto& x : input_.goal->q_g) x = random_.uniform(-1.5, 1.5);
    input_.goal->duration = nanoseconds(random_.uniform(2, 8));
  }
  template <class Watch>
  void step(Watch&& watch) {
    const auto out = scene_.step(*memory_, input_, watch);
    state_.q = out.command.position;
    state_.dq = out.planned.velocity;
  }
  double checksum() const { return state_.q[0]; }

 private:
  const Scene& scene_;
  std::unique_ptr<typename Scene::Memory> memory_ = std::make_unique<typename Scene::Memory>();
  typename Scene::Input input_;
  std::array<CellSample, 16> samples_;
  State<6> state_;
  oracle::Random random_{1};
};

/// Turns that take a time and nothing else: no memory, no branch that can be foretold wrongly.
__attribute__((noinline)) void spin(long turns) {
  for (long k = 0; k < turns; ++k) asm volatile("" ::: "memory");
}
Nanoseconds time_of(long turns) {
  const Nanoseconds begin = Stopwatch::now();
  spin(turns);
  return Stopwatch::now() - begin;
}
/// How many turns take `wanted` nanoseconds, in the median.
long turns_for(Nanoseconds wanted) {
  double each = 1;
  for (int round = 0; round < 5; ++round) {
    const long turns = std::max(1L, static_cast<long>(static_cast<double>(wanted.count()) / each));
    std::array<Nanoseconds, 2001> took;
    for (auto& t : took) t = time_of(turns);
    std::nth_element(took.begin(), took.begin() + 1000, took.end());
    each = static_cast<double>(took[1000].count()) / static_cast<double>(turns);
  }
  return static_cast<long>(static_cast<double>(wanted.count()) / each);
}

void row(const char* name, const Histogram& h) {
  std::printf("%-12s %8.0f", name, h.mean());
  for (const double p : {0.5, 0.99, 0.999, 0.9999, 0.99999})
    std::printf(" %9lld", (long long)h.percentile(p).count());
  std::printf(" %10lld\n", (long long)h.max().count());
}

#if defined(__linux__)
std::string pin() {
  const int core = sched_getcpu();
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(core < 0 ? 0 : core), &set);
  return sched_setaffinity(0, sizeof set, &set) == 0 ? "on core " + std::to_string(core) + " alone\n"
                                                     : "not bound to a core\n";
}
/// What the machine did to this thread so far.
struct Disturbance {
  long switched = 0, faults = 0;
  unsigned long long interrupts = 0;

  static Disturbance now() {
    Disturbance d;
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    d.switched = usage.ru_nivcsw;
    d.faults = usage.ru_minflt + usage.ru_majflt;
    const int core = sched_getcpu();
    if (std::FILE* file = std::fopen("/proc/interrupts", "r")) {
      char line[4096];
      while (std::fgets(line, sizeof line, file) != nullptr) {
        const char* at = std::strchr(line, ':');
        for (int k = 0; at != nullptr && k <= core; ++k) {
          char* end = nullptr;
          const auto n = std::strtoull(at + (k == 0 ? 1 : 0), &end, 10);
          if (end == at + (k == 0 ? 1 : 0)) break;
          if (k == core) d.interrupts += n;
          at = end;
        }
      }
      std::fclose(file);
    }
    return d;
  }
};

/// Instructions of this thread outside the kernel, by the processor's own counter.
class Counter {
 public:
  Counter() {
    perf_event_attr a{};
    a.type = PERF_TYPE_HARDWARE;
    a.size = sizeof a;
    a.config = PERF_COUNT_HW_INSTRUCTIONS;
    a.exclude_kernel = a.exclude_hv = 1;
    file_ = static_cast<int>(syscall(SYS_perf_event_open, &a, 0, -1, -1, 0));
  }
  ~Counter() {
    if (file_ >= 0) close(file_);
  }
  bool there() const { return file_ >= 0; }
  long long read() const {
    long long n = 0;
    return ::read(file_, &n, sizeof n) == sizeof n ? n : 0;
  }

 private:
  int file_ = -1;
};

#else
std::string pin() {
  return "";
}
struct Disturbance {
  long switched = 0, faults = 0;
  unsigned long long interrupts = 0;
  static Disturbance now() { return {}; }
};
struct Counter {
  bool there() const { return false; }
  long long read() const { return 0; }
};
#endif

/// Each cycle five times from where it begins: the fastest, and its instructions where they can be counted.
template <class Scene>
void undisturbed(const Scene& scene, long cycles) {
  Day day(scene);
  const auto before = std::make_unique<typename Scene::Memory>();
  const Counter counter;
  Histogram fastest, counts;
  for (long k = -1000; k < cycles; ++k) {
    day.next();
    std::memcpy(static_cast<void*>(before.get()), &day.memory(), sizeof *before);
    Nanoseconds least = 1s;
    // One that seems to be the worst is looked at again.
    for (int n = 0; n < 5 || (n < 50 && least > fastest.max()); ++n) {
      if (n > 0) std::memcpy(static_cast<void*>(&day.memory()), before.get(), sizeof *before);
      const Nanoseconds begin = Stopwatch::now();
      day.step(NoStopwatch{});
      least = std::min(least, Stopwatch::now() - begin);
    }
    long long count = 0;
    if (counter.there()) {
      std::memcpy(static_cast<void*>(&day.memory()), before.get(), sizeof *before);
      count = counter.read();
      day.step(NoStopwatch{});
      count = counter.read() - count;
    }
    if (k < 0) continue;
    fastest.record(least);
    counts.record(Nanoseconds(count));  // instructions, told apart by the same buckets
  }
  row("undisturbed", fastest);
  if (counter.there()) row("instructions", counts);
  if (!counter.there()) std::printf("(this machine does not let instructions be counted)\n");
}

template <class Scene>
void study(const char* name, const Scene& scene, long cycles, long repeated) {
  Day day(scene);
  const auto before = std::make_unique<typename Scene::Memory>(),
             worst_memory = std::make_unique<typename Scene::Memory>();
  typename Scene::Input worst_input;
  std::array<CellSample, 16> worst_samples{};
  Histogram warm;
  for (int k = 0; k < 20000; ++k) {
    Stopwatch watch;
    day.next();
    day.step(watch);
    warm.record(watch.total());
  }
  long turns = turns_for(warm.percentile(0.5));
  std::array<Histogram, stage_count> stages;
  Histogram whole, empty, lately[2];
  const auto began = Disturbance::now();
  for (long k = 0; k < cycles; ++k) {
    day.next();
    std::memcpy(static_cast<void*>(before.get()), &day.memory(), sizeof *before);
    Stopwatch watch;
    day.step(watch);
    for (std::size_t s = 0; s < stage_count; ++s) stages[s].record(watch[static_cast<CycleStage>(s)]);
    if (watch.total() > whole.max()) {
      *worst_memory = *before;
      worst_input = day.input();
      worst_samples = day.samples();
    }
    whole.record(watch.total());
    const Nanoseconds nothing = time_of(turns);
    empty.record(nothing);
    lately[0].record(watch.total());
    lately[1].record(nothing);
    if (k % 10000 == 9999) {  // neighbours change how fast the core is
      turns = turns * lately[0].percentile(0.5).count() / std::max(lately[1].percentile(0.5), 1ns).count();
      lately[0] = lately[1] = {};
    }
    // Who takes all of a core at real-time priority is stopped for 50 ms in each second.
    if (k % 250 == 0) std::this_thread::sleep_for(std::chrono::microseconds(200));
  }
  const auto ended = Disturbance::now();
  std::printf("\n%s, %ld cycles, ns\n%-12s %8s %9s %9s %9s %9s %9s %10s\n", name, cycles, "stage", "mean",
              "p50", "p99", "p99.9", "p99.99", "p99.999", "worst");
  for (std::size_t s = 0; s < stage_count; ++s) row(skinctl::name(static_cast<CycleStage>(s)), stages[s]);
  row("whole", whole);
  row("empty loop", empty);
  undisturbed(scene, repeated);
  std::printf("meanwhile: switched away %ld times, %llu interrupts on this core, %ld page faults\n",
              ended.switched - began.switched, ended.interrupts - began.interrupts,
              ended.faults - began.faults);
  worst_input.samples = worst_samples;
  Histogram again;
  double sum = day.checksum();
  for (int k = 0; k < 1000; ++k) {
    day.memory() = *worst_memory;
    Stopwatch watch;
    sum += scene.step(day.memory(), worst_input, watch).command.position[0];
    again.record(watch.total());
  }
  std::printf(
      "the slowest cycle, from its memory and input, 1000 times again: median %lld, worst %lld (checksum "
      "%g)\n",
      (long long)again.percentile(0.5).count(), (long long)again.max().count(), sum);
}

}  // namespace

int main(int argc, char** argv) {
  const long cycles = argc > 1 ? std::atol(argv[1]) : 10'000'000;
  const long repeated = argc > 2 ? std::atol(argv[2]) : 1'000'000;
  std::printf("%s%s", request_real_time().report.c_str(), pin().c_str());
  const auto plain = reaching_scene();
  study("without governor", plain, cycles, repeated);
  LinkContact<2> contact{
      .region = {.force = 100, .blow = 200, .first = 500ms, .stiffness = 5e4, .mass = 4, .power = 80},
      .reach = 0.5,
      .reaction = 20ms};
  study("with contact limits, tool speed and jerk",
        plain.with(contact, MaxToolSpeed<5>{.speed = 1, .reach = 1.3}, MaxJerk{JointJerk<6>::constant(500)}),
        cycles, repeated);
}
