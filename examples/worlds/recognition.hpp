// Recognition against the truth: labels by definition and by intent, scores on-line, later, and by segments.
#pragma once

#include <algorithm>
#include <deque>
#include <span>

#include "examples/worlds/led_tasks.hpp"
#include "skinctl/semantics/recogniser.hpp"

namespace skinctl::testing {

/// How a scene senses. Positions of the hand come from the robot.
struct SensingOptions {
  double rate = 250;            ///< of the hand [Hz]
  double sigma = 0.0002;        ///< of its position along each axis [m]
  double force_noise = 0.1;     ///< [N]
  double camera_rate = 30;      ///< [Hz]
  double camera_sigma = 0.005;  ///< [m]
  double camera_delay = 0.06;   ///< [s]
  double camera_lost = 0.05;    ///< share of its pictures
  double occluded = 0.08;       ///< things nearer to the hand than this are seen in one picture of five [m]
};

/// A word over time: each from its beginning until the next one's.
struct WordSpan {
  double begin;
  Activity word;
};
using Words = std::vector<WordSpan>;

[[nodiscard]] inline Activity word_at(const Words& words, double t) {
  Activity word = Activity::unknown;
  for (const auto& w : words) {
    if (w.begin > t) break;
    word = w.word;
  }
  return word;
}
inline void say(Words& words, double t, Activity a) {
  if (words.empty() || words.back().word != a) words.push_back({t, a});
}

/// The rules' words by definition: on signals without noise, tremor, delay and debounce, at 1 kHz. Moving:
/// faster than
/// 0.03 m/s. In hand: from 0.5 N until below 0.25 N. Squeezed: from 1.45 times the largest force before it
/// was carried until below 1.33 times. Carried: 15 mm from where contact began. Left: as the rules say, at
/// the true places.
[[nodiscard]] inline Words words_by_definition(const LedRun& run) {
  Words words;
  bool in_hand = false, carried = false, squeezed = false, left = true;
  double holding = 0, ended = 0;
  std::size_t held = led_things;
  Xyz<double> begun{0, 0, 0};
  for (double t = 0; t < run.lasts(); t += 0.001) {
    const auto now = run.hand.truth(t);
    const bool moving = norm(now.v) > 0.03;
    const auto far = [&](const Xyz<double>& p) { return norm(Xyz<double>(p - now.p)); };
    if (!in_hand && now.force >= 0.5) {
      in_hand = true;
      carried = squeezed = false;
      holding = 0;
      begun = now.p;
      held = led_things;
      double nearest = 0.15;
      for (std::size_t i = 0; i < led_things; ++i)
        if (const double d = far(run.place(i, t)); run.things[i].kind != 0 && d < nearest) {
          nearest = d;
          held = i;
        }
    } else if (in_hand && now.force < 0.25) {
      in_hand = left = false;
      begun = now.p;
      ended = t;
    }
    Activity word = Activity::idle;
    if (in_hand) {
      carried = carried || far(begun) > 0.015;
      if (!carried) holding = std::max(holding, now.force);
      squeezed = carried && now.force >= (squeezed ? 1.33 : 1.45) * holding;
      double nearest = 1;
      for (std::size_t i = 0; i < led_things; ++i)
        if (i != held && run.things[i].kind != 0) nearest = std::min(nearest, far(run.place(i, t)));
      const bool tool =
          held < led_things && ((thing::tools >> run.things[held].kind) & 1u) != 0 && nearest < 0.15;
      word = squeezed         ? Activity::squeeze
             : tool && moving ? Activity::use
             : moving         ? Activity::put
             : carried        ? Activity::hold
                              : Activity::take;
    } else {
      if (!left) {
        left = t - ended >= 1.5 || (!moving && far(begun) >= 0.02);
        for (std::size_t i = 0; !left && moving && far(begun) > 0.06 && i < led_things; ++i)
          if (i != held && run.things[i].kind != 0) {
            const Xyz<double> way = run.place(i, t) - now.p;
            left = dot(way, now.v) > 0.95 * norm(way) * norm(now.v);
          }
      }
      word = !left ? Activity::release : moving ? Activity::reach : Activity::idle;
    }
    say(words, t, word);
  }
  return words;
}
/// The words that an annotator who knows the script writes.
[[nodiscard]] inline Words words_by_intent(const LedRun& run) {
  Words words;
  for (double t = 0; t < run.lasts(); t += 0.001) say(words, t, run.hand.intent(t));
  return words;
}

/// A change of what the recogniser says: when it was said, and since when it holds.
struct Said {
  double decided, since;
  Activity word;
};
/// What was recognised in a run, the features from which it was, and the decisions on contact.
struct Recognition {
  std::vector<Said> said;
  std::vector<Features> features;
  std::vector<double> contact_delays;  ///< from 0.5 N to the decision [s], without transport
};

/// Plays a run to the features and a recogniser as a robot would sense it.
template <class Classifier>
[[nodiscard]] Recognition recognise(const LedRun& run, const Recogniser<Classifier>& recogniser,
                                    const FeatureExtractor<>& extractor, const SensingOptions& o,
                                    std::uint64_t seed, bool keep_features = false) {
  auto random = seeded(seed);
  std::normal_distribution<double> noise(0, 1);
  std::array<ObjectClass, led_things> kinds{};
  for (std::size_t i = 0; i < led_things; ++i) kinds[i] = run.things[i].kind;
  const ObjectWorld<led_things> world(kinds);
  auto objects = world.start();
  FeatureExtractor<>::Memory m;
  typename Recogniser<Classifier>::Memory words;
  struct Picture {
    double arrives;
    Detection<> seen;
  };
  std::deque<Picture> pictures;
  Recognition out;
  const Person& person = run.hand.person();
  double phase[3], next_picture = 0;
  for (double& x : phase) x = uniform(random, 0.0, 6.28);
  const auto sigma = [&](const Xyz<double>& p, double s) {
    return Xyz<double>(p + Xyz<double>{s * noise(random), s * noise(random), s * noise(random)});
  };
  double pressed = -1, last_force = 0;
  bool was_in_hand = false;
  for (std::size_t k = 0; static_cast<double>(k) / o.rate < run.lasts(); ++k) {
    const double t = static_cast<double>(k) / o.rate;
    for (; next_picture <= t; next_picture += 1 / o.camera_rate) {
      if (uniform(random, 0.0, 1.0) < o.camera_lost) continue;
      const auto hand = run.hand.truth(next_picture).p;
      for (std::size_t i = 0; i < led_things; ++i) {
        if (kinds[i] == 0) continue;
        const auto p = run.place(i, next_picture);
        if (norm(Xyz<double>(p - hand)) < o.occluded && uniform(random, 0.0, 1.0) < 0.8) continue;
        const auto at = sigma(p, o.camera_sigma);
        pictures.push_back({next_picture + o.camera_delay,
                            {static_cast<std::uint8_t>(i), ObjectPose<>::translation_xyz(at.x, at.y, at.z),
                             o.camera_sigma, nanoseconds(next_picture) + 1ns}});
      }
    }
    for (; !pictures.empty() && pictures.front().arrives <= t; pictures.pop_front())
      static_cast<void>(world.detect(objects, pictures.front().seen));
    const auto now = run.hand.truth(t);
    const double w = 2 * 3.14159265358979323846 * person.tremor_rate * t;
    const Xyz<double> tremor{person.tremor * std::sin(w + phase[0]), person.tremor * std::sin(w + phase[1]),
                             person.tremor * std::sin(w + phase[2])};
    const auto p = sigma(now.p + tremor, o.sigma);
    const HandSample<> hand{nanoseconds(t) + 1ns, Transform<World, Tool>::translation_xyz(p.x, p.y, p.z),
                            o.sigma, now.force + o.force_noise * noise(random)};
    const auto f = extractor.step(m, world, objects, hand);
    const auto said = recogniser.step(words, f);
    if (out.said.empty() || out.said.back().word != said.activity)
      out.said.push_back({t, seconds<double>(said.since), said.activity});
    if (keep_features) out.features.push_back(f);
    if (last_force < 0.5 && now.force >= 0.5) {
      pressed = t;  // to within a sample: make it exact
      double a = t - 1 / o.rate, b = t;
      for (int i = 0; i < 30; ++i) (run.hand.truth(0.5 * (a + b)).force < 0.5 ? a : b) = 0.5 * (a + b);
      pressed = b;
    }
    if (f.in_hand && !was_in_hand && pressed >= 0) {
      out.contact_delays.push_back(t - pressed);
      pressed = -1;
    }
    was_in_hand = f.in_hand;
    last_force = now.force;
  }
  return out;
}

/// Shares of right words, and a table of truth by word.
struct Score {
  std::array<std::array<double, activities>, activities> said{};  ///< [truth][word], on-line [s]
  double right = 0, right_later = 0, time = 0;                    ///< [s]
  double segments = 0, right_segments = 0;
  double unknown = 0;  ///< [s]

  void add(const Score& s) {
    for (std::size_t i = 0; i < activities; ++i)
      for (std::size_t j = 0; j < activities; ++j) said[i][j] += s.said[i][j];
    right += s.right, right_later += s.right_later, time += s.time, unknown += s.unknown;
    segments += s.segments, right_segments += s.right_segments;
  }
  [[nodiscard]] double online() const { return right / time; }
  [[nodiscard]] double later() const { return right_later / time; }
  [[nodiscard]] double by_segments() const { return right_segments / segments; }
};

/// Compares what was said with the truth every 4 ms. Later: as it is known `delay` after the instant, by the
/// stamps of what was said until then. Segments: stretches of one true word of at least 0.1 s; right: the
/// word of most of its time, as known later, is the true one.
[[nodiscard]] inline Score compare(const std::vector<Said>& said, const Words& truth, double lasts,
                                   double delay = 0.06) {
  Score s;
  std::size_t segment = 0;
  std::array<double, activities> shares{};
  const auto ends = [&](std::size_t k) { return k + 1 < truth.size() ? truth[k + 1].begin : lasts; };
  const auto close = [&] {
    if (ends(segment) - truth[segment].begin >= 0.1) {
      ++s.segments;
      const auto best = std::max_element(shares.begin(), shares.end()) - shares.begin();
      s.right_segments +=
          static_cast<std::size_t>(best) == static_cast<std::size_t>(truth[segment].word) ? 1 : 0;
    }
    shares = {};
  };
  const double dt = 0.004;
  std::size_t online = 0, known = 0;
  for (double t = 0.2; t < lasts - delay; t += dt) {
    while (segment + 1 < truth.size() && truth[segment + 1].begin <= t) {
      close();
      ++segment;
    }
    while (online + 1 < said.size() && said[online + 1].decided <= t + 1e-9) ++online;
    while (known + 1 < said.size() && said[known + 1].decided <= t + delay + 1e-9) ++known;
    std::size_t later = known;
    while (later > 0 && said[later].since > t) --later;
    const auto word = truth[segment].word;
    const auto w = static_cast<std::size_t>(word);
    s.said[w][static_cast<std::size_t>(said[online].word)] += dt;
    s.right += said[online].word == word ? dt : 0;
    s.right_later += said[later].word == word ? dt : 0;
    s.unknown += said[online].word == Activity::unknown ? dt : 0;
    s.time += dt;
    shares[static_cast<std::size_t>(said[later].word)] += dt;
  }
  close();
  return s;
}

}  // namespace skinctl::testing
