// SPDX-License-Identifier: BSD-3-Clause
// What was done in a demonstration: deeds that change facts, from the segments of its recording.
#pragma once

#include "skinctl/semantics/segments.hpp"
#include "skinctl/semantics/task.hpp"
#include "skinctl/semantics/taught_way.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A demonstration as it was recorded.
template <Frame W = World>
struct Demonstration {
  std::vector<ShownSample<W>> hand;  ///< samples of the hand, in the order of time
  std::vector<Detection<W>> seen;    ///< detections, in the order of time; `object` is an index of `kinds`
  std::vector<ObjectClass> kinds;    ///< class of each object, above 0
};

/// The actions of a hand that change facts.
enum class Verb : std::uint8_t { take, squeeze, use, release };
[[nodiscard]] constexpr const char* describe(Verb verb) noexcept {
  constexpr const char* texts[] = {"take", "squeeze", "use", "release"};
  const auto i = static_cast<std::size_t>(verb);
  return i < std::size(texts) ? texts[i] : "";
}

/// One deed: a verb, and where the hand stood for it.
template <Frame W = World>
struct Deed {
  Verb verb = Verb::take;
  ObjectClass role = 0;             ///< class of the object in hand
  ObjectClass mark = 0;             ///< class of the landmark at which the deed is done; 0: the world
  Nanoseconds time{};               ///< begin of the deed
  double sigma = 0;                 ///< standard deviation of the hand's position while it stood [m]
  double felt = 0;                  ///< stiffness that a squeeze felt [N/m]; NaN: not known
  std::vector<TaughtPlace> places;  ///< hand in the world, then in each landmark's frame, nearest first
  TaughtWay way;                    ///< way of a use; of other deeds empty
  [[nodiscard]] TaughtPlace at(ObjectClass wanted) const noexcept {
    for (const auto& p : places)
      if (p.mark == wanted) return p;
    return places.front();
  }
};
/// The deeds from an empty hand to an empty hand, in the order of time.
template <Frame W = World>
using Episode = std::vector<Deed<W>>;

/// The reason for which a demonstration is refused.
enum class Refusal : std::uint8_t {
  none,
  not_a_recording,
  nothing_taken,
  hand_not_empty,
  thing_unknown,
  mixed_order,
  sometimes_missing,
  unlike_without_reason,
  reason_too_small,
  too_many_ways,
  frame_unclear,
  too_long,
  not_proved
};
/// The refusal in words, with the question to the person.
[[nodiscard]] constexpr const char* describe(Refusal why) noexcept {
  constexpr const char* texts[] = {
      "not refused",
      "the recording is empty, not in order, or not finite: please record it again",
      "nothing was taken: does the hand measure its force? Please show it once more",
      "something was in the hand when the recording began or ended: please begin and end with an empty hand",
      "nothing was seen where the hand closed: what was taken there?",
      "the things were taken in an order that I do not understand: please show one kind after the other",
      "something was done in some demonstrations only: when is it to be done?",
      "alike things were treated unlike, and nothing was felt before that tells them apart: why?",
      "what was felt differs too little between things treated unlike: is that the reason? "
      "Please show a "
      "softer and a harder one",
      "one kind of thing was treated in more than two ways: please show fewer ways at once",
      "where it was put down lies alike in two frames: relative to what is it? Please show it once more with "
      "the "
      "container elsewhere",
      "the task has more steps, places or borders than fit: please show its parts one by one",
      "the steps do not make a task that can be proved: please show it once more"};
  const auto i = static_cast<std::size_t>(why);
  return i < std::size(texts) ? texts[i] : "";
}

/// Settings of `deeds_of`.
struct DeedSettings {
  std::uint64_t containers = ~std::uint64_t(0);  ///< bit k: class k < 64 is a landmark of releases
  double reach = 0.15;           ///< greatest distance from the hand of a thing that is taken [m]
  double near_container = 0.15;  ///< largest distance from the hand of the container of a release [m]
  double near_used = 0.25;       ///< largest distance from the hand of a thing on which a tool is used [m]
  double use_ball = 0.25;        ///< radius of the ball of a use, as a share of how far the tool was carried
  double min_use_path = 3.5;     ///< shortest path of a use inside that ball, in radii; straight through: 2
};

/// Throws `ConfigurationError` for a number out of its range.
inline void check(const DeedSettings& s) {
  const auto within = [](double x, double most, const char* what, const char* allowed) {
    require(x > 0 && x <= most, what, x, allowed);
  };
  within(s.reach, 10, "DeedSettings: reach", "> 0, <= 10 m");
  within(s.near_container, 10, "DeedSettings: near_container", "> 0, <= 10 m");
  within(s.near_used, 10, "DeedSettings: near_used", "> 0, <= 10 m");
  within(s.use_ball, 1, "DeedSettings: use_ball", "> 0, <= 1");
  within(s.min_use_path, 1000, "DeedSettings: min_use_path", "> 0, <= 1000 radii");
}

/// The episodes of a demonstration, or why there are none.
template <Frame W = World>
struct Deeds {
  std::vector<Episode<W>> episodes;
  Refusal why = Refusal::none;
  Nanoseconds at{};  ///< time in the demonstration that the refusal is about
};

namespace detail {
template <Frame W>
class DeedReader {
 public:
  DeedReader(const Demonstration<W>& shown, const DeedSettings& s)
      : d_(shown), s_(s), segments_(segments_of(shown.hand)), known_(shown.kinds.size()) {}

  [[nodiscard]] Deeds<W> read() {
    Deeds<W> out;
    const auto refuse = [&](Refusal why, std::size_t i) { return Deeds<W>{{}, why, d_.hand[i].time}; };
    if (segments_.contacts.empty()) return refuse(Refusal::nothing_taken, 0);
    for (const auto& c : segments_.contacts) {
      if (c.span.begin == 0 || c.span.end == d_.hand.size())
        return refuse(Refusal::hand_not_empty, c.span.begin);
      const std::size_t thing = taken(c.span.begin);
      if (thing == d_.kinds.size()) return refuse(Refusal::thing_unknown, c.span.begin);
      out.episodes.push_back(episode(c, thing));
    }
    return out;
  }

 private:
  static constexpr std::size_t place_detections = 30;  ///< newest detections, whose middle is a place
  static constexpr Nanoseconds longest_stand = 500ms;  ///< longest stand that counts, to each side of a deed
  static constexpr Nanoseconds let_go_time = 100ms;    ///< time after which a thing lies where it was put

  struct Known {
    ObjectPose<W> X_WO{};
    Nanoseconds free{};  ///< time since which the thing lies at `X_WO`
    bool placed = false;
  };
  [[nodiscard]] Nanoseconds time(std::size_t i) const {
    return d_.hand[std::min(i, d_.hand.size() - 1)].time;
  }
  [[nodiscard]] Xyz<double> hand(std::size_t i) const { return d_.hand[i].X_WH.origin(); }

  /// Whether a thing has a place at `at`; `X_WO`: middle of its last detections since it was put there.
  [[nodiscard]] bool find(std::size_t thing, Nanoseconds at, ObjectPose<W>& X_WO) const {
    std::vector<ObjectPose<W>> seen;
    for (auto d = std::upper_bound(d_.seen.begin(), d_.seen.end(), at,
                                   [](Nanoseconds t, const Detection<W>& x) { return t < x.time; });
         d != d_.seen.begin() && seen.size() < place_detections;) {
      --d;
      if (d->time <= known_[thing].free) break;
      if (d->object == thing) seen.push_back(d->X_WO);
    }
    if (!seen.empty())
      X_WO = middle(seen);
    else
      X_WO = known_[thing].X_WO;
    return !seen.empty() || known_[thing].placed;
  }
  /// The thing nearest to the hand at sample `i`; the number of things if there is none within `reach`.
  [[nodiscard]] std::size_t taken(std::size_t i) const {
    std::size_t best = d_.kinds.size();
    double nearest = s_.reach;
    for (std::size_t k = 0; k < d_.kinds.size(); ++k) {
      ObjectPose<W> X_WO;
      if (!find(k, time(i), X_WO)) continue;
      const double d = norm(Xyz<double>(X_WO.origin() - hand(i)));
      if (d < nearest) nearest = d, best = k;
    }
    return best;
  }
  /// The samples about `i` in which the hand stands, at most half a second to each side.
  [[nodiscard]] Span stand(std::size_t i) const {
    Span s{i, i + 1};
    while (s.begin > 0 && segments_.moving[s.begin - 1] == 0 && time(i) - time(s.begin - 1) <= longest_stand)
      --s.begin;
    while (s.end < d_.hand.size() && segments_.moving[s.end] == 0 && time(s.end) - time(i) <= longest_stand)
      ++s.end;
    return s;
  }
  /// A deed whose place is the middle of the given poses.
  [[nodiscard]] Deed<W> deed(Verb verb, std::size_t thing, Nanoseconds at,
                             const std::vector<Transform<W, Tool>>& poses) const {
    Deed<W> out;
    out.verb = verb;
    out.role = d_.kinds[thing];
    out.time = at;
    const auto X_WH = middle(poses);
    double square = 0;
    for (const auto& X : poses) square += std::pow(norm(Xyz<double>(X.origin() - X_WH.origin())), 2);
    out.sigma = std::sqrt(square / (3 * static_cast<double>(poses.size())));
    out.places.push_back({0, Transform<ObjectFrame, Tool>(X_WH.axes(), X_WH.origin())});
    for (std::size_t k = 0; k < d_.kinds.size(); ++k) {
      ObjectPose<W> X_WO;
      if ((k != thing || verb == Verb::take) && find(k, at, X_WO))
        out.places.push_back({d_.kinds[k], X_WO.inverse() * X_WH});
    }
    const auto distance = [](const TaughtPlace& p) { return norm(p.X_MH.origin()); };
    std::stable_sort(out.places.begin() + 1, out.places.end(),
                     [&](const TaughtPlace& a, const TaughtPlace& b) { return distance(a) < distance(b); });
    if (verb == Verb::take) out.mark = out.role;
    for (std::size_t k = 1; k < out.places.size() && out.mark == 0; ++k) {
      const ObjectClass kind = out.places[k].mark;
      const bool container = kind < 64 && ((s_.containers >> kind) & 1u) != 0;
      if ((verb == Verb::use && distance(out.places[k]) < s_.near_used) ||
          (verb == Verb::release && container && distance(out.places[k]) < s_.near_container))
        out.mark = kind;
    }
    return out;
  }
  [[nodiscard]] std::vector<Transform<W, Tool>> poses(Span s) const {
    std::vector<Transform<W, Tool>> out;
    for (std::size_t i = s.begin; i < s.end; ++i) out.push_back(d_.hand[i].X_WH);
    return out;
  }
  [[nodiscard]] Episode<W> episode(const ShownContact& c, std::size_t thing) {
    Episode<W> out;
    out.push_back(deed(Verb::take, thing, time(c.span.begin), poses(stand(c.span.begin))));
    const auto X_OH = out.back().at(d_.kinds[thing]).X_MH;
    for (const auto& s : c.squeezes) {
      out.push_back(deed(Verb::squeeze, thing, time(s.span.begin), poses(s.span)));
      out.back().felt = s.felt;
    }
    use(out, c.span, thing);
    std::stable_sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.time < b.time; });
    const Span end = stand(c.span.end - 1);
    out.push_back(deed(Verb::release, thing, time(c.span.end), poses(end)));
    known_[thing] = {middle(poses(end)) * X_OH.inverse(), time(c.span.end) + let_go_time, true};
    return out;
  }
  /// Adds the use of a tool: its path in some ball is longer than that of one that passes through.
  void use(Episode<W>& out, Span in, std::size_t thing) const {
    const auto& p = segments_.p;
    const UsedSpan used = used_span(p, in.begin, in.end, s_.use_ball, s_.min_use_path);
    if (!(used.radius > 0)) return;
    std::vector<Transform<W, Tool>> at;
    for (std::size_t i = in.begin; i < in.end; ++i)
      if (norm(Xyz<double>(p[i] - p[used.centre])) < used.radius) at.push_back(d_.hand[i].X_WH);
    out.push_back(deed(Verb::use, thing, time(used.centre), at));
    const auto X_WH = out.back().places.front().X_MH;
    const UsedSpan s = without_ends(p, used);
    std::vector<Xyz<double>> path;
    for (std::size_t i = s.from; i < s.to; ++i)
      path.push_back(X_WH.axes().transpose() * Xyz<double>(p[i] - X_WH.origin()));
    out.back().way = taught_way(path);
  }
  const Demonstration<W>& d_;
  DeedSettings s_;
  Segments segments_;
  std::vector<Known> known_;
};
inline constexpr Nanoseconds shortest_sample = 100us;  ///< shortest time between two samples

/// Whether `d` has 10 samples, finite, at times that rise by 0.1 ms or more, and only objects that exist.
template <Frame W>
[[nodiscard]] bool is_recording(const Demonstration<W>& d) {
  const auto pose = [](const auto& X) {
    return dot(X.origin(), X.origin()) <= 1e12 && rotation_error(X.axes()) <= 1e-6;
  };
  for (std::size_t i = 0; i < d.hand.size(); ++i)
    if (!pose(d.hand[i].X_WH) || !(std::abs(d.hand[i].force) <= 1e6) || !is_plausible(d.hand[i].time) ||
        (i > 0 && !(d.hand[i].time >= d.hand[i - 1].time + shortest_sample)))
      return false;
  for (std::size_t i = 0; i < d.seen.size(); ++i)
    if (!pose(d.seen[i].X_WO) || d.seen[i].object >= d.kinds.size() || !is_plausible(d.seen[i].time) ||
        (i > 0 && d.seen[i].time < d.seen[i - 1].time))
      return false;
  return d.hand.size() >= 10;
}
}  // namespace detail

/// The deeds of a demonstration. Throws `ConfigurationError` for settings out of range.
///
/// - Each contact is an episode: take, squeezes and a use in the order of time, release.
/// - The pose of a deed is the middle of its stand, in the world and in the frame of every thing seen. Its
///   landmark is the nearest container within `near_container`, of a use any thing within `near_used`, else
///   the world. Things that are carried lie where they were put until they are seen again.
/// - A tool is used where its path in a ball, with radius `use_ball` of the carry, exceeds `min_use_path`.
template <Frame W = World>
[[nodiscard]] Deeds<W> deeds_of(const Demonstration<W>& shown, const DeedSettings& settings = {}) {
  check(settings);
  if (!detail::is_recording(shown)) return {{}, Refusal::not_a_recording, {}};
  return detail::DeedReader<W>(shown, settings).read();
}
SKINCTL_END_NAMESPACE
