// What an arm believes of oranges, box and bins that its detector sees, and does not number.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "examples/packing_oranges/camera_offset.hpp"
#include "examples/packing_oranges/detector.hpp"
#include "skinctl/semantics/tracks_from_base.hpp"

namespace packing {

class Believed {
 public:
  static constexpr std::size_t capacity = 40;  ///< all oranges of the world, trays, ghosts and flashes
  using Tracks = skinctl::TracksFromBase<capacity>;
  using Objects = skinctl::ObjectWorld<capacity>;
  using Place = skinctl::Xyz<double>;

  /// Whether a hand there may hide what is at `p`: from where it was at the picture, at 0.8 m/s for 60 ms.
  [[nodiscard]] static bool hides(const Place& hand, const Place& p) {
    constexpr double beside = Detector::hides + 0.06, below = Detector::hides_below + 0.03;
    return std::hypot(hand.x - p.x, hand.y - p.y) <= beside && hand.z - p.z <= below;
  }
  /// A picture that has arrived, while hands are there: the arm's own, and the other arm's.
  void see(const Picture& picture, std::span<const Place> hands) {
    static_cast<void>(tracks_.drove(m_, picture.base));
    const Place at = picture.base.X_WB.origin();
    const auto shows = [&](const Place& p) {
      if (std::hypot(p.x - at.x, p.y - at.y) > picture.range) return false;
      return std::none_of(hands.begin(), hands.end(), [&](const Place& hand) { return hides(hand, p); });
    };
    static_cast<void>(tracks_.see(m_, picture.taken, std::span(picture.things), shows));
  }
  /// Writes what is believed to objects with the numbers of the tracks; not the one in the hand.
  void write(Objects::Memory& known) const {
    for (std::size_t k = 0; k < capacity; ++k) {
      if (k == known.held) continue;
      const auto& t = m_.tracks[k];
      const Place p = tracks_.aim(m_, t.p);
      auto& o = known.objects[k];
      o.known = is_taken(t.kind) && Tracks::belief(m_, t) > 0;
      if (o.known) o.kind = t.kind;
      o.X_WO = skinctl::ObjectPose<>::translation_xyz(p.x, p.y, p.z);
      o.sigma = t.sigma, o.time = t.seen, o.misses = 0;
    }
  }
  /// Where box and bins are believed to be, and when each was seen last.
  struct FoundTrays {
    Trays at;
    std::array<skinctl::Nanoseconds, tray_count> seen{};
  };
  /// Brings them up to date: each is the believed place of its class that was seen last, the bins each the
  /// one near where it was.
  void find(FoundTrays& known) const {
    for (std::size_t n = 0; n < tray_count; ++n) {
      Tray& tray = known.at[n];
      for (const auto& t : m_.tracks) {
        const Place p = t.p + m_.bias;
        const bool fits = t.kind == (n == 0 ? box_class : bin_class) && Tracks::belief(m_, t) > 0 &&
                          t.sigma <= found_within &&
                          (n == 0 || std::hypot(p.x - tray.x, p.y - tray.y) <= carried_within);
        if (fits && t.seen > known.seen[n]) known.seen[n] = t.seen, tray.x = p.x, tray.y = p.y;
      }
    }
  }
  /// The believed thing of a class that is nearest to a place, of those for whose places `fits(place)`: its
  /// place, and when it was seen last; a time of 0: there is none.
  struct FoundThing {
    Place p{0, 0, 0};
    skinctl::Nanoseconds seen{};
  };
  template <class Fits>
  [[nodiscard]] FoundThing nearest_of(skinctl::ObjectClass kind, const Place& to, const Fits& fits) const {
    FoundThing best;
    for (const auto& t : m_.tracks) {
      const Place p = tracks_.aim(m_, t.p);
      if (t.kind != kind || !(Tracks::belief(m_, t) > 0) || !fits(p)) continue;
      if (best.seen == skinctl::Nanoseconds(0) || norm(Place(p - to)) < norm(Place(best.p - to)))
        best = {p, t.seen};
    }
    return best;
  }
  /// Oranges that are believed to lie in a tray, or on others in it.
  [[nodiscard]] std::vector<Place> lying_in(const Tray& tray) const {
    std::vector<Place> out;
    for (const auto& t : m_.tracks)
      if (const Place p = t.p + m_.bias;
          t.kind == orange_class && Tracks::belief(m_, t) > 0 && tray.holds({p.x, p.y, 0}))
        out.push_back(p);
    return out;
  }
  /// The number of the orange to take, of those that fit, at the least cost; `no_object`: none.
  template <class Fits, class Cost>
  [[nodiscard]] std::uint8_t choose(const Fits& fits, const Cost& cost) {
    const auto number = [&](const auto& t) { return static_cast<std::uint8_t>(&t - m_.tracks.data()); };
    const auto is_left = [&](const Place& p) {
      return std::any_of(left_.begin(), left_.end(),
                         [&](const Place& q) { return norm(Place(p + m_.bias - q)) < left_within; });
    };
    const std::uint8_t k = tracks_.choose(
        m_, [&](const auto& t) { return fits(number(t)) && !is_left(t.p); },
        [&](const auto& t) { return cost(number(t)); });
    if (k < capacity) goes_for_ = m_.tracks[k].p, felt_ = false;
    return k;
  }
  /// Whether its fingers have room beside the orange that was chosen last: they may touch a neighbour else.
  void has_room(bool room) { has_room_ = room; }
  /// The fingers, on their way to the orange that was chosen last and around it.
  void feel(const skinctl::GripperState& fingers) {
    constexpr double touches = 1, meet = 0.02;  // [N]; nearer than so they press on each other [m]
    felt_ = felt_ || (fingers.force > touches && (!fingers.measured || fingers.opening > meet));
  }
  /// The hand has the orange that was chosen last, or found none there.
  void took() {
    before_ = m_;
    tracks_.took(m_, chosen());
    if (wary_ > 0) --wary_;
  }
  void failed(const Tray& feed) {
    tracks_.failed(m_, chosen(), felt_ && has_room_,
                   [&](const auto& t) { return is_taken(t.kind) && feed.holds(t.p); });
    ++failures_;
    wary_ = 3;
    if (felt_ && has_room_) doubt_camera();
  }
  /// Something was missed, has slipped or lies beside the middle of the fingers: the camera may be off.
  void doubt_camera() {
    if (!doubts_camera_) camera_.doubt();
    doubts_camera_ = true, ++turns_;
  }
  /// Whether what it takes is set down first, and looked at: that tells how far the camera is off.
  [[nodiscard]] bool doubts_camera() const { return doubts_camera_; }
  /// Whether what has been set down has told how far it is off.
  [[nodiscard]] bool knows_camera() const { return !doubts_camera_ && camera_.known(); }
  /// Takes over what others have found, until it has found that out itself.
  void hear_of_camera(const Believed& others) {
    if (knew_camera_ || !others.camera_.known()) return;
    camera_ = others.camera_;
    found_camera(others.m_.bias);
  }
  /// Turn of the hand about the vertical for the next take [rad]: while the camera is doubted each one comes
  /// from 45 degrees further. Fingers that are off by 25 mm along their way stand on what they would take;
  /// turned so they do not.
  [[nodiscard]] double turn() const { return doubts_camera_ ? M_PI / 4 * (turns_ % 4) : 0; }
  /// Sets down there what it took, which lies where the fingers held it along these directions.
  void set_down(const Place& p, std::vector<Place> along, skinctl::Nanoseconds now) {
    set_down_ = p, along_ = std::move(along), set_down_at_ = now;
  }
  /// Whether what was set down is still to be seen there; if it is, it has told how far the camera is off.
  [[nodiscard]] bool waits_for_set_down(skinctl::Nanoseconds now) {
    constexpr auto patience = 2s;      // after it was let go
    constexpr double settled = 0.002;  // deviation of a place after seven pictures [m]
    if (along_.empty()) return false;
    const auto* seen = nearest(set_down_, beside);
    if (seen != nullptr && seen->seen > set_down_at_ && seen->sigma <= settled)
      compare(seen->p);
    else if (now - set_down_at_ < patience)
      return true;
    along_.clear();
    return false;
  }
  /// What it took slipped before it was lifted: that take tells nothing of the camera.
  void slipped() {
    m_.bias = before_.bias, m_.trial = before_.trial, m_.successes = before_.successes;
    m_.places = before_.places, m_.since = before_.since, m_.takes = before_.takes;
    m_.found = before_.found, m_.empty = before_.empty;
  }
  /// What was taken there slipped out of the firmest grip: it is left, and somebody is asked once.
  void leave(const Place& p) {
    asks_ = asks_ || left_.empty();
    left_.push_back(p);
  }
  [[nodiscard]] const std::vector<Place>& left() const { return left_; }
  [[nodiscard]] int failures() const { return failures_; }
  /// Whether it comes down slowly, at this speed [m/s], because fingers may come down on an orange: until the
  /// first take has succeeded, and three after one that failed.
  static constexpr double wary_speed = 0.06;
  [[nodiscard]] bool is_wary() const { return wary_ > 0; }
  [[nodiscard]] bool asks() const { return m_.asks || asks_; }
  void ask() { asks_ = true; }
  void answered() {
    if (m_.asks) tracks_.answered(m_);
    asks_ = false;
  }
  [[nodiscard]] const Place& bias() const { return m_.bias; }
  /// Places in the tray at which it saw something that hands did not find.
  [[nodiscard]] std::vector<Place> doubted(const Tray& tray) const {
    std::vector<Place> out;
    for (const auto& t : m_.tracks)
      if (Tracks::is_doubted(m_, t) && tray.holds(t.p)) out.push_back(t.p);
    return out;
  }

 private:
  static constexpr double found_within = 0.003;  ///< deviation of a place that is found; three pictures [m]
  static constexpr double carried_within =
      0.35;  ///< way of a bin while it is not seen; the bins are 1 m apart [m]
  static constexpr double left_within =
      0.06;                                ///< what slipped lies so far from where it was taken, at most [m]
  static constexpr double apart = 0.03;    ///< two things are further apart [m]
  static constexpr double beside = 0.038;  ///< half an orange: no other one's middle is so near [m]
  /// The orange that is believed to lie nearest to a place, within a distance; none: nullptr.
  [[nodiscard]] const skinctl::Track<>* nearest(const Place& p, double within) const {
    const skinctl::Track<>* best = nullptr;
    for (const auto& t : m_.tracks) {
      const double far = std::hypot(t.p.x + m_.bias.x - p.x, t.p.y + m_.bias.y - p.y);
      if (t.kind == orange_class && t.sight > 0 && far < within) best = &t, within = far;
    }
    return best;
  }
  /// What was set down is seen there: a measurement of the camera along each direction in which it lies.
  void compare(const Place& seen) {
    Place bias = m_.bias;
    for (const Place& a : along_) bias = bias + camera_.measure(a, dot(a, set_down_ - seen - bias));
    ++turns_;
    found_camera(bias);
  }
  /// The search for the bias is over, and takes that failed tell nothing of real things.
  void found_camera(const Place& bias) {
    m_.bias = bias;
    doubts_camera_ = !camera_.known();
    knew_camera_ = knew_camera_ || camera_.known();
    m_.trial = m_.found = Tracks::no_trial, m_.places = m_.since = 0;
    for (auto& t : m_.tracks)
      if (t.real) t.touch = 0, t.fails = 0;
  }
  /// Its track now: numbers may change while the hand is on its way.
  [[nodiscard]] std::uint8_t chosen() const {
    std::uint8_t best = skinctl::no_object;
    double least = apart;
    for (std::size_t k = 0; k < capacity; ++k) {
      const double far = norm(Place(m_.tracks[k].p - goes_for_));
      if (m_.tracks[k].kind != 0 && far < least) best = static_cast<std::uint8_t>(k), least = far;
    }
    return best;
  }

  Tracks tracks_;
  Tracks::Memory m_, before_;
  Place goes_for_{0, 0, 0};
  std::vector<Place> left_;
  bool asks_ = false, felt_ = false, has_room_ = true;
  int failures_ = 0, wary_ = 1, turns_ = 0;
  CameraOffset camera_;
  bool doubts_camera_ = false, knew_camera_ = false;
  Place set_down_{0, 0, 0};   ///< where something was set down ...
  std::vector<Place> along_;  ///< ... and along which it lies there; empty: nothing is looked at
  skinctl::Nanoseconds set_down_at_{};
};

}  // namespace packing
