#include "examples/simulated_ur5/script.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <map>
#include <variant>

namespace simulated_ur5 {
namespace {

struct Token {
  enum class Kind { name, number, text, sign, line_end };
  Kind kind = Kind::line_end;
  std::string_view text;
  double number = 0;

  bool is(std::string_view s) const { return (kind == Kind::name || kind == Kind::sign) && text == s; }
};

constexpr std::size_t most_arguments = 32;
constexpr std::size_t farthest_argument = 600;  ///< tokens that one call may span
constexpr int most_evaluated = 200;             ///< calls of a program that are looked at
constexpr int deepest_expression = 24;

bool starts_name(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}
bool in_name(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// Calls `take(token)` for every token of `text`; comments vanish.
template <class Take>
void tokenise(std::string_view text, Take&& take) {
  std::size_t i = 0;
  while (i < text.size()) {
    const char c = text[i];
    if (c == '\n') {
      take(Token{Token::Kind::line_end, text.substr(i, 1), 0});
      ++i;
    } else if (c == '#') {
      while (i < text.size() && text[i] != '\n') ++i;
    } else if (c == '"' || c == '\'') {
      std::size_t end = i + 1;
      while (end < text.size() && text[end] != c && text[end] != '\n') ++end;
      take(Token{Token::Kind::text, text.substr(i + 1, end - i - 1), 0});
      i = end < text.size() && text[end] == c ? end + 1 : end;
    } else if (starts_name(c)) {
      std::size_t end = i;
      while (end < text.size() && in_name(text[end])) ++end;
      take(Token{Token::Kind::name, text.substr(i, end - i), 0});
      i = end;
    } else if (std::isdigit(static_cast<unsigned char>(c)) != 0 ||
               (c == '.' && i + 1 < text.size() &&
                std::isdigit(static_cast<unsigned char>(text[i + 1])) != 0)) {
      std::size_t end = i;
      const auto digits = [&] {
        while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end])) != 0) ++end;
      };
      digits();
      if (end < text.size() && text[end] == '.') {
        ++end;
        digits();
      }
      if (end < text.size() && (text[end] == 'e' || text[end] == 'E')) {
        std::size_t exponent = end + 1;
        if (exponent < text.size() && (text[exponent] == '+' || text[exponent] == '-')) ++exponent;
        if (exponent < text.size() && std::isdigit(static_cast<unsigned char>(text[exponent])) != 0) {
          end = exponent;
          digits();
        }
      }
      const std::string number(text.substr(i, std::min<std::size_t>(end - i, 64)));
      take(Token{Token::Kind::number, text.substr(i, end - i), std::strtod(number.c_str(), nullptr)});
      i = end;
    } else {
      if (std::isspace(static_cast<unsigned char>(c)) == 0)
        take(Token{Token::Kind::sign, text.substr(i, 1), 0});
      ++i;
    }
  }
}

int depth_change(std::string_view line) {
  int change = 0;
  tokenise(line, [&](const Token& t) {
    if (t.kind != Token::Kind::name) return;
    if (t.text == "def" || t.text == "sec" || t.text == "thread" || t.text == "if" || t.text == "while")
      ++change;
    if (t.text == "end") --change;
  });
  return change;
}

/// A constant, or nothing where the program computes.
using Value = std::variant<std::monostate, double, bool, std::string, std::vector<double>>;

struct Call {
  std::string_view name;
  std::vector<Value> positional;
  std::map<std::string_view, Value> named;

  const Value* argument(std::size_t i, std::string_view by_name) const {
    if (const auto n = named.find(by_name); n != named.end()) return &n->second;
    return i < positional.size() ? &positional[i] : nullptr;
  }
  double number(std::size_t i, std::string_view by_name, double otherwise) const {
    const Value* v = argument(i, by_name);
    const double* d = v ? std::get_if<double>(v) : nullptr;
    return d && std::isfinite(*d) ? *d : otherwise;
  }
  std::string text(std::size_t i, std::string_view by_name, std::string otherwise = {}) const {
    const Value* v = argument(i, by_name);
    const std::string* s = v ? std::get_if<std::string>(v) : nullptr;
    return s ? *s : otherwise;
  }
};

/// Evaluates constant expressions and calls at a place in the tokens.
class Evaluator {
 public:
  Evaluator(const std::vector<Token>& tokens, double steptime) : tokens_(tokens), steptime_(steptime) {}

  std::map<std::string_view, Value> constants;

  /// The arguments behind `name (` at token `at`.
  Call call(std::size_t at) {
    Call out;
    out.name = tokens_[at].text;
    at_ = at + 2;
    end_ = std::min(tokens_.size(), at_ + farthest_argument);
    while (at_ < end_ && !tokens_[at_].is(")") && out.positional.size() + out.named.size() < most_arguments) {
      std::string_view by_name;
      if (at_ + 1 < end_ && tokens_[at_].kind == Token::Kind::name && tokens_[at_ + 1].is("=") &&
          !(at_ + 2 < end_ && tokens_[at_ + 2].is("="))) {
        by_name = tokens_[at_].text;
        at_ += 2;
      }
      Value value = whole_argument();
      if (by_name.empty())
        out.positional.push_back(std::move(value));
      else
        out.named[by_name] = std::move(value);
      if (at_ < end_ && tokens_[at_].is(",")) ++at_;
    }
    return out;
  }

  /// The value of the expression that begins at token `at` and reaches to the end of the line.
  Value assigned(std::size_t at) {
    at_ = at;
    end_ = std::min(tokens_.size(), at + farthest_argument);
    Value value = sum(0);
    const bool whole = at_ >= tokens_.size() || tokens_[at_].kind == Token::Kind::line_end;
    return whole ? value : Value{};
  }

 private:
  Value whole_argument() {
    const std::size_t begin = at_;
    Value value = sum(0);
    if (at_ < end_ && (tokens_[at_].is(",") || tokens_[at_].is(")"))) return value;
    // Not a constant: skip to the end of the argument.
    at_ = begin;
    int open = 0;
    for (; at_ < end_; ++at_) {
      const Token& t = tokens_[at_];
      if (t.kind == Token::Kind::line_end && open <= 0) {
        at_ = end_;
        break;
      }
      if (t.is("(") || t.is("[")) ++open;
      if (open == 0 && (t.is(",") || t.is(")"))) break;
      if (t.is(")") || t.is("]")) --open;
    }
    return {};
  }

  static Value combine(const Value& a, const Value& b, char sign) {
    const double* x = std::get_if<double>(&a);
    const double* y = std::get_if<double>(&b);
    if (!x || !y) return {};
    switch (sign) {
      case '+':
        return *x + *y;
      case '-':
        return *x - *y;
      case '*':
        return *x * *y;
      default:
        return *y != 0 ? Value(*x / *y) : Value{};
    }
  }

  Value sum(int depth) {
    Value value = product(depth);
    while (at_ < end_ && (tokens_[at_].is("+") || tokens_[at_].is("-"))) {
      const char sign = tokens_[at_++].text[0];
      value = combine(value, product(depth), sign);
    }
    return value;
  }
  Value product(int depth) {
    Value value = factor(depth);
    while (at_ < end_ && (tokens_[at_].is("*") || tokens_[at_].is("/"))) {
      const char sign = tokens_[at_++].text[0];
      value = combine(value, factor(depth), sign);
    }
    return value;
  }
  Value factor(int depth) {
    if (at_ >= end_ || depth > deepest_expression) return {};
    const Token& t = tokens_[at_];
    if (t.is("-") || t.is("+")) {
      ++at_;
      Value value = factor(depth + 1);
      if (double* x = std::get_if<double>(&value); x && t.is("-")) *x = -*x;
      return value;
    }
    if (t.kind == Token::Kind::number) {
      ++at_;
      return t.number;
    }
    if (t.kind == Token::Kind::text) {
      ++at_;
      return std::string(t.text.substr(0, 1024));
    }
    if (t.is("(")) {
      ++at_;
      Value value = sum(depth + 1);
      if (at_ >= end_ || !tokens_[at_].is(")")) return {};
      ++at_;
      return value;
    }
    if (t.is("[")) {
      ++at_;
      std::vector<double> list;
      while (at_ < end_ && !tokens_[at_].is("]")) {
        const Value item = sum(depth + 1);
        const double* x = std::get_if<double>(&item);
        if (!x || list.size() >= 64) return {};
        list.push_back(*x);
        if (at_ < end_ && tokens_[at_].is(","))
          ++at_;
        else if (at_ >= end_ || !tokens_[at_].is("]"))
          return {};
      }
      if (at_ >= end_) return {};
      ++at_;
      return list;
    }
    if (t.kind == Token::Kind::name) {
      ++at_;
      if (t.text == "True") return true;
      if (t.text == "False") return false;
      if (at_ + 1 < end_ && tokens_[at_].is("(")) {
        if (t.text == "get_steptime" && tokens_[at_ + 1].is(")")) {
          at_ += 2;
          return steptime_;
        }
        if (t.text == "d2r") {
          const Value inside = factor(depth + 1);
          const double* x = std::get_if<double>(&inside);
          return x ? Value(*x * pi / 180) : Value{};
        }
        return {};
      }
      const auto known = constants.find(t.text);
      return known != constants.end() ? known->second : Value{};
    }
    return {};
  }

  const std::vector<Token>& tokens_;
  double steptime_;
  std::size_t at_ = 0, end_ = 0;
};

std::uint16_t as_port(const Value* value) {
  const double* x = value ? std::get_if<double>(value) : nullptr;
  return x && *x >= 1 && *x <= 65535 && *x == std::floor(*x) ? static_cast<std::uint16_t>(*x)
                                                             : std::uint16_t{0};
}

}  // namespace

bool ScriptReader::feed(std::span<const std::uint8_t> bytes, std::vector<std::string>& programs) {
  for (const std::uint8_t b : bytes) {
    if (b == 0 || b == '\r') continue;
    if (text_.size() >= longest_program) return false;
    text_.push_back(static_cast<char>(b));
    if (b == '\n' && !take_line(programs)) return false;
  }
  return true;
}

bool ScriptReader::take_line(std::vector<std::string>& programs) {
  const std::string_view line = std::string_view(text_).substr(line_);
  depth_ = std::max(0, depth_ + depth_change(line));
  line_ = text_.size();
  if (depth_ > 1'000'000) return false;
  if (depth_ > 0) return true;
  bool any = false;
  tokenise(text_, [&](const Token& t) { any = any || t.kind != Token::Kind::line_end; });
  if (any) programs.push_back(std::move(text_));
  text_.clear();
  line_ = 0;
  return true;
}

Program recognise(std::string_view text, double steptime) {
  Program out;
  std::vector<Token> tokens;
  tokenise(text, [&](const Token& t) { tokens.push_back(t); });
  Evaluator evaluate(tokens, steptime);

  struct Read {
    std::string socket;
    double count = 0;
  };
  std::vector<Read> reads;
  int definitions = 0, evaluated = 0;
  bool torques = false, has_servo = false, has_speed = false, has_stop = false;

  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const Token& t = tokens[i];
    if (t.kind != Token::Kind::name) continue;
    if (t.text == "def" || t.text == "sec" || t.text == "thread") {
      if (++definitions == 1) {
        if (i + 1 < tokens.size() && tokens[i + 1].kind == Token::Kind::name)
          out.name = std::string(tokens[i + 1].text.substr(0, 64));
      }
      ++i;  // the name that follows is no call
      continue;
    }
    const bool begins_line = i == 0 || tokens[i - 1].kind == Token::Kind::line_end ||
                             tokens[i - 1].is("global") || tokens[i - 1].is("local");
    if (begins_line && i + 2 < tokens.size() && tokens[i + 1].is("=") && !tokens[i + 2].is("=")) {
      Value value = evaluate.assigned(i + 2);
      // A name that changes is no constant; the first value is what a stream is set up with.
      evaluate.constants.emplace(t.text, std::move(value));
      continue;
    }
    if (i + 1 >= tokens.size() || !tokens[i + 1].is("(")) continue;
    constexpr std::string_view told[] = {"socket_open", "socket_read_binary_integer", "servoj", "speedj",
                                         "stopj",       "rtde_set_watchdog"};
    const bool tells = std::find(std::begin(told), std::end(told), t.text) != std::end(told);
    torques = torques || t.text == "direct_torque";
    // Each look spans a bounded stretch, and so do all of them.
    if (!tells || ++evaluated > most_evaluated) continue;
    const Call call = evaluate.call(i);

    if (call.name == "socket_open") {
      SocketOpen socket{call.text(0, "address"), call.text(2, "socket_name", "socket_0"),
                        as_port(call.argument(1, "port"))};
      const bool known = std::any_of(out.sockets.begin(), out.sockets.end(),
                                     [&](const SocketOpen& s) { return s.name == socket.name; });
      if (!socket.host.empty() && socket.port != 0 && !known && out.sockets.size() < 8)
        out.sockets.push_back(std::move(socket));
    } else if (call.name == "socket_read_binary_integer") {
      if (reads.size() < 32)
        reads.push_back({call.text(1, "socket_name", "socket_0"), call.number(0, "number", 0)});
    } else if (call.name == "servoj" && !has_servo) {
      has_servo = true;
      out.servo_lookahead = call.number(4, "lookahead_time", 0.1);
      out.servo_gain = call.number(5, "gain", 300);
    } else if (call.name == "speedj" && !has_speed) {
      has_speed = true;
      out.speed_acceleration = call.number(1, "a", 40);
    } else if (call.name == "stopj" && !has_stop) {
      has_stop = true;
      out.stop_deceleration = call.number(0, "a", 4);
    } else if (call.name == "rtde_set_watchdog") {
      urscript::Watchdog dog;
      dog.variable = call.text(0, "variable_name");
      dog.min_frequency = call.number(1, "min_frequency", 10);
      dog.stops = call.text(2, "action", "pause") == "stop";
      if (dog.min_frequency > 0 && dog.min_frequency <= 1000) out.watchdog = dog;
    }
  }
  if (const auto m = evaluate.constants.find("MULT_jointstate"); m != evaluate.constants.end())
    if (const double* x = std::get_if<double>(&m->second); x && std::isfinite(*x) && *x > 0)
      out.multiplier = *x;

  const bool streams = out.sockets.size() == 1 && !reads.empty() && !torques &&
                       std::all_of(reads.begin(), reads.end(), [&](const Read& r) {
                         return r.socket == out.sockets[0].name && r.count == 8;
                       });
  if (!streams) out.sockets.clear();
  return out;
}

}  // namespace simulated_ur5
