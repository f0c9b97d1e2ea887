// From tokens to instructions in one pass. See `compile` in code.hpp.
#pragma once

#include <map>
#include <set>
#include <span>

#include "examples/simulated_ur5/urscript/code.hpp"

namespace simulated_ur5::urscript {

inline constexpr int deepest_nesting = 100;
inline constexpr std::size_t most_instructions = 200'000, most_arguments = 64, most_variables = 2000;

/// What ends a block.
inline constexpr std::string_view until_end[] = {"end"};

class Compiler {
 public:
  Compiler(std::vector<Token> tokens, const Version& version, Code& code)
      : tokens_(std::move(tokens)), version_(version), code_(code) {}

  Problem run();

 private:
  // The text.
  const Token& now() const { return tokens_[at_]; }
  const Token& ahead(std::size_t n) const { return tokens_[std::min(at_ + n, tokens_.size() - 1)]; }
  bool at_line_end() const { return now().kind == Token::Kind::line_end || now().kind == Token::Kind::end; }
  bool accept(std::string_view s);
  void expect(std::string_view s);
  /// An operator between two operands. Line ends before and behind it are not significant: no statement
  /// begins with one.
  bool accept_operator(std::string_view sign);
  /// Whether `p[` begins a pose: it is an item where `p` is a variable and one index follows.
  bool begins_pose() const;
  std::string expect_name();
  void skip_lines();
  /// The first problem counts; from then on nothing more is read.
  void fail(const Place& at, std::string text);
  bool good() const { return problem_.text.empty(); }

  // Statements.
  void program();
  void block(std::span<const std::string_view> ends);
  void statement();
  void definition(bool thread);
  void parameters(Function& function);
  Value literal();
  void branch();
  void loop();
  void assignment(bool global, bool local);
  void expect_assignment();

  // Expressions, from the loosest binding to the tightest.
  void expression();
  void conjunction();
  void inversion();
  void comparison();
  void sum();
  void product();
  void factor();
  void postfix();
  void primary();
  void number();
  void binary(void (Compiler::*next)(), std::span<const std::pair<std::string_view, Operation>> operators);
  std::int32_t arguments(const Token& name);
  std::int32_t items(std::string_view close);

  // Code.
  std::int32_t emit(Op op, std::int32_t a = 0, std::int32_t b = 0);
  void land(std::int32_t jump) { code_.instructions[static_cast<std::size_t>(jump)].a = here(); }
  std::int32_t here() const { return static_cast<std::int32_t>(code_.instructions.size()); }
  std::int32_t constant(Value value);
  struct Variable {
    std::int32_t slot = 0, global = 0;
  };
  const Variable* find(std::string_view name) const;
  Variable declare(std::string_view name, bool global);
  void link();
  void link(CallSite& site);

  struct Nested {
    explicit Nested(Compiler& c) : c_(c) {
      if (++c_.depth_ > deepest_nesting) c_.fail(c_.now().at, "compile_error_nested_too_deep");
    }
    Nested(const Nested&) = delete;
    Nested& operator=(const Nested&) = delete;
    ~Nested() { --c_.depth_; }
    Compiler& c_;
  };

  std::vector<Token> tokens_;
  std::size_t at_ = 0;
  const Version version_;
  Code& code_;
  Problem problem_;
  int depth_ = 0;
  std::map<std::string, Variable, std::less<>> globals_, locals_;
  std::map<std::string, std::int32_t, std::less<>> functions_;
  std::int32_t function_ = 0;  ///< being compiled
  struct Loop {
    std::int32_t start = 0;
    std::vector<std::int32_t> leaves;
  };
  std::vector<Loop> loops_;
};

}  // namespace simulated_ur5::urscript
