// A simulated person who leads a robot's hand: what the hand does and feels, and what the person means by it.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "skinctl/semantics/words.hpp"
#include "skinctl/testing/random.hpp"

namespace skinctl::testing {

/// What differs from person to person.
struct Person {
  double speed = 0.4;      ///< peak of a long motion [m/s]
  double patience = 1;     ///< of all waits
  double tremor = 0.0002;  ///< amplitude along each axis [m]
  double tremor_rate = 9;  ///< [Hz]
  double grip = 4;         ///< [N]
  double squeeze = 2;      ///< of the grip
  double rise = 0.06;      ///< time in which the fingers press or let go [s]
  double bend = 0.03;      ///< by which ways are bent [m]
  double hesitates = 0.2;  ///< share of the ways with a pause in the middle

  [[nodiscard]] static Person any(Random& random, double most_tremor = 0.0004) {
    const auto in = [&](double low, double high) { return uniform(random, low, high); };
    return {in(0.25, 0.7), in(0.6, 1.6),  in(0.00005, most_tremor),
            in(8, 10),     in(2, 6),      in(1.7, 2.4),
            in(0.03, 0.1), in(0.0, 0.06), in(0.0, 0.4)};
  }
};

/// A motion, a force and a word by intent, each a list over time.
class LedHand {
 public:
  struct Truth {
    Xyz<double> p{0, 0, 0}, v{0, 0, 0};
    double force = 0;
  };

  LedHand(const Person& person, std::uint64_t seed, const Xyz<double>& at)
      : person_(person), random_(seeded(seed)), p_(at) {
    ways_.push_back({0, 0, at, at, {0, 0, 0}});
    means(Activity::idle);
  }
  [[nodiscard]] const Person& person() const noexcept { return person_; }
  [[nodiscard]] Random& random() noexcept { return random_; }
  [[nodiscard]] double now() const noexcept { return t_; }

  /// From now on the person means this.
  void means(Activity a) {
    if (intents_.empty() || intents_.back().word != a) intents_.push_back({t_, a});
  }
  /// A wait of about this long [s].
  void wait(double time) { t_ += time * person_.patience * uniform(random_, 0.7, 1.4); }
  /// A way of minimum jerk, bent to a side; perhaps with a pause.
  void go(const Xyz<double>& goal, double slower = 1) {
    const double far = norm(Xyz<double>(goal - p_));
    if (far > 0.15 && uniform(random_, 0.0, 1.0) < person_.hesitates) {
      const double u = uniform(random_, 0.4, 0.7);
      way(p_ + u * Xyz<double>(goal - p_), slower);
      wait(0.12);
    }
    way(goal, slower);
  }
  /// Strokes back and forth along `along`, or circles in the plane of `along` and `across`.
  void strokes(int count, const Xyz<double>& along, const Xyz<double>& across, double period) {
    strokes_.push_back({t_, t_ + count * period, period, p_, along, across});
    t_ += count * period;
    ways_.push_back({t_, t_, p_, p_, {0, 0, 0}});
  }
  /// The fingers press with another force.
  void press(double force) {
    presses_.push_back({t_, t_ + person_.rise, force_, force});
    t_ += person_.rise;
    force_ = force;
  }
  void close() { press(person_.grip * uniform(random_, 0.85, 1.15)); }
  void open() { press(0); }
  /// As a part of the present force.
  void press_by(double ratio) { press(force_ * ratio); }
  [[nodiscard]] const Xyz<double>& position() const noexcept { return p_; }

  /// Without tremor and noise.
  [[nodiscard]] Truth truth(double t) const {
    Truth out;
    const auto after = [t](const auto& list) {
      std::size_t low = 0, high = list.size();
      while (low < high) {
        const std::size_t mid = (low + high) / 2;
        (list[mid].begin <= t ? low : high) = list[mid].begin <= t ? mid + 1 : mid;
      }
      return low;
    };
    const auto& w = ways_[after(ways_) - 1];
    const double T = w.end - w.begin, u = T > 0 ? std::min(1.0, (t - w.begin) / T) : 1.0;
    const double s = u * u * u * (10 + u * (6 * u - 15)), ds = T > 0 ? 30 * u * u * (1 - u) * (1 - u) / T : 0;
    const Xyz<double> d = w.to - w.from;
    out.p = w.from + s * d + 4 * s * (1 - s) * w.bend;
    out.v = ds * Xyz<double>(d + 4 * (1 - 2 * s) * w.bend);
    if (const auto k = after(strokes_); k > 0 && t < strokes_[k - 1].end) {
      const auto& o = strokes_[k - 1];
      const double a = 2 * 3.14159265358979323846 * (t - o.begin) / o.period,
                   rate = 2 * 3.14159265358979323846 / o.period;
      out.p = o.about + std::sin(a) * o.along + (1 - std::cos(a)) * o.across;
      out.v = rate * Xyz<double>(std::cos(a) * o.along + std::sin(a) * o.across);
    }
    if (const auto k = after(presses_); k > 0) {
      const auto& f = presses_[k - 1];
      const double x = std::min(1.0, (t - f.begin) / (f.end - f.begin));
      out.force = f.from + (f.to - f.from) * x * x * (3 - 2 * x);
    }
    return out;
  }
  /// The word by intent at `t`.
  [[nodiscard]] Activity intent(double t) const {
    Activity word = Activity::idle;
    for (const auto& i : intents_)
      if (i.begin <= t) word = i.word;
    return word;
  }

 private:
  struct Way {
    double begin, end;
    Xyz<double> from, to, bend;
  };
  struct Strokes {
    double begin, end, period;
    Xyz<double> about, along, across;
  };
  struct Press {
    double begin, end, from, to;
  };
  struct Intent {
    double begin;
    Activity word;
  };
  void way(const Xyz<double>& goal, double slower) {
    const Xyz<double> d = goal - p_;
    const double far = norm(d), peak = person_.speed * uniform(random_, 0.8, 1.2) / slower;
    // A short way is slower: its time is never below a quarter of a second.
    const double time = std::max({1.875 * far / peak, 0.25, 0.6 * std::sqrt(far)});
    const double size = person_.bend * std::min(1.0, far / 0.3);
    const Xyz<double> side{uniform(random_, -1.0, 1.0) * size, uniform(random_, -1.0, 1.0) * size,
                           uniform(random_, 0.0, 1.0) * size};
    ways_.push_back({t_, t_ + time, p_, goal, side});
    t_ += time;
    p_ = goal;
  }

  Person person_;
  Random random_;
  double t_ = 0, force_ = 0;
  Xyz<double> p_;
  std::vector<Way> ways_;
  std::vector<Strokes> strokes_;
  std::vector<Press> presses_;
  std::vector<Intent> intents_;
};

}  // namespace skinctl::testing
