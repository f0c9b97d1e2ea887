// The compiler's expressions.
#include <limits>

#include "examples/simulated_ur5/urscript/compiler.hpp"
#include "examples/support/text.hpp"

namespace simulated_ur5::urscript {
namespace {

using Operators = std::pair<std::string_view, Operation>;
constexpr Operators comparisons[] = {{"==", Operation::equal},
                                     {"!=", Operation::unequal},
                                     {"<", Operation::less},
                                     {"<=", Operation::less_equal}};
constexpr Operators sums[] = {{"+", Operation::add}, {"-", Operation::subtract}};
constexpr Operators products[] = {
    {"*", Operation::multiply}, {"/", Operation::divide}, {"%", Operation::modulo}};

}  // namespace

void Compiler::expression() {
  const Nested nested(*this);
  conjunction();
  std::vector<std::int32_t> jumps;
  while (accept_operator("or")) {
    jumps.push_back(emit(Op::keep_if));
    conjunction();
  }
  for (const std::int32_t jump : jumps) land(jump);
}

void Compiler::conjunction() {
  inversion();
  std::vector<std::int32_t> jumps;
  while (accept_operator("and")) {
    jumps.push_back(emit(Op::keep_unless));
    inversion();
  }
  for (const std::int32_t jump : jumps) land(jump);
}

void Compiler::inversion() {
  bool inverted = false;
  while (accept("not")) {
    skip_lines();
    inverted = !inverted;
  }
  comparison();
  if (inverted) emit(Op::invert);
}

void Compiler::comparison() {
  sum();
  for (;;) {
    // a > b is b < a, with a computed first.
    const bool greater = accept_operator(">");
    if (greater || accept_operator(">=")) {
      const Operation swapped = greater ? Operation::less : Operation::less_equal;
      sum();
      emit(Op::binary, static_cast<std::int32_t>(swapped), 1);
      continue;
    }
    const std::size_t before = at_;
    for (const auto& [sign, operation] : comparisons)
      if (accept_operator(sign)) {
        sum();
        emit(Op::binary, static_cast<std::int32_t>(operation));
      }
    if (at_ == before || !good()) return;
  }
}

void Compiler::binary(void (Compiler::*next)(),
                      std::span<const std::pair<std::string_view, Operation>> operators) {
  (this->*next)();
  for (bool more = true; more && good();) {
    more = false;
    for (const auto& [sign, operation] : operators) {
      if (!accept_operator(sign)) continue;
      (this->*next)();
      emit(Op::binary, static_cast<std::int32_t>(operation));
      more = true;
      break;
    }
  }
}

void Compiler::sum() {
  binary(&Compiler::product, sums);
}
void Compiler::product() {
  binary(&Compiler::factor, products);
}

void Compiler::factor() {
  int signs = 0, minus = 0;
  while (good() && (now().is("-") || now().is("+"))) {
    if (now().is("-")) ++minus;
    ++signs;
    ++at_;
    skip_lines();
  }
  postfix();
  if (minus % 2 != 0) emit(Op::negate);
}

void Compiler::postfix() {
  primary();
  while (good()) {
    if (accept("[")) {
      expression();
      expect("]");
      emit(Op::index);
    } else if (now().is(".") && ahead(1).kind == Token::Kind::name) {
      ++at_;
      emit(Op::field, constant(Value(expect_name())));
    } else {
      return;
    }
  }
}

void Compiler::number() {
  std::string_view digits = now().text;
  double value = std::numeric_limits<double>::infinity();  // what is too large
  static_cast<void>(examples::take_number(digits, value));
  const bool whole = now().kind == Token::Kind::whole && value < 9e15;
  ++at_;
  emit(Op::constant, constant(whole ? Value(static_cast<std::int64_t>(value)) : Value(value)));
}

void Compiler::primary() {
  if (!good()) return;
  const Nested nested(*this);
  const Token t = now();
  if (t.kind == Token::Kind::whole || t.kind == Token::Kind::real) return number();
  if (t.kind == Token::Kind::text) {
    ++at_;
    emit(Op::constant, constant(Value(std::string(t.text.substr(0, longest_string)))));
    return;
  }
  if (accept("(")) {
    expression();
    return expect(")");
  }
  if (accept("[")) {
    const std::int32_t n = items("]");
    emit(Op::make_list, n);
    return;
  }
  if (begins_pose()) {
    at_ += 2;
    if (items("]") != 6) return fail(t.at, "compile_error_pose_needs_six_numbers");
    emit(Op::make_pose);
    return;
  }
  if (t.kind != Token::Kind::name) {
    const std::string what = at_line_end() ? "end_of_line" : std::string(t.text.substr(0, 60));
    return fail(t.at, "compile_error_unexpected:" + what + ":");
  }
  if (accept("True") || accept("False")) {
    emit(Op::constant, constant(Value(t.is("True"))));
    return;
  }
  if (accept("run")) {
    const Token name = now();
    expect_name();
    expect("(");
    if (!good()) return;
    emit(Op::run, arguments(name));
    return;
  }
  ++at_;
  if (accept("(")) {
    const std::int32_t site = arguments(t);
    emit(t.is("struct") ? Op::make_struct : Op::call, site);
    return;
  }
  const Variable* v = find(t.text);
  if (!v) return fail(t.at, "compile_error_name_not_found:" + std::string(t.text.substr(0, 60)) + ":");
  emit(Op::load, v->slot, v->global);
}

bool Compiler::accept_operator(std::string_view sign) {
  std::size_t i = at_;
  while (tokens_[i].kind == Token::Kind::line_end) ++i;
  if (!good() || !tokens_[i].is(sign)) return false;
  at_ = i + 1;
  skip_lines();
  return true;
}

bool Compiler::begins_pose() const {
  if (!now().is("p") || !ahead(1).is("[")) return false;
  if (!find("p")) return true;
  // The variable's item has one index, a pose six numbers.
  int open = 0;
  for (std::size_t n = 1; ahead(n).kind != Token::Kind::end; ++n) {
    if (ahead(n).is("(") || ahead(n).is("[")) ++open;
    if ((ahead(n).is(")") || ahead(n).is("]")) && --open == 0) return false;
    if (ahead(n).is(",") && open == 1) return true;
  }
  return false;
}

std::int32_t Compiler::items(std::string_view close) {
  std::int32_t n = 0;
  while (good() && !accept(close)) {
    expression();
    ++n;
    if (!now().is(close)) expect(",");
  }
  return n;
}

std::int32_t Compiler::arguments(const Token& name) {
  CallSite site;
  site.name = std::string(name.text.substr(0, 200));
  site.at = name.at;
  while (good() && !accept(")")) {
    const bool named = now().kind == Token::Kind::name && ahead(1).is("=");
    site.names.push_back(named ? expect_name() : std::string());
    if (named) expect("=");
    expression();
    if (site.names.size() > most_arguments) fail(now().at, "compile_error_too_many_arguments");
    if (!now().is(")")) expect(",");
  }
  code_.calls.push_back(std::move(site));
  return static_cast<std::int32_t>(code_.calls.size()) - 1;
}

}  // namespace simulated_ur5::urscript
