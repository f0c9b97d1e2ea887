// A run that never took place, with known peaks, for tests of what is shown.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "examples/compliant_ur5/run_log.hpp"
#include "skinctl/core/status.hpp"

namespace compliant_ur5 {

/// So many seconds at `rate`, a touch of 1.5 s every 6 s; the third one never gives way.
inline RunLog synthetic_log(double duration = 60, double rate = 500) {
  RunLog log;
  log.title = "Simulated UR5 e-Series, velocity interface, 500 Hz";
  log.laws = {"spline joint", "skin joint", "gravity"};
  log.velocity_limit.fill(1.5);
  log.acceleration_limit = {15, 15, 15, 20, 20, 20};
  log.rigid_peak_force = 182.4;
  log.scenario = {{"Stiffness of finger and skin", "5000 N/m"},
                  {"Speed of the finger", "0.1 m/s"},
                  {"Travel", "36 mm"},
                  {"Delay of the arm", "8 ms + 8 ms lag"},
                  {"Interface", "velocity, 500 Hz"}};
  log.result = {{"Cycles", "30000"},
                {"Missed deadlines", "0 (faster than real time)"},
                {"Allocations in the loop", "0"},
                {"Command steps above the limits", "0"}};
  log.times = {{"sensing", 0.41, 0.72, 1.3, 18.2}, {"model", 0.63, 0.81, 1.1, 22.9},
               {"laws", 0.22, 0.31, 0.55, 9.1},    {"resolver", 1.31, 1.92, 3.4, 31.0},
               {"guard", 0.12, 0.17, 0.29, 4.4},   {"whole cycle", 2.71, 3.94, 6.8, 61.3}};
  log.cycle = {.period = 1 / rate, .substeps = 4, .repeated = 1001, .repeated_median = 2.4};
  const double pi = std::numbers::pi;
  for (double start = 3; start + 1.5 < duration; start += 6) {
    TouchSummary t;
    const auto i = log.touches.size();
    t.start = start, t.end = start + 1.5;
    t.link = static_cast<int>(1 + i % 3);
    t.cell = static_cast<std::uint32_t>(11 + 7 * i);
    t.peak_force = 21 + static_cast<double>(i);
    t.true_peak_force = t.peak_force * 1.06;
    t.deflection = 0.024 + 0.001 * static_cast<double>(i);
    t.give_way = i == 2 ? -1 : 0.034 + 0.002 * static_cast<double>(i);
    t.return_error = 0.0004;
    // Round the tubes of upper arm, forearm and first wrist.
    const double turn = 2.4 * static_cast<double>(i), along = 0.03 * static_cast<double>(i % 8);
    if (t.link < 3)
      t.place = {-0.08 - along, 0.05 * std::cos(turn),
                 (t.link == 1 ? 0.136 : 0.0165) + 0.05 * std::sin(turn)};
    else
      t.place = {0.045 * std::cos(turn), 0.045 * std::sin(turn), 0.06 + along / 4};
    log.touches.push_back(t);
    log.peak_force = std::max(log.peak_force, t.peak_force);
  }
  const auto n = static_cast<std::size_t>(duration * rate);
  log.entries.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    LogEntry& e = log.entries[k];
    e.time = static_cast<double>(k) / rate;
    double push = 0, away = 0, away_rate = 0;
    for (const TouchSummary& t : log.touches) {
      const double s = e.time - t.start;
      if (s < 0 || s > 3) continue;
      if (s < 1.5) push = t.peak_force * std::min({1.0, s / 0.06, (1.5 - s) / 0.2}) * (s < 0.12 ? 1 : 0.8);
      away = s < 1.5 ? 1 - std::exp(-s / 0.2) : std::exp(-(s - 1.5) / 0.3);
      away_rate = s < 1.5 ? std::exp(-s / 0.2) / 0.2 : -std::exp(-(s - 1.5) / 0.3) / 0.3;
      if (s < 0.1) e.status |= skinctl::Status(skinctl::Reason::acceleration_limited).bits();
    }
    e.force = push;
    for (std::size_t j = 0; j < 6; ++j) {
      const double a = 1 / (1.0 + static_cast<double>(j)), w = 0.2 * pi * (1 + 0.3 * static_cast<double>(j));
      const double dither = 0.02 * std::sin(91.0 * e.time * (1 + static_cast<double>(j)));
      constexpr double home[] = {0, -1.2, 1.4, -1.8, -1.57, 0.3};
      e.target[j] = static_cast<float>(home[j] + 0.6 * a * std::sin(w * e.time));
      e.q[j] = static_cast<float>(static_cast<double>(e.target[j]) - 0.09 * a * away);
      e.velocity[j] = static_cast<float>(0.6 * a * w * std::cos(w * e.time) - 0.09 * a * away_rate);
      e.acceleration[j] = static_cast<float>(-0.6 * a * w * w * std::sin(w * e.time) +
                                             a * (push > 0 ? 9 * away_rate / 5 : 0) + dither);
      e.shares[0][j] = static_cast<float>(8 * a * std::sin(w * e.time) + 6 * a * away);
      e.shares[1][j] = static_cast<float>(-push * 0.4 * a);
      e.shares[2][j] = static_cast<float>(j == 1 ? -48 + 4 * std::cos(w * e.time) : j == 2 ? -14 : 0.3);
    }
    e.deflection = 0.09 * away;
  }
  return log;
}

}  // namespace compliant_ur5
