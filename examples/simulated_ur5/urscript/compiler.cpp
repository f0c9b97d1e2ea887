#include "examples/simulated_ur5/urscript/compiler.hpp"

#include "examples/simulated_ur5/urscript/builtin.hpp"

namespace simulated_ur5::urscript {
namespace {

constexpr std::string_view until_end[] = {"end"};
constexpr std::string_view until_branch[] = {"end", "elif", "else"};

std::string quoted(const Token& t) {
  if (t.kind == Token::Kind::end) return "end_of_program";
  if (t.kind == Token::Kind::line_end) return "end_of_line";
  return std::string(t.text.substr(0, 60));
}

}  // namespace

Problem compile(std::string_view text, const Version& version, Code& code) {
  code = Code{};
  return Compiler(tokens_of(text), version, code).run();
}

Problem Compiler::run() {
  code_.functions.emplace_back();
  program();
  if (good()) link();
  return problem_;
}

bool Compiler::accept(std::string_view s) {
  if (!good() || !now().is(s)) return false;
  ++at_;
  return true;
}
void Compiler::expect(std::string_view s) {
  if (good() && !accept(s))
    fail(now().at, "compile_error_expected:" + std::string(s) + ":before:" + quoted(now()) + ":");
}
std::string Compiler::expect_name() {
  if (!good()) return {};
  if (now().kind != Token::Kind::name) {
    fail(now().at, "compile_error_expected:name:before:" + quoted(now()) + ":");
    return {};
  }
  return std::string(tokens_[at_++].text.substr(0, 200));
}
void Compiler::skip_lines() {
  while (now().kind == Token::Kind::line_end) ++at_;
}
void Compiler::fail(const Place& at, std::string text) {
  if (good()) problem_ = {at, std::move(text)};
}

void Compiler::program() {
  skip_lines();
  const bool block_of_its_own = now().is("def") || now().is("sec");
  if (block_of_its_own) {
    code_.secondary = now().is("sec");
    ++at_;
    code_.name = expect_name();
    expect("(");
    expect(")");
    expect(":");
    block(until_end);
    expect("end");
    skip_lines();
    if (good() && now().kind != Token::Kind::end)
      fail(now().at, "compile_error_text_behind_program:" + quoted(now()) + ":");
  } else {
    block({});
    if (good() && now().kind != Token::Kind::end)
      fail(now().at, "compile_error_unexpected:" + quoted(now()) + ":");
  }
  emit(Op::halt);
}

void Compiler::block(std::span<const std::string_view> ends) {
  const Nested nested(*this);
  while (good()) {
    skip_lines();
    if (now().kind == Token::Kind::end) return;
    for (const std::string_view e : ends)
      if (now().is(e)) return;
    statement();
    if (good() && !at_line_end()) fail(now().at, "compile_error_unexpected:" + quoted(now()) + ":");
  }
}

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
    if (loops_.empty()) return fail(now().at, "compile_error_outside_of_loop:" + quoted(now()) + ":");
    if (accept("break"))
      loops_.back().leaves.push_back(emit(Op::jump));
    else if (accept("continue"))
      emit(Op::jump, loops_.back().start);
    return;
  }
  const bool name = now().kind == Token::Kind::name && !now().is("p") && !now().is("not");
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

void Compiler::assignment(bool global, bool local) {
  const Token name = now();
  expect_name();
  if (!good()) return;
  const Variable* known = find(name.text);
  if (accept("[") || now().is(".")) {
    if (!known) return fail(name.at, "compile_error_name_not_found:" + quoted(name) + ":");
    const Variable v = *known;
    if (accept(".")) {
      const std::int32_t field = constant(Value(expect_name()));
      expect("=");
      expression();
      emit(Op::store_field, v.slot, 2 * field + v.global);
      return;
    }
    expression();
    expect("]");
    expect("=");
    expression();
    emit(Op::store_item, v.slot, v.global);
    return;
  }
  expect("=");
  expression();
  const bool new_one = !known || (local && known->global != 0 && function_ != 0);
  const Variable v = new_one ? declare(name.text, global || function_ == 0) : *find(name.text);
  emit(Op::store, v.slot, v.global);
}

std::int32_t Compiler::emit(Op op, std::int32_t a, std::int32_t b) {
  if (code_.instructions.size() >= most_instructions) fail(now().at, "compile_error_program_too_long");
  const std::size_t before = at_ > 0 ? at_ - 1 : 0;
  code_.instructions.push_back({op, a, b, tokens_[before].at});
  return here() - 1;
}

std::int32_t Compiler::constant(Value value) {
  code_.constants.push_back(std::move(value));
  return static_cast<std::int32_t>(code_.constants.size()) - 1;
}

const Compiler::Variable* Compiler::find(std::string_view name) const {
  if (function_ != 0)
    if (const auto l = locals_.find(name); l != locals_.end()) return &l->second;
  const auto g = globals_.find(name);
  return g == globals_.end() ? nullptr : &g->second;
}

Compiler::Variable Compiler::declare(std::string_view name, bool global) {
  if (globals_.size() + locals_.size() >= most_variables) fail(now().at, "compile_error_too_many_variables");
  const std::string key(name.substr(0, 200));
  if (global) {
    const Variable v{static_cast<std::int32_t>(code_.globals.size()), 1};
    code_.globals.push_back(key);
    return globals_[key] = v;
  }
  const Variable v{code_.functions[static_cast<std::size_t>(function_)].locals++, 0};
  return locals_[key] = v;
}

void Compiler::link() {
  for (CallSite& site : code_.calls)
    if (site.name != "struct" && good()) link(site);
}

void Compiler::link(CallSite& site) {
  std::vector<std::string> parameters;
  if (const auto f = functions_.find(site.name); f != functions_.end()) {
    site.function = f->second;
    for (const auto& p : code_.functions[static_cast<std::size_t>(f->second)].parameters)
      parameters.push_back(p.name);
  } else {
    site.builtin = find_builtin(site.name, version_);
    if (!site.builtin) return fail(site.at, "compile_error_name_not_found:" + site.name + ":");
    parameters = parameters_of(*site.builtin);
  }
  std::set<std::int32_t> taken;
  for (std::size_t i = 0; i < site.names.size(); ++i) {
    std::int32_t to = -1;
    for (std::size_t p = 0; p < parameters.size(); ++p)
      if (site.names[i].empty() ? p == i : parameters[p] == site.names[i]) to = static_cast<std::int32_t>(p);
    if (to < 0 && site.builtin && site.builtin->any_number && site.names[i].empty())
      to = static_cast<std::int32_t>(i);
    if (to < 0 || !taken.insert(to).second)
      return fail(site.at, "compile_error_arguments:" + site.name + ":");
    site.target.push_back(to);
  }
}

}  // namespace simulated_ur5::urscript
