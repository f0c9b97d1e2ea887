// Tape: the operations of one run of a program, in order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bench/studies/proofs/enclosure.hpp"
#include "bench/studies/proofs/rounding_unit.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace math {

/// An operation on a tape.
enum class TapeOp : std::uint8_t {
  input,
  constant,
  add,
  subtract,
  multiply,
  divide,
  negate,
  sqrt,
  sin,
  cos,
  tanh,
  exp,
  abs
};

/// What a program computed from its inputs, operation by operation: recorded once by `Traced` numbers,
/// evaluated for as many boxes of inputs as one likes (`TracedOutput`).
///
/// The same operations hold for another box as long as the program's comparisons come out the same; the tape
/// keeps them, and an evaluation checks them. Not for the loop: it allocates.
class Tape {
 public:
  struct Node {
    TapeOp op;
    bool rounded;       ///< whether the program rounds the result
    std::int32_t a, b;  ///< operands
    double number;      ///< of a constant
  };
  /// `less`: a < b, else a >= b.
  struct Decision {
    std::int32_t a, b;
    bool less;
  };

  /// While it lives, operations of `Traced` numbers on this thread are recorded on `tape`.
  class Recording {
   public:
    explicit Recording(Tape& tape) noexcept : before_(current()) { current() = &tape; }
    ~Recording() { current() = before_; }
    Recording(const Recording&) = delete;
    Recording& operator=(const Recording&) = delete;

   private:
    Tape* before_;
  };
  [[nodiscard]] static Tape*& current() noexcept {
    static thread_local Tape* tape = nullptr;
    return tape;
  }

  /// A new input, which lies in `range` while recording. Inputs are numbers of the program: exact.
  std::int32_t input(const Enclosure& range) {
    inputs_.push_back(static_cast<std::int32_t>(nodes_.size()));
    return push({TapeOp::input, false, -1, -1, 0}, range);
  }
  std::int32_t constant(double x, double as_rounded) {
    return push({TapeOp::constant, x != as_rounded, -1, -1, x},
                x < as_rounded ? Enclosure(x, as_rounded) : Enclosure(as_rounded, x));
  }
  /// @param unit   a relative error that is larger than that of any rounded operation, and an absolute one
  ///               that is larger than that of any kernel.
  /// @param least  what an underflow may lose.
  std::int32_t operation(TapeOp op, std::int32_t a, std::int32_t b, double unit, double least) {
    const bool exact = op == TapeOp::negate || op == TapeOp::abs || exactly_ || scales(op, a, b);
    Enclosure v = apply(op, range(a), b < 0 ? Enclosure() : range(b), a == b);
    const bool turns = op == TapeOp::sin || op == TapeOp::cos || op == TapeOp::tanh;
    if (!exact) v = detail::widened(v.low, v.high, (turns ? 1.0 : v.largest()) * unit + least);
    return push({op, !exact, a, b, 0}, v);
  }
  void decided(std::int32_t a, std::int32_t b, bool less) { decisions_.push_back({a, b, less}); }

  /// From here on results count as exact: for a formula that judges what the program computed before.
  void judge() noexcept { exactly_ = true; }

  [[nodiscard]] const std::vector<Node>& nodes() const noexcept { return nodes_; }
  [[nodiscard]] const std::vector<std::int32_t>& inputs() const noexcept { return inputs_; }
  [[nodiscard]] const std::vector<Decision>& decisions() const noexcept { return decisions_; }
  /// The values of a node, exact and rounded, over the box of the recording.
  [[nodiscard]] const Enclosure& range(std::int32_t node) const noexcept {
    return ranges_[static_cast<std::size_t>(node)];
  }

  [[nodiscard]] static Enclosure apply(TapeOp op, const Enclosure& a, const Enclosure& b,
                                       bool same) noexcept {
    switch (op) {
      case TapeOp::add:
        return a + b;
      case TapeOp::subtract:
        return a - b;
      case TapeOp::multiply:
        return same ? square(a) : a * b;
      case TapeOp::divide:
        return a / b;
      case TapeOp::negate:
        return -a;
      case TapeOp::sqrt:
        return sqrt(a);
      case TapeOp::sin:
        return sin(a);
      case TapeOp::cos:
        return cos(a);
      case TapeOp::tanh:
        return tanh(a);
      case TapeOp::exp:
        return exp(a);
      case TapeOp::abs:
        return abs(a);
      default:
        return a;
    }
  }

 private:
  std::int32_t push(const Node& node, const Enclosure& range) {
    nodes_.push_back(node);
    ranges_.push_back(range);
    return static_cast<std::int32_t>(nodes_.size()) - 1;
  }
  /// The value of a constant that the program holds exactly, else NaN.
  [[nodiscard]] double exact_constant(std::int32_t i) const noexcept {
    const Node& n = nodes_[static_cast<std::size_t>(i)];
    return n.op == TapeOp::constant && !n.rounded ? n.number : std::numeric_limits<double>::quiet_NaN();
  }
  /// Sums with zero, and products with zero or a power of two, are not rounded.
  [[nodiscard]] bool scales(TapeOp op, std::int32_t a, std::int32_t b) const noexcept {
    if (op == TapeOp::add || op == TapeOp::subtract) return exact_constant(a) == 0 || exact_constant(b) == 0;
    if (op == TapeOp::multiply)
      return detail::is_power_of_two_or_zero(exact_constant(a)) ||
             detail::is_power_of_two_or_zero(exact_constant(b));
    return false;
  }

  std::vector<Node> nodes_;
  std::vector<Enclosure> ranges_;
  std::vector<std::int32_t> inputs_;
  std::vector<Decision> decisions_;
  bool exactly_ = false;
};

/// Whether two recordings hold the same operations on the same numbers: then one bounds the errors of both.
[[nodiscard]] inline bool same_program(const Tape& a, const Tape& b) {
  const auto &x = a.nodes(), &y = b.nodes();
  if (x.size() != y.size() || a.decisions().size() != b.decisions().size()) return false;
  for (std::size_t i = 0; i < x.size(); ++i)
    if (x[i].op != y[i].op || x[i].a != y[i].a || x[i].b != y[i].b || x[i].number != y[i].number ||
        (x[i].op != TapeOp::constant && x[i].rounded != y[i].rounded))
      return false;
  for (std::size_t i = 0; i < a.decisions().size(); ++i) {
    const auto &d = a.decisions()[i], &e = b.decisions()[i];
    if (d.a != e.a || d.b != e.b || d.less != e.less) return false;
  }
  return true;
}

}  // namespace math
SKINCTL_END_NAMESPACE
