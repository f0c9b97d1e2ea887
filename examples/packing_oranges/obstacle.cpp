#include "examples/packing_oranges/obstacle.hpp"

#include <algorithm>

namespace packing {
using skinctl::Capsule;
using skinctl::Xyz;

Eyes::Eyes(std::vector<skinctl::CellPlace> cells, std::uint64_t seed)
    : cells_(std::move(cells)), readings_(cells_.size()), random_(seed) {
  rays_.push_back({0, 0, 1});
  for (const double angle : {0.5 * sight_cone, 1.0 * sight_cone})
    for (int k = 0; k < 6; ++k) {
      const double a = angle * M_PI / 180, b = k * M_PI / 3;
      rays_.push_back({std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a)});
    }
}

std::span<const double> Eyes::look(std::span<const skinctl::Transform<skinctl::World, skinctl::Tool>> links,
                                   std::span<const Capsule<>> around) {
  for (std::size_t i = 0; i < cells_.size(); ++i) {
    const auto& X = links[cells_[i].link];
    const Xyz<double> p = X.origin() + X.axes() * cells_[i].place, n = X.axes() * cells_[i].normal;
    readings_[i] = 0;  // noise alone is below the threshold
    const auto near = [&](const Capsule<>& c) { return distance(p, c) < sight_range; };
    if (std::none_of(around.begin(), around.end(), near)) continue;
    const Xyz<double> a = std::abs(n.x) < 0.5 ? Xyz<double>{1, 0, 0} : Xyz<double>{0, 1, 0};
    const Xyz<double> b = cross(n, a), x = (1 / norm(b)) * b, y = cross(n, x);
    double least = sight_range;
    for (const Xyz<double>& r : rays_) {
      const Xyz<double> way = r.x * x + r.y * y + r.z * n;
      for (const Capsule<>& c : around)
        for (double t = 0; t < least;) {
          const double d = distance(Xyz<double>(p + t * way), c);
          if (d < 1e-3) {
            least = t;
            break;
          }
          t += d;
        }
    }
    readings_[i] = std::clamp(1 - least / sight_range + 0.01 * normal_(random_), 0.0, 1.0);
  }
  return readings_;
}

void Passer::begin(double stands, std::span<const Capsule<>> near) {
  const auto in = [&](double a, double b) { return std::uniform_real_distribution<double>(a, b)(random_); };
  const double a = in(-M_PI, M_PI), up = in(-0.15, 0.15);
  along_ = {std::cos(up) * std::cos(a), std::cos(up) * std::sin(a), std::sin(up)};
  from_ = Xyz<double>{in(-0.3, 0.3), in(-0.4, 0.4), in(0.35, 0.6)} - 0.9 * along_;
  radius_ = in(0.03, 0.06);
  way_ = 0;
  for (double s = 0; s < 1.8; s += 0.02) {
    const Xyz<double> p = from_ + s * along_;
    const Capsule<> at{p, p, radius_};
    if (p.z < 0.3) return;
    for (const double x : {stands, -stands})
      if (distance(at, Capsule<>{{x, 0, 0}, {x, 0, 0.25}, 0.12}).distance < 0.25) return;
    if (s > 0) continue;
    for (const auto& c : near)
      if (distance(at, c).distance < 0.25) return;
  }
  at_ = {from_, from_, radius_};
  ++passes_;
}

const Capsule<>& Passer::step(double dt, double stands, std::span<const Capsule<>> near) {
  if (!(at_.radius > 0)) {
    rests_ -= dt;
    if (rests_ <= 0) begin(stands, near);
    return at_;
  }
  way_ += speed_ * dt;
  const Xyz<double> p = from_ + way_ * along_;
  at_ = {p, p, radius_};
  if (way_ > 1.8) at_.radius = 0, rests_ = 2;
  return at_;
}

}  // namespace packing
