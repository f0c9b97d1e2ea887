#include "examples/simulated_ur5/urscript/compiler.hpp"

#include "examples/simulated_ur5/urscript/builtin.hpp"

namespace simulated_ur5::urscript {
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
    fail(now().at, "compile_error_expected:" + std::string(s) + ":before:" + now().words() + ":");
}
std::string Compiler::expect_name() {
  if (!good()) return {};
  if (now().kind != Token::Kind::name) {
    fail(now().at, "compile_error_expected:name:before:" + now().words() + ":");
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
      fail(now().at, "compile_error_text_behind_program:" + now().words() + ":");
  } else {
    block({});
    if (good() && now().kind != Token::Kind::end)
      fail(now().at, "compile_error_unexpected:" + now().words() + ":");
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
    statement();  // the next one may follow in the same line
  }
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
    if (to < 0 && site.builtin && site.builtin->any_number) to = static_cast<std::int32_t>(i);
    if (to < 0 || !taken.insert(to).second)
      return fail(site.at, "compile_error_arguments:" + site.name + ":");
    site.target.push_back(to);
  }
}

}  // namespace simulated_ur5::urscript
