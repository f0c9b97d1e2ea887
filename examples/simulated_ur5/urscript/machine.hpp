// Runs a compiled URScript program: threads that take turns where they wait.
#pragma once

#include "examples/simulated_ur5/urscript/builtin.hpp"
#include "examples/simulated_ur5/urscript/code.hpp"

namespace simulated_ur5::urscript {

inline constexpr std::size_t most_threads = 32, deepest_call = 100, highest_stack = 2000;
/// A thread that computes longer than this in one cycle goes on in the next.
inline constexpr int instructions_per_cycle = 10'000;

class Machine {
 public:
  explicit Machine(Code code);

  /// Runs every thread until all wait. Main goes first, and again when what it waited for has come within the
  /// cycle.
  void step(Robot& robot);

  bool ended() const { return ended_; }
  /// Why it ended, if by an error.
  const Problem& problem() const { return problem_; }
  /// Calls that wait begin anew in the next cycle: the program was paused.
  void begin_anew();
  /// The socket from which a thread waits for `count` integers; null: none does.
  std::shared_ptr<Socket> reads_from(std::size_t count, const Sockets& sockets) const;
  /// What was not done because a secondary program must not: names of functions.
  const std::vector<std::string>& skipped() const { return skipped_; }
  const Code& code() const { return code_; }
  int line() const { return threads_.empty() ? 0 : threads_.front().line; }
  /// The value of a global variable as text; empty: there is none.
  std::string variable(std::string_view name) const;

 private:
  struct Frame {
    std::int32_t back = 0;
    std::size_t base = 0;
  };
  struct Thread {
    std::uint32_t number = 0;
    std::int32_t at = 0;
    std::vector<Value> stack;
    std::vector<Frame> frames;
    bool done = false;
    bool waits = false;  ///< in a call that said `again`
    Nanoseconds since{};
    int stage = 0, line = 0;
  };

  bool advance(std::size_t thread, Robot& robot);
  bool execute(Thread& t, const Instruction& i, Robot& robot);
  bool call(Thread& t, const CallSite& site, Robot& robot);
  bool call_builtin(Thread& t, const CallSite& site, Robot& robot);
  bool enter(Thread& t, const CallSite& site, std::int32_t back);
  bool start_thread(Thread& t, const CallSite& site);
  bool index(Thread& t);
  bool store_item(Thread& t, Value& list);
  bool store_field(Thread& t, Value& where, const std::string& field);
  bool make_struct(Thread& t, const CallSite& site);
  void give(Thread& t);
  Value& variable(Thread& t, std::int32_t slot, std::int32_t global) {
    return global != 0 ? globals_[static_cast<std::size_t>(slot)]
                       : t.stack[t.frames.back().base + static_cast<std::size_t>(slot)];
  }
  Value take(Thread& t);
  Thread* find(const Value& number);
  void fail(const Place& at, std::string text);

  Code code_;
  std::vector<Value> globals_;
  std::vector<Thread> threads_;
  std::uint32_t thread_count_ = 0;
  bool ended_ = false;
  Problem problem_;
  std::vector<std::string> skipped_;
};

}  // namespace simulated_ur5::urscript
