// The compiler's statements.
#include "examples/simulated_ur5/urscript/compiler.hpp"

namespace simulated_ur5::urscript {
namespace {

constexpr std::string_view until_branch[] = {"end", "elif", "else"};

}  // namespace

void Compiler::statement() {
  if (accept("def")) return definition(false);
  if (accept("thread")) return definition(true);
  if (accept("if")) return branch();
  if (accept("while")) return loop();
  if (accept("global")) return assignment(true, false);
  if (accept("local")) return assignment(false, true);
  if (accept("pass") || accept("enter_critical") || accept("exit_critical")) {
    // Threads change only where they wait: every stretch in between is critical.
    if (accept("(")) expect(")");
    return;
  }
  if (accept("halt")) {
    if (accept("(")) expect(")");
    emit(Op::halt);
    return;
  }
  if (accept("return")) {
    if (at_line_end())
      emit(Op::constant, constant({}));
    else
      expression();
    emit(Op::give);
    return;
  }
  if (now().is("join") || now().is("kill")) {
    const Op op = now().is("join") ? Op::join : Op::kill;
    ++at_;
    expression();
    emit(op);
    return;
  }
  if (now().is("break") || now().is("continue")) {
    if (loops_.empty()) return fail(now().at, "compile_error_outside_of_loop:" + now().words() + ":");
    if (accept("break"))
      loops_.back().leaves.push_back(emit(Op::jump));
    else if (accept("continue"))
      emit(Op::jump, loops_.back().start);
    return;
  }
  const bool name = now().kind == Token::Kind::name && !begins_pose() && !now().is("not");
  if (name && (ahead(1).is("=") || ahead(1).is("[") || (ahead(1).is(".") && ahead(3).is("="))))
    return assignment(false, false);
  expression();
  emit(Op::pop);
}

void Compiler::definition(bool thread) {
  const Nested nested(*this);
  const Place at = now().at;
  if (function_ != 0) return fail(at, "compile_error_function_within_function");
  Function function;
  function.thread = thread;
  function.name = expect_name();
  const std::int32_t over = emit(Op::jump);
  function.start = here();
  const auto number = static_cast<std::int32_t>(code_.functions.size());
  functions_[function.name] = number;
  code_.functions.push_back(function);
  locals_.clear();
  function_ = number;
  const auto outer_loops = std::move(loops_);
  loops_.clear();
  expect("(");
  parameters(code_.functions.back());
  expect(":");
  block(until_end);
  expect("end");
  emit(Op::constant, constant({}));
  emit(Op::give);
  loops_ = outer_loops;
  function_ = 0;
  locals_.clear();
  land(over);
}

void Compiler::parameters(Function& function) {
  while (good() && !accept(")")) {
    Function::Parameter p;
    p.name = expect_name();
    declare(p.name, false);
    if (accept("=")) p.otherwise = literal();
    function.parameters.push_back(std::move(p));
    if (function.parameters.size() > most_arguments) fail(now().at, "compile_error_too_many_parameters");
    if (!now().is(")")) expect(",");
  }
}

Value Compiler::literal() {
  // Compile it, take its constant back.
  const std::size_t before = code_.instructions.size();
  factor();
  if (!good()) return {};
  auto& all = code_.instructions;
  const bool one = all.size() == before + 1 && all.back().op == Op::constant;
  const bool negative =
      all.size() == before + 2 && all.back().op == Op::negate && all[before].op == Op::constant;
  if (!one && !negative) {
    fail(now().at, "compile_error_default_is_no_constant");
    return {};
  }
  Value v = code_.constants[static_cast<std::size_t>(all[before].a)];
  all.resize(before);
  if (!negative) return v;
  return combine(Operation::subtract, 0, v).value_or(Value{});
}

void Compiler::branch() {
  const Nested nested(*this);
  std::vector<std::int32_t> to_end;
  for (;;) {
    expression();
    expect(":");
    const std::int32_t next = emit(Op::jump_unless);
    block(until_branch);
    to_end.push_back(emit(Op::jump));
    if (good()) land(next);
    if (!accept("elif")) break;
  }
  if (accept("else")) {
    expect(":");
    block(until_end);
  }
  expect("end");
  for (const std::int32_t jump : to_end) land(jump);
}

void Compiler::loop() {
  const Nested nested(*this);
  loops_.push_back({here(), {}});
  expression();
  expect(":");
  const std::int32_t leave = emit(Op::jump_unless);
  block(until_end);
  expect("end");
  emit(Op::jump, loops_.back().start);
  land(leave);
  for (const std::int32_t jump : loops_.back().leaves) land(jump);
  loops_.pop_back();
}

void Compiler::expect_assignment() {
  expect("=");
  skip_lines();
}

void Compiler::assignment(bool global, bool local) {
  const Token name = now();
  expect_name();
  if (!good()) return;
  const Variable* known = find(name.text);
  if (accept("[") || now().is(".")) {
    if (!known) return fail(name.at, "compile_error_name_not_found:" + name.words() + ":");
    const Variable v = *known;
    if (accept(".")) {
      const std::int32_t field = constant(Value(expect_name()));
      expect_assignment();
      expression();
      emit(Op::store_field, v.slot, 2 * field + v.global);
      return;
    }
    expression();
    expect("]");
    expect_assignment();
    expression();
    emit(Op::store_item, v.slot, v.global);
    return;
  }
  expect_assignment();
  expression();
  const bool new_one = !known || (local && known->global != 0 && function_ != 0);
  const Variable v = new_one ? declare(name.text, global || function_ == 0) : *find(name.text);
  emit(Op::store, v.slot, v.global);
}

}  // namespace simulated_ur5::urscript
