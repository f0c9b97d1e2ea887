// Runs a scene in its worlds, and times its cycles hot and cold.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <type_traits>

#include "bench/studies/trade/world.hpp"
#include "bench/support/cold.hpp"

namespace trade {

/// Calls `f` from a function by whose short name callgrind knows what to count.
template <class F>
inline void call(const void* f) {
  (*static_cast<const F*>(f))();
}
[[gnu::noinline]] inline void trade_step(void (*what)(const void*), const void* with) {
  what(with);
  asm volatile("" : : : "memory");
}
template <class Scene>
void step(const Scene& scene, typename Scene::Memory& memory, const typename Scene::Input& input) {
  const auto once = [&] {
    const auto out = scene.step(memory, input);
    asm volatile("" : : "g"(&out) : "memory");
  };
  trade_step(&call<decltype(once)>, &once);
}

/// @tparam Goal  `goal(input, t)` sets goals
template <class Scene, class Place, class Goal>
class SceneRunner : public Runner {
 public:
  static constexpr std::size_t joints = Scene::joints;
  SceneRunner(const Scene& scene, const std::array<double, joints>& home, std::vector<CellPlace> cells,
              double newtons, const Choices& choices, const Place& place, const Goal& goal,
              const World& given, const World& stiff)
      : scene_(std::make_unique<Scene>(scene)),
        home_(home),
        cells_(std::move(cells)),
        newtons_(newtons),
        choices_(choices),
        place_(place),
        goal_(goal),
        given_(given),
        stiff_(stiff),
        memory_(std::make_unique<typename Scene::Memory>()) {}

  Course given() override {
    record_ = {};
    return run(*scene_, given_, home_, cells_, newtons_, choices_, place_, goal_, &record_);
  }
  Course stiff() override {
    if (stiff_.presses.empty()) return {};
    return run(*scene_, stiff_, home_, cells_, newtons_, choices_, place_, goal_,
               static_cast<Record<Scene>*>(nullptr));
  }
  void cycles(std::size_t count) override {
    for (std::size_t k = 0; k < count; ++k) {
      if (k % record_.cycles.size() == 0) scene_->start(*memory_, record_.start);
      step(*scene_, *memory_, record_.input(k % record_.cycles.size()));
    }
  }
  double hot() override {
    // Others have this machine too: ten cycles at a time, the fastest of their repetitions.
    constexpr std::size_t few = 10, repetitions = 21;
    std::vector<double> best(record_.cycles.size() / few, 1e300);
    for (std::size_t repetition = 0; repetition < repetitions; ++repetition) {
      scene_->start(*memory_, record_.start);
      for (std::size_t k = 0; k < best.size(); ++k) {
        const auto a = now();
        for (std::size_t i = 0; i < few; ++i) step(*scene_, *memory_, record_.input(few * k + i));
        best[k] = std::min(best[k], 1e-3 * double((now() - a).count()) / few);
      }
    }
    return median(best);
  }
  double cold() override {
    std::vector<double> us, nothing;
    const std::size_t n = record_.cycles.size();
    scene_->start(*memory_, record_.start);
    for (std::size_t k = 0; k < n; ++k) {
      const auto input = record_.input(k);
      if (k % 2 == 1) {
        bench::flush(memory_.get(), sizeof(typename Scene::Memory));
        bench::flush(scene_.get(), sizeof(Scene));
        auto a = now();
        nothing.push_back(1e-3 * double((now() - a).count()));
        a = now();
        step(*scene_, *memory_, input);
        us.push_back(1e-3 * double((now() - a).count()));
      } else {
        step(*scene_, *memory_, input);
      }
    }
    return median(us) - median(nothing);
  }
  std::size_t bytes() const override { return sizeof(Scene) + sizeof(typename Scene::Memory); }
  std::size_t count() const override { return record_.cycles.size(); }

 private:
  static Nanoseconds now() { return std::chrono::steady_clock::now().time_since_epoch(); }
  static double median(std::vector<double>& x) {
    std::nth_element(x.begin(), x.begin() + std::ptrdiff_t(x.size() / 2), x.end());
    return x[x.size() / 2];
  }
  std::unique_ptr<Scene> scene_;
  std::array<double, joints> home_;
  std::vector<CellPlace> cells_;
  double newtons_;
  Choices choices_;
  Place place_;
  Goal goal_;
  World given_, stiff_;
  Record<Scene> record_;
  std::unique_ptr<typename Scene::Memory> memory_;
};

template <class Scene, class Place, class Goal>
std::unique_ptr<Runner> runner(const Scene& scene, const std::array<double, Scene::joints>& home,
                               std::vector<CellPlace> cells, double newtons, const Choices& choices,
                               const Place& place, const Goal& goal, const World& given, const World& stiff) {
  return std::make_unique<SceneRunner<Scene, Place, Goal>>(scene, home, std::move(cells), newtons, choices,
                                                           place, goal, given, stiff);
}
inline constexpr auto no_goal = [](auto&, double) {};

}  // namespace trade
