// SPDX-License-Identifier: BSD-3-Clause
// Goals from a demonstration: where a led robot was left alone, and how hard it was told to squeeze.
#pragma once

#include <deque>
#include <vector>

#include "skinctl/semantics/activity.hpp"
#include "skinctl/semantics/bit.hpp"
#include "skinctl/semantics/detail/middle.hpp"
#include "skinctl/semantics/speed_estimate.hpp"
#include "skinctl/semantics/world.hpp"

SKINCTL_BEGIN_NAMESPACE

/// One cycle of a demonstration.
template <Frame W = World>
struct LedSample {
  Nanoseconds time{};
  Transform<W, Tool> X_WH{};
  double touch = 0;                   ///< sum of the magnitudes of all forces that touch the robot [N]
  double force = 0;                   ///< force of the fingers [N]
  bool closed = false;                ///< the switch by which the person closes and opens the hand
  Activity said = Activity::unknown;  ///< a recogniser's word, for force goals; `unknown`: none
  double pressed = 0;  ///< force of the hand, or of the object in it, on a body, by a wrist sensor [N]
};

/// A taught step for a plan.
template <Frame W = World>
struct Taught {
  Activity activity = Activity::unknown;  ///< reach or put: a goal; take, release, squeeze: done there
  std::uint8_t object = no_object;        ///< the goal is relative to this object; `no_object`: to the world
  ObjectClass role = 0;                   ///< class of that object
  Transform<W, Tool> X_WH{};              ///< pose of the hand
  Transform<ObjectFrame, Tool> X_OH{};    ///< pose of the hand in the frame of `object`, if there is one
  double force = 0;                       ///< force of a squeeze [N]
  bool until_touched = false;  ///< the goal ends where something is touched, wherever that is then, ...
  Xyz<double> way{0, 0, 0};    ///< ... after a motion in this direction, of length 1, ...
  double pressed = 0;          ///< ... and was pressed on with this [N]
  Nanoseconds begin{}, end{};  ///< the stretch that it was taken from
};

/// Numbers of the segmentation.
struct DemonstrationSettings {
  double still = 0.02;           ///< slower than this is at rest [m/s]
  double untouched = 0.5;        ///< touched with less than this is left alone [N]
  Nanoseconds min_rest = 200ms;  ///< shortest time at rest and left alone
  Nanoseconds led = 300ms;       ///< shortest touch in one go before a goal, since the last goal or switch
  double apart = 0.05;           ///< smallest distance of a goal from the last one [m]
  double near_object = 0.08;     ///< a goal nearer than this to an object is relative to it [m], ...
  double at_rest = 0.01;         ///< ... unless it moved by more than this while the robot was left alone [m]
  Bit<>::Settings touches{2, 1, 24ms, 24ms};  ///< thresholds of `pressed` for a touch [N]
  double came = 0.03;  ///< length of the last part of the way to a touch, which gives its direction [m]
  SpeedEstimate<>::Settings speed{};
};

/// Reads a demonstration, cycle by cycle, into goals.
///
/// - A goal is where the robot was led and then left alone: touched for `led` in one go (a push on a switch
///   is shorter, and the arm may glide on from it), then at rest and untouched for `least`, at least `apart`
///   from the last one. Its pose is the median of the positions, and the mean of the rotations, of the
///   stretch, which ends when the robot is touched, moves, is switched or squeezes: the push on the switch
///   moves the arm. A hand that waits on the robot makes no goal.
/// - With the hand open it is one to reach, else one to put to. A switch after it is what was done there:
///   take or release.
/// - A goal near an object that rests, other than the one in hand when the robot was left, is relative to it:
///   it moves with it.
/// - A goal where the robot was led onto something, which it pressed on until it was left alone, ends with
///   that touch: its height, say, is whatever it is the next time.
/// - A stretch of the word squeeze gives its median force.
///
/// It keeps the samples of a stretch: it allocates, and belongs beside the loop.
template <Frame W = World>
class DemonstrationReader {
 public:
  /// Throws `ConfigurationError` for a number out of its range.
  SKINCTL_COLD explicit DemonstrationReader(const DemonstrationSettings& s = {})
      : s_(s), speed_(s.speed), touches_(s.touches) {
    require(s.still > 0 && s.still <= 10, "Demonstration: still", s.still, "> 0, <= 10 m/s");
    require(s.untouched > 0 && s.untouched <= 1e3, "Demonstration: untouched", s.untouched, "> 0, <= 1e3 N");
    require(s.min_rest > 0ns && s.min_rest <= 60s, "Demonstration: min_rest", milliseconds(s.min_rest),
            "> 0, <= 6e4 ms");
    require(s.led >= 0ns && s.led <= 60s, "Demonstration: led", milliseconds(s.led), "0 to 6e4 ms");
    require(s.apart >= 0 && s.apart <= 10, "Demonstration: apart", s.apart, "0 to 10 m");
    require(s.near_object >= 0 && s.near_object <= 10, "Demonstration: near_object", s.near_object,
            "0 to 10 m");
    require(s.came > 0 && s.came <= 10, "Demonstration: came", s.came, "> 0, <= 10 m");
    require(s.at_rest >= 0 && s.at_rest <= 10, "Demonstration: at_rest", s.at_rest, "0 to 10 m");
  }

  /// Takes a sample, with the objects as they are known then (a range of `Object<W>`) and the number of the
  /// one in hand. A sample that is not finite or not later than the last one is ignored.
  template <class Objects>
  void take(const LedSample<W>& x, const Objects& objects, std::uint8_t held = no_object) {
    if (speed_.step(m_, x.time, x.X_WH.origin()).any() || (started_ && x.time <= last_)) return;
    const bool switched = started_ && x.closed != closed_;
    feel(x);
    const bool alone =
        norm(m_.v) < s_.still && x.touch < s_.untouched && !switched && x.said != Activity::squeeze;
    if (!alone) close(objects);
    if (!started_ || !(x.touch >= s_.untouched)) touched_ = x.time;
    led_ = (led_ && !switched) || x.time - touched_ >= s_.led;
    if (alone) {
      if (stretch_.empty()) left(x.time, objects, held);
      stretch_.push_back(x.X_WH);
    }
    if (switched) was_switched(x);
    squeeze(x);
    last_ = x.time;
    closed_ = x.closed;
    started_ = true;
  }
  /// The end of the demonstration: what was taught, in order.
  template <class Objects>
  [[nodiscard]] std::vector<Taught<W>> finish(const Objects& objects) {
    close(objects);
    squeeze({});
    return std::move(taught_);
  }

 private:
  /// The beginning of a stretch: fingers that let go at its end have what they held in its course.
  template <class Objects>
  void left(Nanoseconds time, const Objects& objects, std::uint8_t held) {
    begin_ = time;
    held_ = held;
    onto_ = touched_at_.on && !pressed_.empty() ? detail::median(pressed_) : 0;
    lay_.clear();
    for (const Object<W>& o : objects) lay_.push_back(o.X_WO);
  }
  /// The end of a stretch.
  template <class Objects>
  void close(const Objects& objects) {
    if (!stretch_.empty() && led_ && last_ - begin_ >= s_.min_rest) {
      Taught<W> goal;
      goal.X_WH = detail::middle(stretch_);
      goal.activity = closed_ ? Activity::put : Activity::reach;
      goal.begin = begin_;
      goal.end = last_;
      if (!any_ || norm(Xyz<double>(goal.X_WH.origin() - goal_.X_WH.origin())) >= s_.apart) {
        relate(goal, objects);
        press(goal);
        goal_ = goal;
        any_ = true;
        led_ = false;
        taught_.push_back(goal);
      }
    }
    stretch_.clear();
  }
  /// The way that the hand went last, and what it presses on.
  void feel(const LedSample<W>& x) {
    const bool was = touched_at_.on;
    if (touches_.step(touched_at_, x.time, x.pressed).any()) return;
    if (!touched_at_.on) {
      trail_.push_back(x.X_WH.origin());
      if (trail_.size() > max_trail) trail_.pop_front();
      if (was) pressed_.clear();
      return;
    }
    if (!was) {
      way_ = {0, 0, 0};
      for (auto p = trail_.rbegin(); p != trail_.rend() && norm(way_) < s_.came; ++p)
        way_ = x.X_WH.origin() - *p;
      trail_.clear();
    }
    if (stretch_.empty()) pressed_.push_back(x.pressed);
  }
  /// A way shorter than half of `came` tells no direction.
  void press(Taught<W>& goal) const {
    const double went = norm(way_);
    if (!(onto_ > 0) || went < 0.5 * s_.came) return;
    goal.until_touched = true;
    goal.way = (1 / went) * way_;
    goal.pressed = onto_;
  }
  template <class Objects>
  void relate(Taught<W>& goal, const Objects& objects) const {
    double nearest = s_.near_object;
    std::uint8_t i = 0;
    for (const Object<W>& o : objects) {
      const double d = norm(Xyz<double>(o.X_WO.origin() - goal.X_WH.origin()));
      const bool rests =
          i < lay_.size() && norm(Xyz<double>(o.X_WO.origin() - lay_[i].origin())) <= s_.at_rest;
      if (o.known && rests && i != held_ && d < nearest) {
        nearest = d;
        goal.object = i;
        goal.role = o.kind;
        goal.X_OH = lay_[i].inverse() * goal.X_WH;  // before fingers that close moved it
      }
      ++i;
    }
  }
  /// Take or release, where the robot was left alone last.
  void was_switched(const LedSample<W>& x) {
    Taught<W> done = goal_;
    if (!any_) done.X_WH = x.X_WH;
    done.activity = x.closed ? Activity::take : Activity::release;
    done.begin = done.end = x.time;
    taught_.push_back(done);
  }
  void squeeze(const LedSample<W>& x) {
    if (x.said == Activity::squeeze) {
      if (forces_.empty()) squeezed_ = x.time;
      forces_.push_back(x.force);
    } else if (!forces_.empty()) {
      Taught<W> done = goal_;
      done.activity = Activity::squeeze;
      done.begin = squeezed_;
      done.end = last_;
      done.force = detail::median(forces_);
      if (done.end - done.begin >= s_.min_rest) taught_.push_back(done);
      forces_.clear();
    }
  }

  DemonstrationSettings s_;
  SpeedEstimate<> speed_;
  SpeedEstimate<>::Memory m_{};
  std::vector<Transform<W, Tool>> stretch_;
  std::vector<ObjectPose<W>> lay_;  ///< where the objects were when the robot was left
  std::vector<double> forces_;
  std::vector<Taught<W>> taught_;
  Taught<W> goal_{};
  Nanoseconds begin_{}, last_{}, squeezed_{};
  Nanoseconds touched_{};  ///< when nobody touched it last
  static constexpr std::size_t max_trail = 4000;
  Bit<> touches_;
  Bit<>::Memory touched_at_{};
  std::deque<Xyz<double>> trail_;  ///< of the hand, since nothing was touched
  std::vector<double> pressed_;    ///< since something is, while the robot is led
  Xyz<double> way_{0, 0, 0};
  double onto_ = 0;  ///< that it had been led onto something with when it was left [N]
  std::uint8_t held_ = no_object;
  bool led_ = false, any_ = false, closed_ = false, started_ = false;
};

/// The steps that a recording teaches, among objects that stay where they are: a range of `LedSample<W>`, one
/// of `Object<W>`.
template <Frame W = World, class Samples, class Objects>
[[nodiscard]] std::vector<Taught<W>> segment(const Samples& recording, const Objects& objects,
                                             const DemonstrationSettings& settings = {}) {
  DemonstrationReader<W> reader(settings);
  for (const LedSample<W>& x : recording) reader.take(x, objects);
  return reader.finish(objects);
}

SKINCTL_END_NAMESPACE
