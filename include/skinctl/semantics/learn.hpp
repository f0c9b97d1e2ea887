// SPDX-License-Identifier: BSD-3-Clause
// A task from demonstrations: episodes folded, branches with borders, and the activities that deeds need.
#pragma once

#include <optional>

#include "skinctl/semantics/deeds.hpp"

SKINCTL_BEGIN_NAMESPACE

/// Settings of `learn`.
struct LearnSettings {
  DeedSettings deeds{};
  double min_gap = 1.25;      ///< smallest ratio of the stiffnesses that were felt on both sides of a border
  double same_place = 0.15;   ///< distance below which two places in the world are one [m]
  double frame_ratio = 3;     ///< least factor by which places spread less in a frame that is preferred
  double ask_ratio = 1.5;     ///< smallest `frame_ratio` at which the person is asked for the frame
  double min_spread = 0.005;  ///< spread of places below which frames do not differ [m]
};

/// Throws `ConfigurationError` for a number out of its range.
inline void check(const LearnSettings& s) {
  check(s.deeds);
  require(s.min_gap >= 1 && s.min_gap <= 100, "LearnSettings: min_gap", s.min_gap, "1 to 100");
  require(s.same_place > 0 && s.same_place <= 10, "LearnSettings: same_place", s.same_place, "> 0, <= 10 m");
  require(s.ask_ratio >= 1 && s.ask_ratio <= 1000, "LearnSettings: ask_ratio", s.ask_ratio, "1 to 1000");
  require(s.frame_ratio >= s.ask_ratio && s.frame_ratio <= 1000, "LearnSettings: frame_ratio", s.frame_ratio,
          ">= ask_ratio, <= 1000");
  require(s.min_spread > 0 && s.min_spread <= 1, "LearnSettings: min_spread", s.min_spread, "> 0, <= 1 m");
}

/// A task of at most `C` steps, or why there is none.
template <std::size_t C>
struct Learnt {
  TaughtTask<C> task{};
  Refusal why = Refusal::none;
  Nanoseconds at{};               ///< time in the demonstration that the refusal is about
  std::size_t demonstration = 0;  ///< number of the demonstration that is refused
  TaughtWays ways{};              ///< ways of tools in use
};

namespace detail {
/// Alike episodes: one way to treat a kind of thing.
template <Frame W>
using Way = std::vector<Episode<W>>;

template <std::size_t C, Frame W>
class Learner {
 public:
  explicit Learner(const LearnSettings& s) : s_(s) { out_.task.name = "taught"; }

  [[nodiscard]] Learnt<C> learn(const std::vector<Demonstration<W>>& shown) {
    if (shown.empty()) return refused(Refusal::not_a_recording);
    shown_ = shown.size();
    std::vector<Episode<W>> all;
    std::vector<ObjectClass> order;
    for (std::size_t k = 0; k < shown.size(); ++k) {
      const Deeds<W> deeds = deeds_of(shown[k], s_.deeds);
      if (deeds.why != Refusal::none) return {{}, deeds.why, deeds.at, k, {}};
      std::vector<ObjectClass> roles;
      for (const auto& e : deeds.episodes) {
        if (roles.empty() || roles.back() != e[0].role) roles.push_back(e[0].role);
        all.push_back(e);
      }
      auto sorted = roles;
      std::sort(sorted.begin(), sorted.end());
      if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
        return refused(Refusal::mixed_order);
      if (k > 0 && roles.size() != order.size()) return refused(Refusal::sometimes_missing);
      if (k > 0 && roles != order) return refused(Refusal::mixed_order);
      order = roles;
    }
    for (std::size_t k = 0; k < order.size() && out_.why == Refusal::none; ++k)
      kind(all, order[k], k + 1 == order.size());
    if (out_.why == Refusal::none && check(out_.task).any()) return refused(Refusal::not_proved);
    return out_.why == Refusal::none ? out_ : refused(out_.why);
  }

 private:
  [[nodiscard]] Learnt<C> refused(Refusal why) const { return {{}, why, {}, 0, {}}; }
  [[nodiscard]] static double apart(const TaughtPlace& a, const TaughtPlace& b) {
    return norm(Xyz<double>(a.X_MH.origin() - b.X_MH.origin()));
  }
  [[nodiscard]] bool alike(const Deed<W>& a, const Deed<W>& b) const {
    return a.verb == b.verb && a.mark == b.mark &&
           (a.verb != Verb::release || a.mark != 0 || apart(a.at(0), b.at(0)) < s_.same_place);
  }
  [[nodiscard]] std::vector<Way<W>> ways_of(const std::vector<Episode<W>>& all, ObjectClass role) const {
    std::vector<Way<W>> ways;
    for (const auto& e : all) {
      if (e[0].role != role) continue;
      auto way = ways.begin();
      for (; way != ways.end(); ++way)
        if (std::equal(e.begin(), e.end(), way->front().begin(), way->front().end(),
                       [&](const auto& a, const auto& b) { return alike(a, b); }))
          break;
      if (way == ways.end()) way = ways.insert(ways.end(), Way<W>{});
      way->push_back(e);
    }
    if (shown_ > 2 && ways.size() > 1)  // what occurs once in several demonstrations is a slip
      std::erase_if(ways, [](const Way<W>& w) { return w.size() == 1; });
    return ways;
  }

  /// The last squeeze in which every thing of one way felt softer than every thing of the other.
  struct Branch {
    std::size_t deed;
    double border;
    bool first_is_harder;
  };
  [[nodiscard]] std::optional<Branch> branch(const std::vector<Way<W>>& ways) {
    const auto &a = ways[0].front(), &b = ways[1].front();
    std::size_t part = 0;
    while (part < a.size() && part < b.size() && alike(a[part], b[part])) ++part;
    out_.why = Refusal::unlike_without_reason;
    for (std::size_t k = part; k-- > 0;) {
      if (a[k].verb != Verb::squeeze) continue;
      double low[2] = {1e300, 1e300}, high[2] = {0, 0};
      bool known = true;
      for (std::size_t w = 0; w < 2; ++w)
        for (const auto& e : ways[w]) {
          known = known && e[k].felt > 0;
          low[w] = std::min(low[w], e[k].felt), high[w] = std::max(high[w], e[k].felt);
        }
      const bool harder = low[0] > high[1];
      const double below = harder ? high[1] : high[0], above = harder ? low[0] : low[1];
      if (!known || !(above > below)) continue;
      if (above < s_.min_gap * below) {
        out_.why = Refusal::reason_too_small;
        continue;
      }
      out_.why = Refusal::none;
      return Branch{k, std::sqrt(below * above), harder};
    }
    return std::nullopt;
  }

  void kind(const std::vector<Episode<W>>& all, ObjectClass role, bool last) {
    auto ways = ways_of(all, role);
    std::size_t count = 0;
    for (const auto& w : ways) count += w.size();
    if (ways.size() > 2) out_.why = Refusal::too_many_ways;
    if (count < shown_) out_.why = ways.empty() ? Refusal::unlike_without_reason : Refusal::sometimes_missing;
    if (out_.why != Refusal::none) return;
    std::optional<Branch> parts;
    if (ways.size() == 2 && !(parts = branch(ways))) return;
    if (parts && !parts->first_is_harder) std::swap(ways[0], ways[1]);
    const std::uint8_t look = out_.task.size;
    const bool loops = count > shown_;
    add(step_of<activity::Look>({.role = role, .failed = look, .no = loops ? finish : ask_person}));
    const std::size_t shared = parts ? parts->deed + 1 : ways[0].front().size();
    Way<W> pooled = ways[0];
    if (parts) pooled.insert(pooled.end(), ways[1].begin(), ways[1].end());
    deeds(pooled, 0, shared, look, fact::none);
    std::vector<std::uint8_t> ends;
    if (parts) {
      const auto squeeze = static_cast<std::uint8_t>(out_.task.size - 1);
      auto& t = out_.task;
      if (t.border_count == t.max_borders) out_.why = Refusal::too_long;
      if (out_.why != Refusal::none) return;
      t.steps[squeeze].border = t.border_count;
      t.borders[t.border_count++] = parts->border;
      deeds(ways[0], shared, ways[0].front().size(), look, fact::good);
      ends.push_back(static_cast<std::uint8_t>(t.size - 1));
      if (out_.why == Refusal::none) t.steps[squeeze].no = t.size;
      deeds(ways[1], shared, ways[1].front().size(), look, fact::bad);
    }
    if (out_.why != Refusal::none) return;
    ends.push_back(static_cast<std::uint8_t>(out_.task.size - 1));
    const std::uint8_t next = last ? finish : out_.task.size;
    for (const auto e : ends) out_.task.steps[e].done = loops ? look : next;
    if (loops) out_.task.steps[look].no = next;
  }

  /// Adds the steps of deeds `from` to `to - 1`, with the activities that add the facts that they need.
  void deeds(const Way<W>& way, std::size_t from, std::size_t to, std::uint8_t look, Facts judged) {
    for (std::size_t k = from; k < to; ++k) {
      const Verb verb = way.front()[k].verb;
      const ObjectClass role = way.front()[k].role;
      const TaughtPlace at = frame(way, k);
      const std::uint8_t place = place_of(at);
      const bool find = at.mark != 0 && verb != Verb::take && verb != Verb::squeeze;
      const Facts needs = judged | (find ? fact::marked : fact::none);
      if (find) add(step_of<activity::Find>({.role = role, .place = place, .failed = look}));
      if (verb == Verb::take) {
        add(step_of<activity::ReachAbove>({.role = role, .place = place, .failed = look}));
        add(step_of<activity::Reach>({.role = role, .place = place, .failed = look}));
        add(step_of<activity::Take>({.role = role, .place = place, .failed = look}));
      } else if (verb == Verb::squeeze) {
        add(step_of<activity::Carry>({.role = role, .place = place, .failed = look}));
        add(step_of<activity::Squeeze>({.role = role, .place = place, .failed = look}));
      } else if (verb == Verb::use) {
        add(step_of<activity::Carry>({.role = role, .place = place, .failed = look, .needs = needs}));
        add(step_of<activity::Use>({.role = role, .place = place, .failed = look}));
        if (place != no_place) out_.ways[place] = way.front()[k].way;
      } else {
        add(step_of<activity::Put>({.role = role, .place = place, .failed = look, .needs = needs}));
        add(step_of<activity::Release>({.role = role, .place = place, .failed = look}));
      }
    }
  }
  void add(Step s) {
    auto& t = out_.task;
    if (t.size == C) out_.why = Refusal::too_long;
    if (out_.why != Refusal::none) return;
    s.done = static_cast<std::uint8_t>(t.size + 1);
    t.steps[t.size++] = s;
  }
  [[nodiscard]] std::uint8_t place_of(const TaughtPlace& at) {
    auto& t = out_.task;
    if (t.place_count == t.max_places) {
      out_.why = Refusal::too_long;
      return no_place;
    }
    t.places[t.place_count] = at;
    return t.place_count++;
  }
  /// The mean place of deed `k`: in the frame of the landmark of the first episode's deed; of a release in
  /// several demonstrations, in the frame in which the places lie much closer.
  [[nodiscard]] TaughtPlace frame(const Way<W>& way, std::size_t k) {
    const Deed<W>& first = way.front()[k];
    const auto all = [&](ObjectClass mark) {
      std::vector<Transform<ObjectFrame, Tool>> out;
      for (const auto& e : way)
        if (const auto p = e[k].at(mark); p.mark == mark) out.push_back(p.X_MH);
      return out;
    };
    const auto spread = [&](ObjectClass mark) {
      const auto poses = all(mark);
      if (poses.size() < way.size()) return 1e9;
      const auto mean = middle(poses);
      double square = 0;
      for (const auto& X : poses) square += std::pow(norm(Xyz<double>(X.origin() - mean.origin())), 2);
      return std::max(s_.min_spread, std::sqrt(square / static_cast<double>(poses.size())));
    };
    ObjectClass mark = first.verb == Verb::squeeze ? ObjectClass(0) : first.mark;
    if (shown_ > 1 && first.verb == Verb::release) {
      const double usual = spread(mark);
      double closest = usual;
      ObjectClass best = mark;
      for (const auto& p : first.places) {
        const bool may = p.mark == 0 || (p.mark < 64 && ((s_.deeds.containers >> p.mark) & 1u) != 0);
        if (may && spread(p.mark) < closest) best = p.mark, closest = spread(p.mark);
      }
      if (s_.frame_ratio * closest < usual)
        mark = best;
      else if (s_.ask_ratio * closest < usual && out_.why == Refusal::none)
        out_.why = Refusal::frame_unclear;
    }
    return {mark, middle(all(mark))};
  }

  LearnSettings s_;
  Learnt<C> out_;
  std::size_t shown_ = 0;
};
}  // namespace detail

/// The task that demonstrations show, of at most `C` steps, proved by `check`; or why there is none, and what
/// to ask. Throws `ConfigurationError` for settings out of range.
///
/// - Episodes of one kind of thing are one loop, "until none is left", if there are more of them than
///   demonstrations. Kinds follow each other as they were shown.
/// - Where episodes of a kind differ from some deed on, the last squeeze before it that separates them is the
///   branch: its border is the geometric mean of the softest of the harder things and the hardest of the
///   others.
/// - With more than two demonstrations a sequence that occurs once is a slip, and does not count.
/// - Motions are not taught: a deed needs that something is seen, the hand above it, around it, the landmark
///   found.
template <std::size_t C = 32, Frame W = World>
[[nodiscard]] Learnt<C> learn(const std::vector<Demonstration<W>>& shown,
                              const LearnSettings& settings = {}) {
  check(settings);
  return detail::Learner<C, W>(settings).learn(shown);
}

SKINCTL_END_NAMESPACE
