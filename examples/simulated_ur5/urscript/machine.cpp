#include "examples/simulated_ur5/urscript/machine.hpp"

namespace simulated_ur5::urscript {
Machine::Machine(Code code) : code_(std::move(code)), globals_(code_.globals.size()) {
  threads_.reserve(most_threads);
  threads_.emplace_back();
  threads_.back().number = ++thread_count_;
  threads_.back().frames.push_back({});
}

void Machine::step(Robot& robot) {
  for (int pass = 0; pass < 8 && !ended_; ++pass) {
    bool progress = false;
    for (std::size_t i = 0; i < threads_.size() && !ended_; ++i) progress = advance(i, robot) || progress;
    if (!progress) break;
  }
  // Main stays first; what has ended makes room.
  for (std::size_t i = threads_.size(); i-- > 1;)
    if (threads_[i].done) threads_.erase(threads_.begin() + static_cast<std::ptrdiff_t>(i));
}

void Machine::begin_anew() {
  for (Thread& t : threads_) t.waits = false;
}

bool Machine::advance(std::size_t thread, Robot& robot) {
  // Threads are reserved: starting one moves no other.
  Thread& t = threads_[thread];
  int left = instructions_per_cycle;
  while (!t.done && !ended_ && left-- > 0) {
    const Instruction& i = code_.instructions[static_cast<std::size_t>(t.at)];
    t.line = i.at.line;
    if (!execute(t, i, robot)) break;
    if (t.stack.size() > highest_stack) fail(i.at, "runtime_error_stack_too_high");
  }
  return left < instructions_per_cycle - 1 && left > 0;
}

Value Machine::take(Thread& t) {
  Value v = std::move(t.stack.back());
  t.stack.pop_back();
  return v;
}

void Machine::fail(const Place& at, std::string text) {
  if (ended_) return;
  problem_ = {at, std::move(text)};
  ended_ = true;
}

Machine::Thread* Machine::find(const Value& number) {
  const auto* n = number.as<ThreadNumber>();
  if (!n) return nullptr;
  for (Thread& t : threads_)
    if (t.number == n->number && !t.done) return &t;
  return nullptr;
}

/// False: the thread goes no further in this cycle.
bool Machine::execute(Thread& t, const Instruction& i, Robot& robot) {
  const auto a = static_cast<std::size_t>(i.a);
  const std::int32_t next = t.at + 1;
  const auto stop = [&](const char* why) {
    fail(i.at, why);
    return false;
  };
  switch (i.op) {
    case Op::constant:
      t.stack.push_back(code_.constants[a]);
      break;
    case Op::load:
      t.stack.push_back(variable(t, i.a, i.b));
      break;
    case Op::store: {
      Value v = take(t);
      variable(t, i.a, i.b) = std::move(v);
      break;
    }
    case Op::index:
      if (!index(t)) return stop("runtime_error_index");
      break;
    case Op::store_item:
      if (!store_item(t, variable(t, i.a, i.b))) return stop("runtime_error_index");
      break;
    case Op::field: {
      const Value from = take(t);
      const auto* s = from.as<Struct>();
      const std::string& name = *code_.constants[a].as<std::string>();
      const Value* found = nullptr;
      if (s)
        for (const auto& [key, value] : s->fields)
          if (key == name) found = &value;
      if (!found) return stop("runtime_error_no_such_field");
      t.stack.push_back(*found);
      break;
    }
    case Op::store_field:
      if (!store_field(t, variable(t, i.a, i.b % 2),
                       *code_.constants[static_cast<std::size_t>(i.b / 2)].as<std::string>()))
        return stop("runtime_error_no_such_field");
      break;
    case Op::make_list: {
      const auto first = t.stack.end() - i.a;
      auto list =
          list_of(std::vector<Value>(std::make_move_iterator(first), std::make_move_iterator(t.stack.end())));
      t.stack.erase(first, t.stack.end());
      if (!list) return stop("runtime_error_list_too_large");
      t.stack.push_back(std::move(*list));
      break;
    }
    case Op::make_pose: {
      Pose6 p{};
      for (std::size_t k = 6; k-- > 0;) {
        const auto n = take(t).number();
        if (!n) return stop("runtime_error_type:pose");
        p[k] = *n;
      }
      t.stack.emplace_back(p);
      break;
    }
    case Op::make_struct:
      if (!make_struct(t, code_.calls[a])) return stop("runtime_error_list_too_large");
      break;
    case Op::binary: {
      const Value right = take(t), left = take(t);
      const auto operation = static_cast<Operation>(i.a);
      auto v = i.b == 0 ? combine(operation, left, right) : combine(operation, right, left);
      if (!v) return stop("runtime_error_operands");
      t.stack.push_back(std::move(*v));
      break;
    }
    case Op::negate: {
      auto v = combine(Operation::multiply, take(t), -1);
      if (!v) return stop("runtime_error_operands");
      t.stack.push_back(std::move(*v));
      break;
    }
    case Op::invert:
      t.stack.emplace_back(!take(t).truth());
      break;
    case Op::jump:
      t.at = i.a;
      return true;
    case Op::jump_unless:
      t.at = take(t).truth() ? next : i.a;
      return true;
    case Op::keep_unless:
    case Op::keep_if:
      if (t.stack.back().truth() == (i.op == Op::keep_if)) {
        t.at = i.a;
      } else {
        t.stack.pop_back();
        t.at = next;
      }
      return true;
    case Op::call:
      return call(t, code_.calls[a], robot);
    case Op::run:
      if (!start_thread(t, code_.calls[a])) return false;
      break;
    case Op::join:
      if (find(t.stack.back())) return false;
      t.stack.pop_back();
      break;
    case Op::kill: {
      const Value number = take(t);
      if (Thread* other = find(number)) other->done = true;
      break;
    }
    case Op::give:
      give(t);
      return true;
    case Op::pop:
      t.stack.pop_back();
      break;
    case Op::halt:
      ended_ = true;
      return false;
  }
  t.at = next;
  return true;
}

void Machine::give(Thread& t) {
  Value v = take(t);
  const Frame frame = t.frames.back();
  t.frames.pop_back();
  if (frame.back < 0 || t.frames.empty()) {
    t.done = true;
    if (t.number == threads_.front().number) ended_ = true;
    return;
  }
  t.stack.resize(frame.base);
  t.stack.push_back(std::move(v));
  t.at = frame.back;
}

bool Machine::call(Thread& t, const CallSite& site, Robot& robot) {
  return site.builtin ? call_builtin(t, site, robot) : enter(t, site, t.at + 1);
}

/// Arguments from the top of the stack become the first variables of a new frame.
bool Machine::enter(Thread& t, const CallSite& site, std::int32_t back) {
  const Function& f = code_.functions[static_cast<std::size_t>(site.function)];
  if (t.frames.size() >= deepest_call) {
    fail(site.at, "runtime_error_calls_too_deep");
    return false;
  }
  std::vector<Value> locals(static_cast<std::size_t>(f.locals));
  std::vector<bool> given(f.parameters.size());
  const std::size_t first = t.stack.size() - site.names.size();
  for (std::size_t i = 0; i < site.names.size(); ++i) {
    const auto to = static_cast<std::size_t>(site.target[i]);
    locals[to] = std::move(t.stack[first + i]);
    given[to] = true;
  }
  t.stack.resize(first);
  for (std::size_t p = 0; p < f.parameters.size(); ++p) {
    if (given[p]) continue;
    if (f.parameters[p].otherwise.empty()) {
      fail(site.at, "runtime_error_argument_missing:" + f.parameters[p].name + ":");
      return false;
    }
    locals[p] = f.parameters[p].otherwise;
  }
  t.frames.push_back({back, t.stack.size()});
  for (Value& v : locals) t.stack.push_back(std::move(v));
  t.at = f.start;
  return true;
}

bool Machine::start_thread(Thread& t, const CallSite& site) {
  if (site.function < 0) {
    fail(site.at, "compile_error_no_thread:" + site.name + ":");
    return false;
  }
  std::size_t alive = 0;
  for (const Thread& other : threads_) alive += other.done ? 0 : 1;
  if (alive >= most_threads || threads_.size() >= threads_.capacity()) {
    fail(site.at, "runtime_error_too_many_threads");
    return false;
  }
  Thread fresh;
  const std::size_t first = t.stack.size() - site.names.size();
  fresh.stack.assign(t.stack.begin() + static_cast<std::ptrdiff_t>(first), t.stack.end());
  t.stack.resize(first);
  fresh.number = ++thread_count_;
  if (!enter(fresh, site, -1)) return false;
  t.stack.emplace_back(ThreadNumber{fresh.number});
  threads_.push_back(std::move(fresh));
  return true;
}

bool Machine::call_builtin(Thread& t, const CallSite& site, Robot& robot) {
  const std::size_t count = site.names.size(), first = t.stack.size() - count;
  if (code_.secondary && site.builtin->moves) {
    skipped_.push_back(site.name);
    t.stack.resize(first);
    t.stack.emplace_back();
    ++t.at;
    return skipped_.size() < 100;
  }
  std::vector<Value> arguments;
  for (std::size_t i = 0; i < count; ++i) {
    const auto to = static_cast<std::size_t>(site.target[i]);
    if (arguments.size() <= to) arguments.resize(to + 1);
    arguments[to] = t.stack[first + i];
  }
  if (!t.waits) {
    t.since = robot.now;
    t.stage = 0;
  }
  Call call{site.name, robot, arguments, !t.waits, t.since, t.stage};
  const Outcome outcome = site.builtin->act(call);
  t.waits = outcome == Outcome::again;
  switch (outcome) {
    case Outcome::again:
      return false;
    case Outcome::failed:
      fail(site.at, call.error);
      return false;
    case Outcome::ended:
      ended_ = true;
      return false;
    case Outcome::done:
      break;
  }
  t.stack.resize(first);
  t.stack.push_back(std::move(call.result));
  ++t.at;
  return true;
}

}  // namespace simulated_ur5::urscript
