// 200 people teach three goals each by leading a UR5 on its real cycle: which goals are found, and how near.
// `demonstration [first seed] [how many]`
#include <cstdio>
#include <cstdlib>

#include "bench/studies/worlds/led_arm.hpp"

using namespace skinctl;
using namespace skinctl::testing;

int main(int count, char** arguments) {
  const std::uint64_t first = count > 1 ? std::strtoull(arguments[1], nullptr, 10) : 1000;
  const int number = count > 2 ? std::atoi(arguments[2]) : 200;
  int right = 0, fewer = 0, more = 0, compared = 0;
  double rest = 0, worst = 0, button = 0, worst_button = 0, meant = 0, turned = 0;
  for (int i = 0; i < number; ++i) {
    LedArm arm(first + static_cast<std::uint64_t>(i));
    const auto led = arm.teach();
    std::vector<Taught<>> goals;
    for (const auto& t : segment(led.samples, std::vector<Object<>>{}))
      if (t.activity == Activity::reach || t.activity == Activity::put) goals.push_back(t);
    if (goals.size() != led.goals.size()) {
      (goals.size() < led.goals.size() ? fewer : more) += 1;
      continue;
    }
    bool all = true;
    for (std::size_t k = 0; k < goals.size(); ++k) {
      const auto far = [](const auto& a, const auto& b) {
        return norm(Xyz<double>(a.origin() - b.origin()));
      };
      const double off = far(goals[k].X_WH, led.goals[k].rested),
                   by_switch = far(led.goals[k].switched, led.goals[k].rested);
      all = all && off < 0.005;
      rest += off * off, button += by_switch * by_switch;
      meant += std::pow(norm(Xyz<double>(goals[k].X_WH.origin() - led.goals[k].meant)), 2);
      turned = std::max(turned, norm(log_so3(goals[k].X_WH.axes().transpose() * led.goals[k].rested.axes())));
      worst = std::max(worst, off), worst_button = std::max(worst_button, by_switch);
      ++compared;
    }
    right += all ? 1 : 0;
  }
  const auto rms = [&](double square) { return 1e3 * std::sqrt(square / std::max(1, compared)); };
  std::printf(
      "%d demonstrations: %d with exactly the three goals where the arm was left, %d with fewer, %d with "
      "more\n",
      number, right, fewer, more);
  std::printf(
      "taught goal against where the arm rested: %.2f mm rms, %.2f worst; turned by at most %.2f mrad\n",
      rms(rest), 1e3 * worst, 1e3 * turned);
  std::printf("pose at the switch: %.2f mm rms, %.2f worst\nagainst what the person meant: %.2f mm rms\n",
              rms(button), 1e3 * worst_button, rms(meant));
  return right < 0.95 * number || rms(rest) > 1;
}
